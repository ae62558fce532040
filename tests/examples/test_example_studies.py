"""Each shipped study: read, solved, one number checked two ways, and random poses of its robot."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
from scipy.optimize import linprog

from designer.analysis.pose import analyse_pose
from designer.arrays import FloatArray
from designer.grades.registry import load_catalogue
from designer.io.config import read_study
from designer.model.robot import Poses, Robot
from designer.model.verdict import Verdict
from designer.resources import example_file, example_names, example_summary
from designer.sizing.newton import size_poses
from designer.study import Study

GRADES = {grade.id for grade in load_catalogue((), False).grades}
# name: needed diameter [mm] and massless tension [N] of the configured pose
EXPECTED = {
    "fast": (32.59917, 86385.528),
    "yard": (3.132041, 1514.3151),
    "robocrane": (4.405755, 3014.6409),
    "cogiro": (2.674950, 1107.9860),
    "ipanema": (1.161330, 209.23596),
    "falcon": (0.3756076, 20.493127),
    "stadium": (0.9275735, 127.40597),
    "facade": (2.453995, 923.96905),
    "fast-as-built": (43.90231315, 209523.1934),
    "hoist": (5.6173137, 4353.0818),
}


@cache
def study_of(name: str) -> Study:
    return read_study(example_file(name))


def least_largest_tension_N(robot: Robot, pose: Poses) -> float:
    """The best tensions of straight cables, by plain vectors and a linear programme."""
    exits, body = robot.exit_points_m, robot.platform
    levers = robot.attachments_m @ pose.rotation.T
    pulls = exits - pose.position_m - levers
    pulls /= np.linalg.norm(pulls, axis=1, keepdims=True)
    weight = np.array([0.0, 0.0, -9.81 * body.mass_kg])
    arm = pose.rotation @ body.centre_of_mass_m
    wrenches = np.hstack([pulls, np.cross(levers, pulls)])
    load = np.concatenate([weight, np.cross(arm, weight)]) + body.wrench_N
    # What a point mass or a plane does not ask for is zero on both sides: no rows of their own.
    rows = np.flatnonzero(np.abs(wrenches).max(axis=0) > 1e-12)
    n = robot.n_cables
    found = linprog(
        np.append(np.zeros(n), 1.0),
        A_ub=np.hstack([np.eye(n), -np.ones((n, 1))]),
        b_ub=np.zeros(n),
        A_eq=np.hstack([wrenches[:, rows].T, np.zeros((len(rows), 1))]),
        b_eq=-load[rows],
        bounds=[(robot.tension_min_N, None)] * n + [(0.0, None)],
    )
    assert found.success
    return float(found.fun)


def test_every_study_is_tested_and_told_apart() -> None:
    assert set(EXPECTED) == set(example_names())
    summaries = [example_summary(name) for name in example_names()]
    assert len(set(summaries)) == len(summaries)
    assert all(20 < len(text) < 200 for text in summaries)


@pytest.mark.parametrize("name", EXPECTED)
def test_the_configured_pose(name: str) -> None:
    study = study_of(name)
    pose = analyse_pose(study)
    assert pose is not None
    assert bool(pose.sizing.statics.is_solved)
    diameter_mm, tension_N = EXPECTED[name]
    assert 1e3 * float(pose.sizing.diameter_m) == pytest.approx(diameter_mm, rel=1e-6)
    massless = float(pose.massless.largest_tension_N)
    assert massless == pytest.approx(tension_N, rel=1e-6)
    by_hand = least_largest_tension_N(study.robot, pose.sizing.statics.poses)
    assert massless == pytest.approx(by_hand, rel=1e-7)


@pytest.mark.parametrize("name", EXPECTED)
def test_no_pose_is_called_solved_that_is_not(name: str) -> None:
    study = study_of(name)
    assert study.workspace is not None
    some = next(study.workspace.places())[:400]
    poses = beyond(some, study)
    sizing = size_poses(study.robot, poses, study.material)
    statics = sizing.statics
    solved = statics.verdict == Verdict.SOLVED
    assert solved.sum() > 0.3 * len(some)
    largest = statics.largest_tension_N[solved]
    left = np.abs(statics.equilibrium_residual_N()[solved]).max(axis=1)
    assert (left <= 1e-8 * largest).all()
    assert (statics.closure_residual_m()[solved].max(axis=1) < 1e-8).all()
    assert np.isnan(sizing.diameter_m[~solved]).all()
    allowed = study.material.cable(1.0).allowable_tension_N * sizing.diameter_m[solved] ** 2
    assert (largest <= allowed * (1.0 + 1e-6)).all()


def beyond(some: FloatArray, study: Study) -> Poses:
    """Places of the workspace, moved outward by half, so that some cannot be held."""
    assert study.workspace is not None
    middle = study.workspace.region.bounds_m.mean(axis=0)
    moved = some.copy()
    moved[:, :3] = middle + 1.5 * (some[:, :3] - middle)
    return Poses.at(moved)


@pytest.mark.parametrize("name", EXPECTED)
def test_the_named_grades_are_shipped(name: str) -> None:
    selection = study_of(name).selection
    assert selection is not None
    for grade in selection.grades or ():
        assert grade in GRADES
