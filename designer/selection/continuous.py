"""The thinnest member of a grade's continuous family that serves the whole workspace."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from designer.arrays import FloatArray
from designer.effects.design import AsBuilt
from designer.grades.grade import Grade
from designer.model.cable import Material
from designer.model.robot import Poses
from designer.model.verdict import Verdict
from designer.model.workspace import Workspace
from designer.selection.efficiency import Allowance
from designer.sizing.newton import size_poses
from designer.workspace.demand import diameter_demand
from designer.workspace.refine import Worst, worst_over_samples
from designer.workspace.section import FamilyAt, thinnest

_MOST_TURNS = 20
"""Of the fixed point, so that it ends: the need falls steeply, so a few turns reach it."""
_STILL = 1e-7
"""Relative change of the diameter at which it is taken to stay: far below what can be bought."""


@dataclass(frozen=True, slots=True, eq=False)
class ContinuousOptimum:
    """The thinnest member of a grade's continuous family that holds everywhere.

    Parameters
    ----------
    family : Material
        The family.
    diameter_m : float
        That member [m]; NaN where no member holds, or none that the sheave allows.
    verdict : Verdict or None
        Of the pose that no member holds; None where there is none.
    """

    family: Material
    diameter_m: float
    verdict: Verdict | None = None


def continuous_optimum(
    workspace: Workspace,
    grade: Grade,
    allowance: Allowance,
    built: AsBuilt,
    *,
    doubtful: Sequence[FloatArray],
) -> ContinuousOptimum:
    """Return the thinnest member of a grade's family that holds everywhere.

    With a sheave the strength of the family depends on the diameter, so the thinnest member is a
    fixed point. The need falls steeply with the diameter: a few turns reach it, most of them at
    the worst pose alone. With an effect that adds to a cable all figures depend on the diameter,
    and its member is sought as in `designer.workspace.section`. ``doubtful`` are places
    (n, n_coordinates) of the workspace at which members may fail: they are tried first.
    """
    built = built.of_products
    unbent = replace(allowance, sheave_diameter_m=None)

    def family_at(diameter_m: float) -> Material:
        is_allowed = not math.isnan(allowance.efficiency(grade, diameter_m))
        family = (allowance if is_allowed else unbent).family(grade, diameter_m)
        return built.material(family, diameter_m)

    def worst_with(family: Material) -> Worst:
        demand_with = partial(diameter_demand, built.robot, family, workspace.hangs_below)
        for places in doubtful:
            if np.isposinf(demand_with()(places)).any():
                return Worst(places[0], math.inf)
        (worst,) = worst_over_samples(workspace, demand_with)
        # Where every pose is left out, nothing is served.
        return Worst(worst.place, math.inf) if worst.demand == -math.inf else worst

    if built.is_family(unbent.family(grade, grade.thickest.diameter_m)):
        best = _member(grade, allowance, built, family_at, worst_with)
    else:
        diameter = thinnest(built.robot, family_at, worst_with)
        shown_m = diameter if math.isfinite(diameter) else grade.thickest.diameter_m
        best = ContinuousOptimum(family_at(shown_m), diameter)
    is_allowed = not math.isnan(allowance.efficiency(grade, best.diameter_m))
    return best if is_allowed else replace(best, diameter_m=math.nan)


def _member(
    grade: Grade,
    allowance: Allowance,
    built: AsBuilt,
    family_at: FamilyAt,
    worst_with: Callable[[Material], Worst],
) -> ContinuousOptimum:
    diameter = grade.sizes[0].diameter_m
    for _ in range(_MOST_TURNS):
        family = family_at(diameter)
        worst = worst_with(family)
        if not math.isfinite(worst.demand):
            return ContinuousOptimum(family, math.nan, _verdict_at(built, family, worst.place))
        if allowance.sheave_diameter_m is None or _is_still(worst.demand, diameter):
            return ContinuousOptimum(family, worst.demand)
        # The diameter that this pose needs, as strong as a rope of that diameter.
        diameter = worst.demand
        for _ in range(_MOST_TURNS):
            last, pose = diameter, Poses.at(worst.place)
            diameter = float(size_poses(built.robot, pose, family_at(last)).diameter_m)
            if not math.isfinite(diameter):
                diameter = last
                break
            if _is_still(diameter, last):
                break
    return ContinuousOptimum(family, diameter)


def _verdict_at(built: AsBuilt, family: Material, place: FloatArray) -> Verdict | None:
    """Return what became of a pose that no member holds; None where every pose is left out."""
    if not np.isfinite(place).all():
        return None
    return Verdict(int(size_poses(built.robot, Poses.at(place), family).statics.verdict))


def _is_still(diameter_m: float, before_m: float) -> bool:
    return abs(diameter_m / before_m - 1.0) < _STILL
