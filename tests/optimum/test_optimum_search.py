"""The search: known answers, brute force, designs that fail, and when it ends."""

from __future__ import annotations

import itertools
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from optimum_cases import OF_POSE, OF_YARD, YARD, optimum, plan_of

from designer.errors import DesignerError
from designer.grades.registry import load_catalogue
from designer.optimum.measures import MEASURES, Quick, promising
from designer.optimum.optimise import optimum_of
from designer.optimum.search import search
from designer.optimum.trial import NO_STUDY, Examiner


def test_it_finds_what_symmetry_and_reason_say(tmp_path: Path) -> None:
    """Masts as high as may be, and as far to the left of the pose as to its right."""
    found = optimum(tmp_path)
    shift, height = found.best.values
    assert shift == pytest.approx(0.0, abs=0.1)
    assert height == 12.0
    assert found.is_better and found.off == pytest.approx(0.0, abs=1e-9)
    assert found.gain is not None and found.gain < -0.1
    assert all(one is not None and one.values[1] > 11.5 for one in found.starts)
    assert found.plan.variables[1].bound_at(height) == "upper"


@pytest.mark.parametrize("seed", range(2))
def test_no_point_of_a_grid_is_better(tmp_path: Path, seed: int) -> None:
    """Two variables against each other, the best inside: what rope there is goes out or up."""
    plan = plan_of(
        tmp_path,
        "study: crane.yaml\n"
        "objective: {minimise: pose.sagging.max_tension_N}\n"
        "variables: {robot.anchors.2.1: [8 m, 20 m], robot.anchors.2.2: [5 m, 12 m]}\n"
        "constraints: {pose.sagging.lengths_m.2: 8 m}\n"
        f"seed: {seed}\nbudget: {{evaluations: 220}}\n",
    )
    examiner = Examiner(plan, ())
    best = search(examiner, lambda _: None, lambda: False).best_of(None, 1)
    shares = itertools.product(np.linspace(0.0, 1.0, 15), repeat=2)
    grid = [examiner.trial(plan.values(np.array(each))) for each in shares]
    holding = [one.value for one in grid if one.holds]
    assert best is not None and 0 < len(holding) < len(grid)
    assert best.value <= min(holding) * (1.0 + 1e-4)


def test_the_same_seed_finds_the_same(tmp_path: Path) -> None:
    plan = plan_of(tmp_path, OF_POSE.replace("150", "40"))
    trials = [search(Examiner(plan, ()), lambda _: None, lambda: False).trials for _ in range(2)]
    assert trials[0] == trials[1]


def test_designs_that_fail_are_kept_with_their_reason_and_lead_away(tmp_path: Path) -> None:
    """Masts below the pose hold nothing; two masts at one point make no region."""
    plan = plan_of(tmp_path, OF_POSE.replace("[6 m, 12 m]", "[-30 m, 12 m]"))
    examiner = Examiner(plan, ())
    assert examiner.trial((0.0, -30.0)).reason.startswith("the configured pose: ")
    searched = search(examiner, lambda _: None, lambda: False)
    assert any(not one.holds for one in searched.trials)
    best = searched.best_of(None, 1)
    assert best is not None and best.values[1] > 11.0
    yard = plan_of(tmp_path, OF_YARD.replace("[-1 m, 2 m]", "[-10 m, 2 m]"), YARD)
    none = Examiner(yard, ()).trial((-10.0,))
    assert (none.violation, none.reason.split(":")[0]) == (NO_STUDY, "robot.anchors[1]")


@pytest.mark.parametrize(
    ("stop", "ended"), [(lambda: True, "asked"), (lambda: False, "time")], ids=["asked", "time"]
)
def test_it_ends_when_it_is_asked_to(tmp_path: Path, stop: Callable[[], bool], ended: str) -> None:
    budget = "budget: {evaluations: 100000, time: 1 ms}"
    plan = plan_of(tmp_path, OF_POSE.replace("budget: {evaluations: 150}", budget))
    found = search(Examiner(plan, ()), lambda _: None, stop)
    assert found.ended == ended
    assert len(found.trials) < 30


def test_nothing_tried_is_told(tmp_path: Path) -> None:
    plan = plan_of(
        tmp_path, OF_POSE.replace("[robot.anchors.*.0], offset", "[pose.0, pose.1], bounds")
    )
    assert plan.given is None
    with pytest.raises(DesignerError, match="before it had tried a design"):
        optimum_of(plan, stop=lambda: True)


def test_quick_measures_are_those_of_the_whole_result(tmp_path: Path) -> None:
    plan = plan_of(tmp_path, OF_YARD, YARD)
    study = plan.base.study()
    grades = load_catalogue((), False).grades
    quick = Quick(study, promising(study, grades), 300)
    result = plan.base.result(study)
    for name in ("rope_mass", "max_tension", "diameter", "usable_volume"):
        measure = MEASURES[name]
        assert measure.quick is not None
        assert measure.quick(quick) == pytest.approx(measure.value(result), rel=2e-3), name
