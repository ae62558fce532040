"""A duty class in place of a safety factor, and the sheave that goes with the class of the rope."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from designer.errors import InputError
from designer.grades.registry import load_catalogue
from designer.io.config import read_study
from designer.model.load_case import LoadCase
from designer.selection.reeving import least_sheave_ratio, sheave_ratio_of
from designer.study import Selection

GRADES = {grade.id: grade for grade in load_catalogue(with_plugins=False).grades}
STUDY = """\
robot: {anchors: [[0, 0, 9], [9, 0, 9], [4, 9, 9]], platform: {mass: 100}}
cable: {grade: unirope-6x36-iwrc-1960}
workspace: {region: {box: [[3, 4], [3, 4], [1, 2]]}}
selection:
  sheave_diameter: 200 mm
  %s
load_cases: [{name: static}, {name: rare, safety_factor: 3}]
"""


def read(folder: Path, selection: str):
    path = folder / "study.yaml"
    path.write_text(STUDY % selection, encoding="utf-8")
    return read_study(path)


@pytest.mark.parametrize(("duty", "factor"), [("M1", 3.15), ("M5", 4.5), ("M8", 9.0)])
def test_the_class_gives_the_factor(tmp_path: Path, duty: str, factor: float) -> None:
    study = read(tmp_path, f"duty_class: {duty}")
    assert study.selection is not None and study.family is not None
    assert study.selection.safety_factor == factor == study.family.safety_factor
    assert f"duty class {duty}" in study.selection.factor_source
    entries = {entry.field: entry.value_SI for entry in study.source.entries}
    assert float(entries["selection.safety_factor"]) == factor
    rare = study.selection.under(study.load_cases[1])
    assert (rare.safety_factor, rare.duty_class) == (3.0, "none")
    assert rare.factor_source == "S as the study gives it"
    assert study.selection.under(study.load_cases[0]).duty_class == duty


@pytest.mark.parametrize(
    ("given", "field", "words"),
    [
        ("{duty_class: M5, safety_factor: 5}", "selection", "has safety_factor and duty_class"),
        ("{duty_class: M9}", "selection.duty_class", "'M9' is not known"),
        ("{duty_class: 5}", "selection.duty_class", "5 is not known"),
    ],
)
def test_contradictions_and_slips_are_one_line(
    tmp_path: Path, given: str, field: str, words: str
) -> None:
    with pytest.raises(InputError) as caught:
        read(tmp_path, "\n  ".join(given.strip("{}").split(", ")))
    (fault,) = caught.value.faults
    assert fault.field == field
    assert words in fault.problem
    assert fault.line is not None


def test_in_python_as_in_files() -> None:
    assert Selection(duty_class="M6").safety_factor == 5.6
    with pytest.raises(ValueError, match="contradicts duty_class M6"):
        Selection(duty_class="M6", safety_factor=4.0)
    assert Selection(duty_class="M6").under(LoadCase("a")).safety_factor == 5.6


@pytest.mark.parametrize(
    ("grade_id", "ratio"),
    [
        ("unirope-6x36-iwrc-1960", 16.0),
        ("gost-6x19s-iwrc-1960", 16.0),
        ("unirope-19x7-eips", 20.0),
        ("unirope-7x19-galvanised", 20.0),
        ("forestali-6x19m-fc-galvanised-1770", 20.0),
        ("unirope-7x7-galvanised", 25.0),
        ("unirope-1x19-galvanised", 25.0),
        ("superline-hmpe", None),
    ],
)
def test_class_of_a_rope(grade_id: str, ratio: float | None) -> None:
    found = least_sheave_ratio(GRADES[grade_id])
    assert (None if found is None else found[0]) == ratio


def test_stainless_in_parallel_lay_takes_a_larger_sheave() -> None:
    stainless = replace(GRADES["unirope-6x36-iwrc-1960"], material="stainless steel")
    assert least_sheave_ratio(stainless) == (20.0, "stainless, parallel lay")


def test_the_larger_of_both_ratios_counts_and_is_named() -> None:
    grade = GRADES["unirope-7x7-galvanised"]
    assert grade.sheave_ratio is not None
    maker, size = grade.sheave_ratio.minimum, grade.sizes[0]
    plain = Selection(sheave_diameter_m=0.1)
    (given,) = sheave_ratio_of(grade, size, plain)
    assert (given.demand, given.source) == (maker, f"table of {grade.id}")
    bent = replace(grade, sheave_ratio=replace(grade.sheave_ratio, minimum=18.0))
    (asked,) = sheave_ratio_of(bent, size, replace(plain, duty_class="M3"))
    assert asked.demand == 25.0
    assert "crane ordinance" in asked.source
    (kept,) = sheave_ratio_of(grade, size, replace(plain, duty_class="M3"))
    assert kept.demand == max(maker, 25.0)
    unknown = replace(grade, sheave_ratio=None)
    assert not [*sheave_ratio_of(unknown, size, plain)]
    (told,) = sheave_ratio_of(unknown, size, replace(plain, duty_class="M3"))
    assert told.demand == 25.0
