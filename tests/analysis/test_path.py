"""A platform in motion: by Newton's law for its particles, energies, and bends of its ropes."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from pairs.options import BASES
from pairs.table import analysed
from scipy.interpolate import CubicSpline
from scipy.spatial.transform import Rotation

from designer.analysis.analyse import Analysis
from designer.analysis.path import PathCase, life_requirements
from designer.model.motion import Motion, limited, timed, unwrapped
from designer.model.verdict import State
from designer.report.design.drawings import Drawings
from designer.report.design.report import section
from designer.report.render import rendered
from designer.statics.inverse import platform_branch_N

UP = np.array([0.0, 0.0, 1.0])
G = 9.81
"""As the product has it [m/s²]."""


def random_rows(rng: np.random.Generator, count: int, turn_rad: float = 1.0) -> np.ndarray:
    return np.hstack([rng.normal(size=(count, 3)), turn_rad * rng.normal(size=(count, 3))])


def particles_m(motion: Motion, arms_m: np.ndarray) -> np.ndarray:
    """Return where points of the platform are (n_instants, n_points, 3)."""
    turned = Rotation.from_rotvec(np.array(motion.rotation_vectors_rad)).as_matrix()
    return motion.positions_m[:, None] + np.einsum("nij,pj->npi", turned, arms_m)


def derived(time_s: np.ndarray, values: np.ndarray, order: int) -> np.ndarray:
    return CubicSpline(time_s, values)(time_s, order)


@pytest.mark.parametrize("seed", [3, 2611, 90210])
def test_rates_are_those_of_points_of_the_platform(seed: int) -> None:
    rng = np.random.default_rng(seed)
    time_s = np.cumsum(rng.uniform(0.5, 2.0, size=6))
    motion = timed(time_s, random_rows(rng, 6), UP, "at_rest", "rows")
    arms, turn = rng.normal(size=(4, 3)), motion.rotation_vectors_rad
    at = particles_m(motion, arms)
    lever = at - motion.positions_m[:, None]
    (v, w), (a, alpha) = (np.split(x, 2, axis=1) for x in (motion.velocity, motion.acceleration))
    speed = v[:, None] + np.cross(w[:, None], lever)
    gain = a[:, None] + np.cross(alpha[:, None], lever)
    gain = gain + np.cross(w[:, None], np.cross(w[:, None], lever))
    inner = slice(3, -3)
    size = np.abs(gain).max()
    assert derived(motion.time_s, at, 1)[inner] == pytest.approx(speed[inner], abs=1e-4 * size)
    assert derived(motion.time_s, at, 2)[inner] == pytest.approx(gain[inner], abs=0.02 * size)
    assert motion.velocity[[0, -1]] == pytest.approx(0.0, abs=1e-12)
    rows = np.searchsorted(motion.time_s, time_s)
    assert motion.time_s[rows] == pytest.approx(time_s)
    assert len(turn) == len(motion.time_s)


def test_rows_are_passed_at_their_times_and_turns() -> None:
    rng = np.random.default_rng(5)
    places, time_s = random_rows(rng, 7, 2.0), np.arange(7.0)
    motion = timed(time_s, places, UP, "moving", "rows")
    at = motion.places[np.searchsorted(motion.time_s, time_s)]
    assert at[:, :3] == pytest.approx(places[:, :3])
    gap = Rotation.from_rotvec(at[:, 3:]).inv() * Rotation.from_rotvec(places[:, 3:])
    assert gap.magnitude() == pytest.approx(0.0, abs=1e-9)


def test_turns_go_on_beyond_half_a_turn() -> None:
    angles = np.arange(0.0, 9.0, 0.7)
    whole = Rotation.from_rotvec(np.outer(angles, [0.0, 0.6, 0.8])).as_rotvec()
    assert unwrapped(whole) == pytest.approx(np.outer(angles, [0.0, 0.6, 0.8]))


@pytest.mark.parametrize("seed", [8, 51, 777])
def test_inertia_is_newtons_law_of_particles(seed: int) -> None:
    rng = np.random.default_rng(seed)
    masses, arms = rng.uniform(1.0, 3.0, size=9), rng.normal(size=(9, 3))
    mass = masses.sum()
    centre = masses @ arms / mass
    apart = arms - centre
    inertia = sum(m * (r @ r * np.eye(3) - np.outer(r, r)) for m, r in zip(masses, apart))  # noqa: B905
    motion = timed(np.arange(5.0), random_rows(rng, 5), UP, "at_rest", "rows")
    turned = Rotation.from_rotvec(np.array(motion.rotation_vectors_rad)).as_matrix()
    wrench = motion.inertia_wrench_N(motion.positions_m, turned, mass, centre, inertia)
    at = particles_m(motion, arms)
    each = -masses[:, None] * derived(motion.time_s, at, 2)
    lever = at - motion.positions_m[:, None]
    newton = np.hstack([each.sum(axis=1), np.cross(lever, each).sum(axis=1)])
    # Differences of a cubic are as good as the interval, but at its knots.
    error = np.abs(newton - wrench)[4:-4]
    assert np.median(error) < 1e-4 * np.abs(wrench).max()


@pytest.mark.parametrize("seed", [1, 19, 404])
def test_limits_hold_on_all_of_the_platform(seed: int) -> None:
    rng = np.random.default_rng(seed)
    reach, speed, gain = 0.7, rng.uniform(0.2, 3.0), rng.uniform(0.1, 2.0)
    motion = limited(random_rows(rng, 6, 0.5), UP, reach, "rows", speed, gain)
    arms = rng.normal(size=(30, 3))
    arms = reach * arms / np.linalg.norm(arms, axis=1, keepdims=True)
    at = particles_m(motion, arms)
    speeds, gains = (np.linalg.norm(derived(motion.time_s, at, k), axis=2)[3:-3] for k in (1, 2))
    assert speeds.max() <= speed * (1.0 + 1e-3)
    assert gains.max() <= gain * 1.01
    assert max(speeds.max() / speed, gains.max() / gain) > 0.3  # and is not far from them
    assert motion.velocity[[0, -1]] == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize(("length", "fastest"), [(20.0, 2.0), (1.0, None)])
def test_straight_line_from_rest_to_rest(length: float, fastest: float | None) -> None:
    rows = np.zeros((2, 6))
    rows[1, 1] = length
    motion = limited(rows, UP, 0.0, "rows", 2.0, 0.5)
    speed = motion.velocity[:, 1].max()
    assert motion.acceleration[:, 1].max() == pytest.approx(0.5, rel=1e-3)
    ramp = np.pi * speed / (2.0 * 0.5)
    assert motion.time_s[-1] == pytest.approx(length / speed + ramp)
    assert motion.positions_m[-1, 1] == pytest.approx(length)
    if fastest is None:
        assert speed < 2.0
        assert motion.time_s[-1] == pytest.approx(2.0 * ramp)
    else:
        assert speed == pytest.approx(fastest)
    assert derived(motion.time_s, motion.positions_m[:, 1], 1) == pytest.approx(
        motion.velocity[:, 1], abs=1e-3
    )


def test_each_instant_has_its_own_inertia_where_a_place_comes_twice() -> None:
    rows = np.zeros((5, 6))
    rows[[1, 3], 0] = 1.0  # there and back twice, with a stay at the end
    motion = timed(np.arange(5.0), rows, UP, "at_rest", "rows")
    assert len(np.unique(motion.positions_m, axis=0)) == len(motion.time_s)
    assert motion.rates_at(motion.positions_m)[:, 3:] == pytest.approx(motion.acceleration)
    assert not motion.rates_at(motion.positions_m + 1e-3).any()


def test_platform_rests_between_equal_rows() -> None:
    """Also where one of position and orientation is kept alone, and within limits of speed."""
    rng = np.random.default_rng(6)
    rows, time_s = random_rows(rng, 7), np.array([0.0, 2.0, 4.5, 6.0, 8.0, 9.0, 12.0])
    rows[2], rows[3, :3], rows[5, 3:] = rows[1], rows[2, :3], rows[4, 3:]
    for ends in ("at_rest", "moving"):
        motion = timed(time_s, rows, UP, ends, "rows")
        for first, last, part in ((1, 2, slice(6)), (2, 3, slice(3)), (4, 5, slice(3, 6))):
            inside = (motion.time_s >= time_s[first]) & (motion.time_s <= time_s[last])
            places, target = motion.places[inside][:, part], rows[first, part]
            if part.stop == 6 and part.start == 3:  # a rotation vector has turns to spare
                places, target = places - places[0], 0.0
            assert places == pytest.approx(np.broadcast_to(target, places.shape), abs=1e-6)
            assert motion.velocity[inside][:, part] == pytest.approx(0.0, abs=1e-12)
        assert "at rest between rows that are equal" in motion.words
        at = motion.positions_m[np.searchsorted(motion.time_s, time_s)]
        assert at == pytest.approx(rows[:, :3], abs=1e-6)
        # It brakes until it rests, and the brake counts at the instant of its end.
        stop = np.searchsorted(motion.time_s, time_s[1])
        before, there = np.linalg.norm(motion.acceleration[[stop - 1, stop], :3], axis=1)
        assert there == pytest.approx(before, rel=0.1)
    turned = rows[[0, 1, 1, 4]] + np.array([0, 0, 0, 0.3, 0, 0]) * np.arange(4)[:, None]
    around = limited(turned, UP, 0.5, "rows", 1.0, 1.0)
    near = np.linalg.norm(around.positions_m - turned[1, :3], axis=1) < 1e-6
    assert near.sum() > 1  # turns on the spot
    assert np.abs(around.velocity[near, :3]).max() < 1e-9
    assert np.abs(around.velocity[near, 3:]).max() > 0.1


def test_speed_at_rest_has_no_direction() -> None:
    rows = random_rows(np.random.default_rng(2), 3)[[0, 1, 1, 2]]
    motion = timed(np.array([0.0, 3.0, 5.0, 9.0]), rows, UP, "at_rest", "rows")
    length = np.linalg.norm(motion.positions_m - [3.0, 4.0, 9.0], axis=1)[:, None]
    noisy = length * (1.0 + 1e-13 * np.random.default_rng(4).normal(size=length.shape))
    resting = (motion.time_s > 3.0) & (motion.time_s < 5.0)
    assert (motion.speeds_m_per_s(noisy)[resting] == 0.0).all()
    assert np.abs(motion.speeds_m_per_s(noisy)[~resting]).max() > 0.1


def study_on(base: str, folder: Path, rows: np.ndarray, time_s: Any, **more: Any) -> dict[str, Any]:
    """Return a study of the pairs along a path through rows, which it writes."""
    names = ["time_s", "x_m", "y_m", "z_m", "rx_rad", "ry_rad", "rz_rad"][: 1 + rows.shape[1]]
    table = np.column_stack([time_s, rows])
    np.savetxt(folder / "path.csv", table, "%.15g", ",", header=",".join(names), comments="")
    text = BASES[base] | more
    return text | {"workspace": {"path": "path.csv"} | more.get("workspace", {})}


def shared_case(analysis: Analysis) -> PathCase:
    assert analysis.path is not None
    (case,) = analysis.path.cases
    assert case.is_held
    return case


@pytest.mark.parametrize("seed", [12, 345])
def test_forces_at_the_supports_carry_weight_and_inertia(tmp_path: Path, seed: int) -> None:
    rng = np.random.default_rng(seed)
    rows = np.array([6.0, 4.0, 4.0]) + rng.uniform(-1.0, 1.0, size=(5, 3))
    analysis = analysed(study_on("crane", tmp_path, rows, 2.0 * np.arange(5)), tmp_path)
    case = shared_case(analysis)
    time_s = case.motion.time_s
    spline = CubicSpline(2.0 * np.arange(5), rows, bc_type="clamped")
    rope = case.loaded.cable.linear_density_kg_per_m * case.statics.length_m.sum(axis=1)
    on_supports = platform_branch_N(case.statics).sum(axis=1)
    newton = -240.0 * (spline(time_s, 2) + G * UP) - np.outer(rope, G * UP)
    assert on_supports == pytest.approx(newton, rel=1e-6, abs=1e-4)
    # The governing pose is the worst instant, with its inertia.
    allowable = case.loaded.cable.allowable_tension_N
    worst = case.statics.cable_tension_N.max()
    assert analysis.chosen is not None
    assert analysis.chosen.verification.utilisation == pytest.approx(worst / allowable)


def energy_J(case: PathCase, mass_kg: float) -> np.ndarray:
    """Return kinetic and potential energy of a point mass, with own differences [J]."""
    speed = derived(case.motion.time_s, case.motion.positions_m, 1)
    return mass_kg * (0.5 * (speed**2).sum(axis=1) + G * case.motion.positions_m[:, 2])


@pytest.mark.parametrize("seed", [77, 78])
def test_work_of_the_winches_is_the_energy_of_the_platform(tmp_path: Path, seed: int) -> None:
    rng = np.random.default_rng(seed)
    rows = np.array([6.0, 4.0, 4.0]) + rng.uniform(-1.0, 1.0, size=(4, 3))
    case = shared_case(analysed(study_on("crane", tmp_path, rows, 1.5 * np.arange(4)), tmp_path))
    drawn, back = case.energy_J
    energy = energy_J(case, 240.0)
    net, size = float((drawn - back).sum()), float(np.ptp(energy))
    assert net == pytest.approx(energy[-1] - energy[0], abs=0.02 * size)  # rope weighs little
    # The same against straight lines from exit to platform, whose lengths are ours alone.
    exits = np.array(BASES["crane"]["robot"]["anchors"])
    chord = np.linalg.norm(case.motion.positions_m[:, None] - exits, axis=2)
    power = -case.tension_N * derived(case.motion.time_s, chord, 1)
    assert case.power_W == pytest.approx(power, abs=0.02 * np.abs(power).max())


def test_nothing_is_gained_on_a_way_that_comes_back(tmp_path: Path) -> None:
    rng = np.random.default_rng(4)
    rows = np.array([0.0, 0.3, 1.5]) + rng.uniform(-0.5, 0.5, size=(5, 3))
    rows[-1] = rows[0]
    turns = 0.1 * rng.uniform(-1.0, 1.0, size=(5, 3))
    turns[-1] = turns[0]
    base = BASES["six"]["robot"]
    body = {"platform": base["platform"] | {"inertia": [60.0, 70.0, 90.0, 5.0, -4.0, 3.0]}}
    study = study_on(
        "six", tmp_path, np.hstack([rows, turns]), 3.0 * np.arange(5), robot=base | body
    )
    drawn, back = shared_case(analysed(study, tmp_path)).energy_J
    assert (drawn - back).sum() == pytest.approx(0.0, abs=2e-4 * drawn.sum())


def test_winches_and_motors_against_what_they_do(tmp_path: Path) -> None:
    winches = {
        **{"speed_max": 0.5, "drum_diameter": 0.3, "layers": 2, "gear_ratio": 20.0},
        **{"efficiency": 0.8, "motor": {"torque": 50.0, "speed": 1e3, "power": 2e3}},
    }
    robot = BASES["crane"]["robot"] | {"winches": winches}
    rows = np.array([[5.0, 3.0, 4.0], [7.0, 4.0, 5.0], [6.0, 5.0, 3.0]])
    analysis = analysed(study_on("crane", tmp_path, rows, [0, 4, 8], robot=robot), tmp_path)
    case, asked = shared_case(analysis), {each.id: each for each in analysis.requirements}
    speed = derived(case.motion.time_s, case.statics.length_m, 1)
    assert case.speed_m_per_s == pytest.approx(speed, abs=1e-3)
    assert asked["winch_speed"].demand == pytest.approx(np.abs(speed).max(), rel=1e-3)
    assert asked["winch_speed"].state is State.FAILS
    d = case.loaded.cable.diameter_m
    turning = np.abs(speed).max() * 20.0 / (0.15 + 0.5 * d)
    assert asked["motor_speed"].demand == pytest.approx(turning, rel=1e-3)
    pulling = case.tension_N * np.maximum(-speed, 0.0) / 0.8
    assert asked["motor_power"].demand == pytest.approx(pulling.max(), rel=5e-3)
    assert asked["motor_power"].holds
    torque = case.tension_N * (0.15 + 1.5 * d) / 20.0
    assert case.torque_Nm == pytest.approx(np.where(speed > 0.0, 0.8 * torque, torque / 0.8))
    mean = np.trapezoid(case.torque_Nm**2, case.motion.time_s, axis=0) / 8.0
    assert case.rms_torque_Nm == pytest.approx(np.sqrt(mean))
    assert asked["winch_torque"].demand == pytest.approx((torque / 0.8).max(), rel=1e-6)
    block = analysis.to_dict()["path"]
    assert block["duration_s"] == 8.0
    assert [each["cable"] for each in block["winches"]] == [1, 2, 3]
    assert analysis.path is not None
    lines = analysis.path.to_csv().splitlines()
    assert len(lines) == 1 + len(case.motion.time_s)
    assert lines[0].startswith("load_case,time_s,x_m")


LOSSES = {
    **{"tension_max": 1e5, "drum_diameter": 0.3, "gear_ratio": 20.0, "efficiency": 0.8},
    **{"sheave_efficiency": 0.9, "sheaves": 2, "motor": {"torque": 500.0}},
}


@pytest.mark.parametrize("base", ["crane", "four"])
def test_limits_of_winches_follow_the_direction_of_motion(tmp_path: Path, base: str) -> None:
    """A platform that is let down: no winch ever hauls in, and sheaves and gear help to hold."""
    robot = BASES[base]["robot"] | {"winches": LOSSES}
    rows = np.array([[6.0, 4.5, 6.0], [6.0, 4.5, 3.0], [6.0, 4.5, 1.0]])
    path = {"path": {"file": "path.csv", "ends": "moving"}}
    study = study_on(base, tmp_path, rows, [0, 4, 8], robot=robot, workspace=path)
    analysis = analysed(study, tmp_path)
    case, asked = shared_case(analysis), {each.id: each for each in analysis.requirements}
    at_drum = 0.81 * case.tension_N
    rope_m = case.loaded.cable.diameter_m
    torque = at_drum * 0.8 * 0.5 * (0.3 + rope_m) / 20.0
    assert asked["winch_tension"].demand == pytest.approx(at_drum.max())
    assert asked["winch_torque"].demand == pytest.approx(torque.max())
    rows_of_file = analysis.to_dict()["path"]["winches"]
    assert max(row["torque_max_Nm"] for row in rows_of_file) == pytest.approx(torque.max())
    assert max(row["drum_tension_max_N"] for row in rows_of_file) == pytest.approx(at_drum.max())
    governing = analysis.to_dict()["governing"]["cables"]
    assert max(row["drum_tension_N"] for row in governing) <= at_drum.max() * (1.0 + 1e-9)
    # The other way round every winch hauls in; at rest each is about to.
    up = study_on(base, tmp_path, rows[::-1], [0, 4, 8], robot=robot, workspace=path)
    asked_up = {each.id: each for each in analysed(up, tmp_path).requirements}
    lifted = torque.max() / 0.81**2 / 0.8**2
    assert asked_up["winch_torque"].demand == pytest.approx(lifted, rel=0.05)


def test_drums_take_up_strained_rope(tmp_path: Path) -> None:
    """Of a soft family, that stretches by per cents: speeds and power, and the account of work."""
    base = {name: part for name, part in BASES["crane"].items() if name != "selection"}
    winches = {
        **{"speed_max": 5.0, "drum_diameter": 0.3, "gear_ratio": 20.0},
        "motor": {"torque": 500.0, "speed": 1e4, "power": 1e5},
    }
    rows = np.array([[5.0, 3.0, 4.0], [7.0, 4.0, 6.0], [6.0, 5.0, 3.0]])
    soft = base["cable"] | {"youngs_modulus": 5e9}
    text = study_on(
        "crane", tmp_path, rows, [0, 4, 8], robot=base["robot"] | {"winches": winches}, cable=soft
    )
    del text["selection"]
    analysis = analysed(text, tmp_path)
    case, asked = shared_case(analysis), {each.id: each for each in analysis.requirements}
    strain = case.tension_N / case.loaded.cable.axial_stiffness_N
    assert strain.max() > 0.02
    speed = derived(case.motion.time_s, case.statics.length_m, 1)
    at_drum = np.abs(speed) * (1.0 + strain)
    assert asked["winch_speed"].demand == pytest.approx(at_drum.max(), rel=1e-3)
    turning = at_drum.max() * 20.0 / (0.15 + 0.5 * case.loaded.cable.diameter_m)
    assert asked["motor_speed"].demand == pytest.approx(turning, rel=1e-3)
    power = case.tension_N * at_drum
    assert asked["motor_power"].demand == pytest.approx(power.max(), rel=1e-3)
    rows_of_file = analysis.to_dict()["path"]["winches"]
    fastest = max(
        max(r["hauling_in_max_m_per_s"], r["paying_out_max_m_per_s"]) for r in rows_of_file
    )
    assert fastest == pytest.approx(asked["winch_speed"].demand)
    # Work of the winches: energy of the platform and of strain, on the drums and between.
    energy = energy_J(case, 240.0)
    drawn, back = case.energy_J
    time_s, strained = case.motion.time_s, 0.5 * case.tension_N * strain
    free = (strained * case.statics.length_m).sum(axis=1)
    on_drums = np.trapezoid(-strained * speed, time_s, axis=0).sum()
    gained = energy[-1] + free[-1] - energy[0] - free[0] + on_drums
    scale = float(np.ptp(energy))
    assert float((drawn - back).sum()) == pytest.approx(gained, abs=2e-3 * scale)


@pytest.mark.slow
def test_page_of_the_report(tmp_path: Path) -> None:
    rows = np.array([[5.0, 3.0, 4.0], [7.0, 4.0, 5.0], [6.0, 5.0, 3.0]])
    cases = [{"name": "empty", "mass": 120.0}, {"name": "windy", "wind": {"speed": 8.0}}]
    study = study_on("crane", tmp_path, rows, [0, 4, 8], load_cases=cases)
    analysis = analysed(study, tmp_path)
    assert analysis.path is not None
    assert analysis.chosen is not None
    assert [case.name for case in analysis.path.cases] == ["empty", "windy"]
    assert len(analysis.path.directions[1]) == 8
    drawings = Drawings(analysis, draws=True, missing="no scenes here")
    page = rendered(section(drawings, "path")).body
    assert "a cubic spline in time through 3 rows of path.csv" in page
    assert page.count("<tr") == 2 * (1 + 2 * 3)
    assert "cable 3" in page  # of the chart
    path_block = analysis.path.to_dict()
    summary = rendered(section(drawings, "answer")).body
    assert "instants of the path were solved one by one" in summary
    windy_rows = path_block["winches"][3:]
    for name, values in (("tension_max_N", "tension_N"), ("power_max_W", "power_W")):
        every = [getattr(case, values).max(axis=0) for case in analysis.path.directions[1]]
        assert [row[name] for row in windy_rows] == np.max(every, axis=0).tolist()
    light, windy = (case.tension_N.max() for case in analysis.path.cases)
    assert light < 0.7 * windy
    for case, mass in zip(analysis.path.cases, (120.0, 240.0), strict=True):
        rope = analysis.chosen.cable.linear_density_kg_per_m * case.statics.length_m.sum(axis=1)
        assert case.cable_share == pytest.approx((rope / (rope + mass)).max())


def test_a_speed_of_cables_to_spare_is_open_beyond_its_limit(tmp_path: Path) -> None:
    anchors = [*BASES["crane"]["robot"]["anchors"], [11.0, 0.5, 9.0]]
    winches = {"speed_max": 0.05}
    robot = BASES["crane"]["robot"] | {"anchors": anchors, "winches": winches}
    rows = np.array([[5.0, 3.0, 4.0], [7.0, 4.0, 5.0], [6.0, 5.0, 3.0]])
    analysis = analysed(study_on("crane", tmp_path, rows, [0, 4, 8], robot=robot), tmp_path)
    (asked,) = (each for each in analysis.requirements if each.id == "winch_speed")
    assert asked.demand > asked.capacity
    assert asked.state is State.OPEN
    assert "other internal forces may need less" in asked.remark


LIFE: dict[str, Any] = {
    "b0": 1.2, "b1": -2.5, "b2": 5.5, "b3": -1.7, "wire_strength": "1770 MPa",
    "source": "made up for a test", "runs_per_day": 30, "days_min": 100,
}  # fmt: skip
ROWS = ((5.0, 4.0, 3.0), (7.0, 4.0, 4.5), (5.5, 5.0, 3.0), (7.0, 3.5, 5.0))


def moving(folder: Path, *, has_drum: bool, **of_winches: Any) -> Analysis:
    """The crane of the pairs there and back along rows, its winches near its exit points."""
    path = np.column_stack([2.0 * np.arange(len(ROWS)), ROWS])
    np.savetxt(folder / "path.csv", path, "%.15g", ",", header="time_s,x_m,y_m,z_m", comments="")
    study: dict[str, Any] = BASES["crane"] | {"workspace": {"path": "path.csv"}}
    study["selection"] = study["selection"] | {
        "sheave_diameter": 0.3, "rope_life": LIFE,
    }  # fmt: skip
    if has_drum:
        positions = np.array(study["robot"]["anchors"]) - [0.0, 0.0, 1.0]
        winches = {
            "positions": positions.tolist(), "drum_diameter": 0.25, "layers": 1,
            "motor": {"torque": 1e6},
        } | of_winches  # fmt: skip
        study["robot"] = study["robot"] | {"winches": winches}
    return analysed(study, folder)


def borne(tension_N: float, d_mm: float, ratio: float, zone: float) -> float:
    """Feyrer's equation, in scalars."""
    lg = math.log10
    size = 0.52 / ((max(d_mm, 4.0) / 16.0) ** 0.3 - 0.48)
    length = 1.49 / (2.49 - ((zone - 2.5) / 57.5) ** -0.14)
    power = LIFE["b1"] + LIFE["b3"] * lg(ratio)
    return size * length * 10 ** (LIFE["b0"] + power * lg(tension_N / d_mm**2) + 5.5 * lg(ratio))


