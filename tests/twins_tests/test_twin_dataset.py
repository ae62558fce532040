"""Campaigns on the twins: seeds, noise, gaps, files, sizes."""

from __future__ import annotations

import csv

import numpy as np
import pytest
import yaml
from twins.dataset import effect_size, make, size_for
from twins.robots import HALL6, ROBOTS, YARD3


@pytest.mark.parametrize("settled", [True, False])
@pytest.mark.parametrize("robot", ROBOTS.values(), ids=lambda robot: robot.name)
def test_a_campaign_is_plausible_and_repeatable(robot, settled) -> None:
    one, two = (make(robot, seed=7, settled=settled) for _ in range(2))
    other = make(robot, seed=8, settled=settled)
    assert np.array_equal(one.length_m, two.length_m)
    assert not np.array_equal(one.length_m, other.length_m)
    scene, (low, high) = one.scene, np.array(robot.box_m).T
    assert (np.diff(scene.time_s) > 0).all()
    assert ((scene.position_m >= low) & (scene.position_m <= high)).all()
    assert 15 <= scene.temperature_C.min() <= scene.temperature_C.max() <= 30
    assert one.clean_tension_N.min() > 0.02 * robot.mass_kg * 9.81
    misfit = (one.length_m - one.clean_length_m) / robot.noise_m
    assert misfit.std() == pytest.approx(1, abs=0.15)


def test_time_does_not_go_with_place_in_passes() -> None:
    scene = make(YARD3, seed=1).scene
    jumps = np.linalg.norm(np.diff(scene.position_m, axis=0), axis=1)
    at_random = make(YARD3, seed=1, order="random").scene.position_m
    assert np.median(jumps) < 0.6 * np.median(np.linalg.norm(np.diff(at_random, axis=0), axis=1))
    for axis in range(3):
        assert abs(np.corrcoef(scene.time_s, scene.position_m[:, axis])[0, 1]) < 0.3


def test_repeats_return_to_poses_seen_before() -> None:
    position = make(YARD3, rows=60, seed=2, repeats=15).scene.position_m
    assert len(np.unique(position, axis=0)) == 45


def test_gaps_and_outliers() -> None:
    data = make(YARD3, rows=200, seed=3, missing=0.1, outliers=0.05)
    assert np.isnan(data.length_m).mean() == pytest.approx(0.1, abs=0.04)
    assert data.outlier_tension.mean() == pytest.approx(0.045, abs=0.02)
    off = np.abs(data.tension_N - data.clean_tension_N)[data.outlier_tension] / YARD3.noise_N
    assert off.min() > 4


def test_noise_free_readings_are_the_physics() -> None:
    data = make(YARD3, {"pulley_radius": {"radius_m": 0.1}}, noise=0.0)
    assert np.array_equal(data.length_m, data.clean_length_m)


def test_size_of_an_effect_among_others() -> None:
    both = make(
        YARD3, ["length_offset", "tension_gain"],
        {
            "length_offset": {"offset_1_m": 0.01, "offset_2_m": 0.01, "offset_3_m": 0.01},
            "tension_gain": {"cable": 1, "gain": 1.001},
        },
    )  # fmt: skip
    assert effect_size(both, "length_offset") == pytest.approx(10 / np.sqrt(2), rel=1e-6)
    assert effect_size(both, "tension_gain") < 1 < effect_size(both)
    assert effect_size(make(YARD3)) == 0


@pytest.mark.parametrize(
    "effect", ["pulley_radius", "elastic_modulus", "wind_drag", "mast_compliance"]
)
def test_an_effect_can_be_had_at_a_multiple_of_the_noise(effect) -> None:
    size = size_for(HALL6, effect, 3.0, seed=4, rows=40)
    data = make(HALL6, [effect], HALL6.draw(effect, size, 4), rows=40, seed=4)
    assert effect_size(data) == pytest.approx(3.0, rel=0.02)


def test_a_size_that_no_plausible_parameter_gives_is_an_error() -> None:
    with pytest.raises(ValueError, match="clock_offset on yard3"):
        size_for(YARD3, "clock_offset", 5.0)
    with pytest.raises(ValueError, match="bending_stiffness"):
        size_for(YARD3, "bending_stiffness", 5.0, rows=3)


@pytest.mark.parametrize("robot", ROBOTS.values(), ids=lambda robot: robot.name)
def test_files(robot, tmp_path) -> None:
    data = make(robot, rows=9, seed=5, missing=0.2)
    config = yaml.safe_load(data.write(tmp_path / "set").read_text(encoding="utf-8"))
    assert config["robot"]["anchors"][1] == list(robot.exit_m[1])
    assert config["measurements"]["noise"]["length"] == f"{robot.noise_m:g} m"
    assert "effects" not in config
    with (tmp_path / "set" / "measured.csv").open(encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    turned = ["rx_rad", "ry_rad", "rz_rad"] if robot is HALL6 else []
    numbers = range(1, robot.cables + 1)
    assert list(rows[0]) == [
        "time_s", "x_m", "y_m", "z_m", *turned,
        *(f"length_{k}_m" for k in numbers), *(f"tension_{k}_N" for k in numbers),
        "temperature_C", *(f"wind_{a}_m_per_s" for a in "xyz"),
    ]  # fmt: skip
    read = np.array([[float(row[f"length_{k}_m"] or "nan") for k in numbers] for row in rows])
    assert np.allclose(read, data.length_m, atol=1e-6, equal_nan=True)
    only = data.columns(["tension"])
    assert "length_1_m" not in only
    assert "tension_1_N" in only
