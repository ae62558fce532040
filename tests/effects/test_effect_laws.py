"""Each effect on readings and on the machine, against its law written out for a few rows."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from designer.analysis.sensitivity import payload_scaled
from designer.diagnosis.problem import readings_of as foretold
from designer.effects.effect import Effect, Readings, frame_size_m
from designer.effects.registry import SHIPPED
from designer.effects.winches import direction_of, dragged_m
from designer.model.cable import STANDARD_GRAVITY_M_PER_S2, Cable
from designer.model.load_case import LoadCase, Wind, WrenchSet
from designer.model.measurements import Measured
from designer.model.robot import Machine, Platform, Poses, Robot
from designer.statics.inverse import solve_sagging

CABLE = Cable(0.01, 0.4, 5e6, 12e3)
EXIT_POINTS_M = np.array([[0.0, 0.0, 10.0], [20.0, 0.0, 12.0], [8.0, 15.0, 11.0]])
POSITION_M = np.array([[9.0, 5.0, 3.0], [10.0, 6.0, 2.0], [8.0, 4.0, 4.0]])
LENGTH_M = np.array([[12.0, 15.0, 13.0], [13.0, 14.0, 13.0], [11.0, 15.5, 14.0]])
TENSION_N = np.array([[900.0, 700.0, 1100.0], [950.0, 720.0, 1000.0], [870.0, 800.0, 1200.0]])
TIME_S = np.array([0.0, 90.0, 900.0])
TEMPERATURE_C = np.array([20.0, 30.0, 5.0])


@pytest.fixture
def machine() -> Machine:
    return Machine(Robot(EXIT_POINTS_M, Platform(150.0)), CABLE)


@pytest.fixture
def measured() -> Measured:
    return Measured(
        Poses.at(POSITION_M), LENGTH_M, TENSION_N, True, time_s=TIME_S, temperature_C=TEMPERATURE_C
    )


def effect_of(machine: Machine, name: str, cable: int = 1) -> Effect:
    variants = SHIPPED.by_id[name].on(machine)
    return variants[cable - 1] if len(variants) > 1 else variants[0]


def with_values(effect: Effect, **values: float) -> Mapping[str, float]:
    assert set(values) <= set(effect.neutral)
    return effect.neutral | values


def readings_of(
    machine: Machine, measured: Measured, name: str, cable: int = 1, **values: float
) -> Readings:
    effect = effect_of(machine, name, cable)
    assert effect.on_readings is not None
    return effect.on_readings(
        Readings(LENGTH_M, TENSION_N), with_values(effect, **values), measured
    )


def machine_with(machine: Machine, name: str, cable: int = 1, **values: float) -> Machine:
    effect = effect_of(machine, name, cable)
    assert effect.on_machine is not None
    return effect.on_machine(machine, with_values(effect, **values))


def test_pulley_friction_lowers_what_the_winch_feels_while_it_pays_out(machine, measured):
    tension = readings_of(machine, measured, "pulley_friction", coefficient=0.1).tension_N
    paying_out = np.array([[0, 0, 0], [1, -1, 0], [-1, 1, 1]])
    assert tension == pytest.approx(TENSION_N * np.exp(-0.1 * paying_out), rel=1e-12)


def test_creep_takes_unstrained_length_from_the_winch_by_the_decade(machine, measured):
    length = readings_of(machine, measured, "creep", strain_per_decade=0.01, onset_s=10.0).length_m
    decades = [[0.0], [1.0], [math.log10(91.0)]]
    assert length == pytest.approx(LENGTH_M / (1.0 + 0.01 * np.array(decades)), rel=1e-12)


def test_thermal_expansion_counts_from_20_degrees(machine, measured):
    length = readings_of(machine, measured, "thermal_expansion", coefficient_per_K=1e-3).length_m
    growth = [[1.0], [1.01], [0.985]]
    assert length == pytest.approx(LENGTH_M / np.array(growth), rel=1e-12)


def test_drum_layering_integrates_what_a_turn_pays_out(machine, measured):
    gain, reference_m = 0.01, 13.0
    values = {f"reference_{k}_m": reference_m for k in (1, 2, 3)}
    counted = readings_of(
        machine, measured, "drum_layering", radius_gain_per_m=gain, **values
    ).length_m
    # Counted length from the reference on, by quadrature of its inverse rate.
    for true_m, shown_m in zip(LENGTH_M.flat, counted.flat, strict=True):
        lengths = np.linspace(reference_m, true_m, 2001)
        rate = 1.0 / (1.0 + gain * (reference_m - lengths))
        assert shown_m == pytest.approx(reference_m + np.trapezoid(rate, lengths), abs=1e-8)


@pytest.mark.parametrize(
    ("name", "values", "length", "tension"),
    [
        ("drum_scale", {"scale": 1.01}, LENGTH_M * 1.01, TENSION_N),
        ("length_offset", {"offset_2_m": 0.3}, LENGTH_M + np.array([0.0, 0.3, 0.0]), TENSION_N),
        (
            "winch_expansion",
            {"coefficient_per_K": 1e-3},
            LENGTH_M * np.array([[1.0], [1.01], [0.985]]),
            TENSION_N,
        ),
        ("tension_scale", {"gain": 1.1}, LENGTH_M, 1.1 * TENSION_N),
        ("tension_bias", {"offset_3_N": -5.0}, LENGTH_M, TENSION_N + np.array([0.0, 0.0, -5.0])),
        ("tension_length", {"compliance_m_per_N": 1e-4}, LENGTH_M + 1e-4 * TENSION_N, TENSION_N),
    ],
)
def test_sensors_and_winches(machine, measured, name, values, length, tension):
    readings = readings_of(machine, measured, name, **values)
    assert readings.length_m == pytest.approx(length, rel=1e-12)
    assert readings.tension_N == pytest.approx(tension, rel=1e-12)


def test_a_wrong_gain_is_that_of_its_own_cable(machine, measured):
    tension = readings_of(machine, measured, "tension_gain", cable=2, gain=1.1).tension_N
    assert tension == pytest.approx(TENSION_N * [1.0, 1.1, 1.0], rel=1e-12)


def parabola(row: int, cable: int) -> tuple[float, float]:
    """Return the level force and the tension half way of a parabola, by bisection on the former.

    The upward force at the exit point is H D / X + w c / 2 with the chord c, its level part X and
    its drop D; with H it makes the tension there.
    """
    exit_point, weight = (
        EXIT_POINTS_M[cable],
        CABLE.linear_density_kg_per_m * STANDARD_GRAVITY_M_PER_S2,
    )
    chord = POSITION_M[row] - exit_point
    level_m, drop_m = math.hypot(chord[0], chord[1]), -chord[2]
    low, high = 0.0, TENSION_N[row, cable]
    for _ in range(200):
        force = 0.5 * (low + high)
        upward = force * drop_m / level_m + 0.5 * weight * np.linalg.norm(chord)
        low, high = (
            (force, high) if math.hypot(force, upward) < TENSION_N[row, cable] else (low, force)
        )
    return force, TENSION_N[row, cable] - 0.5 * weight * drop_m


def test_stiffening_adds_strain_at_the_tension_half_way(machine, measured):
    values = {"toe_strain": 0.004, "toe_tension_N": 500.0}
    length = readings_of(machine, measured, "stiffening", **values).length_m
    for row, cable in np.ndindex(3, 3):
        _, mean_N = parabola(row, cable)
        stretch = 1.0 + mean_N / CABLE.axial_stiffness_N
        strain = 0.004 * (1.0 - math.exp(-mean_N / 500.0))
        expected = LENGTH_M[row, cable] * stretch / (stretch + strain)
        assert length[row, cable] == pytest.approx(expected, rel=1e-12)


def test_a_mast_gives_way_along_the_level_pull(machine, measured):
    compliance = 1e-6
    readings = readings_of(machine, measured, "mast_compliance", compliance_m_per_N=compliance)
    for row, cable in np.ndindex(3, 3):
        force_N, _ = parabola(row, cable)
        shorter = compliance * force_N * force_N / TENSION_N[row, cable]
        assert readings.length_m[row, cable] == pytest.approx(
            LENGTH_M[row, cable] - shorter, rel=1e-9
        )
    # Straight cables to the moved exit points, with the tensions found, pull as before.
    for row in range(3):
        chords = EXIT_POINTS_M - POSITION_M[row]
        directions = chords / np.linalg.norm(chords, axis=1)[:, None]
        levels = -chords * [1.0, 1.0, 0.0]
        levels /= np.linalg.norm(levels, axis=1)[:, None]
        moves = np.array([compliance * parabola(row, cable)[0] for cable in range(3)])
        moved = chords + moves[:, None] * levels
        turned = moved / np.linalg.norm(moved, axis=1)[:, None]
        change = turned.T @ readings.tension_N[row] - directions.T @ TENSION_N[row]
        assert np.abs(change).max() < 1e-6 * TENSION_N.max()


def test_effects_on_the_machine(machine):
    robot = machine.robot
    moved = machine_with(machine, "anchor_offset", cable=2, x_m=0.1, y_m=-0.2, z_m=0.3).robot
    shift = [[0, 0, 0], [0.1, -0.2, 0.3], [0, 0, 0]]
    assert moved.exit_points_m == pytest.approx(robot.exit_points_m + shift, rel=1e-15)
    assert machine_with(machine, "elastic_modulus", scale=0.9).cable.axial_stiffness_N == 4.5e6
    heavier = machine_with(machine, "linear_mass", scale=1.25).cable
    assert heavier.linear_density_kg_per_m == pytest.approx(0.5, rel=1e-15)
    loaded = machine_with(machine, "platform_mass", offset_kg=-20.0).robot.platform
    assert (loaded.mass_kg, loaded.mass_offset_kg) == (130.0, -20.0)
    assert machine_with(machine, "pulley_radius", radius_m=0.2).robot.pulley_radius_m == 0.2
    assert machine_with(machine, "wind_drag", drag_area_m2=2.0).drag_area_m2 == 2.0
    tilted = machine_with(machine, "base_tilt", rx_rad=0.01, ry_rad=0.02).robot
    assert tilted.tilt_rad == pytest.approx([0.01, 0.02])


def test_the_centre_of_mass_moves_in_the_platforms_frame(six_cable_robot):
    machine = Machine(six_cable_robot, CABLE)
    moved = machine_with(machine, "centre_of_mass_offset", x_m=0.1, y_m=0.2, z_m=-0.3).robot
    expected = six_cable_robot.platform.centre_of_mass_m + np.array([0.1, 0.2, -0.3])
    assert moved.platform.centre_of_mass_m == pytest.approx(expected, rel=1e-15)


def test_sizes_follow_the_machine(machine):
    """A machine twice as large and heavy has sizes of parameters in proportion."""
    robot = Robot(2.0 * EXIT_POINTS_M, Platform(300.0))
    twice = replace(machine, robot=robot)
    powers = {
        "anchor_offset": 1.0,  # with the frame
        "mast_compliance": 0.0,  # frame over weight
        "platform_mass": 1.0,
        "load_step": 1.0,
        "tension_bias": 1.0,
        "wind_drag": 1.0,
        "tension_length": 1.0,
    }
    for name, power in powers.items():
        small, large = (effect_of(each, name).parameters[0].size_here for each in (machine, twice))
        assert large.typical == pytest.approx(2.0**power * small.typical, rel=1e-12), name
        assert small.plausible[1] <= small.bounds[1], name
        assert small.typical < max(map(abs, small.plausible)), name


@pytest.mark.parametrize(
    ("name", "parameter", "believed", "doubted"),
    [
        # The sheave of a winch on a desk, and one that a tall man could hide behind.
        ("pulley_radius", "radius_m", (0.008, 0.5), (0.003, 0.9)),
        ("centre_of_mass_offset", "z_m", (-0.4, 0.4), (-0.7, 0.7)),
        ("base_tilt", "rx_rad", (-0.08, 0.08), (-0.15, 0.15)),
        ("length_offset", "offset_1_m", (-0.8, 0.8), (-1.5, 1.5)),
        ("drum_scale", "scale", (0.96, 1.04), (0.9, 1.1)),
        ("elastic_modulus", "scale", (0.3, 4.0), (0.15, 7.0)),
        # A rope soaked or iced over weighs twice as much; one that has lost a third is another.
        ("linear_mass", "scale", (0.85, 2.0), (0.6, 4.0)),
        ("clock_offset", "offset_s", (-4.0, 4.0), (-8.0, 8.0)),
        ("pulley_friction", "coefficient", (0.01, 0.25), (0.45,)),
        ("tension_gain", "gain", (0.8, 1.3), (0.5, 2.0)),
        ("tension_scale", "gain", (0.8, 1.3), (0.5, 2.0)),
        # Aramid shrinks as it warms, polyamide grows by a tenth of a permille a degree.
        ("thermal_expansion", "coefficient_per_K", (-6e-6, 1.2e-5, 1e-4), (-8e-5, 3e-4)),
    ],
)
def test_values_that_an_engineer_believes_or_doubts(
    six_cable_robot,
    name: str,
    parameter: str,
    believed: tuple[float, ...],
    doubted: tuple[float, ...],
) -> None:
    effect = effect_of(Machine(six_cable_robot, CABLE), name)
    (tried,) = (p for p in effect.parameters if p.name == parameter)
    assert all(map(tried.is_plausible, believed))
    assert not any(map(tried.is_plausible, doubted))


def test_a_turn_pays_out_cable_at_the_largest_gain_of_a_drum(machine):
    """A fit tries no gain at which a turn would pay out nothing within the frame."""
    (gain,) = (p for p in effect_of(machine, "drum_layering").parameters if "gain" in p.name)
    assert 0.0 < gain.bounds[1] * frame_size_m(machine) < 1.0


@pytest.mark.parametrize(
    ("size_m", "gain_per_m", "believed"),
    [(3.0, 0.04, True), (3.0, 0.1, False), (50.0, 0.015, True), (50.0, 0.025, False)],
    ids=["line on a spool", "spool too small", "winch", "drum too small"],
)
def test_a_small_machine_may_have_small_spools(machine, size_m, gain_per_m, believed):
    """A 1 mm line on a spool of 40 mm, ten turns wide: 4 % of its radius with each metre."""
    exit_points_m = machine.robot.exit_points_m * size_m / frame_size_m(machine)
    robot = replace(machine.robot, exit_points_m=exit_points_m)
    effect = effect_of(Machine(robot, CABLE), "drum_layering")
    (gain,) = (p for p in effect.parameters if "gain" in p.name)
    assert gain.is_plausible(gain_per_m) is believed


@pytest.mark.parametrize(
    ("size_m", "radius_m", "believed"),
    [(4.5, 0.0036, True), (4.5, 0.001, False), (50.0, 0.006, True), (50.0, 0.0036, False)],
)
def test_a_small_machine_may_have_small_pulleys(machine, size_m, radius_m, believed):
    exit_points_m = machine.robot.exit_points_m * size_m / frame_size_m(machine)
    robot = replace(machine.robot, exit_points_m=exit_points_m)
    (radius,) = effect_of(Machine(robot, CABLE), "pulley_radius").parameters
    assert radius.is_plausible(radius_m) is believed


def poses_with(machine: Machine, poses: Poses, name: str, **values: float) -> Poses:
    effect = effect_of(machine, name)
    assert effect.on_poses is not None
    return effect.on_poses(poses, with_values(effect, **values))


def test_poses_are_taken_back_to_the_robots_frame(machine, six_cable_robot):
    """What a camera sees that is shifted, turned and scaled, told by points that it looks at."""
    seen = Poses.at(POSITION_M)
    back = poses_with(machine, seen, "pose_shift", x_m=0.1, z_m=-0.2)
    assert back.position_m == pytest.approx(POSITION_M - [0.1, 0.0, -0.2], rel=1e-15)
    back = poses_with(machine, seen, "pose_scale", scale=1.01)
    assert back.position_m == pytest.approx(POSITION_M / 1.01, rel=1e-15)
    robot = Machine(six_cable_robot, CABLE)
    middle = six_cable_robot.exit_points_m.mean(axis=0)
    quarter = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    true = Poses.at(np.column_stack([POSITION_M, np.full((3, 3), 0.1)]))
    seen_m = middle + 1.1 * (true.position_m - middle) @ quarter.T + [0.1, 0.2, 0.3]
    seen = Poses(seen_m, quarter @ true.rotation)
    frame = {"x_m": 0.1, "y_m": 0.2, "z_m": 0.3, "rz_rad": math.pi / 2, "scale": 1.1}
    back = poses_with(robot, seen, "pose_frame", **frame)
    assert back.position_m == pytest.approx(true.position_m, rel=1e-12)
    assert back.rotation == pytest.approx(true.rotation, abs=1e-12)


def test_a_marker_beside_the_origin_is_taken_back_to_it(machine, six_cable_robot):
    """Six numbers where orientation is measured; of a point mass three, along fixed axes."""
    true = Poses.at(np.column_stack([POSITION_M, np.full((3, 3), 0.2)]))
    askew = Rotation.from_rotvec([0.01, -0.02, 0.03]).as_matrix()
    marker_m = np.array([0.1, -0.2, 0.3])
    seen = Poses(true.position_m + true.rotation @ askew @ marker_m, true.rotation @ askew)
    values = {"x_m": 0.1, "y_m": -0.2, "z_m": 0.3}
    turn = {"rx_rad": 0.01, "ry_rad": -0.02, "rz_rad": 0.03}
    back = poses_with(Machine(six_cable_robot, CABLE), seen, "tool_point", **values, **turn)
    assert back.rotation == pytest.approx(true.rotation, abs=1e-12)
    offset = true.rotation @ (askew @ marker_m - marker_m)
    assert back.position_m == pytest.approx(true.position_m + offset, abs=1e-12)
    assert [p.name for p in effect_of(machine, "tool_point").parameters] == [*values]
    back = poses_with(machine, Poses.at(POSITION_M), "tool_point", **values)
    assert back.position_m == pytest.approx(POSITION_M - marker_m, rel=1e-15)


def test_heights_off_by_the_square_of_the_distance_are_taken_back(machine):
    tracker_m = np.array([-30.0, 5.0, 1.5])
    away_m = np.linalg.norm(POSITION_M - tracker_m, axis=1)
    seen_m = POSITION_M + np.outer(2e-4 * away_m**2, [0.0, 0.0, 1.0])
    place = {"x_m": -30.0, "y_m": 5.0, "z_m": 1.5}
    back = poses_with(machine, Poses.at(seen_m), "pose_distortion", gain_per_m=2e-4, **place)
    assert back.position_m == pytest.approx(POSITION_M, abs=1e-9)


def test_a_constant_force_is_one_that_no_load_case_replaces(machine):
    pushed = machine_with(machine, "platform_force", x_N=30.0, z_N=-12.0).robot
    assert machine.robot.loads_N()[0, :3] - pushed.loads_N()[0, :3] == pytest.approx([30, 0, -12])
    case = LoadCase("own", wrench_N=np.array([0.0, 100.0, 0.0, 0.0, 0.0, 0.0]))
    loaded = case.under(pushed, CABLE).robot
    assert case.under(machine.robot, CABLE).robot.pull_N - loaded.pull_N == pytest.approx(
        [30, 0, -12, 0, 0, 0]
    )
    flat = replace(machine.robot, exit_points_m=EXIT_POINTS_M * [1.0, 0.0, 1.0], is_planar=True)
    names = [p.name for p in effect_of(replace(machine, robot=flat), "platform_force").parameters]
    assert names == ["x_N", "z_N"]


def test_a_constant_moment_stays_beside_the_wrench_of_a_load_case(machine, six_cable_robot):
    body = Machine(six_cable_robot, CABLE)
    turned = machine_with(body, "platform_moment", x_N_m=4.0, z_N_m=-7.0).robot
    assert turned.pull_N - six_cable_robot.pull_N == pytest.approx([0, 0, 0, -4, 0, 7])
    several = WrenchSet(np.array([[0.0, 100.0, 0.0, 1.0, 0.0, 0.0]]))
    own = several.wrenches_N[0]
    for case in (LoadCase("own", wrench_N=own), LoadCase("set", wrench_set=several)):
        (loaded,) = case.on(turned, CABLE)
        assert loaded.robot.platform.wrench_N == pytest.approx([0, 100, 0, 5, 0, -7])
        # Twice the payload is twice all that acts, the moment counted once.
        twice = payload_scaled(loaded, 2.0)
        (twice,) = twice.case.on(*twice.bare)
        assert twice.robot.platform.wrench_N == pytest.approx([0, 200, 0, 10, 0, -14])
    assert not any(effect.id == "platform_moment" for effect in SHIPPED.of(machine))
    flat = machine.robot.exit_points_m * [1.0, 0.0, 1.0]
    planar = replace(six_cable_robot, exit_points_m=np.tile(flat, (2, 1)), is_planar=True)
    (about,) = effect_of(replace(body, robot=planar), "platform_moment").parameters
    assert about.name == "y_N_m"


def test_wind_that_is_measured_pushes_as_that_of_a_load_case_does(machine, measured):
    """One density of air."""
    blown = replace(measured, wind_m_per_s=np.tile([20.0, 0.0, 0.0], (3, 1)))
    found = foretold(machine_with(machine, "wind_drag", drag_area_m2=0.6), blown.poses, blown)
    platform = replace(machine.robot.platform, drag_area_m2=0.6)
    case = LoadCase("wind", wind=Wind(20.0, 0.0))
    loaded = case.under(replace(machine.robot, platform=platform), CABLE, np.array([1.0, 0, 0]))
    expected = solve_sagging(loaded.robot, blown.poses, CABLE)
    assert found.tension_N == pytest.approx(expected.exit_tension_N, rel=1e-9)


@pytest.mark.parametrize(
    ("density", "believed", "doubted"),
    [
        (7800.0, (1.2e-5, 4e-5), (-2.3e-5, 1e-4)),
        (4600.0, (1.2e-5,), (-1e-6,)),
        (980.0, (-1.2e-5, 1e-4), (-8e-5,)),
        (math.nan, (-1.2e-5, 1e-4), (-8e-5,)),
    ],
)
def test_how_much_a_rope_may_grow_is_told_by_its_material(machine, density, believed, doubted):
    (growth,) = effect_of(
        replace(machine, rope_density_kg_per_m3=density), "thermal_expansion"
    ).parameters
    assert all(map(growth.is_plausible, believed))
    assert not any(map(growth.is_plausible, doubted))


def test_a_planar_robot_is_shifted_in_its_plane(machine):
    """Across the plane nothing is told: no number where an axis is across, none of it elsewhere."""
    flat = replace(machine.robot, exit_points_m=EXIT_POINTS_M * [1.0, 0.0, 1.0], is_planar=True)
    names = [p.name for p in effect_of(replace(machine, robot=flat), "pose_shift").parameters]
    assert names == ["x_m", "z_m"]
    slanting = EXIT_POINTS_M @ [[1.0, 1.0, 0.0], [0.0, 0.0, 0.0], [0.0, 0.0, 1.0]]
    slanting_machine = replace(machine, robot=replace(flat, exit_points_m=slanting))
    moved = poses_with(slanting_machine, Poses.at(np.zeros((1, 3))), "pose_shift", x_m=0.2)
    assert moved.position_m == pytest.approx(np.array([[-0.1, -0.1, 0.0]]), abs=1e-12)
    assert not SHIPPED.by_id["pose_frame"].on(slanting_machine)
    scaled = poses_with(slanting_machine, Poses.at([[2.0, 0.0, 4.0]]), "pose_scale", scale=2.0)
    assert scaled.position_m == pytest.approx(np.array([[1.5, -0.5, 2.0]]), abs=1e-12)


def test_attachment_offset_is_in_the_platforms_frame(machine, six_cable_robot):
    body = Machine(six_cable_robot, CABLE)
    moved = machine_with(body, "attachment_offset", 3, x_m=0.01, y_m=0.02, z_m=-0.03)
    change = moved.robot.attachments_m - six_cable_robot.attachments_m
    expected = np.zeros((6, 3))
    expected[2] = [0.01, 0.02, -0.03]
    assert change == pytest.approx(expected, abs=1e-15)
    assert not SHIPPED.by_id["attachment_offset"].on(machine)


def test_one_cable_differs_from_the_others(machine, measured):
    softer = machine_with(machine, "cable_modulus", 2, scale=0.5)
    heavier = machine_with(softer, "cable_mass", 3, scale=2.0)
    assert heavier.cables.axial_stiffness_N == pytest.approx([5e6, 2.5e6, 5e6])
    assert heavier.cables.linear_density_kg_per_m == pytest.approx([0.4, 0.4, 0.8])
    assert machine.cables == CABLE
    grown = readings_of(
        machine, measured, "cable_creep", 2, strain_per_decade=1e-3, onset_s=100.0
    ).length_m
    decades = np.log10(1.0 + TIME_S / 100.0)
    assert grown[:, 1] == pytest.approx(LENGTH_M[:, 1] / (1.0 + 1e-3 * decades), rel=1e-14)
    assert grown[:, [0, 2]] == pytest.approx(LENGTH_M[:, [0, 2]], rel=1e-15)


def test_one_winch_has_a_scale_and_a_zero_of_its_own(machine, measured):
    read = readings_of(machine, measured, "winch_scale", 3, scale=2.0, offset_m=-13.0).length_m
    assert read[:, 2] == pytest.approx(2.0 * LENGTH_M[:, 2] - 13.0, rel=1e-14)
    read = readings_of(machine, measured, "winch_zero", 1, offset_m=0.3).length_m
    assert read - LENGTH_M == pytest.approx(np.outer([1, 1, 1], [0.3, 0, 0]), abs=1e-14)
    # Beside offsets of all winches, they are no numbers of their own.
    (scale,) = effect_of(machine, "winch_scale").beside({"length_offset"}).parameters
    assert scale.name == "scale"
    assert not effect_of(machine, "winch_zero").beside({"length_offset"}).parameters


def test_a_larger_pulley_of_one_cable_is_that_of_all(machine, measured):
    """On that cable, to what the pulleys of the others do to its tension."""
    of_all = machine_with(machine, "pulley_radius", radius_m=0.05)
    both = readings_with(of_all, measured).length_m
    one = readings_of(machine, measured, "cable_pulley_radius", 2, radius_m=0.05).length_m
    straight = readings_with(machine, measured).length_m
    assert (one - LENGTH_M)[:, 1] == pytest.approx((both - straight)[:, 1], rel=0.01)
    assert (one - LENGTH_M)[:, [0, 2]] == pytest.approx(np.zeros((3, 2)), abs=1e-15)


def test_pulleys_turn_the_pulls_of_single_cables_as_those_of_all(machine, measured):
    straight = readings_with(machine, measured)
    of_all = readings_with(machine_with(machine, "pulley_radius", radius_m=0.05), measured)
    effects = [effect_of(machine, "cable_pulley_radius", cable) for cable in (1, 2, 3)]
    shown = [e.on_readings(straight, with_values(e, radius_m=0.05), measured) for e in effects]
    added_N = sum(one.tension_N - straight.tension_N for one in shown)
    assert added_N == pytest.approx(of_all.tension_N - straight.tension_N, rel=0.03, abs=0.05)
    assert np.abs(added_N).max() > 1.0


@pytest.mark.parametrize(
    ("name", "values"),
    [
        ("pulley_inclination", {"rx_rad": 0.15, "ry_rad": -0.1}),
        ("cable_pulley_radius", {"radius_m": 0.1}),
    ],
)
def test_tensions_over_a_changed_pulley_do_the_work_of_the_lengths(machine, measured, name, values):
    """A cable pulls along the slope of its length in the position: T · dL is the weight's work."""
    with_pulleys = machine_with(machine, "pulley_radius", radius_m=0.2)
    with_pulleys = replace(with_pulleys, cable=Cable(0.01, 1e-4, 1e9, 12e3))  # straight
    effect = effect_of(with_pulleys, name, cable=2)

    def shown(shift_m: np.ndarray) -> tuple[Readings, Readings]:
        moved = replace(measured, poses=Poses.at(POSITION_M + shift_m))
        before = readings_with(with_pulleys, moved)
        return before, effect.on_readings(before, with_values(effect, **values), moved)

    steps_m = 1e-4 * np.eye(3)
    slopes = np.subtract(
        [[readings.length_m for readings in shown(step)] for step in steps_m],
        [[readings.length_m for readings in shown(-step)] for step in steps_m],
    )
    weight = np.array([0.0, 0.0, -150.0 * STANDARD_GRAVITY_M_PER_S2])
    pulls = np.moveaxis(slopes / 2e-4, 0, -2)  # (before and after, row, axis, cable)
    loads = np.broadcast_to(weight[:, None], (2, 3, 3, 1))
    before_N, after_N = np.linalg.solve(pulls, loads)[..., 0]
    change_N = np.subtract(shown(np.zeros(3))[1].tension_N, shown(np.zeros(3))[0].tension_N)
    assert np.abs(change_N).max() > 1.0
    assert change_N == pytest.approx(after_N - before_N, rel=5e-3, abs=5e-3)


