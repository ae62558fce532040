"""Which diameter of the configured family each load case needs, where no rope is to be chosen.

Ice and drag do not grow with the section as weight does, and kept lengths are those of one cable:
loaded cables are no family. So one diameter is tried in all directions of a case, and the thinnest
that serves the worst pose in the direction found there is tried next, until none is worse. As
`designer.workspace.section` seeks the section that needs itself.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from designer.effects.design import AsBuilt
from designer.errors import DesignerError
from designer.model.cable import Cable, Material
from designer.model.load_case import LoadCase
from designer.model.workspace import Workspace
from designer.progress import Reporter
from designer.selection.cases import CaseResult, Cases, governing, refine_all
from designer.study import Study
from designer.workspace.section import FIRST_TRIED_M, thinnest_that

_STILL = 1e-9
"""Relative growth of the diameter that is rounding: the search is at its end."""
_SAME = 1e-6
"""Beyond a utilisation of 1: how exactly the thinnest diameter of a pose is found."""
_MOST_TURNS = 20
"""Of trial and search, so that it ends where each pose asks for another diameter."""


@dataclass(frozen=True, slots=True, eq=False)
class CaseNeed:
    """What a load case needs of the configured family.

    Parameters
    ----------
    diameter_m : float
        The thinnest diameter found that holds every pose in every direction of the case [m]; NaN
        where none does.
    governing : CaseResult
        What it meets where the case asks for most; where none holds, a cable that fails, and where.
    """

    diameter_m: float
    governing: CaseResult

    @property
    def is_held(self) -> bool:
        """Whether a cable of the family holds the case."""
        return math.isfinite(self.diameter_m)


def most_needed(needs: Sequence[CaseNeed]) -> CaseNeed | None:
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

    section_m, diameter_m = 0.0, FIRST_TRIED_M
    for _ in range(_MOST_TURNS):
        (results,) = cases.sampled([[cable(diameter_m)]], lambda _: None)
        worst = governing(results)
        if worst.verification.holds:
            worst = governing(refine_all(results))
        # Of the first trial the pose counts, whether it holds there or not.
        if section_m > 0.0 and worst.utilisation <= 1.0 + _SAME:
            return CaseNeed(section_m, worst)
        needed_m = _thinnest(worst, cable)
        if math.isnan(needed_m) or needed_m <= section_m * (1.0 + _STILL):
            return CaseNeed(math.nan, worst)
        section_m = diameter_m = needed_m
    raise DesignerError(
        f"no diameter was found that serves the load case '{case.name}': each asks for another one"
    )


def _thinnest(worst: CaseResult, cable: Callable[[float], Cable]) -> float:
    """Return the thinnest diameter that serves the pose found, in its direction [m]; or NaN."""
    robot = worst.loaded.bare[0]
    if not np.isfinite(worst.pose.position_m).all():  # every pose is left out
        return math.nan

    def serves(diameter_m: float) -> bool:
        loaded = worst.loaded.on(robot, cable(diameter_m))
        return worst.tension_N(loaded) <= loaded.cable.allowable_tension_N

    return thinnest_that(serves)
