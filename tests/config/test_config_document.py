from __future__ import annotations

import errno
import math
import os
from pathlib import Path
from typing import NoReturn

import pytest

from designer.documents.document import DEEPEST_NESTING, Document, path_text, read_document
from designer.documents.opened import LARGEST_FILE_BYTES
from designer.errors import Fault, InputError


def document_of(folder: Path, content: str | bytes) -> Document:
    path = folder / "a.yaml"
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    return read_document(path)


def fault_of(folder: Path, content: str | bytes) -> Fault:
    with pytest.raises(InputError) as caught:
        document_of(folder, content)
    (fault,) = caught.value.faults
    assert fault.file == str(folder / "a.yaml")
    return fault


def test_every_value_knows_its_line(tmp_path: Path) -> None:
    text = "a: 1\n# comment\nb:\n  c: [1, 2,\n      3 m]\n  d:\n    - x: 7\n"
    lines = {path_text(keys): node.line for keys, node in document_of(tmp_path, text).root.walk()}
    assert lines == {
        "": 1,
        "a": 1,
        "b": 3,
        "b.c": 4,
        "b.c[0]": 4,
        "b.c[1]": 4,
        "b.c[2]": 5,
        "b.d": 6,
        "b.d[0]": 7,
        "b.d[0].x": 7,
    }


def test_scalars_follow_yaml_1_2(tmp_path: Path) -> None:
    text = "a: 010\nb: 1e5\nc: no\nd: 12:30\ne: true\nf: ~\ng: '5'\nh: 2020-01-01\ni: -.5\nj:\n"
    assert document_of(tmp_path, text).root.data() == {
        "a": 10,
        "b": 1e5,
        "c": "no",
        "d": "12:30",
        "e": True,
        "f": None,
        "g": "5",
        "h": "2020-01-01",
        "i": -0.5,
        "j": None,
    }


def test_nan_is_read_as_such(tmp_path: Path) -> None:
    data = document_of(tmp_path, "a: .nan\n").root.data()
    assert isinstance(data, dict)
    assert isinstance(data["a"], float)
    assert math.isnan(data["a"])


def test_aliases_stand_for_their_anchor_in_their_own_line(tmp_path: Path) -> None:
    root = document_of(tmp_path, "a: &x [1, 2]\nb: *x\n").root
    assert root.data() == {"a": [1, 2], "b": [1, 2]}
    assert isinstance(root.content, dict)
    assert root.content["b"].line == 2


def test_byte_order_mark_and_windows_line_ends(tmp_path: Path) -> None:
    assert document_of(tmp_path, b"\xef\xbb\xbfa: 1\r\nb: 2\r\n").root.data() == {"a": 1, "b": 2}


@pytest.mark.parametrize("content", ["", "# only a comment\n", "---\n", "null\n", "\n\n"])
def test_empty_file(tmp_path: Path, content: str) -> None:
    assert fault_of(tmp_path, content).problem == "the file is empty"


@pytest.mark.parametrize(
    ("content", "line", "problem"),
    [
        (b"a: 1\n\xff\xfe\x00", 2, "this is not text in UTF-8"),
        (b"a: 1\nb: \x00\x01", 2, "this is a binary file"),
        (b"PK\x03\x04abc", 1, "this is a binary file"),
        ("- 1\n- 2\n", 1, "the file does not hold a mapping"),
        ("just words\n", 1, "the file does not hold a mapping"),
        ("a: 1\nb: [1, 2\nc: 3\n", 3, "this is not valid YAML: "),
        ("a: 1\nb:\n\t- 1\n", 3, "a tab indents this line"),
        ("a: 1\nb: c: d\n", 2, "this is not valid YAML: "),
        ("a: 1\n---\nb: 2\n", 2, "a second document starts here"),
        ("a: 1\nb: &x [*x]\n", 2, "the alias *x contains itself"),
        ("a: 1\nb: *y\n", 2, "the alias *y has no anchor before it"),
        ("a: !!python/object/apply:os.system [ls]\n", 1, "the tag '!!python/object"),
        ("a: !mine 1\n", 1, "the tag '!mine' is not supported"),
        ("? [1, 2]\n: 3\n", 1, "a mapping or a list is no field name"),
    ],
)
def test_what_is_no_document_is_refused_with_its_line(
    tmp_path: Path, content: str | bytes, line: int, problem: str
) -> None:
    fault = fault_of(tmp_path, content)
    assert fault.line == line
    assert fault.problem.startswith(problem)