def readings_with(machine: Machine, measured: Measured) -> Readings:
    return foretold(machine, measured.poses)


def test_an_eccentric_drum_counts_what_its_lever_arm_makes_of_a_turn(machine, measured):
    eccentricity_m, round_m, phase = 0.004, 0.6, 0.7
    values = {"amplitude_m": eccentricity_m, "circumference_m": round_m, "phase_rad": phase}
    counted = readings_of(machine, measured, "drum_eccentricity", cable=2, **values).length_m
    assert counted[:, [0, 2]] == pytest.approx(LENGTH_M[:, [0, 2]], abs=0.0)
    # Lever arm R - e cos of the turn, by quadrature from the length counted as it is.
    at = np.linspace(counted[0, 1], counted[1, 1], 20001)
    arm = 1.0 - 2 * np.pi / round_m * eccentricity_m * np.cos(2 * np.pi * at / round_m + phase)
    assert np.trapezoid(arm, at) == pytest.approx(LENGTH_M[1, 1] - LENGTH_M[0, 1], abs=1e-7)


def test_backlash_leads_or_is_dragged_by_half_the_play(machine, measured):
    plays = {"play_1_m": 0.02, "play_2_m": -0.02, "play_3_m": 0.02}
    shown = readings_of(machine, measured, "backlash", **plays).length_m
    # Cable 3 first stands still: it has not moved yet.
    ahead = 0.01 * np.array([[0, 0, 0], [1, 1, 0], [-1, -1, 1]])
    assert shown - LENGTH_M == pytest.approx(ahead, abs=1e-12)


