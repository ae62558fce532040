"""What is asked of winches, against the reference of the pairs, which has world axes alone."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml
from pairs.agreement import Situation, ropes_of
from pairs.options import BASES
from pairs.reference import Pose, solve
from pairs.table import analysed

from designer.analysis.analyse import Analysis
from designer.explore.session import Session
from designer.model.verdict import Answer, Requirement, State
from designer.plugins import find_plugins
from designer.resources import example_file

Study = dict[str, Any]


def crane(**robot: Any) -> Study:
    """Return the small crane of the pairs over a box, with more of its robot."""
    base = BASES["crane"]
    workspace = {"region": {"box": [[5.0, 7.0], [3.0, 5.0], [2.0, 5.0]]}, "samples": 60, "proof": 0}
    return base | {"robot": base["robot"] | robot, "workspace": workspace}


def states(study: Study, analysis: Analysis, case: dict[str, Any] | None = None, count: int = 60):
    """Yield the reference's state at random places of the box."""
    rng = np.random.default_rng(20261125)
    low, high = np.array(study["workspace"]["region"]["box"]).T
    situation = Situation(study, ropes_of(analysis), case or {})
    for share in rng.uniform(size=(count, 3)):
        yield solve(situation.problem, Pose(low + share * (high - low)))


@pytest.mark.slow
def test_largest_tension_at_exit_points(tmp_path: Path) -> None:
    study = crane(winches={"tension_max": 2500.0})
    analysis = analysed(study, tmp_path)
    (winch,) = (each for each in analysis.requirements if each.id == "winch_tension")
    exit_N = [np.linalg.norm(state.exit_pull_N, axis=1).max() for state in states(study, analysis)]
    assert winch.place is not None and winch.cable is not None
    there = solve(Situation(study, ropes_of(analysis), {}).problem, Pose(winch.place))
    pull_N = np.linalg.norm(there.exit_pull_N, axis=1)
    assert winch.demand == pytest.approx(pull_N.max(), rel=1e-6)
    assert winch.cable == pull_N.argmax() + 1
    assert max(exit_N) <= winch.demand
    assert winch.utilisation == pytest.approx(winch.demand / 2500.0)


@pytest.mark.parametrize("lost", [None, pytest.param(3, marks=pytest.mark.slow)])
def test_largest_tension_of_each_winch(tmp_path: Path, lost: int | None) -> None:
    largest = [np.inf, 2500.0, 400.0]
    study = crane(winches={"tension_max": [None, *largest[1:]], "sheave_efficiency": 0.9})
    study["workspace"] |= {"hangs_below": "include"}
    if lost is not None:
        study |= {"load_cases": [{"name": "loss", "cable_lost": lost}]}
        del largest[lost - 1]
    analysis = analysed(study, tmp_path)
    (winch,) = (each for each in analysis.requirements if each.id == "winch_tension")
    assert winch.place is not None and winch.cable is not None
    column = winch.cable - 1
    assert winch.capacity == pytest.approx(largest[column])
    assert winch.utilisation == pytest.approx(winch.demand / winch.capacity)
    if lost is not None:  # the platform settles elsewhere
        assert winch.cable == 2
        return
    shares = [
        np.linalg.norm(state.exit_pull_N, axis=1) / 0.9 / largest
        for state in states(study, analysis)
    ]
    assert winch.utilisation >= np.max(shares)
    there = solve(Situation(study, ropes_of(analysis), {}).problem, Pose(winch.place))
    pull_N = np.linalg.norm(there.exit_pull_N, axis=1) / 0.9
    assert winch.demand == pytest.approx(pull_N[column], rel=1e-6)
    assert column == (pull_N / largest).argmax()


