"""The thinnest member of a grade's continuous family that serves the whole workspace."""

from __future__ import annotations

import math
from collections.abc import Generator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from designer.arrays import FloatArray, IntArray
from designer.effects.design import AsBuilt
from designer.grades.grade import Grade
from designer.model.cable import Material, MaterialsByPose
from designer.model.robot import Poses
from designer.model.verdict import Verdict
from designer.model.workspace import Workspace
from designer.selection.cases import FEW_OF_QUICK
from designer.selection.reeving import Allowance
from designer.sizing.newton import size_poses
from designer.workspace.demand import diameter_demand
from designer.workspace.refine import Worst, worst_over_samples
from designer.workspace.section import FamilyAt, in_lockstep, thinnest

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


_Search = Generator[Material, Worst, ContinuousOptimum]
"""Yields a family, is sent the worst pose for it, and returns the optimum in the end."""


def continuous_optima(
    workspace: Workspace,
    grades: Sequence[Grade],
    allowance: Allowance,
    built: AsBuilt,
    worst_places: Sequence[FloatArray],
) -> list[ContinuousOptimum]:
    """Return of each grade the thinnest member of its family that holds everywhere.

    With a sheave the strength of the family depends on the diameter, so the thinnest member is a
    fixed point. The need falls steeply with the diameter: a few turns reach it, most of them at
    the worst pose alone. With an effect that adds to a cable all figures depend on the diameter,
    and its member is sought as in `designer.workspace.section`. ``worst_places`` (n, n_coordinates)
    are, of each grade, where its sizes are used most: the first is tried before all else, and the
    search starts there and from the worst of some samples.

    The worst poses of all families are sought in one batch.
    """
    built, hangs_below = built.of_products, workspace.hangs_below

    def worsts_of(families: Mapping[int, Material]) -> Mapping[int, Worst]:
        worsts = {}
        for k, family in families.items():
            first = worst_places[k][:1]
            if np.isposinf(diameter_demand(built.robot, family, hangs_below, first)).any():
                worsts[k] = Worst(first[0], math.inf)
        unsettled = [k for k in families if k not in worsts]
        materials = [families[k] for k in unsettled]

        def demand(places: FloatArray, search: IntArray, **how: bool) -> FloatArray:
            each = MaterialsByPose(materials, search)
            return diameter_demand(built.robot, each, hangs_below, places, **how)

        known = [worst_places[k] for k in unsettled]
        extremes = worst_over_samples(
            workspace, demand, len(materials), most=FEW_OF_QUICK, known=known
        )
        for k, (worst,) in zip(unsettled, extremes, strict=True):
            # Where every pose is left out, nothing is served.
            left_out = worst.demand == -math.inf
            worsts[k] = Worst(worst.place, math.inf) if left_out else worst
        return worsts

    return in_lockstep([_optimum(grade, allowance, built) for grade in grades], worsts_of)


def _optimum(grade: Grade, allowance: Allowance, built: AsBuilt) -> _Search:
    unbent = replace(allowance, sheave_diameter_m=None)

    def family_at(diameter_m: float) -> Material:
        is_allowed = not math.isnan(allowance.efficiency(grade, diameter_m))
        family = (allowance if is_allowed else unbent).family(grade, diameter_m)
        return built.material(family, diameter_m)

    if built.is_family(unbent.family(grade, grade.thickest.diameter_m)):
        best = yield from _member(grade, allowance, built, family_at)
    else:
        diameter = yield from thinnest(built.robot, family_at)
        shown_m = diameter if math.isfinite(diameter) else grade.thickest.diameter_m
        best = ContinuousOptimum(family_at(shown_m), diameter)
    is_allowed = not math.isnan(allowance.efficiency(grade, best.diameter_m))
    return best if is_allowed else replace(best, diameter_m=math.nan)


def _member(grade: Grade, allowance: Allowance, built: AsBuilt, family_at: FamilyAt) -> _Search:
    diameter = grade.sizes[0].diameter_m
    for _ in range(_MOST_TURNS):
        family = family_at(diameter)
        worst = yield family
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
