"""Nominal grades, against tables that somebody printed."""

from __future__ import annotations

from itertools import pairwise

import pytest

from designer.grades.checks import find_flaws
from designer.grades.grade import Grade
from designer.grades.registry import load_catalogue
from designer.grades.standard_rope import (
    DIAMETERS_M,
    FACTORS,
    WIRE_GRADES_MPA,
    standard_rope,
    standard_ropes,
)

_BY_NAME = {(one.construction, one.core): one for one in FACTORS}


def _grade(construction: str, core: str, wire_grade_MPa: int) -> Grade:
    return standard_rope(_BY_NAME[construction, core], wire_grade_MPa)


@pytest.mark.parametrize(
    ("construction", "core", "wire_grade", "printed"),
    [
        # (diameter mm, breaking force kN), each from a table of its own
        ("6x7", "FC", 1770, [(6, 21.2), (20, 235.0), (40, 940.0)]),
        ("6x7", "FC", 1960, [(9, 52.7), (40, 1040.0)]),
        ("6x36 WS", "IWRC", 1960, [(10, 69.8), (16, 179.0), (28, 548.0)]),
        ("6x36 WS", "FC", 1960, [(8, 41.4), (16, 165.0)]),
        ("6x19M", "FC", 1770, [(6, 19.6), (12, 78.3)]),
        ("6x19M", "IWRC", 1960, [(6, 23.4), (12, 93.7)]),
        ("8x19", "IWRC", 1960, [(8, 44.7), (11, 84.4)]),
        ("6x36 WS", "IWRC", 1960, [(15, 157.0), (17, 201.65)]),
    ],
)
def test_breaking_forces_are_those_of_printed_tables(construction, core, wire_grade, printed):
    sizes = {size.id: size for size in _grade(construction, core, wire_grade).sizes}

    for diameter_mm, force_kN in printed:
        size = sizes[f"{diameter_mm} mm"]
        assert size.minimum_breaking_load_N == pytest.approx(1e3 * force_kN, rel=4e-3)


def test_mass_and_metallic_area_follow_their_factors():
    grade = _grade("6x36 WS", "IWRC", 1770)
    size = next(size for size in grade.sizes if size.id == "20 mm")

    assert size.linear_density_kg_per_m == pytest.approx(0.409 * 400.0 / 100.0)
    assert grade.metallic_area_m2(size) == pytest.approx(0.460 * 400.0e-6)


@pytest.mark.parametrize("factors", FACTORS, ids=lambda one: f"{one.construction}-{one.core}")
def test_factors_are_those_of_steel_wire(factors):
    """Laying costs up to three tenths of its strength; core and lubricant add to its 7850 kg/m³."""
    assert 0.7 < factors.breaking_force / factors.metallic_area < 0.95
    assert 7850.0 < 1e4 * factors.mass / factors.metallic_area < 10_000.0


@pytest.mark.parametrize(
    ("construction", "core", "wire_grade", "product"),
    [
        ("6x7", "FC", 1770, "api-9a-6x7-fc-1770"),
        ("6x19M", "FC", 1770, "forestali-6x19m-fc-galvanised-1770"),
        ("6x19M", "IWRC", 1960, "forestali-6x19m-steelcore-galvanised-1960"),
        ("6x36 WS", "IWRC", 1960, "unirope-6x36-iwrc-1960"),
    ],
)
def test_ropes_that_are_sold_follow_the_standard(construction, core, wire_grade, product):
    computed = _grade(construction, core, wire_grade).fit()
    sold = load_catalogue(with_plugins=False).grade(product).fit()

    assert sold.breaking_stress_Pa == pytest.approx(computed.breaking_stress_Pa, rel=5e-3)
    assert sold.density_kg_per_m3 == pytest.approx(computed.density_kg_per_m3, rel=0.025)


def test_every_construction_is_there_in_every_wire_grade_and_sound():
    grades = list(standard_ropes())

    assert len({grade.id for grade in grades}) == len(FACTORS) * len(WIRE_GRADES_MPA)
    for grade in grades:
        assert find_flaws(grade) == []
        assert len(grade.sizes) == len(DIAMETERS_M)


def test_a_nominal_grade_says_that_it_is_computed():
    grade = _grade("18x7", "WSC", 1960)

    assert grade.is_nominal
    assert grade.trust == "B"
    assert {column.figure for column in grade.computed} == {
        "minimum_breaking_load",
        "linear_mass",
        "metallic_area",
    }
    assert grade.modulus is not None
    assert grade.modulus.basis == "borrowed"
    assert any("not a product" in note for note in grade.notes)


def test_they_come_in_beside_the_products():
    catalogue = load_catalogue(with_plugins=False)

    assert catalogue.grade("en12385-6x36ws-iwrc-1960").is_nominal
    assert not catalogue.grade("unirope-6x36-iwrc-1960").is_nominal


def test_any_diameters_will_do():
    grade = standard_rope(_BY_NAME["34x7", "WSC"], 2160, diameters_m=(0.0155, 0.073))

    assert [size.id for size in grade.sizes] == ["15.5 mm", "73 mm"]
    assert find_flaws(grade) == []


@pytest.mark.parametrize("diameters_m", [(), (0.0, 0.01), (0.01, 0.01), (0.02, 0.01)])
def test_diameters_that_do_not_ascend_are_refused(diameters_m):
    with pytest.raises(ValueError, match="ascend"):
        standard_rope(FACTORS[0], 1960, diameters_m)


def test_a_wire_grade_that_the_standard_does_not_know_is_refused():
    with pytest.raises(ValueError, match="1965 MPa"):
        standard_rope(FACTORS[0], 1965)


def test_the_preferred_diameters_ascend_in_small_steps():
    assert all(thin < thick < 1.17 * thin for thin, thick in pairwise(DIAMETERS_M))
    assert {1e-3 * mm for mm in (15, 34, 35, 42, 46)} <= set(DIAMETERS_M)
