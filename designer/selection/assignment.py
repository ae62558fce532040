"""Which rope goes onto which cable, and what robot that makes.

One rope for all cables, or one for each group; stiffness and clearances follow from them.
"""

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
from designer.selection.candidate import Candidate
from designer.selection.family import CaseNeed
from designer.study import CableGroup
from designer.workspace.clearance import Interference, survey
from designer.workspace.stiffness import StiffnessSurvey, survey_stiffness
from designer.workspace.sweep import HangingCables, WorkspaceMap, survey_hanging


@dataclass(frozen=True, slots=True, eq=False)
class GroupVerification:
    """What given cables meet in the workspace."""

    worst_place: FloatArray  #: (n_groups, n_coordinates), where each group is used most [m, rad]
    utilisation: FloatArray
    """(n_groups,) largest over allowable tension there; inf if a pose cannot be held at all."""
    longest_m: FloatArray  #: (n_cables,) longest unstrained length that each cable has [m]
    shortest_m: FloatArray  #: (n_cables,) shortest; NaN where it was not searched for [m]
    is_refined: bool
    """Whether it was searched between the samples as well; not where a sample already fails."""

    @property
    def holds(self) -> bool:
        """Whether every group stays within its allowable tension everywhere."""
        return self.is_refined and bool((self.utilisation <= 1.0).all())

    @property
    def most_used(self) -> int:
        """Index of the group that is used most."""
        return int(np.argmax(self.utilisation))


@dataclass(frozen=True, slots=True, eq=False)
class Assignment:
    """Ropes on the cables; one rope for all cables is one group of all of them, without a name."""

    groups: tuple[CableGroup, ...]  #: every cable in one of them; empty where no ropes were found
    ropes: tuple[Candidate, ...]  #: of each group
    verification: GroupVerification  #: what they meet together

    @property
    def is_found(self) -> bool:
        """Whether there are ropes."""
        return bool(self.ropes)

    @property
    def has_groups(self) -> bool:
        """Whether the ropes are those of groups that the study names."""
        return any(group.name for group in self.groups)

    @property
    def rope(self) -> Candidate | None:
        """The rope that was chosen for all cables; None where groups have ropes of their own."""
        return None if self.has_groups or not self.ropes else self.ropes[0]

    @property
    def by_cable(self) -> tuple[Candidate, ...]:
        """The rope of each cable, in the order of their numbers."""
        pairs = zip(self.groups, self.ropes, strict=True)
        of_cable = {cable: rope for group, rope in pairs for cable in group.cables}
        return tuple(of_cable[cable] for cable in sorted(of_cable))

    @property
    def cable(self) -> Cable | Cables:
        """The cables as the solver takes them."""
        rope = self.rope
        return Cables(tuple(rope.cable for rope in self.by_cable)) if rope is None else rope.cable

    @property
    def products(self) -> tuple[Candidate, ...]:
        """The different ropes."""
        return tuple(dict.fromkeys(self.ropes))

    @property
    def name(self) -> str:
        """Grade and size of the different ropes."""
        return ", ".join(dict.fromkeys(f"{rope.grade.id} {rope.size.id}" for rope in self.by_cable))

    @property
    def total_mass_kg(self) -> float:
        """Mass of all cables, each at the longest length that it needs [kg]; NaN without ropes."""
        if not self.ropes:
            return np.nan
        rope = self.rope
        if rope is not None:
            return rope.total_mass_kg
        density = np.array([rope.cable.rope_density_kg_per_m for rope in self.by_cable])
        return float(density @ self.verification.longest_m)

    @property
    def max_tension_N(self) -> float:
        """The largest tension that any cable meets [N]."""
        used = zip(self.verification.utilisation, self.ropes, strict=True)
        return max(float(share) * rope.cable.allowable_tension_N for share, rope in used)


_NOTHING = np.empty(0)
NOT_ASSIGNED = Assignment((), (), GroupVerification(_NOTHING, _NOTHING, _NOTHING, _NOTHING, False))
"""Where no ropes were found, or none were asked for."""


def for_all(rope: Candidate | None) -> Assignment:
    """Return one rope on all cables; nothing assigned without one."""
    if rope is None:
        return NOT_ASSIGNED
    worst = rope.verification
    place, utilisation = worst.worst_place[None], np.array([worst.utilisation])
    verification = GroupVerification(
        place, utilisation, worst.longest_m, worst.shortest_m, worst.is_refined
    )
    all_cables = CableGroup("", tuple(range(1, len(worst.longest_m) + 1)))
    return Assignment((all_cables,), (rope,), verification)


@dataclass(frozen=True, slots=True)
class DesignCable:
    """The cables that the design comes to."""

    cable: Cable | Cables  #: as they are on the machine
    name: str  #: what they are, for the reader of a report
    ropes: tuple[Candidate, ...] = ()  #: of each cable; empty where of the configured family

    @property
    def turn_m(self) -> FloatArray:
        """Rope on one turn of the drum that its grade suggests (1 or n_cables,) [m].

        About the centre of the rope, in one layer; NaN where no drum is suggested.
        """
        turns = [rope.grade.drum_turn_m(rope.size) for rope in self.ropes]
        return np.array(turns or [np.nan])


@dataclass(frozen=True, eq=False)
class Qualities:
    """Stiffness and clearances over the workspace, each when it is first read."""

    robot: Robot  #: as built
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
