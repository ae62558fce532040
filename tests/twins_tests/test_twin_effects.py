"""Each effect on a twin, against what its law says by hand."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from twins.dataset import effect_size, make
from twins.effects import LISTED, UNLISTED, Scene, as_seen, predict
from twins.physics import GRAVITY, solve
from twins.robots import FAST3, HALL6, ROBOTS, YARD3, TwinRobot

from designer.effects.registry import EFFECTS

CONTRACT = {effect.id for effect in EFFECTS} - {"load_step", "pulley_inclination"}
"""Every effect that a diagnosis knows has its twin; a step is one of `twins.troubles`, and what
inclines a pulley needs one."""


def readings(robot: TwinRobot, effect: str | None = None, scene: Scene | None = None, **p: float):
    scene = scene or make(robot, rows=12, seed=1).scene
    return (scene, *predict(robot, {effect: p} if effect else {}, scene))


def test_the_contracts_effects_are_there_and_no_other_under_its_names() -> None:
    assert set(LISTED) == CONTRACT | {"pulley_inclination"}
    assert not set(UNLISTED) & CONTRACT


@pytest.mark.cases_by_default(1)
@pytest.mark.parametrize("robot", ROBOTS.values(), ids=lambda robot: robot.name)
def test_every_plausible_effect_grows_with_its_size(robot) -> None:
    of_bodies = {"centre_of_mass_offset", "attachment_offset", "platform_moment"}
    names = (CONTRACT | set(UNLISTED)) - (of_bodies if robot is not HALL6 else set())
    assert set(robot.sizes) == names
    for effect, (small, large) in robot.sizes.items():
        how = {"rows": 10, "seed": 2, "settled": effect != "clock_offset"}
        found = [
            effect_size(make(robot, [effect], robot.draw(effect, size, 2), **how))
            for size in (small, large)
        ]
        assert 0 < 2 * found[0] < found[1], effect


def test_unknown_effect_is_an_error() -> None:
    with pytest.raises(KeyError, match="moon_phase"):
        make(YARD3, ["moon_phase"], {"phase": 1.0})


def test_softer_cable_is_paid_out_shorter_by_its_stretch() -> None:
    _, length, tension = readings(YARD3)
    _, softer, same = readings(YARD3, "elastic_modulus", scale=0.5)
    assert np.allclose(same, tension, rtol=2e-4)
    assert np.allclose(softer - length, -length * tension / YARD3.stiffness_N, rtol=0.03)


def test_platform_mass_and_linear_mass_add_to_the_load() -> None:
    known = make(YARD3, rows=12, seed=1)
    heavier = make(YARD3, {"platform_mass": {"offset_kg": 9.0}}, rows=12, seed=1)
    soaked = make(YARD3, {"linear_mass": {"scale": 2.0}}, rows=12, seed=1)
    load, cable_m = _vertical(known)
    assert np.allclose(_vertical(heavier)[0] - load, 9.0 * GRAVITY, rtol=2e-3)
    extra = YARD3.linear_mass * cable_m * GRAVITY
    assert np.allclose(_vertical(soaked)[0] - load, extra, rtol=0.02)


def _vertical(dataset) -> tuple[np.ndarray, np.ndarray]:
    """Sum of vertical forces at the exits by straight chords, and total cable length."""
    chord = np.array(dataset.robot.exit_m) - dataset.scene.position_m[:, None]
    unit = chord / np.linalg.norm(chord, axis=-1, keepdims=True)
    mass = dataset.effects.get("linear_mass", {"scale": 1.0})["scale"] * dataset.robot.linear_mass
    # At the upper end the cable is steeper than its chord by half its weight.
    chordal = dataset.clean_tension_N * unit[..., 2]
    across = 1 - unit[..., 2] ** 2
    steeper = 0.5 * mass * GRAVITY * dataset.clean_length_m * across
    return (chordal + steeper).sum(1), dataset.clean_length_m.sum(1)


def test_anchor_offset_moves_one_exit_point() -> None:
    scene, length, _ = readings(YARD3)
    _, moved, _ = readings(YARD3, "anchor_offset", cable=2, x_m=0.01, y_m=0.0, z_m=0.0)
    away = np.array(YARD3.exit_m[1]) - scene.position_m
    expected = 0.01 * away[:, 0] / np.linalg.norm(away, axis=1)
    assert np.allclose((moved - length)[:, 1], expected, atol=2e-5)
    assert np.abs((moved - length)[:, [0, 2]]).max() < 2e-5


def test_tilted_base_is_a_tilted_robot() -> None:
    scene, *_ = readings(FAST3)
    turn = Rotation.from_rotvec([0.01, -0.02, 0])
    upright = FAST3.machine()
    upright = replace(upright, exit_m=turn.apply(upright.exit_m[0])[None])
    position = turn.apply(scene.position_m)
    true = solve(upright, position, np.repeat(np.eye(3)[None], len(position), 0))
    _, length, tension = readings(FAST3, "base_tilt", rx_rad=0.01, ry_rad=-0.02)
    assert np.allclose(length, true.length_m, rtol=1e-11)
    assert np.allclose(tension, true.exit_tension_N, rtol=1e-11)


def test_wind_pushes_the_platform() -> None:
    scene, _, tension = readings(YARD3)
    _, _, pushed = readings(YARD3, "wind_drag", drag_area_m2=2.0)
    chord = np.array(YARD3.exit_m) - scene.position_m[:, None]
    unit = chord / np.linalg.norm(chord, axis=-1, keepdims=True)
    speed = np.linalg.norm(scene.wind_m_per_s, axis=1, keepdims=True)
    drag = 0.5 * 1.25 * 2.0 * speed * scene.wind_m_per_s
    held = np.einsum("rc,rci->ri", pushed - tension, unit)
    assert np.allclose(held, -drag, atol=0.02 * np.abs(drag).max())


def test_a_centre_of_mass_off_the_middle_is_a_moment() -> None:
    scene, _, tension = readings(HALL6)
    _, _, shifted = readings(HALL6, "centre_of_mass_offset", x_m=0.2, y_m=0.0, z_m=0.0)
    body = Rotation.from_rotvec(scene.rotation_vector_rad)
    lever = np.stack([body.apply(point) for point in HALL6.attachment_m], 1)
    chord = np.array(HALL6.exit_m) - scene.position_m[:, None] - lever
    unit = chord / np.linalg.norm(chord, axis=-1, keepdims=True)
    moment = ((shifted - tension)[..., None] * np.cross(lever, unit)).sum(1)
    weight = [0, 0, -HALL6.mass_kg * GRAVITY]
    expected = -np.cross(body.apply([0.2, 0, 0]), weight)
    assert np.allclose(moment, expected, atol=0.5)


def test_winch_readings() -> None:
    scene, length, tension = readings(YARD3)
    warm = scene.temperature_C[:, None] - 20
    _, read, same = readings(YARD3, "thermal_expansion", coefficient_per_K=1e-4)
    assert np.allclose(read * (1 + 1e-4 * warm), length, rtol=1e-13)
    assert np.array_equal(same, tension)
    _, read, _ = readings(YARD3, "creep", strain_per_decade=1e-3, onset_s=100.0)
    grown = 1 + 1e-3 * np.log10(1 + scene.time_s / 100)
    assert np.allclose(read * grown[:, None], length, rtol=1e-13)
    _, read, _ = readings(YARD3, "drum_scale", scale=1.01)
    assert np.allclose(read, 1.01 * length, rtol=1e-13)
    offsets = {"offset_1_m": 0.1, "offset_2_m": -0.2, "offset_3_m": 0.3}
    _, read, _ = readings(YARD3, "length_offset", **offsets)
    assert np.allclose(read - length, [0.1, -0.2, 0.3], atol=1e-13)


def test_drum_layering_counts_turns_of_a_growing_drum() -> None:
    gain = 0.01
    _, length, _ = readings(YARD3)
    _, read, _ = readings(YARD3, "drum_layering", radius_gain_per_m=gain)
    reference = YARD3.reference_length_m
    turns = np.linspace(0, reference - read, 20001)
    # Wind up step by step: each bit of reading brings in (1 + gain × wound) of cable.
    step, wound = np.diff(turns, axis=0)[0], np.zeros_like(read)
    for _ in range(20000):
        wound = wound + step * (1 + gain * (wound + step / 2))
    assert np.allclose(reference - wound, length, atol=1e-6)
    assert np.allclose(read - length, gain * (reference - length) ** 2 / 2, rtol=0.1)


def test_load_cell_readings() -> None:
    _, length, tension = readings(YARD3)
    _, same, read = readings(YARD3, "pulley_friction", coefficient=0.05)
    paid_out = np.diff(length, axis=0) > 0
    assert np.array_equal(same, length)
    assert np.array_equal(read[0], tension[0])
    assert np.allclose(read[1:] / tension[1:], np.where(paid_out, np.exp(-0.05), np.exp(0.05)))
    _, _, read = readings(YARD3, "tension_gain", cable=3, gain=1.1)
    assert np.allclose(read / tension, [1, 1, 1.1])
    _, _, read = readings(YARD3, "tension_bias", offset_1_N=5.0, offset_2_N=-6.0, offset_3_N=7.0)
    assert np.allclose(read - tension, [5, -6, 7])


def test_clock_offset_reads_lengths_of_earlier_and_tensions_of_now() -> None:
    scene = make(YARD3, rows=40, seed=3, settled=False).scene
    step = scene.time_s[1] - scene.time_s[0]
    _, length, tension = readings(YARD3, scene=scene)
    _, read, same = readings(YARD3, "clock_offset", scene=scene, offset_s=step)
    assert np.allclose(read[1:], length[:-1], rtol=1e-12)
    assert np.array_equal(same, tension)
    settled = make(YARD3, ["clock_offset"], {"offset_s": 5.0}, rows=12)
    assert effect_size(settled) == 0


def test_what_is_not_in_the_list() -> None:
    _, length, tension = readings(YARD3)
    _, read, _ = readings(YARD3, "tower_settles", cable=1, depth_m=0.1)
    sunk = readings(YARD3, "anchor_offset", cable=1, x_m=0.0, y_m=0.0, z_m=-0.1)[1]
    assert np.allclose(read[-1], sunk[-1], rtol=1e-12)
    early, late = np.abs(read - length)[[0, -1], 0]
    assert early < 0.3 * late
    _, read, _ = readings(YARD3, "tower_settles", cable=1, depth_m=0.1, relaxation=0.01)
    assert np.allclose(read[-1], sunk[-1], rtol=1e-9)
    _, _, heavy = readings(YARD3, "linear_mass", scale=1.5)
    _, _, drifting = readings(YARD3, "cable_mass_drift", gain=0.5)
    assert np.allclose(drifting[-1], heavy[-1], rtol=1e-12)
    assert np.abs(drifting - tension)[0].max() < 0.3 * np.abs(heavy - tension)[0].max()


def test_effects_of_one_cable_leave_the_others() -> None:
    _, length, tension = readings(YARD3)
    _, softer, _ = readings(YARD3, "cable_modulus", cable=2, scale=0.5)
    stretch = length * tension / YARD3.stiffness_N
    assert np.allclose((softer - length)[:, 1], -stretch[:, 1], rtol=0.03)
    assert np.abs((softer - length)[:, [0, 2]]).max() < 0.01 * stretch.min()
    _, read, _ = readings(YARD3, "winch_scale", cable=3, scale=2.0)
    homed = YARD3.reference_length_m[2]
    assert np.allclose(read - length, (length - homed) * [0, 0, 1], atol=1e-12)
    _, read, _ = readings(YARD3, "winch_zero", cable=1, offset_m=0.2)
    assert np.allclose(read - length, [0.2, 0, 0], atol=1e-12)


def test_a_camera_with_a_frame_of_its_own_sees_the_same_platform() -> None:
    """A robot that is moved with its camera's frame has the readings of the one that stands."""
    frame = {"x_m": 0.3, "y_m": -0.2, "z_m": 0.1, "rx_rad": 0.0, "ry_rad": 0.0, "rz_rad": 0.4}
    scene = make(HALL6, rows=6, seed=3).scene
    seen = as_seen(scene, {"pose_frame": {**frame, "scale": 1.0}})
    turn = Rotation.from_rotvec([0.0, 0.0, 0.4])
    moved = HALL6.machine()
    moved = replace(moved, exit_m=turn.apply(moved.exit_m[0])[None] + [0.3, -0.2, 0.1])
    body = Rotation.from_rotvec(seen.rotation_vector_rad).as_matrix()
    _, length, tension = readings(HALL6, scene=scene)
    true = solve(moved, seen.position_m, body)
    assert np.allclose(true.length_m, length, rtol=1e-10)
    assert np.allclose(true.exit_tension_N, tension, rtol=1e-10)