def test_a_dragged_count_stays_where_it_is_within_the_play():
    length = np.array([[1.0], [1.2], [1.15], [1.11], [np.nan], [1.05], [1.3]])
    shown = dragged_m(length, np.array([0.1]))
    expected = np.array([[1.0], [1.15], [1.15], [1.15], [np.nan], [1.1], [1.25]])
    assert shown == pytest.approx(expected, abs=1e-12, nan_ok=True)
    out = np.array([[0.0], [1.0], [-1.0], [-1.0], [-1.0], [-1.0], [1.0]])
    assert direction_of(length) == pytest.approx(out)


def test_tension_hysteresis_is_half_the_width_either_way(machine, measured):
    widths = {"width_1_N": 30.0, "width_2_N": 10.0, "width_3_N": 20.0}
    tension = readings_of(machine, measured, "tension_hysteresis", **widths).tension_N
    less = np.array([[0, 0, 0], [15, -5, 0], [-15, 5, 10]])
    assert TENSION_N - tension == pytest.approx(less, abs=1e-9)


def test_an_encoder_on_the_rope_counts_the_strain_of_what_runs_past(machine, measured):
    length = readings_of(machine, measured, "encoder_on_rope", share=1.0, offset_2_m=0.1).length_m
    more = (length - LENGTH_M)[:, 1] - 0.1
    first = -1.0 * 710.0 / CABLE.axial_stiffness_N
    assert more == pytest.approx([0.0, first, first + 1.5 * 760.0 / CABLE.axial_stiffness_N])


