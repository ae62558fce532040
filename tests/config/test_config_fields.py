"""Bounds and units of the fields of the config."""

from __future__ import annotations

import json
import math
import os
import random
import re
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, get_args

import pytest
from benchmarks.damaged_inputs import NUMBERS, no_longer_than, spoilt
from hypothesis import given
from hypothesis import strategies as st
from pint import UnitRegistry

from designer.documents.bounds import BOUNDS
from designer.documents.fields import (
    AnySection,
    FileValue,
    QuantityField,
    ReadAs,
    Section,
    fields_of,
)
from designer.documents.plain import finite
from designer.errors import Fault, InputError
from designer.grades.grade import GradeSheet
from designer.grades.registry import read_grade
from designer.io.config import read_study
from designer.io.config.schema import StudySection
from designer.resources import data_folder, example_file, example_names
from designer.study import GradeFamily, Study
from designer.units import (
    ANGLE,
    AREA,
    DENSITY,
    FORCE,
    LENGTH,
    LINEAR_DENSITY,
    MASS,
    NUMBER,
    PER_TEMPERATURE,
    SCALES,
    STRESS,
    Dimension,
    QuantityError,
    format_SI,
    in_SI,
    read_quantity,
)

StudyOf = Callable[[str], Study]
FaultsOf = Callable[[str], list[Fault]]


def quantities(kind: Any, seen: set[Any]) -> Iterator[QuantityField]:
    """Yield the annotation of every number in a schema."""
    if isinstance(kind, QuantityField):
        yield kind
    elif isinstance(kind, ReadAs):
        yield from quantities(kind.section, seen)
    elif isinstance(kind, type) and issubclass(kind, Section | FileValue):
        if kind not in seen:
            seen.add(kind)
            for info in fields_of(kind).values():
                yield from quantities(info.rebuild_annotation(), seen)
    else:
        for part in get_args(kind):
            yield from quantities(part, seen)


@pytest.mark.parametrize("schema", [StudySection, GradeSheet])
def test_every_number_has_two_ends_and_a_reason(schema: AnySection) -> None:
    found = list(quantities(schema, set()))
    assert len(found) > 5
    # the figures of a size are looked at by designer.grades.checks, by the same table
    sizes = [one for one in found if one == QuantityField(one.dimension, above=0.0)]
    assert len(sizes) == (4 if schema is GradeSheet else 0)
    for one in found:
        if one not in sizes:
            assert one.at_least is not None and one.at_most is not None
            assert one.reason
    for bound in BOUNDS.values():
        assert -math.inf < bound.least < bound.most < math.inf


MISTAKES = [
    ("safety_factor: 4", "safety_factor: 4\n  sheave_diameter: 250", "did you mean '250 mm'?"),
    ("safety_factor: 4", "safety_factor: 4\n  sheave_diameter: 250", "mine hoists have up to 9 m"),
    ("safety_factor: 4", "safety_factor: 1e6", "at most 100: lifts of persons have 12"),
    ("180 kg", "1e300 kg", "at most 1e8 kg"),
    ("pose: [15, 9, 4]", "pose: 15, 9, 4", "a list stands in brackets: [15, 9, 4]"),
    ("anchors: [", "gravity: 0, 0, -1\n  anchors: [", "in brackets: [0, 0, -1]"),
    ("safety_factor: 4", "grades: a, b", "in brackets: [a, b]"),
    ("pose: [15, 9, 4]", "pose: [15000000, 9, 4]", "at most 1e7 m: as far as survey"),
    ("pose: [15, 9, 4]", "pose: [150000, 9, 4]", "pose: lies 1.5e+05 m from the exit points"),
    ("z: [1, 8]", "z: [1, 800000]", "workspace.region.z: lies 8e+05 m from"),
    ("12]]", "12], [1e6, 1e6, 12]]", "the exit points are 1e+06 m apart"),
    (
        "{prism: anchors, inset: 3 m, z: [1, 8]}",
        "{rectangle: [[0, 0], [900000, 0]], z: [1, 8]}",
        "workspace.region.rectangle: lies 9e+05 m from the exit points",
    ),
    ("pose: [15, 9, 4]", "surroundings: {temperature: 5000}", "a bare number is in degC"),
    (
        "pose: [15, 9, 4]",
        f"effects: {{pulley_radius: {{radius_m: {'1' * 300}}}}}",
        "effects.pulley_radius.radius_m: 1.111111111e+299 is out of range",
    ),
]
FLAT = """\
robot:
  anchors: [[0, 0, 12], [30, 0, 12], [15, 26, 12]]
  platform: {mass: 180 kg}
cable: {density: 5290 kg/m^3, youngs_modulus: 62.7 GPa, allowable_stress: 198 MPa}
pose: [15, 9, 4]
workspace: {region: {prism: anchors, inset: 3 m, z: [1, 8]}}
selection:
  safety_factor: 4
"""


