"""Which rope goes onto which cable: one for all of them, or one for each group."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from designer.arrays import FloatArray
from designer.model.cable import Cable, Cables
from designer.selection.candidate import Candidate
from designer.study import CableGroup


@dataclass(frozen=True, slots=True, eq=False)
class GroupVerification:
    """What given cables meet in the workspace.

    Parameters
    ----------
    worst_place : array (n_groups, n_coordinates)
        Places where each group is used most [m, rad].
    utilisation : array (n_groups,)
        Largest over allowable tension there; inf if a pose cannot be held at all.
    longest_m, shortest_m : array (n_cables,)
        Longest and shortest unstrained length that each cable has [m]; the latter NaN where it was
        not searched for.
    is_refined : bool
        Whether the worst poses were searched for between the samples as well. Where a sample
        already fails, they were not.
    """

    worst_place: FloatArray
    utilisation: FloatArray
    longest_m: FloatArray
    shortest_m: FloatArray
    is_refined: bool

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
    """Ropes on the cables; one rope for all cables is one group of all of them, without a name.

    Parameters
    ----------
    groups : tuple of CableGroup
        The groups, every cable in one of them; empty where no ropes were found.
    ropes : tuple of Candidate
        The rope of each group.
    verification : GroupVerification
        What they meet together.
    """

    groups: tuple[CableGroup, ...]
    ropes: tuple[Candidate, ...]
    verification: GroupVerification

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
    met = rope.verification
    every = CableGroup("", tuple(range(1, len(met.longest_m) + 1)))
    verification = GroupVerification(
        met.worst_place[None],
        np.array([met.utilisation]),
        met.longest_m,
        met.shortest_m,
        met.is_refined,
    )
    return Assignment((every,), (rope,), verification)
