"""The creep law against closed forms; the grades against the rule that they follow."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import fibre_rope
import pytest
from fibre_rope.creep import BOLTZMANN_J_PER_K, CreepLaw
from fibre_rope.grades import breaking_load_N, computed_grades, creep_load_fraction
from fibre_rope.parameters import Condition, Parameters, read_parameters

from designer.grades.checks import find_flaws

YEAR_S = 365.25 * 86400.0
LAW = CreepLaw(
    activation_energy_J=2.4e-19,
    activation_volume_m3=4.5e-29,
    reference_stress_Pa=250e6,
    reference_temperature_K=293.15,
    reference_life_s=5.0 * YEAR_S,
)


@pytest.fixture(scope="module")
def parameters() -> Parameters:
    return read_parameters(fibre_rope.SHIPPED_PARAMETERS)


def test_the_law_goes_through_its_reference() -> None:
    assert LAW.life_s(250e6, 293.15) == pytest.approx(5.0 * YEAR_S)
    assert LAW.stress_Pa(5.0 * YEAR_S, 293.15) == pytest.approx(250e6)


@pytest.mark.parametrize("stress_Pa", [1e6, 50e6, 250e6, 900e6])
@pytest.mark.parametrize("temperature_K", [263.15, 293.15, 333.15])
def test_stress_is_the_inverse_of_life(stress_Pa, temperature_K) -> None:
    life_s = LAW.life_s(stress_Pa, temperature_K)
    assert LAW.stress_Pa(life_s, temperature_K) == pytest.approx(stress_Pa, rel=1e-9)


def test_at_one_stress_over_temperature_life_follows_arrhenius() -> None:
    warm_K = 313.15
    ratio = LAW.life_s(250e6 * warm_K / 293.15, warm_K) / LAW.life_s(250e6, 293.15)
    slope_K = LAW.activation_energy_J / BOLTZMANN_J_PER_K
    assert ratio == pytest.approx(math.exp(slope_K * (1.0 / warm_K - 1.0 / 293.15)))


def test_at_small_stress_life_is_inverse_to_it_and_at_large_stress_exponential() -> None:
    assert LAW.life_s(1e3, 293.15) / LAW.life_s(2e3, 293.15) == pytest.approx(2.0, rel=1e-6)
    step = 100e6 * LAW.activation_volume_m3 / (BOLTZMANN_J_PER_K * 293.15)
    ratio = LAW.life_s(2.0e9, 293.15) / LAW.life_s(2.1e9, 293.15)
    assert ratio == pytest.approx(math.exp(step), rel=1e-6)


def test_the_allowable_load_is_the_lesser_of_safety_factor_and_creep(parameters) -> None:
    for condition, grade in zip(parameters.conditions, computed_grades(parameters), strict=True):
        fraction = min(1.0 / 5.0, creep_load_fraction(parameters, condition))
        for size in grade.sizes:
            cable = grade.cable(size, 5.0)
            full_N = breaking_load_N(parameters, size.diameter_m)
            assert cable.allowable_tension_N == pytest.approx(fraction * full_N)
            assert cable.axial_stiffness_N == pytest.approx(56.0 * full_N)


def test_forty_millimetres_break_where_the_regression_says(parameters) -> None:
    assert breaking_load_N(parameters, 0.04) == pytest.approx(969_664.0)


def test_warmer_or_longer_is_weaker(parameters) -> None:
    def left(temperature_C: float, years: float) -> float:
        return creep_load_fraction(parameters, Condition(temperature_C + 273.15, years * YEAR_S))

    assert left(20.0, 5.0) == pytest.approx(0.2)
    assert left(10.0, 5.0) > left(20.0, 5.0) > left(30.0, 5.0) > left(60.0, 5.0) > 0.0
    assert left(20.0, 1.0) > left(20.0, 5.0) > left(20.0, 20.0)


def test_the_hook_gives_sound_grades_that_say_what_is_assumed(parameters) -> None:
    grades = fibre_rope.register_grades()
    assert len({grade.id for grade in grades}) == len(grades) == len(parameters.conditions)
    for grade in grades:
        assert find_flaws(grade) == []
        assert grade.is_nominal
        assert all("assumption" in (size.doubt or "") for size in grade.sizes)
    (known, *_) = computed_grades(replace(parameters, reference_source="Maker, sheet 7"))
    assert all(size.doubt is None for size in known.sizes)
    assert any("Maker, sheet 7" in note for note in known.notes)


def test_a_file_of_one_s_own_is_read(tmp_path, monkeypatch) -> None:
    own = tmp_path / "own.yaml"
    text = fibre_rope.SHIPPED_PARAMETERS.read_text(encoding="utf-8")
    hot = text.replace("30 degC, life: 5 years", "40 degC, life: 0.5 years")
    own.write_text(hot, encoding="utf-8")
    monkeypatch.setenv(fibre_rope.PARAMETERS_VARIABLE, str(own))
    assert fibre_rope.register_grades()[-1].id == "hmpe-computed-40c-0.5y"


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("temperature: 30 degC", "temperature: 80 degC", r"conditions\[2\].temperature: is above"),
        ("temperature: 30 degC", "temperature: 30 kg", r"conditions\[2\].temperature: '30 kg' has"),
        ("temperature: 30 degC, ", "", r"conditions\[2\].temperature: is missing"),
        ("safety_factor: 5 ", "safety_factor: -5 ", "safety_factor: is not above zero"),
        ("activation_energy: 1.5 eV", "", "creep.activation_energy: is missing"),
        ("load_fraction: 0.2", "load_fraction: much", "creep.reference.load_fraction: 'much'"),
        ("diameters: [", "diameters: [] # [", "diameters: is not a list"),
    ],
)
def test_a_mistake_names_the_file_and_the_field(tmp_path, old, new, words) -> None:
    own = tmp_path / "own.yaml"
    text = fibre_rope.SHIPPED_PARAMETERS.read_text(encoding="utf-8")
    assert old in text
    own.write_text(text.replace(old, new), encoding="utf-8")
    with pytest.raises(ValueError, match=rf"own\.yaml: {words}") as caught:
        read_parameters(own)
    assert "\n" not in str(caught.value)


def test_a_file_that_is_not_there_is_named() -> None:
    with pytest.raises(ValueError, match=r"absent\.yaml: cannot be read"):
        read_parameters(Path("absent.yaml"))
