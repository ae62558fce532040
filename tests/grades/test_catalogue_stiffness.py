from __future__ import annotations

from dataclasses import replace

import pytest
from grade_samples import family_grade
from hypothesis import given
from hypothesis import strategies as st

from designer.grades.grade import Grade, RelativeStiffness


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
