"""Stiffness of a fibre rope, which sources give over its breaking load, and which grows with it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Self

from pydantic import Field, model_validator

from designer.documents.fields import list_of, refusal
from designer.documents.section import Section
from designer.grades.parts import (
    Basis,
    LoadFraction,
    Origin,
    OverBreakingLoad,
    StatedBasis,
    Uncertainty,
)
from designer.model.cable import Stiffening


@dataclass(frozen=True, slots=True)
class RelativeStiffness:
    """Axial stiffness EA of a worked-in rope over its minimum breaking load.

    A sagging cable is computed with one EA. It is the one at the largest tension that the rope
    meets in a load case, see `designer.selection.stiffening`; of a continuous family the one at
    its allowable tension, which its thinnest member meets. Strain at low load, and stretch that
    does not come back, are not in it.

    Parameters
    ----------
    ea_over_breaking_load : tuple of float
        EA / MBL, slope of load fraction over strain; one figure, or one for each load.
    load_fraction : tuple of float
        Loads over MBL at which they hold, ascending; empty where one figure is for all loads.
    basis, source, uncertainty
        As for a `designer.grades.parts.Modulus`.
    """

    ea_over_breaking_load: tuple[float, ...]
    load_fraction: tuple[float, ...]
    basis: Basis
    source: str
    uncertainty: float

    @property
    def figure(self) -> str:
        """The stiffness in words."""
        ratios = ", ".join(f"{ratio:.4g}" for ratio in self.ea_over_breaking_load)
        loads = ", ".join(f"{load:.4g}" for load in self.load_fraction)
        at_loads = f" at {loads} of it" if loads else ""
        return f"EA is {ratios} times the breaking load{at_loads}"

    @property
    def stiffening(self) -> Stiffening | None:
        """EA over the load, both over the breaking load; None where one figure is for all loads."""
        if len(self.load_fraction) < 2:
            return None
        return Stiffening(self.load_fraction, self.ea_over_breaking_load)

    def at(self, load_fraction: float) -> float:
        """Return EA / MBL at a load over MBL: linear between the loads, constant beyond."""
        law = self.stiffening
        return self.ea_over_breaking_load[0] if law is None else law.at(load_fraction)


class StiffnessSection(Section):
    """A relative stiffness as a file has it: one figure, or a table by load fraction."""

    ea_over_breaking_load: OverBreakingLoad | None = None
    at_load_fraction: LoadFraction | None = None
    by_load_fraction: (
        Annotated[
            tuple[
                Annotated[
                    tuple[LoadFraction, OverBreakingLoad],
                    list_of(2, 2, "[load fraction, EA over breaking load]"),
                ],
                ...,
            ],
            list_of(2, 20, "a list of [load fraction, EA over breaking load]"),
        ]
        | None
    ) = None
    basis: StatedBasis
    source: Origin
    uncertainty: Uncertainty = Field(description="a fraction such as 0.3")

    @model_validator(mode="after")
    def _is_one_figure_or_a_table(self) -> Self:
        if (self.ea_over_breaking_load is None) == (self.by_load_fraction is None):
            expected = "ea_over_breaking_load or by_load_fraction"
            raise refusal("needs one figure or a table", expected)
        if self.by_load_fraction is not None and self.at_load_fraction is not None:
            raise refusal("a table has its loads in it", "no at_load_fraction")
        return self

    def value(self) -> RelativeStiffness:
        """Return the stiffness."""
        if self.by_load_fraction is not None:
            loads, ratios = zip(*self.by_load_fraction, strict=True)
        else:
            assert self.ea_over_breaking_load is not None  # see above
            ratios = (self.ea_over_breaking_load,)
            loads = () if self.at_load_fraction is None else (self.at_load_fraction,)
        return RelativeStiffness(ratios, loads, self.basis, self.source, self.uncertainty)
