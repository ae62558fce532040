from __future__ import annotations

import math
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st
from pint import UnitRegistry

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
