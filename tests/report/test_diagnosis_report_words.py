"""Fitted values, chances and effects in words."""

from __future__ import annotations

import numpy as np
import pytest

from designer.diagnosis import words
from designer.diagnosis.figures import MOST_POINTS, running_median, thinned, window
from designer.diagnosis.result import Estimate
from designer.diagnosis.structure import strongest_channel, whereabouts
from designer.effects.effect import Effect, Parameter, Size
from designer.spelling import in_runs
from designer.units import NUMBER, TIME


@pytest.mark.parametrize(
    ("value", "std", "unit", "text"),
    [
        (0.0900063, 0.000062, "m", "90.006 ± 0.062 mm"),
        (1.5, 0.02, "m", "1.500 ± 0.020 m"),
        (1.2482, 0.0031, "", "1.2482 ± 0.0031"),
        (12.5e-6, 0.31e-6, "1/K", "(1.250 ± 0.031) × 10⁻⁵ 1/K"),
        (-3.2, 14.0, "kg", "−3 ± 14 kg"),
        (0.0, float("nan"), "N", "0 N"),
    ],
)
def test_estimate(value: float, std: float, unit: str, text: str) -> None:
    shown = words.estimate(Estimate(value, std), unit)
    assert shown.replace("\u00a0", " ") == text


def test_interval() -> None:
    shown = words.interval_95(Estimate(2.0, 0.5), "kg")
    assert shown.replace("\u00a0", " ") == "1.02 to 2.98 kg"
    assert words.interval_95(Estimate(2.0, float("nan")), "kg") == "–"


@pytest.mark.parametrize(
    ("value", "start"), [(0.0, "below"), (0.003, "0.30"), (2e-7, "2.0"), (float("nan"), "–")]
)
def test_chance(value: float, start: str) -> None:
    assert words.chance(value).startswith(start)


@pytest.mark.parametrize(
    ("name", "label"),
    [
        ("offset_1_m", "offset 1"),
        ("flexural_rigidity_N_m2", "flexural rigidity"),
        ("compliance_m_per_N", "compliance"),
        ("scale", "scale"),
    ],
)
def test_the_label_of_a_parameter_drops_the_unit(name: str, label: str) -> None:
    assert Parameter(name, NUMBER, Size(1.0, (0.0, 1.0), (0.0, 1.0))).label == label


@pytest.mark.parametrize(
    ("name", "text", "axis"),
    [
        ("z_m", "z", "z [m]"),
        ("time_s", "time", "time [s]"),
        ("tension_12_N", "tension of cable 12", "tension of cable 12 [N]"),
        ("direction_3", "direction of cable 3", "direction of cable 3"),
        ("load_on_hook_N", "load_on_hook_N", "load_on_hook [N]"),
        ("temperature_C", "temperature", "temperature [°C]"),
        ("wind_x_m_per_s", "wind along x", "wind along x [m/s]"),
        ("speed_m_per_s", "speed of the platform", "speed of the platform [m/s]"),
        ("speed_2_m_per_s", "speed of cable 2", "speed of cable 2 [m/s]"),
        ("battery", "battery", "battery"),
    ],
)
def test_covariates_of_every_table_have_words_and_others_their_name(
    name: str, text: str, axis: str
) -> None:
    assert words.covariate(name) == text
    assert words.covariate_axis(name) == axis


@pytest.mark.parametrize(("scale", "word"), [(0.9, "softer"), (1.1, "stiffer")])
def test_plain_words_tell_the_direction(scale: float, word: str) -> None:
    parameter = Parameter("scale", NUMBER, Size(0.1, (0.1, 3.0), (0.5, 1.6)), neutral=1.0)
    effect = Effect("elastic_modulus", "softer or stiffer", "law", "source", (parameter,))
    assert word in words.plain(effect, {"scale": scale})
    other = Effect("of_a_plugin", "ice on the cable", "law", "source", (parameter,))
    assert words.plain(other, {"scale": scale}) == "ice on the cable"


@pytest.mark.parametrize(("offset", "word"), [(0.03, "lags"), (-0.03, "runs ahead of")])
def test_the_sign_of_a_clock_offset_is_told(offset: float, word: str) -> None:
    parameter = Parameter("offset_s", TIME, Size(0.05, (-60.0, 60.0), (-5.0, 5.0)))
    effect = Effect("clock_offset", "the length stream lags", "law", "source", (parameter,))
    assert words.plain(effect, {"offset_s": offset}) == f"the length stream {word} the pose stream"


def test_strongest_channel_and_its_trend() -> None:
    rng = np.random.default_rng(0)
    covariate = np.linspace(-1.0, 1.0, 200)
    residual = rng.normal(size=(200, 4))
    residual[:, 1] = np.nan
    residual[:, 2] += 5.0 * covariate
    assert strongest_channel(residual, covariate) == 2
    place = whereabouts(residual, covariate, np.arange(11, 211))
    assert place.reading == "tension 1"
    assert {11, 12, 209, 210} & set(place.rows)
    assert abs(place.size) == pytest.approx(5.0, abs=0.5)
    x, trend = running_median(covariate, residual[:, 2])
    assert np.max(np.abs(trend - 5.0 * x)) < 1.5
    x, trend = running_median(np.sign(covariate), residual[:, 2])
    assert x.tolist() == [-1.0, 1.0]
    assert trend[0] < -1.5 < 1.5 < trend[1]


def test_long_logs_are_thinned_and_wild_readings_do_not_flatten() -> None:
    assert len(thinned(100_000)) <= MOST_POINTS
    assert len(thinned(120)) == 120
    values = np.random.default_rng(1).normal(size=1000)
    values[0] = 1e6
    low, high = window(values)
    assert -10.0 < low < -3.0 < 3.0 < high < 10.0


def test_neighbouring_rows_are_drawn_together() -> None:
    assert in_runs([3, 7, 8, 9, 12]) == ["3", "7 to 9", "12"]


def test_rivals_of_several_effects_are_said_to_stand_together() -> None:
    assert words.rival_names(["creep"]) == "creep"
    pair = "winch_zero of cable 1 and winch_zero of cable 3"
    assert words.rival_names(["creep", pair]) == f"creep or {pair} together"
    assert words.rival_names(["winch_zero", "pose_shift"], "and") == "winch_zero and pose_shift"