@pytest.mark.parametrize(("old", "new", "words"), MISTAKES)
def test_what_no_machine_has_is_refused_with_the_reason(
    faults_of: FaultsOf, old: str, new: str, words: str
) -> None:
    assert old in FLAT
    told = [str(fault) for fault in faults_of(FLAT.replace(old, new))]
    assert any(words in line for line in told), told


def test_coordinates_of_a_survey_are_taken(study_of: StudyOf) -> None:
    shift = "[[5000000, 5300000, 12], [5000030, 5300000, 12], [5000015, 5300026, 12]]"
    text = FLAT.replace("[[0, 0, 12], [30, 0, 12], [15, 26, 12]]", shift)
    study = study_of(text.replace("[15, 9, 4]", "[5000015, 5300009, 4]"))
    assert study.robot.exit_points_m[1, 0] == 5000030.0


def test_a_tab_is_told_with_its_line(faults_of: FaultsOf) -> None:
    (fault,) = faults_of("robot:\n\tanchors: [[0, 0, 1]]\n")
    assert str(fault).endswith(":2: a tab indents this line (expected blanks, which YAML asks for)")


@pytest.mark.parametrize("tail", ["", " kg", "x", "e", ".", ".5.5"])
def test_a_text_as_long_as_a_file_may_be_is_no_hang(faults_of: FaultsOf, tail: str) -> None:
    with no_longer_than(20):
        (fault,) = faults_of(FLAT.replace("180 kg", 300_000 * "7" + tail))
    assert ": robot.platform.mass: " in str(fault)
    assert len(str(fault)) < 300


@pytest.mark.parametrize("number", [n for n in NUMBERS if len(n) > 16])
def test_long_numbers_are_settled_at_once(tmp_path: Path, number: str) -> None:
    path = tmp_path / "damaged.yaml"
    for place in ("180 kg", "30,", "198 MPa", "3 m", "4\n"):
        path.write_text(FLAT.replace(place, place.replace(place.split()[0], number)))
        with no_longer_than(10):
            try:
                study = read_study(path)
            except InputError:
                continue
        assert math.isfinite(study.robot.platform.mass_kg)


def test_damaged_files_are_read_or_refused(tmp_path: Path) -> None:
    chance, path, refused = random.Random(7), tmp_path / "damaged.yaml", 0
    studies = [example_file(name).read_text(encoding="utf-8") for name in example_names()]
    tables = [p.read_text(encoding="utf-8") for p in sorted(data_folder("catalog").glob("*.yaml"))]
    for sources, read in (
        (studies, read_study),
        (tables, read_grade),
    ):
        for _ in range(40):
            path.write_text(spoilt(chance.choice(sources), chance), encoding="utf-8")
            with no_longer_than(10):
                try:
                    read(path)
                except InputError:
                    refused += 1
    assert 20 < refused < 80


def test_what_json_cannot_hold_is_nothing() -> None:
    values = {"a": [1.0, math.inf, {"b": math.nan}], "c": (2, "x", None, True)}
    expected = {"a": [1.0, None, {"b": None}], "c": [2, "x", None, True]}
    assert json.loads(json.dumps(finite(values), allow_nan=False)) == expected


