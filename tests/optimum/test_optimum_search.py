"""The search: known answers, brute force, failing designs, its end; verification in full."""

from __future__ import annotations

import itertools
from collections.abc import Callable
from contextlib import suppress
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from optimum_cases import OF_POSE, OF_YARD, YARD, optimum, plan_of

from designer.errors import DesignerError
from designer.grades.registry import load_catalogue
from designer.optimum.measures import MEASURES, Quick, promising
from designer.optimum.optimise import MOST_VERIFIED, Verifier, optimum_of
from designer.optimum.plan import Values
from designer.optimum.search import NO_STUDY, Examiner, Trial, _OverError, _Run, search


@pytest.mark.slow
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


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(2))
@pytest.mark.parametrize(
    "rails",
    [
        "robot.anchors.2.1: [8 m, 20 m], robot.anchors.2.2: [5 m, 12 m]",
        "robot.anchors.2.0: [2 m, 18 m], robot.anchors.2.1: [8 m, 20 m]",
    ],
)
def test_no_point_of_a_grid_is_better(tmp_path: Path, rails: str, seed: int) -> None:
    """An exit point on two rails, the best inside: what rope there is goes out or up."""
    plan = plan_of(
        tmp_path,
        "study: crane.yaml\n"
        "objective: {minimise: pose.sagging.max_tension_N}\n"
        f"variables: {{{rails}}}\n"
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


@pytest.mark.slow
def test_the_same_seed_finds_the_same(tmp_path: Path) -> None:
    plan = plan_of(tmp_path, OF_POSE.replace("150", "40"))
    trials = [search(Examiner(plan, ()), lambda _: None, lambda: False).trials for _ in range(2)]
    assert trials[0] == trials[1]


@pytest.mark.slow
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


@pytest.mark.slow
def test_quick_measures_are_those_of_the_whole_result(tmp_path: Path) -> None:
    plan = plan_of(tmp_path, OF_YARD, YARD)
    study = plan.base.study()
    grades = load_catalogue((), False).grades
    quick = Quick(study, promising(study, grades), 300)
    names = ("rope_mass", "max_tension", "diameter", "usable_volume")
    keep = tuple(MEASURES[name].path for name in names)
    result = replace(plan.base, keep=keep).result(study)
    for name in names:
        measure = MEASURES[name]
        assert measure.quick is not None
        assert measure.quick(quick) == pytest.approx(measure.value(result), rel=2e-3), name


def test_requirements_beside_strength_constrain_the_search(tmp_path: Path) -> None:
    """A design that is far too soft is further from holding than one that is a bit too soft."""
    grades = load_catalogue((), False).grades
    far = []
    for stiffness in ("100 kN/m", "1 GN/m"):
        soft = YARD.replace("galvanised]", f"galvanised], limits: {{stiffness: {stiffness}}}")
        plan = plan_of(tmp_path, OF_YARD.replace("100", "20"), soft)
        trial = Examiner(plan, promising(plan.base.study(), grades)).trial((0.0,))
        assert trial.reason == "stiffness in static: fails"
        far.append(trial.violation)
    assert 0.0 < far[0] < far[1] <= 1.0


def test_the_cable_of_a_family_is_held_to_the_floor(tmp_path: Path) -> None:
    study = YARD.replace("  samples: 200", "  floor: 5 m\n  samples: 20").partition("selection")[0]
    plan = plan_of(tmp_path, OF_YARD.replace("rope_mass", "diameter"), study)
    trial = Examiner(plan, ()).trial((0.0,))
    assert trial.reason == "floor in static: fails"
    assert 0.0 < trial.violation < 1.0


class Formula(Examiner):
    """Designs whose value is a formula of the shares of the ranges, which takes no time."""

    def trial(self, values: Values | None) -> Trial:
        shown = self.plan.given if values is None else values
        assert shown is not None
        pairs = zip(self.plan.variables, shown, strict=True)
        shares = np.array([variable.share(value) for variable, value in pairs])
        return Trial(shown, 1.0 + float(((shares - [0.93, 0.5]) ** 2).sum()), 0.0, "")


def test_the_simplex_comes_down_from_an_upper_border(tmp_path: Path) -> None:
    """The first step, of 0.05, from 0.975 across the border would be turned back onto the start."""
    plan = plan_of(tmp_path, OF_POSE.replace("[-4 m, 6 m]", "[-3.9 m, 0.1 m]"))
    assert plan.variables[0].share(0.0) == pytest.approx(0.975, abs=1e-12)
    run = _Run(Formula(plan, ()), lambda _: None, lambda: False)
    run._left = 60
    with suppress(_OverError):
        run._polish()
    assert run._best().value == pytest.approx(1.0, abs=1e-5)


def tried(values: Values) -> Trial:
    """Return a design that is better the further its first variable is to the left."""
    return Trial(values, 8.0 + 0.1 * values[0], 0.0, "")


def verified(folder: Path, holds_from: float, step: float = 0.05) -> Verifier:
    """Verify designs from 0 to 5 m, within -4 to 6 m, of which those far to the right hold."""

    def in_full(trial: Trial) -> float | None:
        return trial.value if trial.values[0] >= holds_from else None

    verifier = Verifier(plan_of(folder), in_full, lambda _: None)
    verifier.verify([tried((step * k, 10.0)) for k in range(round(5.0 / step))], tried)
    return verifier


@pytest.mark.parametrize("holds_from", [0.0, 0.33, 1.23, 4.81])
def test_the_best_that_holds_is_where_the_first_design_holds(
    tmp_path: Path, holds_from: float
) -> None:
    """Not only tried: the way to the last that fails is bisected, to a step of 0.01."""
    found = verified(tmp_path, holds_from)
    assert found.best is not None
    assert found.best.values[0] == pytest.approx(holds_from, abs=0.011)
    assert found.best.values[0] >= holds_from
    assert len(found.verified) <= MOST_VERIFIED
    assert all(trial.values[0] < holds_from for trial in found.failed)


@pytest.mark.parametrize("rank", [0, 1, 3])
def test_one_of_the_first_that_holds_is_found_in_a_handful(tmp_path: Path, rank: int) -> None:
    holds_from = 0.05 * rank - 1e-6

    def in_full(trial: Trial) -> float | None:
        return trial.value if trial.values[0] >= holds_from else None

    verifier = Verifier(plan_of(tmp_path), in_full, lambda _: None, most=10)
    verifier.verify([tried((0.05 * k, 10.0)) for k in range(100)], tried)
    assert verifier.best is not None
    assert verifier.best.values[0] == pytest.approx(0.05 * rank, abs=0.01)
    assert len(verifier.verified) <= 8


def test_a_better_design_among_those_that_fail_is_looked_for(tmp_path: Path) -> None:
    """It lies by itself, 0.3 m wide, where the ranks that are bisected pass it by."""

    def in_full(trial: Trial) -> float | None:
        x = trial.values[0]
        return trial.value if x >= 3.0 or 0.45 <= x <= 0.75 - 1e-9 else None

    verifier = Verifier(plan_of(tmp_path), in_full, lambda _: None)
    verifier.verify([tried((0.05 * k, 10.0)) for k in range(100)], tried)
    assert verifier.best is not None and verifier.best.values[0] < 0.75


def test_what_is_left_when_the_budget_is_used_up_is_counted(tmp_path: Path) -> None:
    verifier = Verifier(plan_of(tmp_path), lambda _: None, lambda _: None, most=8)
    ranked = [tried((0.5 * k - 4.0, 10.0)) for k in range(20)]
    verifier.verify(ranked, tried)
    assert verifier.best is None
    assert len(verifier.verified) == len(verifier.failed) == 4
    assert len(verifier.unverified(ranked)) == 16
