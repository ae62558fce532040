"""Poses that no taut cables hold: bodies that enclose what a cable does, wrenches that prove it."""

from __future__ import annotations

import sys
from dataclasses import replace
from pathlib import Path

import numba
import numpy as np
import pytest
from redundant_robots import FOUR, SEVEN, anywhere, four_poses, one, seven_poses, steel
from sample_robots import COGIRO
from twins.certificates import figures_of, refused
from twins.thinnest import least_utilisation, thinnest

from designer.arrays import frozen_array
from designer.kernel.calling import plain
from designer.kernel.feasible import (
    ABOVE,
    BELOW,
    REST,
    SLOPE,
    _enclose,
    _hang,
    new_parts,
    set_ranges,
)
from designer.kernel.pose import asked, limit_sag, new_pose, place
from designer.model.robot import Platform, Poses, Robot
from designer.model.verdict import Verdict
from designer.physics import catenary
from designer.proof.enclosure.cable import enclose
from designer.sizing.newton import size_poses
from designer.statics.geometry import cable_geometry, upright_exit_points_m
from designer.statics.inverse import solve_sagging
from designer.statics.pulleys import straight_run
from designer.statics.task import situation_at

sys.path.insert(0, str(Path(__file__).parents[1] / "benchmarks"))

from impossible import IMPOSSIBLE, OPEN, compare, given_cable, random_case, varied


@numba.njit(error_model="numpy")
def _bodies(situation, figures, inverse_weight, lines, ranges):
    pose = new_pose(situation, figures)
    parts, _ = new_parts(situation.rows.size, situation.attachments.shape[0])
    for at in range(lines.shape[0]):
        place(pose, situation, figures, at)
        limit_sag(pose)
        set_ranges(pose, parts, asked(pose, inverse_weight), False)
        for i in range(lines.shape[2]):
            low, high = parts.ranges[0, 0, i], parts.ranges[0, 1, i]
            # Parts of the range as well, down to a thousandth of it.
            share = (at % 4) / 3.0
            high = low * (high / low) ** (1e-3**share)
            _enclose(pose, parts, parts.lines[0], i, low, high)
            ranges[at, 0, i], ranges[at, 1, i] = low, high
        lines[at] = parts.lines[0]


@numba.njit(error_model="numpy")
def _lift(p, X2, D, kappa):
    return enclose((p, p), (X2, X2), (D, D), kappa)[5]


@pytest.mark.slow
@pytest.mark.parametrize("diameter_m", [0.0, 0.004, 0.03])
def test_bodies_enclose_what_the_cable_does(diameter_m: float) -> None:
    """At a thousand pulls of each range, by interval arithmetic; of a family and given cables."""
    family = steel(3.0)
    cable = family.cable(diameter_m) if diameter_m else family
    for robot, poses in ((COGIRO, anywhere(40, 3)), (replace(FOUR, sag_max=0.5), four_poses(40))):
        figures, inverse = figures_of(robot, cable)
        n, count = robot.n_cables, len(poses.position_m)
        lines, ranges = np.zeros((count, 6, n)), np.zeros((count, 2, n))
        _bodies(situation_at(robot, poses), figures, inverse, lines, ranges)
        geometry = cable_geometry(robot, poses)
        for k in range(count):
            for i in range(n):
                X2, D = geometry.horizontal_distance_m[k, i] ** 2, geometry.drop_m[k, i]
                pulls = np.geomspace(ranges[k, 0, i], ranges[k, 1, i], 1000)
                v = np.array([_lift(p, X2, D, figures.kappa[0, 0]) for p in pulls])
                beside = v - (lines[k, REST, i] + lines[k, SLOPE, i] * pulls)[:, None]
                rounding = 1e-12 * np.abs(v).max()
                assert beside[:, 0].min() > lines[k, BELOW, i] - rounding
                assert beside[:, 1].max() < lines[k, ABOVE, i] + rounding


