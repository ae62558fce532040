"""Spot figures of the shipped grades, as their sources print them."""

from __future__ import annotations

import math
from itertools import pairwise

import pytest

from designer.grades.grade import Grade
from designer.grades.listing import ton_remarks
from designer.grades.registry import Catalogue, load_catalogue, read_grades
from designer.resources import data_folder

_LBF_N = 4.4482216152605
_LB_PER_FT = 0.45359237 / 0.3048
_PSI_PA = _LBF_N / 0.0254**2


@pytest.fixture(scope="module")
def catalogue() -> Catalogue:
    return load_catalogue(with_plugins=False)


def test_no_ton_of_a_shipped_grade_is_doubted(catalogue):
    assert not [remark for grade in catalogue.grades for remark in ton_remarks(grade)]


def _size(grade: Grade, size_id: str):
    return next(size for size in grade.sizes if size.id == size_id)


def _products(catalogue: Catalogue) -> list[Grade]:
    return [grade for grade in catalogue.grades if not grade.is_nominal]


def test_every_shipped_file_is_a_grade_without_a_fault(catalogue):
    files = list(data_folder("catalog").glob("*.yaml"))

    assert read_grades(data_folder("catalog"))[1] == []
    assert catalogue.problems == ()
    assert {grade.file for grade in _products(catalogue)} == {file.name for file in files}
    assert len(files) >= 60


def test_a_shipped_file_is_named_after_its_grade(catalogue):
    products = _products(catalogue)

    assert [grade.file for grade in products] == [f"{grade.id}.yaml" for grade in products]


def test_the_grades_come_from_many_publishers_and_are_of_many_materials(catalogue):
    assert len({grade.source.publisher for grade in catalogue.grades}) >= 8
    assert len({grade.material for grade in catalogue.grades}) >= 8
    assert None not in {grade.material for grade in catalogue.grades}


def test_loading_reports_no_two_grades_with_the_same_table(catalogue):
    tables = [
        [(size.diameter_m, size.minimum_breaking_load_N, grade.core) for size in grade.sizes]
        for grade in _products(catalogue)
        # the seller prints the same figures for these two classes
        if grade.id not in ("unirope-6x37-fc-eips",)
    ]

    assert all(first != second for k, first in enumerate(tables) for second in tables[:k])


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
        ("unirope-1x19-galvanised", "5/32 in", (3.96875, 3300 * _LBF_N, 0.055 * _LB_PER_FT)),
        ("unirope-compac35-rotation-resistant", "80 mm", (80.0, 6_143_000.0, 31.3)),
        ("unirope-python-super8v-2160", "14 mm", (14.0, 197_600.0, 0.92)),
        ("api-9a-6x7-fc-1960", "9 mm", (9.0, 52_700.0, 0.279)),
        ("yale-vectrus-vectran", "1 in", (25.4, 98_100 * _LBF_N, 0.321 * _LB_PER_FT)),
        ("english-braids-superyacht-dockline-nylon", "24 mm", (24.0, 12_700 * 9.80665, 0.391)),
        ("robline-rapallo-polyester", "28 mm", (28.0, 135_000.0, 0.490)),
        ("superline-polyester", "192 mm", (192.0, 10_104_000.0, 24.08)),
        ("unirope-18x7-2160", "7 mm", (7.0, 34_700.0, 0.20)),
        ("unirope-19x7-1960", "9.5 mm", (9.5, 58_000.0, 0.38)),
        ("unirope-24x7-compacted-2160", "13 mm", (13.0, 145_000.0, 0.71)),
        ("metalico-1x7-messenger-utilities", "3/8 in", (9.525, 4898 * 9.80665, 0.407)),
        ("samson-amsteel-blue-hmpe", "3 mm", (3.0, 1000 * 9.80665, 0.0074)),
        ("unirope-8x19s-compacted-2160", "10 mm", (10.0, 76_900.0, 0.31 * _LB_PER_FT)),
        ("unirope-compac8-2160", "16 mm", (16.0, 250_700.0, 0.82 * _LB_PER_FT)),
        ("astm-a475-1x7-extra-high-strength", "1/4 in", (6.35, 29_581.0, 0.121 * _LB_PER_FT)),
        ("astm-a586-helical-strand-a", "3/4 in", (19.05, 68_000 * _LBF_N, 1.18 * _LB_PER_FT)),
        ("hendrik-veder-hmpe", "46 mm", (46.0, 1_618_600.0, 1.11)),
        ("liros-tsl-aramid", "TSL 380", (2.2, 3800.0, 0.00346)),
        ("liros-dsl-hmpe", "DSL 350", (2.0, 3500.0, 0.00325)),
        ("edelrid-a8001-aramid", "A-8001-470", (2.2, 4700.0, 0.0028)),
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
        assert len(grade.elasticity.source) > 20
        least = 0.1 if grade.elasticity.basis == "printed" else 0.15
        assert grade.elasticity.uncertainty >= least
        assert (grade.modulus is None) != (grade.stiffness is None)


def test_the_soft_ropes_are_soft_and_the_stiff_ones_stiff(catalogue):
    """EA over breaking load, at a fifth of it; wire rope strains about 0.3 % there."""
    ratio = {
        grade.id: grade.axial_stiffness_N(grade.thickest) / grade.thickest.minimum_breaking_load_N
        for grade in catalogue.grades
    }

    assert ratio["yale-yalon-nylon"] < ratio["yale-yalex-polyester"] < ratio["yale-vectrus-vectran"]
    assert ratio["yale-vectrus-vectran"] < ratio["yale-ultrex-hmpe"] < ratio["yale-pobon-pbo"]
    assert 0.2 / ratio["unirope-7x19-galvanised"] == pytest.approx(0.0031, rel=0.2)
    assert ratio["superline-hmpe"] == pytest.approx(0.5 * (10.5 + 28.6))


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
        ("unirope-18x7-2160", 0.328, 2160.0),
        ("unirope-19x7-1960", 0.328, 1960.0),
    ):
        fit = catalogue.grade(grade_id).fit()
        expected_Pa = factor * wire_grade_MPa * 1e6 / (math.pi / 4.0)
        assert fit.breaking_stress_Pa == pytest.approx(expected_Pa, rel=5e-3)


def test_stranded_steel_ropes_have_limits_of_temperature_and_single_strands_have_none(catalogue):
    for grade in catalogue.grades:
        if grade.material_class != "fibre":
            assert (grade.limits is None) == grade.is_strand
    assert catalogue.grade("unirope-7x19-galvanised").limits.temperature_C == (-54.0, 121.0)


def test_rotation_and_wire_breaks_fit_the_construction(catalogue):
    breaks = {
        grade.construction: grade.discard.text.split(" visible")[0]
        for grade in catalogue.grades
        if grade.discard is not None
    }
    assert {name: breaks[name] for name in ("6x7", "7x7", "6x19 Seale", "7x19", "34x7")} == {
        "6x7": "2",
        "7x7": "2",
        "6x19 Seale": "3",
        "7x19": "5",
        "34x7": "3",
    }
    for grade in catalogue.grades:
        if grade.rotation is not None and grade.construction.startswith("6x"):
            assert grade.rotation.text == "not rotation-resistant"


def test_sizes_ascend_in_diameter_and_in_breaking_load_but_for_doubtful_ones(catalogue):
    for grade in catalogue.grades:
        for thin, thick in pairwise(size for size in grade.sizes if size.doubt is None):
            assert thin.diameter_m < thick.diameter_m
            assert thin.minimum_breaking_load_N < thick.minimum_breaking_load_N
