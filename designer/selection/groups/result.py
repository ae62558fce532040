"""What the choice for groups of cables came to."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from designer.arrays import FloatArray
from designer.selection.groups.trials import GroupVerification
from designer.selection.products import Product
from designer.study import CableGroup

Outcome = Literal["holds", "fails", "not_better"]
Proof = Literal["optimal", "stopped", "infeasible"]
GroupObjective = Literal["mass", "cost"]


@dataclass(frozen=True, slots=True, eq=False)
class Proposal:
    """An assignment that was tried."""

    products: tuple[Product, ...]  # Of each group
    # Mass or cost that it cannot fall below: straight cables stretched as far as they may be
    bound: float
    total: float | None  # The same with the lengths that it needs; None where that was not computed
    outcome: Outcome  # `holds`, `fails`, or `not_better` than what was known to hold
    group: int | None  # The group that is used most; None where its loads decided nothing
    utilisation: float | None  # Of that group
    place: FloatArray | None  # (n_coordinates,): Where, see `designer.model.space` [m, rad]
    excluded: int  # How many assignments the cut excludes, the proposal among them
    guided: bool  # Whether the linearisation had a say in it


@dataclass(frozen=True, slots=True, eq=False)
class Assigned:
    """An assignment that holds everywhere."""

    products: tuple[Product, ...]  # Of each group
    verification: GroupVerification
    total_mass_kg: float  # Mass of all cables, each at the longest length that it needs [kg]
    total: float  # What was minimised: that mass, or the cost of these lengths


@dataclass(frozen=True, slots=True, eq=False)
class GroupChoice:
    """The choice for groups, and what is proved of it."""

    groups: tuple[CableGroup, ...]
    most_distinct: int  # How many different products were allowed
    # The lightest (or cheapest) assignment that holds; None if none was found
    chosen: Assigned | None
    # The lightest single product for all cables, where the selection found one
    single: Assigned | None
    objective: GroupObjective  # `mass` or `cost`
    unit: str  # Of the objective: `kg`, or a currency
    bound: float  # No assignment of what was offered that holds has less of it
    proof: Proof  # `optimal`; `stopped` at the limit of proposals; `infeasible`
    # Whether the balance of poses excluded assignments (`designer.selection.groups.balance`)
    by_balance: bool
    # Whether cuts were proved by weight (`designer.selection.groups.blocks`), else by trial
    by_weight: bool
    # Whether the bound's lengths cannot be undercut. Not so where poses are left out.
    lengths_are_bounds: bool
    # Products that no other one beats, and all of them
    offered: int
    catalogued: int
    proposals: tuple[Proposal, ...]  # What was tried, in order
    trials: int  # How many times cables were solved at the witnesses

    @property
    def gap(self) -> float | None:
        """What was minimised over the bound on it, less one; None if nothing was found."""
        return None if self.chosen is None else self.chosen.total / self.bound - 1.0

    @property
    def proof_sentence(self) -> str:
        """What is proved, and on what condition, for the reader of a report."""
        kind = "cheaper" if self.objective == "cost" else "lighter"
        of = f"the {self.offered} products that no other one beats, out of {self.catalogued},"
        if self.proof == "infeasible":
            return f"No assignment of {of} holds the whole workspace."
        if self.proof == "stopped":
            count = len(self.proposals)
            if self.chosen is None:
                return f"Stopped after {count} proposals, none of which holds."
            return (
                f"Stopped after {count} proposals: no assignment of {of} that holds has less than "
                f"{self.bound:.4g} {self.unit}, so one may be {kind} by up to {self.gap:.2%}."
            )
        return f"No assignment of {of} is {kind} and holds. {self._grounds}"

    @property
    def _grounds(self) -> str:
        means = "by poses that the solver showed they cannot hold"
        if self.by_weight:
            means += ", where heavier company of an overloaded cable does not help it"
        if self.by_balance:
            means += ", by the balance of forces in a pose"
        text = f"All that would be were excluded {means}, or by the lengths that they need."
        if self.lengths_are_bounds:
            return text
        return (
            f"{text} This is for the lengths of the first answer: which poses count, and so how "
            "long a cable must be, depends on the cables themselves."
        )

    @property
    def saving_kg(self) -> float | None:
        """What the groups save against one product for all cables [kg]."""
        if self.chosen is None or self.single is None:
            return None
        return self.single.total_mass_kg - self.chosen.total_mass_kg