@numba.njit(error_model="numpy")
def _beyond_bodies(situation, figures, inverse_weight):
    """Return how far the curves of cables over pulleys are outside of their bodies, over these."""
    pose = new_pose(situation, figures)
    n, worst = situation.attachments.shape[0], -np.inf
    parts, _ = new_parts(situation.rows.size, n, 3)
    for at in range(situation.positions.shape[0]):
        place(pose, situation, figures, at)
        limit_sag(pose)
        set_ranges(pose, parts, asked(pose, inverse_weight), False)
        for i in range(n):
            low, high = parts.ranges[0, 0, i], parts.ranges[0, 1, i]
            high = low * (high / low) ** (1e-3 ** ((at % 4) / 3.0))
            _enclose(pose, parts, parts.lines[0], i, low, high)
            for share in np.linspace(0.0, 1.0, 200):
                p = low + share * (high - low) if at % 2 else low * (high / low) ** share
                _, lift, _, _, _, _, _, along, aside = _hang(pose, i, p)
                curves = lift, along, aside
                for q in range(3):
                    rows = parts.lines[0, 2 + 4 * q : 6 + 4 * q, i]
                    beside = curves[q] - rows[0] - rows[1] * p
                    size = rows[3] - rows[2] + 1e-9 * (abs(curves[q]) + p)
                    worst = max(worst, (beside - rows[3]) / size, (rows[2] - beside) / size)
    return worst


@pytest.mark.slow
def test_bodies_enclose_what_a_cable_over_a_pulley_does() -> None:
    """In wind, where the force along and across the chord has bodies of its own."""
    leaning = replace(COGIRO, cable_load_direction=frozen_array([0.3, 0.2, -1.0]))
    slack = replace(FOUR, sag_max=0.5)
    for without, poses in ((leaning, anywhere(40, 3)), (slack, four_poses(40))):
        robot = replace(without, pulley_radius_m=0.5)
        figures, inverse = figures_of(robot, steel(3.0))
        figures = figures._replace(
            pulleys=plain(upright_exit_points_m(robot)),
            pulley_radius=robot.pulley_radius_m,
            vertical=plain(robot.leaning[:, 2]),
        )
        situation = situation_at(robot, poses).starting_at(straight_run(robot, poses).exit_points_m)
        assert _beyond_bodies(situation, figures, inverse) < 1e-3


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(3))
def test_each_refusal_is_certified_by_interval_arithmetic(seed: int) -> None:
    parts = 0
    for robot in range(12):
        rng = np.random.default_rng([seed, robot])
        case = varied(random_case(rng, 12), rng)
        if case.robot.pulley_radius_m > 0.0:
            continue
        sizing = size_poses(case.robot, case.poses, case.material)
        cable = given_cable(case, sizing, rng)
        given = solve_sagging(case.robot, case.poses, cable)
        for of, statics in ((case.material, sizing.statics), (cable, given)):
            at = np.flatnonzero(np.isin(statics.verdict, IMPOSSIBLE))
            if len(at):
                found = refused(case.robot, case.poses.part(at), of)
                assert found[:, 0].all()
                assert np.array_equal(found[:, 1], found[:, 2])
                parts += int(found[:, 1].sum())
    assert parts > 100