GRADE_CABLE = FLAT.replace(
    "{density: 5290 kg/m^3, youngs_modulus: 62.7 GPa, allowable_stress: 198 MPa}",
    "{grade: unirope-7x19-galvanised, safety_factor: 5}",
)


def graded(folder: Path, text: str) -> Study:
    path = folder / "crane.yaml"
    path.write_text(text, encoding="utf-8")
    return read_study(path)


def test_a_grade_may_be_the_configured_family(tmp_path: Path) -> None:
    study = graded(tmp_path, GRADE_CABLE)
    own = read_grade(data_folder("catalog") / "unirope-7x19-galvanised.yaml")
    assert study.material == own.family(5.0)
    assert study.family == GradeFamily("unirope-7x19-galvanised", 5.0)
    (entry,) = (e for e in study.source.entries if e.field == "cable.grade")
    assert "on the nominal circle" in entry.value_SI
    assert entry.given == "unirope-7x19-galvanised"


def test_its_safety_factor_is_that_of_the_selection_if_left_out(tmp_path: Path) -> None:
    study = graded(tmp_path, GRADE_CABLE.replace(", safety_factor: 5", ""))
    assert study.family is not None
    assert study.family.safety_factor == 4.0
    (entry,) = (e for e in study.source.entries if e.field == "cable.safety_factor")
    assert (entry.given, entry.value_SI) == ("default", "4")


@pytest.mark.parametrize(
    ("grade", "words"),
    [
        ("6x36", "unirope-6x36-fc-1960, unirope-6x36-iwrc-1960"),
        ("unirope-7x19-galvanized", "'unirope-7x19-galvanised'"),
        ("astm-a475-7-wire-ehs", "of the plugin guy-strand, which --no-plugins leaves out"),
        ("unirope-7x19-galvanised, density: 5290", "unknown field 'density'"),
        ("unirope-7x19-galvanised, safety_factor: 0.5", "at least 1"),
    ],
)
def test_a_grade_that_cannot_be_is_told_with_its_line(
    tmp_path: Path, grade: str, words: str
) -> None:
    text = re.sub(r"grade: .*", f"grade: {grade}}}", GRADE_CABLE)
    with pytest.raises(InputError, match=r"crane\.yaml:4: cable\.") as caught:
        graded(tmp_path, text)
    assert words in str(caught.value)


PINT = UnitRegistry()
# How much of the SI unit one of each unit is, by definition (NIST SP 811, appendix B).
FACTORS = [
    (LENGTH, "mm", 1e-3),
    (LENGTH, "km", 1e3),
    (LENGTH, "in", 0.0254),
    (LENGTH, "ft", 0.3048),
    (AREA, "mm^2", 1e-6),
    (AREA, "cm²", 1e-4),
    (MASS, "t", 1e3),
    (MASS, "lb", 0.45359237),
    (FORCE, "kN", 1e3),
    (FORCE, "tonf", 9806.65),
    (FORCE, "short_ton_force", 2000 * 4.4482216152605),
    (FORCE, "long_ton_force", 2240 * 4.4482216152605),
    (MASS, "short_ton", 2000 * 0.45359237),
    (FORCE, "kip", 4448.2216152605),
    (LINEAR_DENSITY, "lb/100ft", 0.45359237 / 30.48),
    (LINEAR_DENSITY, "lb / 100 ft", 0.45359237 / 30.48),
    (LINEAR_DENSITY, "kg/100m", 0.01),
    (LINEAR_DENSITY, "lb/1000 ft", 0.45359237 / 304.8),
    (FORCE, "MN", 1e6),
    (FORCE, "lbf", 4.4482216152605),
    (FORCE, "kgf", 9.80665),
    (STRESS, "MPa", 1e6),
    (STRESS, "N/mm**2", 1e6),
    (STRESS, "psi", 4.4482216152605 / 0.0254**2),
    (DENSITY, "g/cm3", 1e3),
    (LINEAR_DENSITY, "kg m^-1", 1.0),
    (LINEAR_DENSITY, "lb / ft", 0.45359237 / 0.3048),
    (PER_TEMPERATURE, "/K", 1.0),
    (PER_TEMPERATURE, "1/°C", 1.0),
    (ANGLE, "deg", math.pi / 180.0),
]