def test_duplicate_fields_are_all_found(tmp_path: Path) -> None:
    document = document_of(tmp_path, "a: 1\nb: {c: 1, c: 2}\na: 3\nl:\n  - x: 1\n    x: 2\n")
    assert [(fault.line, fault.field) for fault in document.faults] == [
        (2, "b.c"),
        (3, "a"),
        (6, "l[0].x"),
    ]
    assert "is given twice, first in line 1" in str(document.faults[1])


def test_huge_file_is_refused_unread(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "huge.yaml"
    with path.open("wb") as file:
        file.truncate(100_000_000)

    def unwanted(*_: object, **__: object) -> NoReturn:
        raise AssertionError("the file was opened")

    monkeypatch.setattr(Path, "open", unwanted)
    with pytest.raises(InputError, match="the file has 100 MB"):
        read_document(path)


def test_an_endless_stream_is_not_read() -> None:
    endless = Path("/dev/zero")
    if not endless.exists():
        pytest.skip("this system has no /dev/zero")
    with pytest.raises(InputError, match="the file cannot be read: it is a device, not a file"):
        read_document(endless)


def test_largest_file_is_still_read(tmp_path: Path) -> None:
    text = "a: 1\n#"
    document = document_of(tmp_path, text.ljust(LARGEST_FILE_BYTES, "x"))
    assert document.root.data() == {"a": 1}


def test_billion_laughs(tmp_path: Path) -> None:
    levels = ["a0: &a0 [" + ", ".join(["lol"] * 10) + "]"]
    levels += [
        f"a{level}: &a{level} [" + ", ".join([f"*a{level - 1}"] * 10) + "]"
        for level in range(1, 10)
    ]
    fault = fault_of(tmp_path, "\n".join(levels))
    assert "expand to more than" in fault.problem
    assert fault.line == 6


def test_chain_of_aliases_is_refused_by_its_depth(tmp_path: Path) -> None:
    chain = ["a0: &a0 [x]"] + [f"a{i}: &a{i} [*a{i - 1}]" for i in range(1, 400)]
    assert "nested more than" in fault_of(tmp_path, "\n".join(chain)).problem


@pytest.mark.parametrize("opening", ["[", "{a: ", "- "])
def test_deep_nesting(tmp_path: Path, opening: str) -> None:
    lead = "" if opening == "- " else "a: "
    assert "nested more than" in fault_of(tmp_path, lead + opening * 200_000).problem


def test_nesting_up_to_the_limit(tmp_path: Path) -> None:
    depth = DEEPEST_NESTING - 1
    assert document_of(tmp_path, "a: " + "[" * depth + "]" * depth).root.height == DEEPEST_NESTING


def test_control_codes_do_not_reach_the_message(tmp_path: Path) -> None:
    document = document_of(tmp_path, '"\\x1b[31m": 1\n"\\x1b[31m": 2\n')
    assert str(document.faults[0]).isprintable()


@pytest.mark.parametrize(
    ("name", "problem"),
    [
        ("absent.yaml", "there is no such file"),
        (".", "this is a folder"),
        ("x" * 300, "the file cannot be read"),
        ("\0", "the file cannot be read"),
    ],
)
def test_file_that_cannot_be_read(tmp_path: Path, name: str, problem: str) -> None:
    with pytest.raises(InputError, match=problem):
        read_document(tmp_path / name)


def test_file_without_permission(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "a.yaml"
    path.write_text("a: 1\n")

    def refuse(*_: object, **__: object) -> NoReturn:
        raise PermissionError(errno.EACCES, os.strerror(errno.EACCES))

    monkeypatch.setattr(os, "open", refuse)
    with pytest.raises(InputError, match="the file cannot be read: permission denied"):
        read_document(path)