@pytest.mark.parametrize(("has_drum", "kept"), [(False, 1.0), (True, 1.0), (True, 0.9)])
def test_cycles_and_damage_are_those_of_a_rope_that_is_walked(
    tmp_path: Path, has_drum: bool, kept: float
) -> None:
    losses = {"sheave_efficiency": kept, "sheaves": 3} if kept < 1.0 else {}
    analysis = moving(tmp_path, has_drum=has_drum, **losses)
    path = analysis.path
    assert path is not None
    (case,), (cables,) = path.cases, path.bending
    d_m = path.cases[0].loaded.cable.diameter_m
    EA = float(case.loaded.cable.axial_stiffness_N)
    for k, cable in enumerate(cables):
        assert (cable.on_drum is not None) is has_drum
        zone = cable.bent_m / d_m
        for place in range(0, 1000, 97):
            sheave = drum = damage = 0.0
            before: list[bool] | None = None
            for i, (length, tension) in enumerate(
                zip(case.statics.length_m[:, k], case.tension_N[:, k], strict=True)
            ):
                ends = [length, length]
                if has_drum:
                    ends.append(length + 1.0 / (1.0 + tension / EA))
                at = [bool(cable.places_m[place] < end) for end in ends]
                for end, passed in enumerate(
                    at if before is None else map(bool.__ne__, at, before)
                ):
                    if before is None or not passed:
                        continue
                    mean = 0.5 * (tension + case.tension_N[i - 1, k])
                    if length < case.statics.length_m[i - 1, k]:  # hauled in, pulled at the drum
                        mean = mean / (kept * kept * kept if end == 2 else kept)
                    elif end == 2:
                        mean = mean * kept * kept * kept
                    over = 0.25 + d_m if end == 2 else 0.3
                    damage += 0.5 / borne(mean, 1e3 * d_m, over / d_m, zone)
                    sheave += 0.5 * (end < 2)
                    drum += 0.5 * (end == 2)
                before = at
            assert cable.on_sheave[place] == sheave
            assert cable.on_drum is None or cable.on_drum[place] == drum
            assert cable.damage is not None
            assert cable.damage[place] == pytest.approx(damage, rel=1e-9)
        assert cable.cycles.max() >= 1.0


def test_days_that_are_asked_for_are_a_requirement(tmp_path: Path) -> None:
    analysis = moving(tmp_path, has_drum=True)
    (life,) = (
        requirement for requirement in analysis.requirements if requirement.id == "rope_life"
    )
    path = analysis.path
    assert path is not None
    assert path.life is not None
    assert life.demand == 3000.0
    assert life.capacity == min(cable.runs or 0.0 for cable in path.bending[0])
    assert path.is_steel
    fibre = replace(path, is_steel=False)
    for factor, of_path, state in (
        (0.99, path, State.HOLDS),
        (1.01, path, State.FAILS),
        (0.01, fibre, State.OPEN),
    ):
        asked = replace(path.life, days_min=factor * life.capacity / 30.0)
        (other,) = life_requirements(of_path.bent, asked)
        assert other.state is state
    assert {cable.runs for cable in fibre.bending[0]} == {None}
