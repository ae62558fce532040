"""What the chosen cables make of the robot: its stiffness, and how clear they keep."""

from __future__ import annotations

from dataclasses import dataclass, field

from designer.effects.design import AsBuilt
from designer.model.cable import Cable, Cables, Material
from designer.selection.groups.result import GroupChoice
from designer.selection.result import SelectionResult
from designer.study import Workspace
from designer.workspace.hanging import HangingCables, survey_hanging
from designer.workspace.interference import Interference, survey
from designer.workspace.result import WorkspaceMap
from designer.workspace.stiffness import StiffnessSurvey, survey_stiffness


@dataclass(frozen=True, slots=True)
class DesignCable:
    """The cables that the design comes to.

    Parameters
    ----------
    cable : Cable or Cables
        As they are on the machine.
    name : str
        What they are, for the reader of a report.
    """

    cable: Cable | Cables
    name: str


@dataclass(frozen=True, slots=True, eq=False)
class Qualities:
    """Stiffness and clearances over the workspace.

    Parameters
    ----------
    cable : DesignCable
        With which cables.
    stiffness : StiffnessSurvey or None
        None if no sample is held stably.
    interference : Interference or None
        None if the study asks for no clearance.
    hanging : HangingCables
        Cables far longer than their chord, or below the floor.
    """

    cable: DesignCable
    stiffness: StiffnessSurvey | None
    interference: Interference | None
    hanging: HangingCables = field(default_factory=HangingCables)


def design_cable(
    found: WorkspaceMap,
    selection: SelectionResult | None,
    groups: GroupChoice | None,
    family: Material,
) -> DesignCable | None:
    """Return the cables of the groups, else the chosen product, else the thinnest of the family.

    None where no cable holds everywhere.
    """
    if groups is not None and groups.chosen is not None:
        of_cable = {
            cable: product
            for group, product in zip(groups.groups, groups.chosen.products, strict=True)
            for cable in group.cables
        }
        products = [of_cable[cable] for cable in sorted(of_cable)]
        names = dict.fromkeys(f"{one.grade.id} {one.size.id}" for one in products)
        return DesignCable(Cables(tuple(one.cable for one in products)), ", ".join(names))
    if selection is not None and selection.chosen is not None:
        chosen = selection.chosen
        return DesignCable(chosen.cable, f"{chosen.grade.id} {chosen.size.id}")
    if found.sagging is None:
        return None
    diameter_m = found.sagging.diameter_m
    name = f"{1e3 * diameter_m:.1f} mm of the configured family"
    return DesignCable(family.cable(diameter_m), name)


def qualities_of(
    workspace: Workspace,
    found: WorkspaceMap,
    selection: SelectionResult | None,
    groups: GroupChoice | None,
    built: AsBuilt,
    material: Material,
) -> Qualities | None:
    """Survey the workspace with the cables of the design; None where no cable holds everywhere."""
    cable = design_cable(found, selection, groups, built.material(material))
    if cable is None:
        return None
    interference = None
    if workspace.clearance_m is not None:
        interference = survey(built.robot, workspace, cable.cable, workspace.clearance_m)
    stiffness = survey_stiffness(built.robot, workspace, cable.cable)
    hanging = survey_hanging(built.robot, workspace, cable.cable)
    return Qualities(cable, stiffness, interference, hanging)