def test_what_taut_cables_hold_is_never_refused() -> None:
    """Pulls within the sag are chosen, and the load that they balance is asked for."""
    rng = np.random.default_rng(5)
    cable = steel(3.0).cable(0.006)
    w, EA = cable.weight_N_per_m, cable.axial_stiffness_N
    checked = 0
    for robot, poses in (
        (COGIRO, anywhere(12, 5)),
        (FOUR, four_poses(12, 5)),
        (SEVEN, seven_poses(12)),
    ):
        for k in range(12):
            pose = one(poses, k)
            geometry = cable_geometry(robot, pose)
            X, D, chord = geometry.horizontal_distance_m, geometry.drop_m, geometry.chord_m
            p = X / chord / 8.0 / robot.sag_max * 10 ** rng.uniform(0.1, 1.5, robot.n_cables)
            length, force_z = catenary.length_and_force_z(w * p, X, D, EA, w)
            force_x = w * p * X
            if (
                catenary.sag_m(length, force_x, force_z, EA, w, X, D) > robot.sag_max * chord
            ).any():
                continue
            least = float(catenary.least_tension_N(length, force_x, force_z, w).min())
            outward = np.column_stack([geometry.outward, np.zeros(robot.n_cables)])
            forces = outward * force_x[:, None] + [0.0, 0.0, 1.0] * force_z[:, None]
            moment = np.cross(geometry.lever_m, forces).sum(axis=0)
            wrench = frozen_array(np.append(forces.sum(axis=0), moment))
            platform = replace(robot.platform, mass_kg=0.0, wrench_N=wrench)
            loaded = replace(robot, platform=platform, tension_min_N=0.999 * least)
            statics = solve_sagging(loaded, pose, cable)
            assert statics.is_solved
            ends = catenary.end_tensions_N(length, force_x, force_z, w)
            assert statics.largest_tension_N <= np.max(ends) * (1.0 + 1e-6)
            checked += 1
    assert checked > 20


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(4))
def test_random_robots_against_another_solver(seed: int) -> None:
    rng = np.random.default_rng([31, seed])
    case = varied(random_case(rng, 4), rng)
    outcomes = [outcome for outcome, _ in compare(case, rng, starts=4)]
    assert len(outcomes) == 8
    assert not [outcome for outcome in outcomes if outcome.startswith("wrongly")]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("seed", "index", "k", "is_sizing"),
    [
        (7, 28, 19, True),  # some ten thousand parts
        (11, 50, 7, True),  # bodies too thin for the linear programme
        (21, 71, 12, True),  # a cable that hangs down on its pulley, almost vertical
        (21, 71, 15, True),
        (12, 115, 9, True),  # two equilibria, each with the tangent points of the other
        (21, 110, 7, True),
        (21, 227, 4, False),
        (21, 227, 16, False),
    ],
)
def test_hard_poses_are_decided(seed: int, index: int, k: int, is_sizing: bool) -> None:
    rng = np.random.default_rng([seed, index])
    case = varied(random_case(rng, 20), rng)
    sizing = size_poses(case.robot, case.poses, case.material)
    pose = case.poses.part(np.array([k]))
    if is_sizing:
        verdict = size_poses(case.robot, pose, case.material).statics.verdict[0]
    else:
        verdict = solve_sagging(case.robot, pose, given_cable(case, sizing, rng)).verdict[0]
    assert Verdict(int(verdict)) not in OPEN


def test_the_other_solver_keeps_the_sag() -> None:
    robot, poses, cable = replace(FOUR, sag_max=0.03), four_poses(4, 4), steel(2.0).cable(0.01)
    rng = np.random.default_rng(0)
    statics = solve_sagging(robot, poses, cable)
    sizing = size_poses(robot, poses, steel(2.0))
    held = 0
    for k in range(4):
        place_ = robot, poses.position_m[k], np.zeros(3), steel(2.0)
        used, _ = least_utilisation(*place_, cable.weight_N_per_m, rng, starts=4)
        assert np.isfinite(used) == statics.is_solved[k]
        if statics.is_solved[k]:
            ours = statics.largest_tension_N[k] / cable.allowable_tension_N
            assert ours == pytest.approx(used, rel=1e-6)
            held += 1
        other = thinnest(*place_, rng, starts=4).diameter_m
        assert sizing.diameter_m[k] == pytest.approx(other, rel=1e-6, nan_ok=True)
    assert held > 1


def test_a_refusal_tells_what_the_cables_would_have_to_do() -> None:
    outside = solve_sagging(FOUR, Poses.at([120.0, 40.0, -10.0]), steel().cable(0.01))
    assert outside.verdict == Verdict.OUTSIDE_HULL
    assert outside.wrench is not None
    along = (FOUR.exit_points_m - outside.poses.position_m) @ outside.wrench
    assert (along <= 1e-9).all() and outside.wrench[2] > 0.0  # no cable pulls along it
    x, y, z = outside.wrench.round(2) + 0.0
    assert outside.sentence.endswith(f"have to push along ({x:g}, {y:g}, {z:g}).")
    turned = Robot(
        frozen_array(
            [[-3.0, 0, 9], [3, 0, 9], [-3, 0.1, 9], [3, 0.1, 9], [0, 3, 9], [0, -3, 9], [0, 0, 9]]
        ),
        Platform(
            10.0,
            frozen_array([[0.0, 0, 0]] * 6 + [[0.1, 0, 0]]),
            wrench_N=frozen_array([0.0, 0, 0, 0, 0, 50.0]),
        ),
    )
    statics = solve_sagging(turned, Poses.at([0.0, 0.0, 0.0]), steel().cable(0.003))
    assert statics.verdict in IMPOSSIBLE and statics.verdict not in OPEN
    held = solve_sagging(FOUR, four_poses(1).part(np.array([0])), steel().cable(0.01)).part(0)
    assert held.sentence == Verdict.SOLVED.sentence
