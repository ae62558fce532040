"""Continuous optimum of each grade, snap to a size, verify, next size up until it holds."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from designer.catalogue.grade import Grade, Size
from designer.effects.design import AsBuilt
from designer.robot import Robot
from designer.selection.result import Candidate, GradeOutcome, Outcome, SelectionResult
from designer.selection.verify import verify, worst_of
from designer.study import Selection, Workspace
from designer.workspace.demand import diameter_demand

Progress = Callable[[], None]
"""Called after each grade."""


def select(
    robot: Robot,
    workspace: Workspace,
    selection: Selection,
    grades: Sequence[Grade],
    *,
    built: AsBuilt | None = None,
    progress: Progress = lambda: None,
) -> SelectionResult:
    """Choose the lightest product among the grades that the study allows.

    Parameters
    ----------
    robot, workspace, selection
        The study.
    grades : sequence of Grade
        The whole catalogue; ``selection.grades`` narrows it.
    built : AsBuilt, optional
        By how much cables on this machine differ from their data sheet.
    progress : callable
        Called after each grade.
    """
    allowed = [g for g in grades if selection.grades is None or g.id in selection.grades]
    outcomes = []
    for grade in allowed:
        outcomes.append(try_grade(robot, workspace, grade, selection.safety_factor, built))
        progress()
    fitting = [outcome.best for outcome in outcomes if outcome.best is not None]
    if fitting:
        chosen = min(fitting, key=lambda candidate: candidate.total_mass_kg)
        return SelectionResult(tuple(outcomes), chosen, None)
    others = [g for g in grades if g not in allowed]
    alternatives = [try_grade(robot, workspace, g, selection.safety_factor, built) for g in others]
    return SelectionResult(
        tuple(outcomes),
        None,
        _reason(outcomes),
        tuple(outcome for outcome in alternatives if outcome.outcome == "fits"),
    )


def try_grade(
    robot: Robot,
    workspace: Workspace,
    grade: Grade,
    safety_factor: float,
    built: AsBuilt | None = None,
) -> GradeOutcome:
    """Find the thinnest size of a grade that holds everywhere.

    The sizes of a table scatter about their family, so the size below the snap is tried as well:
    it either proves that the choice is the thinnest, or replaces it.
    """
    built = built or AsBuilt(robot)
    family = built.material(grade.family(safety_factor))
    demand = diameter_demand(robot, family, workspace.hangs_below)
    worst = worst_of(workspace, demand, demand)
    if not np.isfinite(worst.demand):
        return GradeOutcome(grade, family, float("nan"), (), "no_finite_cable")

    def attempt(size: Size) -> Candidate:
        cable = built.cable(grade.cable(size, safety_factor))
        result = verify(robot, workspace, cable)
        mass = cable.linear_density_kg_per_m * float(result.longest_m.sum())
        return Candidate(grade, size, cable, worst.demand, result, mass)

    tried = _around_the_snap(grade.sizes, worst.demand, attempt)
    outcome: Outcome = "fits" if any(c.verified for c in tried) else "too_thin"
    return GradeOutcome(grade, family, worst.demand, tried, outcome)


def _around_the_snap(
    sizes: tuple[Size, ...], diameter_m: float, attempt: Callable[[Size], Candidate]
) -> tuple[Candidate, ...]:
    """Try sizes upward from the one below the optimum, and downward while they hold."""
    above = [k for k, size in enumerate(sizes) if size.diameter_m >= diameter_m]
    first = max((above[0] if above else len(sizes)) - 1, 0)
    tried = [attempt(sizes[first])]
    down, up = first, first
    while tried[0].verified and down > 0:
        down -= 1
        tried.insert(0, attempt(sizes[down]))
    while not tried[-1].verified and up < len(sizes) - 1:
        up += 1
        tried.append(attempt(sizes[up]))
    return tuple(tried)


def _reason(outcomes: Sequence[GradeOutcome]) -> str:
    if not outcomes:
        return "the catalogue has none of the grades that the study names"
    if all(outcome.outcome == "no_finite_cable" for outcome in outcomes):
        return "no section of any grade holds the whole workspace"
    thin = [outcome for outcome in outcomes if outcome.outcome == "too_thin"]
    nearest = min(thin, key=lambda o: o.continuous_diameter_m / o.grade.thickest.diameter_m)
    return f"every grade ends too thin; the nearest is {nearest.grade.id}, which {nearest.sentence}"
