"""Faults that are planted into a table of a sound 7x19, and whether each is found in its line."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path

import pytest
from grade_samples import family_grade, write_grade

from designer.grades.checks import find_flaws
from designer.grades.grade import (
    AreaFactor,
    ComputedFigure,
    Grade,
    Limits,
    Modulus,
    RelativeStiffness,
    ThermalExpansion,
)
from designer.grades.registry import read_grades

_SOUND = """\
id: acme-7x19
manufacturer: Acme
product: Hoistline
construction: 7x19
core: WSC
finish: galvanised
material: steel
wire_grade: 1960 N/mm2
trust: A
source:
  publisher: Acme Ropes
  document: Catalogue, page 3
modulus:
  value: 62 GPa
  reference_area: nominal
  basis: printed
  uncertainty: 0.05
  source: Catalogue, page 4
units: {diameter: mm, minimum_breaking_load: kN, linear_mass: kg/m}
sizes:
  - {id: 4 mm,  diameter:  4, minimum_breaking_load: 10.6, linear_mass: 0.061}
  - {id: 5 mm,  diameter:  5, minimum_breaking_load: 16.6, linear_mass: 0.095}
  - {id: 6 mm,  diameter:  6, minimum_breaking_load: 23.9, linear_mass: 0.137}
  - {id: 8 mm,  diameter:  8, minimum_breaking_load: 42.5, linear_mass: 0.244}
  - {id: 10 mm, diameter: 10, minimum_breaking_load: 66.4, linear_mass: 0.381}
  - {id: 12 mm, diameter: 12, minimum_breaking_load: 95.6, linear_mass: 0.548}