def test_load_cells_at_the_platform_read_the_lower_end_of_a_catenary(machine, measured):
    """Both ends of each cable, as the equilibrium of the robot has them."""
    statics = solve_sagging(machine.robot, measured.poses, machine.cables)
    effect = effect_of(machine, "cell_at_platform")
    assert effect.on_readings is not None
    winch = Readings(statics.length_m, statics.exit_tension_N)
    lower = effect.on_readings(winch, {"share": 1.0}, measured).tension_N
    assert lower == pytest.approx(statics.platform_tension_N, rel=1e-9)
    assert (statics.exit_tension_N - lower > 10.0).all()


def test_an_inclined_pulley_is_an_upright_one_in_a_tilted_room(machine, measured):
    """The length of a taut string round a fine polygon, in space."""
    radius_m, tilt = 0.2, np.array([0.15, -0.1, 0.0])
    with_pulleys = machine_with(machine, "pulley_radius", radius_m=radius_m)
    effect = effect_of(with_pulleys, "pulley_inclination", cable=2)
    assert effect.on_readings is not None
    values = {"rx_rad": tilt[0], "ry_rad": tilt[1]}
    read = effect.on_readings(Readings(LENGTH_M, TENSION_N), values, measured).length_m
    assert read[:, [0, 2]] == pytest.approx(LENGTH_M[:, [0, 2]], abs=0.0)

    def string_m(axis: np.ndarray, to_m: np.ndarray) -> float:
        level = to_m - (to_m @ axis) * axis
        out = level / np.linalg.norm(level)
        turns = np.linspace(0.0, np.pi, 200_001)
        rim = radius_m * (out - np.outer(np.cos(turns), out) + np.outer(np.sin(turns), axis))
        # A cable that leaves anywhere else than at its tangent point cuts or leaves the rim: the
        # length over the rim to a point and on in a straight line has its maximum slope there.
        leaves = np.einsum("ni,ni->n", np.gradient(rim, turns, axis=0), to_m - rim)
        across = np.linalg.norm(to_m - rim, axis=1) * radius_m
        at = int(np.argmax(leaves / across))
        return radius_m * turns[at] + float(np.linalg.norm(to_m - rim[at]))

    tilted = Rotation.from_rotvec(tilt).apply([0.0, 0.0, 1.0])
    for row in range(3):
        to_m = POSITION_M[row] - EXIT_POINTS_M[1]
        change = string_m(tilted, to_m) - string_m(np.array([0.0, 0.0, 1.0]), to_m)
        assert abs(change) > 1e-3
        assert read[row, 1] - LENGTH_M[row, 1] == pytest.approx(change, abs=1e-6)


def test_an_inclined_pulley_of_no_size_changes_nothing(machine, measured):
    read = readings_of(machine, measured, "pulley_inclination", cable=1, rx_rad=0.2)
    assert read.length_m == pytest.approx(LENGTH_M, abs=1e-12)
    assert read.tension_N == pytest.approx(TENSION_N, abs=1e-9)
