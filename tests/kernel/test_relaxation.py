"""The proof that no finite cable holds a pose: never of one that is held, but of what was open."""

from __future__ import annotations

import sys
from pathlib import Path

import numba
import numpy as np
import pytest
from twins.thinnest import thinnest

from designer.kernel.calling import CableFigures, Situation, plain
from designer.kernel.pose import new_pose, place
from designer.kernel.relaxation import misses_loads, new_body
from designer.model.robot import Poses
from designer.model.verdict import Verdict
from designer.sizing.newton import size_poses
from designer.statics.geometry import upright_exit_points_m, upright_situation

sys.path.insert(0, str(Path(__file__).parents[1] / "benchmarks"))

from impossible import Case, random_case


@numba.njit(error_model="numpy")
def _refuse(situation: Situation, figures: CableFigures, refused: np.ndarray) -> None:
    pose = new_pose(situation, figures)
    body = new_body(situation.rows.size, situation.attachments.shape[0])
    for at in range(refused.size):
        place(pose, situation, figures, at)
        refused[at] = misses_loads(pose, body)


def _refused(case: Case, poses: Poses) -> np.ndarray:
    ones = np.ones((1, case.robot.n_cables))
    situation = upright_situation(case.robot, poses, upright_exit_points_m(case.robot))
    kappa, strength = case.material.elastic_compliance_per_m, case.material.strength_length_m
    figures = CableFigures(plain(kappa * ones), plain(ones), plain(strength * ones), 0.0)
    refused = np.zeros(len(poses.position_m), dtype=np.bool_)
    _refuse(situation, figures, refused)
    return refused


@pytest.mark.slow
def test_no_pose_that_is_held_is_refused() -> None:
    held = 0
    for robot in range(60):
        case = random_case(np.random.default_rng([7004, robot]), count=20)
        poses = Poses.at(case.position, None if case.robot.is_point_mass else case.turn)
        solved = size_poses(case.robot, poses, case.material).statics.is_solved
        assert not (_refused(case, poses) & solved).any()
        held += int(solved.sum())
    assert held > 300


@pytest.mark.slow
@pytest.mark.parametrize(("robot", "pose"), [(3, 3), (8, 2), (17, 4), (18, 0)])
def test_a_pose_that_no_start_held_is_refused(robot, pose) -> None:
    case = random_case(np.random.default_rng([2711, robot]))
    position, turn = case.position[pose], case.turn[pose]
    sizing = size_poses(case.robot, Poses.at(position, turn), case.material)
    assert sizing.statics.verdict == Verdict.NO_FINITE_CABLE
    other = thinnest(case.robot, position, turn, case.material, np.random.default_rng(1), starts=4)
    assert not np.isfinite(other.diameter_m)
