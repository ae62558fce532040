"""Files of older and newer formats."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from designer import __version__
from designer.documents.plain import RESULT_FORMAT
from designer.errors import InputError
from designer.grades.registry import read_grade
from designer.io.config import read_study
from designer.io.results import read_result
from designer.resources import data_folder, example_file


def study_text(first_line: str) -> str:
    return f"{first_line}\n{example_file('yard').read_text(encoding='utf-8')}"


def grade_text(first_line: str) -> str:
    path = data_folder("catalog") / "unirope-7x19-galvanised.yaml"
    return f"{first_line}\n{path.read_text(encoding='utf-8')}"


@pytest.mark.parametrize(("text", "read"), [(study_text, read_study), (grade_text, read_grade)])
def test_configs_and_grades_of_this_format_and_without_are_read(tmp_path, text, read) -> None:
    path = tmp_path / "file.yaml"
    for line in ("", "format: 1", "format:"):
        path.write_text(text(line), encoding="utf-8")
        assert read(path)


@pytest.mark.parametrize(("text", "read"), [(study_text, read_study), (grade_text, read_grade)])
@pytest.mark.parametrize(
    ("number", "words"),
    [
        (
            "7",
            f"1: format: format 7 is newer than this cdpr-designer {__version__} reads",
        ),
        ("7", f"this file needs cdpr-designer newer than {__version__}"),
        ("0", "is no format (expected a whole number, 1 to 1)"),
        ("1.5", "is no format"),
        ("true", "is no format"),
        ("new", "is no format"),
        ("9" * 300, "is no format"),
    ],
)
def test_other_formats_say_what_to_do(tmp_path, text, read, number, words) -> None:
    path = tmp_path / "file.yaml"
    path.write_text(text(f"format: {number}"), encoding="utf-8")
    with pytest.raises(InputError) as caught:
        read(path)
    assert words in str(caught.value)


def result(folder: Path, **changes: object) -> Path:
    path = folder / "result.json"
    values = {
        "format": RESULT_FORMAT, "name": "x", "workspace": None, "provenance": {"version": "0.1.0"}
    }  # fmt: skip
    path.write_text(json.dumps({**values, **changes}), encoding="utf-8")
    return path


def test_results_of_this_format_and_without_are_read(tmp_path) -> None:
    assert read_result(result(tmp_path))["name"] == "x"
    old = {"name": "x", "workspace": None, "provenance": {}}
    path = tmp_path / "old.json"
    path.write_text(json.dumps(old), encoding="utf-8")
    assert read_result(path) == {"format": 1, **old}


def test_a_newer_result_names_the_version_that_it_needs(tmp_path) -> None:
    path = result(tmp_path, format=99, provenance={"version": "4.2.0"})
    with pytest.raises(InputError, match=r"needs cdpr-designer 4\.2\.0 or newer"):
        read_result(path)


OF_ANOTHER_KIND = '{"format": 1, "objective": {}, "provenance": {"version": "0.1.0"}}'


@pytest.mark.parametrize(
    "text", ["", "[]", "{}", "{", '{"format": 1}', "\x00", "[" * 10_000, OF_ANOTHER_KIND]
)
def test_what_is_no_result_is_one_line(tmp_path, text) -> None:
    path = tmp_path / "result.json"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(InputError, match=r"result.json: (is no result|cannot be read)") as caught:
        read_result(path)
    assert "\n" not in str(caught.value)


CHECK = {"id": "strength", "load_case": "static", "state": "holds", "demand": 1.0}
ROPE = {"grade": "a", "size_id": "8 mm", "standing": "chosen"}
SELECTION = {"candidates": [ROPE], "chosen": {"cost": 8.0}, "currency": "EUR"}
WHOLE = {"checks": [CHECK], "selection": SELECTION, "pose": {"length_m": [1.5, 2]}}


def nested(depth: int) -> object:
    return [nested(depth - 1)] if depth else 1


@pytest.mark.parametrize(
    ("changes", "fault"),
    [
        ({"checks": None}, "checks: is an empty value (expected a list)"),
        ({"checks": [None]}, "checks[0]: is an empty value (expected a mapping)"),
        ({"checks": [CHECK, {"id": "a", "load_case": "b"}]}, "checks[1].state: is an empty value"),
        ({"checks": [{**CHECK, "demand": "x"}]}, "checks[0].demand: is 'x' (expected a number)"),
        ({"checks": [{**CHECK, "id": ["a"]}]}, "checks[0].id: is a list (expected a text)"),
        ({"selection": []}, "selection: is a list (expected a mapping, or null)"),
        ({"selection": {"candidates": None}}, "selection.candidates: is an empty value"),
        ({"selection": {"candidates": [{"grade": "a"}]}}, "selection.candidates[0].size_id: is an"),
        ({"selection": {"chosen": {"cost": "8"}}}, "selection.chosen.cost: is '8' (expected a num"),
        ({"selection": {"currency": ["EUR"]}}, "selection.currency: is a list (expected a text"),
        ({"provenance": "x"}, "provenance: is 'x' (expected a mapping)"),
        ({"pose": {"length_m": [1, 10**400]}}, "pose.length_m[1]: is too large, or no number"),
        ({"pose": float("inf")}, "pose: is too large, or no number (expected a finite number)"),
        ({"pose": float("nan")}, "pose: is too large, or no number (expected a finite number)"),
        ({"name": "\ud800"}, "name: holds half a letter"),
        ({"pose": {"\udfff": 1}}, "pose.?: holds half a letter"),
        ({"pose": nested(900)}, "is nested too deeply (expected at most 24 levels)"),
    ],
)
def test_a_result_that_was_tampered_with_is_told_by_field(tmp_path, changes, fault) -> None:
    path = result(tmp_path, **WHOLE)
    assert read_result(path)["checks"] == [CHECK]
    path = result(tmp_path, **{**WHOLE, **changes})
    with pytest.raises(InputError) as caught:
        read_result(path)
    assert fault in str(caught.value).splitlines()[0]


def test_a_huge_result_is_not_read(tmp_path, monkeypatch) -> None:
    monkeypatch.setattr("designer.io.results._LARGEST_RESULT_BYTES", 20)
    with pytest.raises(InputError, match="cannot be read: it has more than"):
        read_result(result(tmp_path))


def test_a_result_that_is_not_there(tmp_path) -> None:
    with pytest.raises(InputError, match="cannot be read: no such file"):
        read_result(tmp_path / "none.json")
