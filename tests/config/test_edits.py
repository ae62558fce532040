"""Changes of one value leave every other letter as it was."""

from __future__ import annotations

import pytest
import yaml
from hypothesis import given
from hypothesis import strategies as st

from designer.documents.document import document_of
from designer.documents.edits import (
    scalar,
    value_text,
    with_section,
    with_value,
    without,
    without_aliases,
)
from designer.resources import example_file, example_names

TEXT = """\
# a study
robot:          # the machine
  mass: 180 kg  # with payload, Nm²
  anchors:
    - [0, 0, 1]
    - [ 3 , 0,1 ]

pose: [1, 2, 3]   # here
flow: {a: 1, b: {c: 2}}
empty:
last: {}
"""


@pytest.mark.cases_by_default(1)
@pytest.mark.parametrize("name", example_names())
def test_every_value_put_in_as_it_stands_changes_nothing(name: str) -> None:
    text = example_file(name).read_text(encoding="utf-8")
    paths = [keys for keys, _ in document_of(text.encode(), name).root.walk() if keys]
    for keys in paths:
        written = value_text(text, keys)
        assert written is not None
        assert with_value(text, keys, written) == text


def test_a_field_that_goes_leaves_an_empty_line_above_it() -> None:
    assert without("\na: 1\nb: 2\n", ("a",)) == "\nb: 2\n"


ALIASES = """\
a: &mast
  height: &h 7.2 m   # of all
  place: [1, *h, 'it''s']
b: *mast
c: {again: *mast, low: *h}
d: &lines |
  two
  lines
e: *lines
f: [&name Crane, &q "A\\tB", *name, *q, 5*3, '&no']
"""


def test_aliases_are_written_out() -> None:
    text = without_aliases(ALIASES)
    assert "*mast" not in text and "   # of all\n" in text
    assert (
        document_of(text.encode(), "").root.data() == document_of(ALIASES.encode(), "").root.data()
    )


def test_a_change_at_an_alias_is_none_of_what_it_stands_for() -> None:
    root = document_of(with_value(ALIASES, ("b", "height"), "9 m").encode(), "").root.data()
    assert isinstance(root, dict)
    assert [root[key]["height"] for key in "ab"] == ["7.2 m", "9 m"]  # type: ignore[index, call-overload]
    root = document_of(with_value(ALIASES, ("a", "height"), "9 m").encode(), "").root.data()
    assert isinstance(root, dict)
    assert [root[key]["height"] for key in "ab"] == ["9 m", "7.2 m"]  # type: ignore[index, call-overload]
    assert value_text(ALIASES, ("c", "low")) == value_text(ALIASES, ("a", "height")) == "7.2 m"


@pytest.mark.parametrize(
    ("keys", "value", "was", "becomes"),
    [
        (("robot", "mass"), "0.2 t", "mass: 180 kg  #", "mass: 0.2 t  #"),
        (("robot", "anchors", 1, 0), "4 m", "[ 3 , 0,1 ]", "[ 4 m , 0,1 ]"),
        (("pose", 2), "-1", "[1, 2, 3]   # here", "[1, 2, -1]   # here"),
        (("flow", "b", "c"), "7", "{c: 2}", "{c: 7}"),
        (("empty",), "5", "empty:\n", "empty: 5\n"),
        (("flow", "b", "d"), "9", "{c: 2}", "{c: 2, d: 9}"),
        (("last", "x"), "1", "last: {}", "last: {x: 1}"),
        (("robot", "wrench", "force"), "[1, 2]", "0,1 ]\n", "0,1 ]\n  wrench: {force: [1, 2]}\n"),
    ],
)
def test_one_value_alone_changes(keys: tuple, value: str, was: str, becomes: str) -> None:
    assert TEXT.count(was) == 1
    assert with_value(TEXT, keys, value) == TEXT.replace(was, becomes)


@pytest.mark.parametrize("keys", [("robot", "z"), ("flow", "z"), ("flow", "b", "z"), ("z",)])
@pytest.mark.parametrize("ends", ["\n", "\r\n"])
def test_what_was_added_goes_again(keys: tuple, ends: str) -> None:
    text = TEXT.replace("\n", ends)
    longer = with_value(text, keys, "1")
    assert value_text(longer, keys) == "1"
    assert longer.count("\n") == longer.count(ends)
    assert without(longer, keys) == text


def test_a_field_that_was_first_goes_too() -> None:
    assert without("a: 1\nb: 2\n", ("a",)) == "b: 2\n"
    assert without("x: {a: 1, b: 2}\n", ("x", "a")) == "x: {b: 2}\n"
    assert without("- a: 1\n  b: 2\n", (0, "a")) == "- b: 2\n"


@pytest.mark.parametrize(
    ("text", "becomes"),
    [
        ("pose:\n  a: [1, 2]\n  # word\n  b: 4\n# end\n", "pose: [5, 6]\n# end\n"),
        ("pose:\n- 1\n- 2\nlast: 1\n", "pose: [5, 6]\nlast: 1\n"),
        ("pose: # here\n- 1\n- 2\n", "pose: # here\n [5, 6]\n"),
        ("pose: [1,\n  2] # here\n", "pose: [5, 6] # here\n"),
    ],
)
def test_what_takes_several_lines_is_replaced_whole(text: str, becomes: str) -> None:
    found = with_value(text, ("pose",), "[5, 6]")
    assert found == becomes
    assert yaml.safe_load(found)["pose"] == [5, 6]


@given(st.text(st.characters(categories=("L", "N", "P", "S", "Z"))))
def test_whatever_is_typed_is_one_value(typed: str) -> None:
    plain = " ".join(typed.split())
    found = yaml.compose(f"a: {{b: {scalar(typed)}}}")
    assert found.value[0][1].value[0][1].value == plain


@pytest.mark.parametrize(
    ("text", "becomes"),
    [
        ("a: 1\n", "a: 1\n# why\nb:\n  c:\n  - d: 0.5\n"),
        ("b: {}  # old\na: 1\n", "# why\nb:\n  c:\n  - d: 0.5  # old\na: 1\n"),
        ("b:\n  # old\n  d: 2\na: 1\n", "# why\nb:\n  # old\n  c:\n  - d: 0.5\na: 1\n"),
        ("  b: 1\n  a: 1\n", "  # why\n  b:\n    c:\n    - d: 0.5\n  a: 1\n"),
        ("{a: 1, b: {}}\n", '{a: 1, b: {"c": [{"d": 0.5}]}}\n'),
    ],
)
def test_a_section_is_written_a_line_for_each_value(text: str, becomes: str) -> None:
    assert with_section(text, "b", {"c": [{"d": 0.5}]}, "why") == becomes
    assert yaml.safe_load(becomes)["b"] == {"c": [{"d": 0.5}]}
