"""Spot figures of the shipped grades, as their sources print them."""

from __future__ import annotations

import math
from itertools import pairwise

import pytest

from designer.catalogue.grade import Grade
from designer.catalogue.listing import check_path
from designer.catalogue.registry import Catalogue, load_catalogue
from designer.resources import data_folder

_LBF_N = 4.4482216152605
_LB_PER_FT = 0.45359237 / 0.3048
_PSI_PA = _LBF_N / 0.0254**2


@pytest.fixture(scope="module")
def catalogue() -> Catalogue:
    return load_catalogue(with_plugins=False)


def _size(grade: Grade, size_id: str):
    return next(size for size in grade.sizes if size.id == size_id)


def test_every_shipped_file_is_a_grade_without_a_fault(catalogue):
    files = list(data_folder("catalog").glob("*.yaml"))

    assert check_path(data_folder("catalog")) == []
    assert catalogue.problems == ()
    assert {grade.file for grade in catalogue.grades} == {file.name for file in files}
    assert len(files) >= 19


def test_a_shipped_file_is_named_after_its_grade(catalogue):
    assert [grade.file for grade in catalogue.grades] == [
        f"{grade.id}.yaml" for grade in catalogue.grades
    ]


@pytest.mark.parametrize(
    ("grade_id", "size_id", "figures"),
    [
        ("unirope-7x19-galvanised", "1/4 in", (6.35, 31_137.6, 0.163698)),
        ("unirope-7x19-galvanised", "3/8 in", (9.525, 14_400 * _LBF_N, 0.243 * _LB_PER_FT)),
        ("lg-7x19-wsc-galvanised-2070", "12 mm", (12.0, 98_900.0, 0.548)),
        ("unirope-6x19-iwrc-stainless-302-304", "1 in", (25.4, 85_400 * _LBF_N, 1.87 * _LB_PER_FT)),
        ("unirope-6x37-iwrc-stainless-316", "1/2 in", (12.7, 18_360 * _LBF_N, 0.43 * _LB_PER_FT)),
        ("unirope-6x19-iwrc-eips", "1-1/8 in", (28.575, 130_000 * _LBF_N, 2.23 * _LB_PER_FT)),
        ("unirope-6x37-iwrc-eips", "2-1/2 in", (63.5, 604_000 * _LBF_N, 11.16 * _LB_PER_FT)),
        ("unirope-6x36-iwrc-1960", "28 mm", (28.0, 548_000.0, 3.28)),
        ("unirope-6x36-fc-1960", "6.5 mm", (6.5, 27_300.0, 0.16)),
        ("forestali-6x19m-steelcore-galvanised-1770", "10 mm", (10.0, 58_700.0, 0.38)),
        ("gost-6x19s-iwrc-1960", "27.5 mm", (27.5, 529_500.0, 3.05)),
        ("gost-7668-6x36-fc-1370-large", "72 mm", (72.0, 2_255_000.0, 19.8)),
        ("engtoolbox-6x19-fc-ips", "1-5/8 in", (41.275, 214_000 * _LBF_N, 6.61)),
    ],
)
def test_spot_figures(catalogue, grade_id, size_id, figures):
    diameter_mm, load_N, mass_kg_per_m = figures
    size = _size(catalogue.grade(grade_id), size_id)

    assert size.diameter_m == pytest.approx(diameter_mm * 1e-3, rel=1e-9)
    assert size.minimum_breaking_load_N == pytest.approx(load_N, rel=2e-6)
    assert size.linear_density_kg_per_m == pytest.approx(mass_kg_per_m, rel=2e-6)


def test_an_ordinary_7x19_cable_fills_two_thirds_of_its_circle(catalogue):
    family = catalogue.grade("unirope-7x19-galvanised").family(safety_factor=1.0)

    assert family.density_kg_per_m3 == pytest.approx(5250.0, rel=0.02)
    assert family.youngs_modulus_Pa == pytest.approx(62.7e9)
    assert family.allowable_stress_Pa == pytest.approx(1.0e9, rel=0.01)


@pytest.mark.parametrize(
    ("grade_id", "stretch_factor"),
    [
        ("unirope-7x19-galvanised", 1.40e-5),
        ("unirope-6x19-iwrc-eips", 1.36e-5),
        ("unirope-6x37-iwrc-eips", 1.44e-5),
        ("unirope-6x19-iwrc-stainless-316", 1.57e-5),
        ("unirope-6x37-iwrc-stainless-316", 1.60e-5),
    ],
)
def test_a_modulus_follows_from_the_lender_s_stretch_factor(catalogue, grade_id, stretch_factor):
    """Stretch in per cent = W G / d² (lbf, in), hence E = 400 / (π G) psi on the circle."""
    modulus = catalogue.grade(grade_id).modulus

    expected_Pa = 400.0 / (math.pi * stretch_factor) * _PSI_PA
    assert modulus.reference_area == "nominal"
    assert modulus.value_Pa == pytest.approx(expected_Pa, rel=1e-3)


def test_a_borrowed_figure_names_its_lender_and_carries_its_uncertainty(catalogue):
    for grade in catalogue.grades:
        assert grade.modulus.basis == "borrowed"
        assert grade.modulus.uncertainty == 0.15
        assert len(grade.modulus.source) > 20


def test_printed_metallic_areas_carry_the_modulus_of_the_seale_rope(catalogue):
    grade = catalogue.grade("gost-6x19s-iwrc-1960")
    size = _size(grade, "10 mm")

    assert grade.modulus.value_Pa == pytest.approx(15e6 * _PSI_PA, rel=1e-3)
    assert grade.axial_stiffness_N(size) == pytest.approx(103.4e9 * 45.94e-6, rel=1e-9)


def test_breaking_loads_follow_the_factors_of_en_12385_4(catalogue):
    """F = K d² Rr, K from table 1.9 of Feyrer, Wire Ropes; none of our figures is taken from it."""
    for grade_id, factor, wire_grade_MPa in (
        ("unirope-6x36-iwrc-1960", 0.356, 1960.0),
        ("unirope-6x36-fc-1960", 0.330, 1960.0),
        ("forestali-6x19m-fc-galvanised-1770", 0.307, 1770.0),
        ("forestali-6x19m-steelcore-galvanised-1960", 0.332, 1960.0),
    ):
        fit = catalogue.grade(grade_id).fit()
        expected_Pa = factor * wire_grade_MPa * 1e6 / (math.pi / 4.0)
        assert fit.breaking_stress_Pa == pytest.approx(expected_Pa, rel=5e-3)


def test_sizes_ascend_in_diameter_and_in_breaking_load_but_for_doubtful_ones(catalogue):
    for grade in catalogue.grades:
        for thin, thick in pairwise(size for size in grade.sizes if size.doubt is None):
            assert thin.diameter_m < thick.diameter_m
            assert thin.minimum_breaking_load_N < thick.minimum_breaking_load_N
