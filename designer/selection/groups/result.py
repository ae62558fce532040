"""What the choice for groups of cables came to."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import ClassVar, Literal

from designer.arrays import FloatArray
from designer.selection.assignment import Assignment
from designer.selection.candidate import Candidate
from designer.spelling import digits
from designer.study import CableGroup

Outcome = Literal["holds", "fails", "not_better"]
Proof = Literal["optimal", "stopped", "infeasible"]
GroupObjective = Literal["mass", "cost"]


@dataclass(frozen=True, slots=True, eq=False)
class TriedAssignment:
    """An assignment that was tried.

    Parameters
    ----------
    products : tuple of Candidate
        Of each group.
    bound : float
        Mass or cost that it cannot fall below: straight cables stretched as far as they may be.
    total : float or None
        The same with the lengths that it needs; None where that was not computed.
    outcome : str
        ``holds``, ``fails``, or ``not_better`` than what was known to hold.
    group : CableGroup or None
        The group that is used most; None where its loads decided nothing.
    utilisation : float or None
        Of that group.
    place : array (n_coordinates,) or None
        Where, see `designer.model.space` [m, rad].
    excluded : int
        How many assignments the cut excludes, the proposal among them.
    guided : bool
        Whether the linearisation had a say in it.
    """

    products: tuple[Candidate, ...] = field(
        metadata={"json": lambda ropes: {"products": [rope.ids for rope in ropes]}}
    )
    bound: float
    total: float | None
    outcome: Outcome
    group: CableGroup | None = field(
        metadata={"json": lambda group: {"group": group and group.name}}
    )
    utilisation: float | None
    place: FloatArray | None = field(metadata={"json": "pose"})
    excluded: int
    guided: bool


@dataclass(frozen=True, slots=True, eq=False)
class GroupChoice:
    """How ropes for groups of cables were sought, and what is proved of the best.

    Parameters
    ----------
    groups : tuple of CableGroup
        The groups.
    most_distinct : int
        How many different products were allowed.
    chosen : Assignment
        The lightest (or cheapest) that holds; without ropes if none was found.
    total : float or None
        What was minimised, of that: mass, or the cost of the lengths that it needs.
    single : Assignment
        The lightest single product for all groups; without ropes where the selection found none.
    objective : str
        ``mass`` or ``cost``.
    unit : str
        Of the objective: ``kg``, or a currency.
    bound : float
        No assignment of what was offered that holds has less of it.
    proof : str
        ``optimal``; ``stopped`` at the limit of proposals; ``infeasible``.
    by_balance : bool
        Whether the balance of poses excluded assignments (`designer.selection.groups.balance`).
    by_weight : bool
        Whether cuts were proved by weight (`designer.selection.groups.blocks`), else by trial.
    lengths_are_bounds : bool
        Whether the bound's lengths cannot be undercut. Not so where poses are left out.
    offered, catalogued : int
        Products that no other one beats, and all of them.
    proposals : tuple of TriedAssignment
        What was tried, in order.
    trials : int
        How many times cables were solved at the witnesses.
    """

    groups: tuple[CableGroup, ...] = field(metadata={"json": None})
    most_distinct: int = field(metadata={"json": "max_distinct_products"})
    chosen: Assignment = field(
        metadata={"json": lambda chosen: {"total_mass_kg": chosen.total_mass_kg}}
    )
    total: float | None
    single: Assignment = field(
        metadata={"json": lambda single: {"single_product_mass_kg": single.total_mass_kg}}
    )
    objective: GroupObjective
    unit: str
    bound: float
    proof: Proof
    by_balance: bool = field(metadata={"json": None})
    by_weight: bool = field(metadata={"json": None})
    lengths_are_bounds: bool = field(metadata={"json": None})
    offered: int
    catalogued: int = field(metadata={"json": None})
    proposals: tuple[TriedAssignment, ...]
    trials: int

    also_in_files: ClassVar = ("bound_kg", "gap", "proof_sentence", "saving_kg")

    @property
    def bound_kg(self) -> float | None:
        """The bound where it is one on the mass [kg]."""
        return self.bound if self.objective == "mass" else None

    @property
    def gap(self) -> float | None:
        """What was minimised over the bound on it, less one; None if nothing was found."""
        return None if self.total is None else self.total / self.bound - 1.0

    @property
    def proof_sentence(self) -> str:
        """What is proved, and on what condition, for the reader of a report."""
        kind = "cheaper" if self.objective == "cost" else "lighter"
        of = f"the {self.offered} products that no other one beats, out of {self.catalogued},"
        if self.proof == "infeasible":
            return f"No assignment of {of} holds the whole workspace."
        if self.proof == "stopped":
            count = len(self.proposals)
            if not self.chosen.is_found:
                return f"Stopped after {count} proposals, none of which holds."
            return (
                f"Stopped after {count} proposals: no assignment of {of} that holds has less than "
                f"{digits(self.bound)} {self.unit}, so one may be {kind} by up to {self.gap:.2%}."
            )
        means = "by poses that the solver showed they cannot hold"
        if self.by_weight:
            means += ", where heavier company of an overloaded cable does not help it"
        if self.by_balance:
            means += ", by the balance of forces in a pose"
        text = (
            f"No assignment of {of} is {kind} and holds. "
            f"All that would be were excluded {means}, or by the lengths that they need."
        )
        if not self.lengths_are_bounds:
            text += (
                " This is for the lengths of the first answer: which poses count, and so how "
                "long a cable must be, depends on the cables themselves."
            )
        return text

    @property
    def saving_kg(self) -> float | None:
        """What the groups save against one product for all cables [kg]."""
        if not (self.chosen.is_found and self.single.is_found):
            return None
        return self.single.total_mass_kg - self.chosen.total_mass_kg
