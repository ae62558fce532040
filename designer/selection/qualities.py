"""What the chosen cables make of the robot: its stiffness, and how clear they keep."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from designer.arrays import FloatArray
from designer.effects.design import AsBuilt
from designer.model.cable import Cable, Cables, Material
from designer.model.robot import Robot
from designer.model.workspace import Workspace
from designer.selection.assignment import Assignment
from designer.selection.candidate import Candidate
from designer.selection.family_need import CaseNeed
from designer.workspace.clearance import Interference, survey
from designer.workspace.stiffness import StiffnessSurvey, survey_stiffness
from designer.workspace.sweep import HangingCables, WorkspaceMap, survey_hanging


@dataclass(frozen=True, slots=True)
class DesignCable:
    """The cables that the design comes to.

    Parameters
    ----------
    cable : Cable or Cables
        As they are on the machine.
    name : str
        What they are, for the reader of a report.
    ropes : tuple of Candidate
        Each cable's; empty where they are of the configured family.
    """

    cable: Cable | Cables
    name: str
    ropes: tuple[Candidate, ...] = ()

    @property
    def turn_m(self) -> FloatArray:
        """Rope on one turn of the drum that its grade suggests (1 or n_cables,) [m].

        About the centre of the rope, in one layer; NaN where no drum is suggested.
        """
        turns = [rope.grade.drum_turn_m(rope.size) for rope in self.ropes]
        return np.array(turns or [np.nan])


@dataclass(frozen=True, eq=False)
class Qualities:
    """Stiffness and clearances over the workspace, each when it is first read.

    Parameters
    ----------
    robot, workspace : Robot, Workspace
        As built, and where it goes.
    cable : DesignCable
        With which cables.
    """

    robot: Robot
    workspace: Workspace
    cable: DesignCable

    @cached_property
    def stiffness(self) -> StiffnessSurvey | None:
        """None if no sample is held stably."""
        return survey_stiffness(self.robot, self.workspace, self.cable.cable)

    @cached_property
    def interference(self) -> Interference | None:
        """None if the study asks for no clearance."""
        clearance_m = self.workspace.clearance_m
        if clearance_m is None:
            return None
        return survey(self.robot, self.workspace, self.cable.cable, clearance_m)

    @cached_property
    def hanging(self) -> HangingCables:
        """Cables far longer than their chord, or below the floor."""
        return survey_hanging(self.robot, self.workspace, self.cable.cable)


def design_cable(
    family_map: WorkspaceMap,
    assignment: Assignment,
    family: Material,
    needs: Sequence[CaseNeed],
) -> DesignCable | None:
    """Return the ropes that were found, else the thinnest cable of the family.

    None where no cable holds everywhere. ``needs`` is what load cases need of the family.
    """
    if assignment.is_found:
        return DesignCable(assignment.cable, assignment.name, assignment.by_cable)
    diameter_m = np.nan if family_map.sagging is None else family_map.sagging.diameter_m
    if needs:
        diameter_m = float(np.max([need.diameter_m for need in needs]))
    if np.isnan(diameter_m):
        return None
    name = f"{1e3 * diameter_m:.1f} mm of the configured family"
    return DesignCable(family.cable(diameter_m), name)


def qualities_of(
    workspace: Workspace,
    family_map: WorkspaceMap,
    assignment: Assignment,
    built: AsBuilt,
    material: Material,
    needs: Sequence[CaseNeed],
) -> Qualities | None:
    """Return what the cables of the design make of it; None where no cable holds everywhere.

    ``needs`` is what load cases need of the configured family.
    """
    cable = design_cable(family_map, assignment, built.material(material), needs)
    return None if cable is None else Qualities(built.robot, workspace, cable)
