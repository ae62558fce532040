"""Cables far longer than their chord or below the floor, against cables drawn point by point."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from designer.arrays import frozen_array
from designer.model.cable import Material
from designer.model.prism import Prism
from designer.model.robot import Platform, Poses, Robot
from designer.model.workspace import Workspace
from designer.sizing.newton import size_poses
from designer.statics.inverse import solve_sagging
from designer.statics.task import LONG
from designer.workspace.sweep import HangingCables, look_at, map_workspace, survey_hanging

STEEL = Material(7800.0, 200e9, 180e6)
MAST = frozen_array([[0, 0, 0], [100, 0, 0], [100, 80, 0], [0, 80, 0]])
ROBOT = Robot(MAST, Platform(400.0), sag_max=0.5)
REGION = Prism.box((10.0, 90.0), (10.0, 70.0), (-40.0, -10.0))
ROPE = STEEL.cable(0.012)


def drawn_z_m(statics, robot) -> np.ndarray:
    """Heights along every cable, by adding up short straight pieces from the exit point."""
    steps = 4000
    w, EA = statics.weight_N_per_m[..., None], statics.axial_stiffness_N[..., None]
    s = (np.arange(steps) + 0.5) / steps * statics.length_m[..., None]
    upward = statics.force_z_N[..., None] + w * (s - statics.length_m[..., None])
    tension = np.hypot(statics.force_x_N[..., None], upward)
    piece = upward / tension * (1.0 + tension / EA) * statics.length_m[..., None] / steps
    return robot.exit_points_m[:, 2, None] + np.cumsum(piece, axis=-1)


def some_statics(cable=ROPE):
    rng = np.random.default_rng(4)
    low, high = REGION.bounds_m
    return solve_sagging(ROBOT, Poses.at(rng.uniform(low, high, (200, 3))), cable)


def test_the_lowest_point_is_that_of_the_drawn_cable() -> None:
    statics = some_statics(STEEL.cable(0.02))
    assert statics.is_solved.all()
    assert statics.hangs_below.any() and not statics.hanging_cables.all()
    drawn = np.minimum(drawn_z_m(statics, ROBOT).min(axis=-1), 0.0)
    assert np.abs(statics.lowest_m - drawn).max() < 0.05
    assert np.all(statics.lowest_m <= statics.poses.position_m[:, None, 2] + 1e-9)


def test_samples_are_counted_and_the_worst_is_told() -> None:
    statics = some_statics(STEEL.cable(0.03))
    places = statics.poses.position_m
    ratio, lowest = statics.length_over_chord, statics.lowest_m
    floor_m = float(np.median(lowest.min(axis=1)))
    counts = statics.is_solved & (np.arange(200) % 3 > 0)
    whole = look_at(HangingCables(), places, statics, counts, floor_m)
    assert whole.samples == counts.sum()
    assert whole.below_floor is not None
    below = lowest[counts].min(axis=1)
    assert whole.below_floor.samples == (below < floor_m).sum()
    assert whole.below_floor.extreme == below.min()
    at = int(np.flatnonzero((places == whole.below_floor.place).all(axis=1))[0])
    assert lowest[at, whole.below_floor.cable - 1] == below.min()
    assert (whole.long is not None) == (ratio[counts] > LONG).any()
    assert look_at(HangingCables(), places, statics, counts, None).below_floor is None


@pytest.mark.parametrize("samples", [300])
def test_a_sweep_counts_them(samples) -> None:
    workspace = Workspace(REGION, samples=samples, floor_m=-45.0)
    light = map_workspace(ROBOT, workspace, STEEL).census.hanging
    assert light.samples == samples
    with_heavy = survey_hanging(ROBOT, workspace, STEEL.cable(0.03))
    assert with_heavy.below_floor is not None
    assert with_heavy.below_floor.extreme < -45.0
    assert [heading for heading, _ in with_heavy.notes()][-1] == "below floor"
    none = survey_hanging(ROBOT, replace(workspace, floor_m=None), STEEL.cable(0.003))
    assert [*none.notes()] == []


def test_a_cable_is_not_left_to_hang_far_down_where_that_saves_nothing() -> None:
    """Of a hall of 60 m by 40 m; held or not, the needed diameter is the same to 0.05 %."""
    corners = [(x, y) for x in (-1, 1) for y in (-1, 1)]
    exits = [p for x, y in corners for p in ([30 * x, 19 * y, 25], [29 * x, 20 * y, 25])]
    body = [p for x, y in corners for p in ([x, -y, 1], [-x, y, -1])]
    robot = Robot(frozen_array(exits), Platform(500.0, frozen_array(body)))
    rope = Material(5290.0, 62.7e9, 198e6)
    places = [[17.53754872083664, 10.275146467611194, 4.830685159191489], [-21.55, 10.84, 3.36]]
    sizing = size_poses(robot, Poses.at(places), rope)
    held = size_poses(replace(robot, tension_min_N=0.5), Poses.at(places), rope)
    assert sizing.statics.is_solved.all()
    assert sizing.statics.length_over_chord.max() < LONG
    assert sizing.diameter_m == pytest.approx(held.diameter_m, rel=5e-4)
