"""Other branches: a solver of another kind holds nothing called impossible, nor a thinner cable."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import pytest
from redundant_robots import FOUR, cogiro_poses, four_poses, one, steel
from sample_robots import COGIRO
from twins.thinnest import thinnest

from designer.model.robot import Poses
from designer.model.verdict import Verdict
from designer.sizing.newton import size_poses
from designer.statics.inverse import solve_sagging

sys.path.insert(0, str(Path(__file__).parents[1] / "benchmarks"))

from impossible import compare, random_case


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(4))
def test_random_robots_against_another_solver(seed) -> None:
    rng = np.random.default_rng([1, seed])
    case = random_case(rng, count=3)
    outcomes = [outcome for outcome, _ in compare(case, rng, starts=4)]
    assert len(outcomes) == 6  # of each pose, its thinnest cable and a given one
    assert not [o for o in outcomes if o == "thicker" or o.startswith("wrongly")]


def test_the_other_solver_finds_the_same_cable() -> None:
    poses = cogiro_poses(3, 11)
    sizing = size_poses(COGIRO, poses, steel(30.0))
    rng = np.random.default_rng(0)
    for k in range(3):
        place = poses.place[k]
        other = thinnest(COGIRO, place[:3], place[3:], steel(30.0), rng, starts=2)
        assert sizing.diameter_m[k] == pytest.approx(other.diameter_m, rel=1e-6)


def test_only_one_equilibrium_is_called_the_thinnest(fast_robot) -> None:
    three = size_poses(fast_robot, Poses.at([[250.0, 200.0, -50.0]]), steel())
    assert three.is_thinnest.all()
    four = size_poses(FOUR, four_poses(5), steel())
    assert four.statics.is_solved.any()
    assert not four.is_thinnest.any()


def test_no_thinner_cable_is_within_its_strength() -> None:
    """The fixed-section solver agrees: a cable half a per cent thinner is overloaded."""
    poses, material = cogiro_poses(30, 5), steel(30.0)
    sizing = size_poses(COGIRO, poses, material)
    for k in np.flatnonzero(sizing.statics.is_solved):
        cable = material.cable(0.995 * float(sizing.diameter_m[k]))
        statics = solve_sagging(COGIRO, one(poses, k), cable)
        assert statics.largest_tension_N > cable.allowable_tension_N


def test_every_refusal_is_told_apart() -> None:
    labels = [verdict.label for verdict in Verdict]
    assert labels[int(Verdict.NOT_FOUND)] == "not_found"
    assert len({verdict.sentence for verdict in Verdict}) == len(labels)
