"""The section that serves where the effects on a cable are not the same for all sections.

Sizing takes cables of one family: mass, stiffness and strength all grow with the section. An
effect that adds to a cable leaves no family. It is applied to one section then, and that section
sought which needs itself: the thinnest d with

    need(pose, figures of d) <= d.

Poses that need less are sized with the figures of that section, too, which are too light for
them; the worst pose, and that its cable serves all others, is right.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Generator, Mapping, Sequence
from typing import TypeVar

import numpy as np

from designer.effects.design import AsBuilt
from designer.errors import DesignerError
from designer.model.cable import Material
from designer.model.robot import Poses, Robot
from designer.model.workspace import Workspace
from designer.sizing.newton import size_poses
from designer.workspace.refine import Worst
from designer.workspace.sweep import map_workspace

Yielded = TypeVar("Yielded")
Sent = TypeVar("Sent")
Returned = TypeVar("Returned")
FamilyAt = Callable[[float], Material]
"""From a diameter [m] to the family whose member of that diameter is right."""
_THICKEST_M = 1.0
_DIAMETERS_M = np.geomspace(1e-4, _THICKEST_M, 81)
"""Where to look for the first section that serves itself; the next one is 12 % thicker."""
FIRST_TRIED_M = float(_DIAMETERS_M[_DIAMETERS_M.size // 2])
"""The middle of these."""
_RTOL = 1e-9
_MAX_ITERATIONS = 20


def min_diameter_where(serves: Callable[[float], bool]) -> float:
    """Return the thinnest diameter that serves [m]; NaN where none does that a cable can have."""
    at = next((k for k, d in enumerate(_DIAMETERS_M.tolist()) if serves(d)), None)
    if at is None:
        return math.nan
    thin, thick = float(_DIAMETERS_M[max(at - 1, 0)]), float(_DIAMETERS_M[at])
    while thick / thin > 1.0 + _RTOL:
        middle = math.sqrt(thin * thick)
        thin, thick = (thin, middle) if serves(middle) else (middle, thick)
    return thick


def section_at(robot: Robot, pose: Poses, family_at: FamilyAt) -> float:
    """Return the thinnest diameter that serves one pose with its own figures [m].

    NaN where none does that a cable can have.
    """
    return min_diameter_where(
        lambda d: float(size_poses(robot, pose, family_at(d)).diameter_m) <= d
    )


def thinnest(robot: Robot, family_at: FamilyAt) -> Generator[Material, Worst, float]:
    """Return the thinnest diameter that serves all poses with its own figures [m].

    The worst pose at one section tells the next section, until no pose asks for more. NaN where a
    pose cannot be served. Yields a family, and is sent the pose that needs the thickest member of
    it and that diameter [m], inf where no member serves it.

    Raises
    ------
    DesignerError
        If that does not come to an end.
    """
    section, trial = 0.0, FIRST_TRIED_M
    for _ in range(_MAX_ITERATIONS):
        worst = yield family_at(trial)
        if not np.isfinite(worst.place).all():  # every pose is left out
            return math.nan
        if worst.demand <= section * (1.0 + _RTOL):
            return section
        needed = section_at(robot, Poses.at(worst.place), family_at)
        if math.isnan(needed) or needed <= section:
            return math.nan  # not even with what serves it alone
        section = trial = needed
    raise DesignerError(
        "the declared effects differ so much between sections that none was found which serves "
        "the workspace with its own figures"
    )


def in_lockstep(
    searches: Sequence[Generator[Yielded, Sent, Returned]],
    answer_all: Callable[[Mapping[int, Yielded]], Mapping[int, Sent]],
) -> list[Returned]:
    """Return the results of searches that yield questions and are sent the answers.

    ``answer_all`` answers, at once, all searches that have not ended, by their numbers.
    """
    results: dict[int, Returned] = {}
    questions = {k: next(search) for k, search in enumerate(searches)}
    while questions:
        answers, questions = answer_all(questions), {}
        for k, answer in answers.items():
            try:
                questions[k] = searches[k].send(answer)
            except StopIteration as end:
                results[k] = end.value
    return [results[k] for k in range(len(searches))]


def section_of_pose(built: AsBuilt, pose: Poses, material: Material) -> float | None:
    """Return the section for one pose [m]; None where the effects leave the family one.

    Where no section serves, the thickest that was tried.
    """
    if built.is_family(material):
        return None
    section = section_at(built.robot, pose, lambda d: built.material(material, d))
    return _THICKEST_M if math.isnan(section) else section


def section_of_workspace(built: AsBuilt, workspace: Workspace, material: Material) -> float | None:
    """Return the section for a whole workspace [m], as for one pose."""
    if built.is_family(material):
        return None

    def worst_of(family: Material) -> Worst:
        workspace_map = map_workspace(built.robot, workspace, family, with_massless=False)
        if workspace_map.sagging is not None:
            return Worst(workspace_map.sagging.place, workspace_map.sagging.diameter_m)
        pose = workspace_map.infeasible_pose
        return Worst(np.full(6, np.nan) if pose is None else pose.place, math.inf)

    def worsts_of(families: Mapping[int, Material]) -> Mapping[int, Worst]:
        return {k: worst_of(family) for k, family in families.items()}

    search = thinnest(built.robot, lambda d: built.material(material, d))
    (section_m,) = in_lockstep([search], worsts_of)
    return _THICKEST_M if math.isnan(section_m) else section_m