NAMES = ["m", "mm", "kg", "degC", "°C", "%", "°", "dBm", "Ym", "ym", "lambda", "E5", "µ", "²"]


@given(
    value=st.floats(-1e9, 1e9).filter(lambda value: abs(value) > 1e-9),
    how=st.sampled_from(FACTORS),
)
def test_a_value_written_in_another_unit_is_the_same_in_SI(
    value: float, how: tuple[Dimension, str, float]
) -> None:
    dimension, unit, factor = how
    assert read_quantity(f"{value / factor!r} {unit}", dimension) == pytest.approx(value, rel=1e-12)


@pytest.mark.parametrize(
    ("dimension", "unit"),
    [
        (MASS, "ton"),
        (MASS, "tons"),
        (FORCE, "ton"),
        (FORCE, "ton_force"),
        (LINEAR_DENSITY, "ton/m"),
    ],
)
def test_a_ton_of_whatever_kind_is_asked_for(dimension: Dimension, unit: str) -> None:
    with pytest.raises(QuantityError, match="of which there are three") as refused:
        read_quantity(f"4 {unit}", dimension)
    for name in ("short_ton (2000 lb)", "t (1000 kg)", "long_ton_force (2240 lb)"):
        assert name in refused.value.expected


@given(value=st.floats(-1e15, 1e15))
def test_a_bare_number_is_SI(value: float) -> None:
    assert read_quantity(value, LENGTH) == value
    assert read_quantity(repr(value), LENGTH) == value


@pytest.mark.parametrize(
    ("SI", "unit"), [(SI, unit) for SI, scales in SCALES.items() for unit in scales]
)
def test_the_table_of_common_units_is_what_pint_makes_of_them(SI: str, unit: str) -> None:
    name = re.sub("(?<=m|n)2", "^2", unit.replace("100", "hecto"))
    for value in ("1", "12.7", "6.1e5"):
        assert SCALES[SI][unit] * float(value) == PINT(f"{value} {name}").to(SI).magnitude


@pytest.mark.parametrize(("dimension", "unit", "factor"), FACTORS)
def test_a_quantity_of_whatever_kind_is_as_large_as_of_its_own(
    dimension: Dimension, unit: str, factor: float
) -> None:
    assert in_SI(f"2 {unit}") == pytest.approx(2.0 * factor, rel=1e-12)


@pytest.mark.parametrize("text", ["2 mm", "2mm", " 2.0  mm ", "+2e0 mm", "0.002", "2 millimetre"])
def test_ways_to_write_a_length(text: str) -> None:
    assert read_quantity(text, LENGTH) == pytest.approx(0.002, rel=1e-15)


def test_typographic_minus() -> None:
    assert read_quantity("−40 m", LENGTH) == -40.0


