"""The ropes of the answer, as they are loaded where they are used most."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from designer.arrays import FloatArray
from designer.model.cable import Cable, Cables
from designer.model.robot import Poses, Robot
from designer.model.workspace import Workspace
from designer.selection.cases import governing
from designer.statics.inverse import MasslessStatics, Statics, solve_massless, solve_sagging

if TYPE_CHECKING:
    from designer.analysis.analyse import Analysis


@dataclass(frozen=True, eq=False)
class GoverningRopes:
    """The ropes of the answer as they are loaded where they are used most.

    Parameters
    ----------
    robot, cable, workspace
        What is solved.
    name : str
        Of the ropes.
    load_case : str
        Of these loads.
    place : array (n_coordinates,)
        The worst place that is known [m, rad].
    """

    robot: Robot
    cable: Cable | Cables
    workspace: Workspace
    name: str
    load_case: str
    place: FloatArray

    @cached_property
    def worst(self) -> Statics:
        """The equilibrium at the worst place."""
        return self.statics(self.place)

    @cached_property
    def straight(self) -> MasslessStatics:
        """The same with straight weightless cables."""
        return solve_massless(self.robot, Poses.at(self.place))

    def statics(self, place: FloatArray) -> Statics:
        """Return the equilibrium at places (..., n_coordinates)."""
        return solve_sagging(self.robot, Poses.at(place), self.cable)

    def used(self, statics: Statics) -> FloatArray:
        """Return the largest tension over allowable tension of any cable (...)."""
        return np.asarray((statics.cable_tension_N / self.cable.allowable_tension_N).max(axis=-1))


def governing_ropes(analysis: Analysis) -> GoverningRopes | None:
    """Return the ropes of the answer; None where none is chosen.

    Of one rope for all cables in the governing load case, or where that keeps lengths in the worst
    of the others; where all do, in the static load of the study, as ropes for groups of cables.
    """
    study, robot, assignment = analysis.study, analysis.built.robot, analysis.assignment
    if analysis.qualities is None or study.workspace is None or not assignment.is_found:
        return None
    name = analysis.qualities.cable.name
    cases = () if assignment.rope is None else assignment.rope.cases
    of_poses = [case for case in cases if not case.loaded.keeps_lengths]
    if not of_poses:
        verification = assignment.verification
        place = verification.worst_place[verification.most_used]
        return GoverningRopes(robot, assignment.cable, study.workspace, name, "static", place)
    worst = governing(of_poses)
    place, loaded = worst.verification.worst_place, worst.loaded
    return GoverningRopes(loaded.robot, loaded.cable, worst.workspace, name, worst.case.name, place)
