"""Workspaces in which every position is asked for in several orientations."""

from __future__ import annotations

from functools import partial
from pathlib import Path

import numpy as np
import pytest

from designer.arrays import frozen_array
from designer.model.cable import Material
from designer.model.region import CHUNK, PointList, Prism
from designer.model.robot import Poses, Robot
from designer.model.space import FILLING, Orientations, Space
from designer.model.workspace import Workspace
from designer.selection.verify import verify
from designer.sizing.newton import size_poses
from designer.workspace.demand import diameter_demand
from designer.workspace.refine import refine
from designer.workspace.sweep import map_workspace, open_sweep

BOX = Prism.box((-10.0, 10.0), (-10.0, 10.0), (-90.0, -70.0))
TILTS = frozen_array([[0.0, 0, 0], [0.03, 0, 0], [0, -0.02, 0.05]])


def workspace_in(orientations: Orientations, samples: int = 300) -> Workspace:
    return Workspace(BOX, samples=samples, orientations=orientations)


def test_places_of_a_level_platform_are_its_positions() -> None:
    chunk = next(workspace_in(Orientations()).places())
    assert chunk.shape == (300, 3)
    assert Orientations().is_level


def test_places_come_in_groups_and_flat_in_memory() -> None:
    chunks = list(workspace_in(Orientations(TILTS), 20_000).places())
    assert sum(len(chunk) for chunk in chunks) == 60_000
    assert max(len(chunk) for chunk in chunks) <= CHUNK
    groups = chunks[0].reshape(-1, 3, 6)
    assert (groups[:, 0, :3] == groups[:, 2, :3]).all()
    assert (groups[:, :, 3:] == TILTS).all()


def test_a_range_has_its_middle_its_corners_and_a_filling() -> None:
    found = Orientations.within([-0.1, 0.0, 0.2], [0.1, 0.0, 0.4])
    assert found.count == 1 + 4 + FILLING
    np.testing.assert_allclose(found.turns_rad[0], [0.0, 0.0, 0.3])
    corners = {tuple(turn.round(12)) for turn in found.turns_rad[1:5]}
    assert corners == {(-0.1, 0.0, 0.2), (0.1, 0.0, 0.2), (-0.1, 0.0, 0.4), (0.1, 0.0, 0.4)}
    inner = found.turns_rad[5:]
    assert ((inner[:, [0, 2]] > [-0.1, 0.2]) & (inner[:, [0, 2]] < [0.1, 0.4])).all()
    assert len(np.unique(inner, axis=0)) == FILLING


@pytest.mark.slow
def test_every_sample_is_in_its_worst_orientation(
    six_cable_robot: Robot, steel: Material, tmp_path: Path
) -> None:
    workspace = workspace_in(Orientations(TILTS))
    path = tmp_path / "sweep.nc"
    found = map_workspace(six_cable_robot, workspace, steel, file=path)
    with open_sweep(path) as sweep:
        position = sweep["position"].to_numpy()
        turn = sweep["rotation_vector"].to_numpy()
        diameter = sweep["diameter"].to_numpy()
    each = np.stack(
        [
            size_poses(six_cable_robot, Poses.at(position, np.tile(t, (300, 1))), steel).diameter_m
            for t in TILTS
        ]
    )
    np.testing.assert_allclose(diameter, each.max(axis=0), rtol=1e-9)
    assert (turn == TILTS[each.argmax(axis=0)]).all()
    assert len(np.unique(turn, axis=0)) > 1
    assert found.census.samples == 300
    assert found.sagging is not None
    assert found.sampled is not None
    assert found.sagging.diameter_m >= found.sampled.diameter_m == pytest.approx(diameter.max())
    there = size_poses(six_cable_robot, found.sagging.pose, steel)
    assert float(there.diameter_m) == pytest.approx(found.sagging.diameter_m, rel=1e-9)


@pytest.mark.slow
def test_a_range_is_searched_between_its_orientations(
    six_cable_robot: Robot, steel: Material
) -> None:
    low, high = np.array([-0.02, -0.02, -0.04]), np.array([0.03, 0.02, 0.04])
    workspace = workspace_in(Orientations.within(low, high))
    found = map_workspace(six_cable_robot, workspace, steel)
    assert found.sagging is not None
    assert found.sampled is not None
    turn = found.sagging.rotation_vector_rad
    assert ((turn >= low) & (turn <= high)).all()
    rng = np.random.default_rng(1)
    corners = np.array(np.meshgrid(*BOX.bounds_m.T)).reshape(3, -1).T
    position = np.concatenate([rng.uniform(*BOX.bounds_m, (4000, 3)), np.repeat(corners, 250, 0)])
    turns = rng.uniform(low, high, position.shape)
    brute = size_poses(six_cable_robot, Poses.at(position, turns), steel)
    assert brute.statics.is_solved.all()
    assert found.sagging.diameter_m >= brute.diameter_m.max()


@pytest.mark.slow
def test_a_list_of_points_in_a_range(six_cable_robot: Robot, steel: Material) -> None:
    region = PointList(frozen_array([[0.0, 0, -80], [5, 5, -75]]))
    space = Space(region, Orientations.within([-0.03, 0, 0], [0.05, 0, 0]))
    assert not space.is_discrete
    demand = partial(diameter_demand, six_cable_robot, steel, "include")
    (worst,) = refine(space, demand, np.array([[0.0, 0, -80, 0.01, 0, 0], [5, 5, -75, 0.01, 0, 0]]))
    assert any((worst.place[:3] == point).all() for point in region.points_m)
    line = np.linspace(-0.03, 0.05, 41)
    tried = [
        demand(np.array([[*point, rx, 0.0, 0.0] for rx in line])).max() for point in region.points_m
    ]
    assert worst.demand == pytest.approx(max(tried), rel=1e-6)


@pytest.mark.slow
def test_a_cable_is_verified_in_every_orientation(six_cable_robot: Robot, steel: Material) -> None:
    level = verify(six_cable_robot, workspace_in(Orientations()), steel.cable(0.03))
    tilted = verify(six_cable_robot, workspace_in(Orientations(TILTS)), steel.cable(0.03))
    assert tilted.max_tension_N > level.max_tension_N
    assert (tilted.longest_m >= level.longest_m - 1e-9).all()
    assert tilted.worst_place.shape == (6,)