@pytest.mark.parametrize(
    ("given_value", "dimension", "problem", "expected"),
    [
        ("4000 kg", LENGTH, "'4000 kg' has the unit kilogram", "a length such as '2 mm'"),
        ("5 kg", NUMBER, "'5 kg' has the unit kilogram", "a plain number such as 5"),
        ("10 %", ANGLE, "'10 %' has the unit percent", "an angle such as '10 deg'"),
        (
            "4 KG",
            MASS,
            "'4 KG' has the unknown unit 'KG'",
            "a mass such as '4000 kg'; did you mean 'kg'?",
        ),
        (
            "4 kilogramm",
            MASS,
            "'4 kilogramm' has the unknown unit 'kilogramm'",
            "a mass such as '4000 kg'; did you mean 'kilogram'?",
        ),
        ("4,5 kg", MASS, "'4,5 kg' has a decimal comma", "a decimal point"),
        ("heavy", MASS, "'heavy' is not a number", "a mass such as '4000 kg'"),
        (True, MASS, "true is not a number", "a mass such as '4000 kg'"),
        (None, MASS, "an empty value is not a number", "a mass such as '4000 kg'"),
        ([1], MASS, "a list is not a number", "a mass such as '4000 kg'"),
        (math.nan, MASS, "nan is not a finite number", "a mass such as '4000 kg'"),
        (-math.inf, MASS, "-inf is not a finite number", "a mass such as '4000 kg'"),
        ("NaN kg", MASS, "'NaN kg' is not a number", "a mass such as '4000 kg'"),
        ("inf", MASS, "'inf' is not a finite number", "a mass such as '4000 kg'"),
        ("1e999 kg", MASS, "'1e999 kg' is not a finite number", "a mass such as '4000 kg'"),
        (10**400, MASS, "inf is not a finite number", "a mass such as '4000 kg'"),
    ],
)
def test_what_is_no_quantity_is_refused_in_plain_words(
    given_value: object, dimension: Dimension, problem: str, expected: str
) -> None:
    with pytest.raises(QuantityError) as caught:
        read_quantity(given_value, dimension)
    assert (caught.value.problem, caught.value.expected) == (problem, expected)


@pytest.mark.parametrize(
    "text",
    [
        "2**9**9 m",
        "2 m**9**9**9",
        "2 m^999999999",
        "2 __import__('os')",
        "2 (m)",
        "2 m/",
        "2 kg//m",
        "2 m^0",
        "2 dBm*m",
        "2 " + "m" * 10_000,
        "9" * 10_000,
    ],
)
def test_hostile_texts_are_refused_at_once(text: str) -> None:
    with pytest.raises(QuantityError):
        read_quantity(text, LENGTH)


@given(
    number=st.sampled_from(["1", "1e300 ", "-2.5", "0", "1e-300"]),
    words=st.lists(
        st.sampled_from([*NAMES, *"/* ^29(.,_\n\x1b", "**", "-3"]),
        max_size=8,
    ),
    dimension=st.sampled_from([LENGTH, NUMBER, STRESS, PER_TEMPERATURE]),
)
def test_any_text_is_a_finite_number_or_refused(
    number: str, words: list[str], dimension: Dimension
) -> None:
    try:
        value = read_quantity(number + "".join(words), dimension)
    except QuantityError as error:
        assert error.problem.isprintable()
    else:
        assert math.isfinite(value)


@pytest.mark.parametrize(
    ("value", "dimension", "text"),
    [
        (0.002, LENGTH, "0.002 m"),
        (-0.0, LENGTH, "0 m"),
        (2e11, STRESS, "2e11 Pa"),
        (1.42e6, FORCE, "1.42e6 N"),
        (5.0, NUMBER, "5"),
    ],
)
def test_format(value: float, dimension: Dimension, text: str) -> None:
    assert format_SI(value, dimension) == text


@given(value=st.floats(-1e12, 1e12))
def test_format_can_be_read_back(value: float) -> None:
    back = read_quantity(format_SI(value, LENGTH), LENGTH)
    assert back == pytest.approx(value, rel=1e-9, abs=0.0)


@pytest.mark.parametrize("left", [None, b"half"])
def test_units_are_known_where_pint_can_keep_nothing_or_finds_it_half_written(
    tmp_path: Path, left: bytes | None
) -> None:
    read = "from designer.units import LENGTH, read_quantity as q; print(q('2 mm', LENGTH))"
    cache = tmp_path if left else os.devnull
    for _ in range(2 if left else 1):
        done = subprocess.run(
            [sys.executable, "-c", read], env={**os.environ, "XDG_CACHE_HOME": str(cache)},
            capture_output=True, text=True, check=True,
        )  # fmt: skip
        assert done.stdout == "0.002\n"
        for kept in tmp_path.rglob("*.pickle"):
            kept.write_bytes(left or b"")