"""

_PLANTED = [
    ("unit of mass", "linear_mass: kg/m}", "linear_mass: lb/ft}", 20, "sizes", "check the units"),
    ("swapped digits", "42.5", "52.4", 24, "sizes[3].minimum_breaking_load", "23% above"),
    ("another wire grade", "1960 N/mm2", "2960 N/mm2", 21, "sizes[0].minimum_breaking_load", "46%"),
    ("duplicate id", "id: 8 mm", "id: 6 mm", 24, "sizes[3].id", "given twice"),
    ("unordered", "diameter:  6,", "diameter:  9,", 24, "sizes[3].diameter", "8 mm follows 9 mm"),
    ("new above bedded in", "62 GPa\n", "62 GPa\n  new: 63 GPa\n", 15, "modulus.new", "is 63 GPa"),
    ("metallic as nominal", "62 GPa", "104 GPa", 14, "modulus.value", "check value and reference"),
    ("load above A·R", "1960 N/mm2", "1270 N/mm2", 21, "sizes[0].minimum_breaking_load", "wire"),
    ("unknown field", "finish:", "finnish:", 6, "finnish", "did you mean 'finish'"),
    ("bad basis", "basis: printed", "basis: guessed", 16, "modulus.basis", "is not known"),
    ("missing source", "  source: Catalogue, page 4\n", "", 13, "modulus.source", "is missing"),
    ("negative", "0.137", "-0.137", 23, "sizes[2].linear_mass", "out of range"),
    ("fibre's material", "material: steel", "material: nylon", 20, "sizes", "for nylon"),
]


def test_the_table_itself_is_sound(tmp_path):
    found, faults = read_grades(write_grade(tmp_path / "acme.yaml", _SOUND))

    assert faults == []
    assert len(found) == 1


@pytest.mark.parametrize(
    ("old", "new", "line", "field", "words"),
    [fault[1:] for fault in _PLANTED],
    ids=[fault[0] for fault in _PLANTED],
)
def test_a_planted_fault_is_found_in_its_line(tmp_path, old, new, line, field, words):
    assert _SOUND.count(old) == 1

    found, faults = read_grades(write_grade(tmp_path / "acme.yaml", _SOUND.replace(old, new)))

    assert found == []
    named, *_ = [fault for fault in faults if fault.field == field and fault.line == line]
    assert words in str(named)


@pytest.mark.parametrize(
    ("construction", "loads", "material"),
    [("7x19", 1 / 4.4482, "steel"), ("7x19", 4.4482, "steel"), ("8-strand", 1 / 4.4482, "HMPE")],
)
def test_kip_and_kN_are_told_apart_without_a_wire_grade(tmp_path, construction, loads, material):
    text = _SOUND.replace("wire_grade: 1960 N/mm2\n", "").replace("7x19", construction)
    text = text.replace("material: steel", f"material: {material}")
    if material == "HMPE":
        text = re.sub(r"mass: (0\.\d+)", lambda m: f"mass: {0.15 * float(m[1]):.4f}", text)
    assert read_grades(write_grade(tmp_path / "sound.yaml", text))[1] == []
    wrong = re.sub(r"load: ([\d.]+)", lambda m: f"load: {loads * float(m[1]):.4f}", text)
    found, (fault,) = read_grades(write_grade(tmp_path / "wrong.yaml", wrong))

    assert found == []
    assert fault.field == "sizes"
    assert "minimum_breaking_load over the nominal circle" in fault.problem


def test_two_files_with_the_same_grade_are_found(tmp_path):
    write_grade(tmp_path / "a.yaml", _SOUND)
    write_grade(tmp_path / "b.yaml", _SOUND)

    found, (fault,) = read_grades(tmp_path)

    assert len(found) == 1
    assert (Path(fault.file).name, fault.line, fault.field) == ("b.yaml", 1, "id")


def test_an_outlier_is_named_alone_and_a_doubt_keeps_it(tmp_path):
    text = _SOUND.replace("23.9", "32.9")
    found, (fault,) = read_grades(write_grade(tmp_path / "acme.yaml", text))

    assert found == []
    assert (fault.line, fault.field) == (23, "sizes[2].minimum_breaking_load")
    assert "38% above the neighbouring sizes" in fault.problem

    doubted = text.replace("0.137}", "0.137, doubt: printed so}")
    found, faults = read_grades(write_grade(tmp_path / "acme.yaml", doubted))

    assert faults == []
    assert found[0].grade.sizes[2].doubt == "printed so"


def test_even_a_doubtful_size_is_no_other_unit(tmp_path):
    text = _SOUND.replace("linear_mass: 0.137}", "linear_mass: 0.302, doubt: printed so}")

    _, (fault,) = read_grades(write_grade(tmp_path / "acme.yaml", text))

    assert fault.field == "sizes[2].linear_mass"
    assert "times the median of the grade" in fault.problem


def _steel(**changes: object) -> Grade:
    grade = replace(family_grade(youngs_modulus_Pa=62e9), material="steel")
    return replace(grade, **changes)


def _relative(ratios: tuple[float, ...], loads: tuple[float, ...] = ()) -> RelativeStiffness:
    return RelativeStiffness(ratios, loads, "printed", "a test", 0.1)


def _priced(grade: Grade) -> Grade:
    return replace(grade, sizes=tuple(replace(size, price_per_m=2.0) for size in grade.sizes))


def test_a_grade_made_in_python_is_checked_alike():
    assert find_flaws(_steel()) == []
    assert find_flaws(_priced(_steel(currency="EUR"))) == []


@pytest.mark.parametrize(
    ("changes", "field", "words"),
    [
        ({"modulus": None}, "modulus", "is missing"),
        ({"stiffness": _relative((60.0,))}, "stiffness", "beside a modulus"),
        ({"modulus": None, "stiffness": _relative((60.0, 70.0))}, "stiffness", "ratios 60, 70"),
        ({"modulus": None, "stiffness": _relative((-1.0,))}, "stiffness", "ratios -1"),
        (
            {"modulus": None, "stiffness": _relative((60.0, 70.0), (0.3, 0.2))},
            "stiffness",
            "load fractions 0.3, 0.2",
        ),
        ({"modulus": None, "stiffness": _relative((140.0,))}, "stiffness", "GPa on the metallic"),
        ({"material": "wood"}, "material", "'wood' is not known"),
        *(({"product": text}, "product", "empty, too long") for text in (" ", "x" * 1001, "a\tb")),
        ({"currency": "euro"}, "currency", "no currency"),
        ({"limits": Limits("a sheet")}, "limits", "sets no limit"),
        ({"limits": Limits("a sheet", temperature_C=(80.0, -40.0))}, "limits", "is 80 to -40"),
        ({"computed": (ComputedFigure("colour", "by eye"),)}, "computed", "'colour'"),
        (
            {"thermal_expansion": ThermalExpansion(1e-5, "guessed", "a test")},
            "thermal_expansion",
            "'guessed'",
        ),
        ({"area_factor": AreaFactor(0.472, "heard", "a test")}, "area_factor", "'heard'"),
        ({"construction": "19x7", "modulus": Modulus(1e11, "nominal", "printed", "x", 0.1)},
         "modulus", "on the metallic area"),
    ],
)  # fmt: skip
def test_what_a_file_could_not_even_say_is_found_in_a_grade_of_python(changes, field, words):
    (flaw,) = find_flaws(_steel(**changes))

    assert flaw.keys[0] == field
    assert words in flaw.problem


def test_a_price_needs_a_currency():
    flaws = find_flaws(_priced(_steel()))

    assert [flaw.keys for flaw in flaws] == [("sizes", k, "price_per_m") for k in range(5)]


def test_a_printed_metallic_area_has_to_weigh_what_steel_weighs():
    grade = _steel()
    sizes = [replace(size, metallic_area_m2=0.35 * size.nominal_area_m2) for size in grade.sizes]

    flaws = find_flaws(replace(grade, sizes=tuple(sizes)))

    assert [flaw.keys[-1] for flaw in flaws] == ["metallic_area"] * 5
    assert "mass over metallic area is 14857" in flaws[0].problem


def test_a_strand_may_be_stiffer_than_a_rope():
    stiff = Modulus(1.1e11, "nominal", "printed", "a test", 0.1)

    assert find_flaws(_steel(construction="1x19 strand", modulus=stiff)) == []
    assert find_flaws(_steel(construction="7x19", modulus=stiff)) != []


@pytest.mark.parametrize(
    ("material", "ratio", "is_sound"),
    [
        ("HMPE", 56.0, True),
        ("HMPE", 5.0, False),
        ("nylon", 4.0, True),
        ("nylon", 56.0, False),
        ("polyester", 12.0, True),
        ("polyester", 60.0, False),
        ("polypropylene", 9.5, True),
        ("polypropylene", 35.0, False),
        ("other", 300.0, True),
    ],
)
def test_a_fibre_rope_is_as_stiff_as_its_fibre_lets_it(material, ratio, is_sound):
    grade = family_grade(density_kg_per_m3=700.0, breaking_stress_Pa=3e8)
    fibre = replace(grade, modulus=None, stiffness=_relative((ratio,)), material=material)

    assert (find_flaws(fibre) == []) is is_sound
