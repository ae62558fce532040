"""The thinnest member of a continuous family that serves the whole workspace.

Of each grade, beside its sizes (`continuous_optima`). And of the configured family in each load
case, where no rope is to be chosen (`family_needs`): ice and drag do not grow with the section as
weight does, and kept lengths are those of one cable, so loaded cables are no family. One diameter
is tried in all directions of a case, and the thinnest that serves the worst pose in the direction
found there is tried next, until none is worse. As `designer.workspace.section` seeks the section
that needs itself.
"""

from __future__ import annotations

import math
from collections.abc import Generator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from designer.arrays import FloatArray, IntArray
from designer.effects.design import AsBuilt
from designer.errors import DesignerError
from designer.grades.grade import Grade
from designer.model.cable import Cable, Material, MaterialsByPose
from designer.model.load_case import LoadCase
from designer.model.robot import Poses
from designer.model.verdict import Verdict
from designer.model.workspace import Workspace
from designer.progress import Reporter
from designer.selection.cases import CaseResult, Cases, governing, refine_all
from designer.selection.reeving import Allowance
from designer.sizing.newton import size_poses
from designer.study import Study
from designer.workspace.demand import diameter_demand
from designer.workspace.effort import COARSE
from designer.workspace.refine import Worst, worst_over_samples
from designer.workspace.section import (
    FIRST_TRIED_M,
    FamilyAt,
    in_lockstep,
    min_diameter_where,
    thinnest,
)

_MAX_ITERATIONS = 20
"""Of a fixed point, so that it ends: the need falls steeply, so a few reach it."""
_DIAMETER_RTOL = 1e-7
"""Relative change of a grade's diameter at which it is taken to stay: far below what is sold."""
_ROUNDING, _UTILISATION_TOL = 1e-9, 1e-6
"""Relative growth of the diameter that is rounding; beyond a utilisation of 1, how exactly the
thinnest diameter of a pose is found."""


@dataclass(frozen=True, slots=True, eq=False)
class ContinuousOptimum:
    """The thinnest member of a grade's continuous family that holds everywhere."""

    family: Material
    diameter_m: float  #: that member [m]; NaN where none holds, or none that the sheave allows
    verdict: Verdict | None = None  #: of the pose that no member holds; None where there is none


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
    fixed point. The need falls steeply with the diameter: a few iterations reach it, most of them
    at the worst pose alone. With an effect that adds to a cable all figures depend on the diameter,
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
            materials_by_pose = MaterialsByPose(materials, search)
            return diameter_demand(built.robot, materials_by_pose, hangs_below, places, **how)

        known = [worst_places[k] for k in unsettled]
        extremes = worst_over_samples(
            workspace, demand, len(materials), most=COARSE.quick, known=known
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
    for _ in range(_MAX_ITERATIONS):
        family = family_at(diameter)
        worst = yield family
        if not math.isfinite(worst.demand):
            if not np.isfinite(worst.place).all():  # every pose is left out
                return ContinuousOptimum(family, math.nan)
            statics = size_poses(built.robot, Poses.at(worst.place), family).statics
            return ContinuousOptimum(family, math.nan, Verdict(int(statics.verdict)))
        if allowance.sheave_diameter_m is None or _has_converged(worst.demand, diameter):
            return ContinuousOptimum(family, worst.demand)
        # The diameter that this pose needs, as strong as a rope of that diameter.
        diameter = worst.demand
        for _ in range(_MAX_ITERATIONS):
            last, pose = diameter, Poses.at(worst.place)
            diameter = float(size_poses(built.robot, pose, family_at(last)).diameter_m)
            if not math.isfinite(diameter):
                diameter = last
                break
            if _has_converged(diameter, last):
                break
    return ContinuousOptimum(family, diameter)


def _has_converged(diameter_m: float, before_m: float) -> bool:
    return abs(diameter_m / before_m - 1.0) < _DIAMETER_RTOL


@dataclass(frozen=True, slots=True, eq=False)
class CaseNeed:
    """What a load case needs of the configured family."""

    diameter_m: float
    """The thinnest found that holds every pose in every direction [m]; NaN where none does."""
    governing: CaseResult
    """Where the case asks for most of it; where none holds, a cable that fails, and where."""

    @property
    def is_held(self) -> bool:
        """Whether a cable of the family holds the case."""
        return math.isfinite(self.diameter_m)


def governing_need(needs: Sequence[CaseNeed]) -> CaseNeed | None:
    """Return the case that needs the thickest cable, or one that none holds; None of none."""
    return max(needs, key=lambda need: need.diameter_m if need.is_held else math.inf, default=None)


def family_needs(study: Study, built: AsBuilt, reporter: Reporter) -> tuple[CaseNeed, ...]:
    """Return what each load case needs where the study asks for no rope; else none."""
    workspace, needs = study.workspace, []
    if workspace is None or study.selection is not None or not study.load_cases:
        return ()
    with reporter.task("load cases", len(study.load_cases)) as advance:
        for case in study.load_cases:
            needs.append(family_need(built, workspace, study.material, case))
            advance(1)
    return tuple(needs)


def family_need(
    built: AsBuilt, workspace: Workspace, material: Material, case: LoadCase
) -> CaseNeed:
    """Return what a load case needs; ``material`` is the family as its data sheet has it.

    Raises
    ------
    DesignerError
        If the search does not come to an end.
    """
    cases = Cases(built.robot, workspace, (case,))

    def cable(diameter_m: float) -> Cable:
        return built.cable(material.cable(diameter_m))

    def thinnest_of(worst: CaseResult) -> float:
        """Return the thinnest diameter that serves the pose found, in its direction [m]; or NaN."""

        def serves(diameter_m: float) -> bool:
            loaded = worst.loaded.on(worst.loaded.bare[0], cable(diameter_m))
            return worst.tension_N(loaded) <= loaded.cable.allowable_tension_N

        return min_diameter_where(serves)

    section_m, diameter_m = 0.0, FIRST_TRIED_M
    for _ in range(_MAX_ITERATIONS):
        (results,) = cases.sampled([[cable(diameter_m)]], lambda _: None)
        worst = governing(results)
        if worst.verification.holds:
            worst = governing(refine_all(results))
        # Of the first trial the pose counts, whether it holds there or not.
        if section_m > 0.0 and worst.utilisation <= 1.0 + _UTILISATION_TOL:
            return CaseNeed(section_m, worst)
        needed_m = thinnest_of(worst) if np.isfinite(worst.pose.position_m).all() else math.nan
        if math.isnan(needed_m) or needed_m <= section_m * (1.0 + _ROUNDING):
            return CaseNeed(math.nan, worst)
        section_m = diameter_m = needed_m
    raise DesignerError(
        f"no diameter was found that serves the load case '{case.name}': each asks for another one"
    )
