"""Grades, their families and their stiffness."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest
from grade_samples import family_grade
from hypothesis import given
from hypothesis import strategies as st

from designer.grades.grade import AreaFactor, Grade, Modulus, Reference, RelativeStiffness


def _with_size(grade: Grade, index: int, **changes: object) -> Grade:
    sizes = list(grade.sizes)
    sizes[index] = replace(sizes[index], **changes)
    return replace(grade, sizes=tuple(sizes))


@given(
    density=st.floats(500.0, 8000.0),
    modulus=st.floats(1e9, 2e11),
    stress=st.floats(1e8, 2e9),
    diameters=st.sets(st.integers(1, 100), min_size=1, max_size=12),
)
def test_fit_recovers_the_family_that_the_sizes_follow(density, modulus, stress, diameters):
    grade = family_grade(density, modulus, stress, sorted(diameters))

    family = grade.family(safety_factor=4.0)
    fit = grade.fit()

    assert family.density_kg_per_m3 == pytest.approx(density, rel=1e-12)
    assert family.youngs_modulus_Pa == pytest.approx(modulus, rel=1e-12)
    assert family.allowable_stress_Pa == pytest.approx(stress / 4.0, rel=1e-12)
    assert fit.breaking_load_spread == pytest.approx((0.0, 0.0), abs=1e-12)
    assert fit.linear_density_spread == pytest.approx((0.0, 0.0), abs=1e-12)


def test_a_size_as_a_cable_is_the_member_of_the_family_with_its_diameter():
    grade = family_grade()
    size = grade.sizes[2]

    cable = grade.cable(size, safety_factor=5.0)
    member = grade.family(safety_factor=5.0).cable(size.diameter_m)

    assert cable.allowable_tension_N == size.minimum_breaking_load_N / 5.0
    for name in ("diameter_m", "linear_density_kg_per_m", "axial_stiffness_N"):
        assert getattr(cable, name) == pytest.approx(getattr(member, name), rel=1e-12)


def test_one_misprint_moves_neither_the_fit_nor_hides_in_its_spread():
    grade = family_grade(breaking_stress_Pa=1.0e9)
    misprinted = _with_size(
        grade, 2, minimum_breaking_load_N=1.2 * grade.sizes[2].minimum_breaking_load_N
    )

    fit = misprinted.fit()

    assert fit.breaking_stress_Pa == pytest.approx(1.0e9, rel=1e-12)
    assert fit.breaking_load_spread == pytest.approx((0.0, 0.2), abs=1e-12)


def test_doubtful_sizes_are_left_out_of_the_fit_but_not_of_its_spread():
    grade = family_grade(breaking_stress_Pa=1.0e9)
    for index in (0, 1):
        load_N = 1.25 * grade.sizes[index].minimum_breaking_load_N
        grade = _with_size(grade, index, minimum_breaking_load_N=load_N, doubt="another rope")
    certain = replace(grade, sizes=grade.sizes[2:])

    assert grade.fit().n_fitted == 3
    assert grade.fit().breaking_stress_Pa == certain.fit().breaking_stress_Pa
    assert grade.fit().breaking_load_spread[1] == pytest.approx(0.25, rel=1e-12)


def test_where_most_of_a_table_is_doubted_all_of_it_is_fitted():
    grade = family_grade()
    for index in (0, 1, 2):
        grade = _with_size(grade, index, doubt="below the standard")

    assert grade.fit().n_fitted == 5


def test_a_modulus_on_the_metallic_area_is_converted_to_the_nominal_circle():
    nominal = family_grade(youngs_modulus_Pa=60e9)
    factor = AreaFactor(0.45, "computed", "made up for a test")
    modulus = Modulus(60e9 * (math.pi / 4.0) / 0.45, "metallic", "computed", "a test", 0.0)
    metallic = replace(nominal, modulus=modulus, area_factor=factor)

    for size in nominal.sizes:
        stiffness_N = metallic.axial_stiffness_N(size)
        assert stiffness_N == pytest.approx(nominal.axial_stiffness_N(size), rel=1e-12)
    assert metallic.family(5.0).youngs_modulus_Pa == pytest.approx(60e9, rel=1e-12)


def test_a_printed_metallic_area_goes_before_the_area_factor():
    grade = replace(family_grade(), area_factor=AreaFactor(0.45, "computed", "a test"))
    grade = _with_size(grade, 1, metallic_area_m2=1.5e-5)

    assert grade.metallic_area_m2(grade.sizes[1]) == 1.5e-5
    assert grade.metallic_area_m2(grade.sizes[0]) == pytest.approx(0.45 * 0.004**2)


def test_an_unknown_metallic_area_is_never_guessed():
    grade = replace(family_grade(), modulus=Modulus(1e11, "metallic", "printed", "a test", 0.0))

    assert grade.metallic_area_m2(grade.sizes[0]) is None
    with pytest.raises(ValueError, match="4 mm: the metallic area is not known"):
        grade.axial_stiffness_N(grade.sizes[0])


def test_the_thickest_size_is_the_last():
    assert family_grade(diameters_mm=(3.0, 5.0, 9.0)).thickest.id == "9 mm"


def test_a_reference_reads_as_one_line_without_gaps():
    assert str(Reference("Acme", "Sheet 3", url="https://acme.example")) == (
        "Acme, Sheet 3, https://acme.example"
    )


def _stiffness(ratios: tuple[float, ...], loads: tuple[float, ...] = ()) -> RelativeStiffness:
    return RelativeStiffness(ratios, loads, "printed", "made up for a test", 0.1)


def _fibre(stiffness: RelativeStiffness) -> Grade:
    grade = family_grade(density_kg_per_m3=700.0, breaking_stress_Pa=9e8)
    return replace(grade, modulus=None, stiffness=stiffness, material="HMPE")


@pytest.mark.parametrize(
    ("load", "expected"),
    [(0.05, 10.0), (0.1, 10.0), (0.2, 20.0), (0.3, 30.0), (0.4, 35.0), (0.5, 40.0), (1.0, 40.0)],
)
def test_a_table_is_interpolated_and_constant_beyond_its_ends(load, expected):
    stiffness = _stiffness((10.0, 30.0, 40.0), (0.1, 0.3, 0.5))

    assert stiffness.at(load) == pytest.approx(expected, rel=1e-12)


@given(st.floats(0.001, 1.0))
def test_one_figure_holds_at_every_load(load):
    assert _stiffness((56.0,)).at(load) == 56.0
    assert _stiffness((56.0,), (0.2,)).at(load) == 56.0


def test_a_cable_is_as_stiff_as_at_its_tension_whatever_its_safety_factor():
    grade = _fibre(_stiffness((10.0, 30.0), (0.1, 0.3)))
    size = grade.sizes[2]

    for safety_factor in (10.0, 5.0, 2.0):
        cable = grade.cable(size, safety_factor)
        assert cable.allowable_tension_N == size.minimum_breaking_load_N / safety_factor
        for load, ratio in ((0.05, 10.0), (0.2, 20.0), (0.4, 30.0)):
            at_load = cable.at_tension(load * size.minimum_breaking_load_N)
            expected = ratio * size.minimum_breaking_load_N
            assert at_load.axial_stiffness_N == pytest.approx(expected, rel=1e-12)
    for safety_factor, ratio in ((10.0, 10.0), (5.0, 20.0), (2.0, 30.0)):
        family = grade.family(safety_factor)  # whose thinnest member is used to the full
        strain = family.allowable_stress_Pa / family.youngs_modulus_Pa
        assert strain == pytest.approx(1.0 / (safety_factor * ratio))


@given(ratio=st.floats(1.0, 200.0), safety_factor=st.floats(1.5, 12.0))
def test_the_family_of_a_fibre_rope_has_the_stiffness_of_its_sizes(ratio, safety_factor):
    grade = _fibre(_stiffness((ratio,)))
    family = grade.family(safety_factor)

    assert family.youngs_modulus_Pa == pytest.approx(ratio * 9e8, rel=1e-12)
    for size in grade.sizes:
        member, cable = family.cable(size.diameter_m), grade.cable(size, safety_factor)
        assert member.axial_stiffness_N == pytest.approx(cable.axial_stiffness_N, rel=1e-12)
        assert member.allowable_tension_N == pytest.approx(cable.allowable_tension_N, rel=1e-12)


def test_a_grade_without_modulus_or_stiffness_does_not_guess():
    grade = replace(family_grade(), modulus=None)

    with pytest.raises(ValueError, match="neither modulus nor stiffness"):
        grade.axial_stiffness_N(grade.sizes[0])


def test_stiffness_reads_as_a_sentence():
    assert _stiffness((56.0,)).figure == "EA is 56 times the breaking load"
    table = _stiffness((10.5, 28.6), (0.1, 0.3))
    assert table.figure == "EA is 10.5, 28.6 times the breaking load at 0.1, 0.3 of it"
