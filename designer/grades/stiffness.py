"""Stiffness of a fibre rope, which sources give over its breaking load, and which grows with it."""

from __future__ import annotations

from bisect import bisect_right
from dataclasses import dataclass
from typing import Literal

Basis = Literal["printed", "computed", "borrowed"]
"""How a figure was got: printed for this grade, computed from others of it, or another rope's."""


@dataclass(frozen=True, slots=True)
class RelativeStiffness:
    """Axial stiffness EA of a worked-in rope over its minimum breaking load.

    A sagging cable is computed with one EA. It is the one at the load that the rope is designed
    for: breaking load over safety factor. Strain at low load, and stretch that does not come
    back, are not in it.

    Parameters
    ----------
    ea_over_breaking_load : tuple of float
        EA / MBL, slope of load fraction over strain; one figure, or one for each load.
    load_fraction : tuple of float
        Loads over MBL at which they hold, ascending; empty where one figure is for all loads.
    basis : str
        ``printed``, ``computed`` or ``borrowed``, as for a modulus.
    source : str
        Where the figures come from; for borrowed ones, the lender.
    uncertainty : float
        Relative half-width of the range the true value may lie in.
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
        where = f" at {loads} of it" if loads else ""
        return f"EA is {ratios} times the breaking load{where}"

    def at(self, load_fraction: float) -> float:
        """Return EA / MBL at a load over MBL: linear between the loads, constant beyond."""
        loads, ratios = self.load_fraction, self.ea_over_breaking_load
        above = bisect_right(loads, load_fraction)
        if above == 0 or above == len(loads):
            return ratios[0] if above == 0 else ratios[-1]
        share = (load_fraction - loads[above - 1]) / (loads[above] - loads[above - 1])
        return ratios[above - 1] + share * (ratios[above] - ratios[above - 1])