def test_other_tensions_may_suit_winches_that_differ(tmp_path: Path) -> None:
    base = BASES["four"]
    study = base | {"robot": base["robot"] | {"winches": {"tension_max": 1e6}}}
    (alike,) = _winch_of(study, tmp_path)
    each = [1e6] * len(base["robot"]["anchors"])
    assert alike.cable is not None
    each[alike.cable - 1] = 0.9 * alike.demand
    study["robot"]["winches"] = {"tension_max": each}
    (winch,) = _winch_of(study, tmp_path)
    assert winch.state is State.OPEN
    assert "others may suit winches that differ" in winch.remark
    study["robot"]["winches"] = {"tension_max": 0.9 * alike.demand}
    assert _winch_of(study, tmp_path)[0].state is State.FAILS


def _winch_of(study: Study, folder: Path) -> list[Requirement]:
    return [each for each in analysed(study, folder).requirements if each.id == "winch_tension"]


def test_torque_of_the_motors(tmp_path: Path) -> None:
    winches = {"drum_diameter": 0.3, "layers": 3, "gear_ratio": 20.0, "efficiency": 0.7}
    study = crane(winches=winches | {"motor": {"torque": 1.0}})
    analysis = analysed(study, tmp_path)
    (motor,) = (each for each in analysis.requirements if each.id == "winch_torque")
    assert motor.place is not None
    assert not motor.holds
    ropes = ropes_of(analysis)
    state = solve(Situation(study, ropes, {}).problem, Pose(motor.place))
    pull_N = np.linalg.norm(state.exit_pull_N, axis=1)
    # Two layers lie below the outermost, and half a rope.
    radius_m = 0.15 + 2.5 * ropes[0][1]["diameter"]
    assert motor.demand * 20.0 * 0.7 == pytest.approx(pull_N.max() * radius_m, rel=1e-6)


def test_torque_with_groups_of_cables(tmp_path: Path) -> None:
    drum = {"drum_diameter": 0.3, "motor": {"torque": 1e5}}
    study = crane(winches=drum)
    groups = {"first": [1], "others": [2, 3]}
    study |= {"selection": study["selection"] | {"groups": groups, "objectives": ["mass"]}}
    analysis = analysed(study, tmp_path)
    (motor,) = (each for each in analysis.requirements if each.id == "winch_torque")
    assert motor.place is not None
    assert motor.cable is not None
    ropes = ropes_of(analysis)
    state = solve(Situation(study, ropes, {}).problem, Pose(motor.place))
    pull_N = np.linalg.norm(state.exit_pull_N, axis=1)
    radius_m = 0.15 + 0.5 * np.array([size["diameter"] for _, size in ropes])
    assert motor.demand == pytest.approx((pull_N * radius_m).max(), rel=1e-6)


@pytest.mark.cases_by_default(1)
@pytest.mark.parametrize("share", [0.99, 1.01])
def test_winch_decides_the_answer(tmp_path: Path, share: float) -> None:
    asked = analysed(crane(winches={"tension_max": 1e6}), tmp_path)
    (winch,) = (each for each in asked.requirements if each.id == "winch_tension")
    again = analysed(crane(winches={"tension_max": share * winch.demand}), tmp_path)
    assert again.answer is (Answer.YES if share > 1.0 else Answer.NO)


def test_window_offers_winches() -> None:
    session = Session.open(example_file("yard"), find_plugins(with_plugins=False))
    assert "robot.winches.tension_max" in [field.path for field in session.fields()]
    session.edit("robot.winches.tension_max", "5 kN")
    assert session.question().study.robot.winches.tension_max_N == 5000.0


def test_window_edits_the_largest_tension_of_one_winch(tmp_path: Path) -> None:
    file = tmp_path / "crane.yaml"
    file.write_text(yaml.safe_dump(crane(winches={"tension_max": [900.0, None, 700.0]})))
    session = Session.open(file, find_plugins(with_plugins=False))
    labels = {each.path: each.label for each in session.fields()}
    assert labels["robot.winches.tension_max[2]"] == "Largest tension of a winch, 3"
    session.edit("robot.winches.tension_max[1]", "5 kN")
    largest_N = session.question().study.robot.winches.tension_max_N
    assert np.array_equal(largest_N, [900.0, 5000.0, 700.0])
