"""How surely the inputs of a study are known: a distribution for each that is not certain."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated, Literal, get_args

import numpy as np

from designer import checked
from designer.arrays import FloatArray

Input = Literal["payload", "modulus", "linear_mass", "breaking_load", "exit_points"]
INPUTS: tuple[Input, ...] = get_args(Input)
MAX_DEVIATION = 0.2
"""Largest relative standard deviation: beyond it, a normal quantity may come near zero."""
LEAST_DEVIATION = -0.9
"""Lower end of a uniform relative deviation: a quantity keeps a tenth at least."""


@checked.reports_field
@dataclass(frozen=True, slots=True)
class Normal(checked.Value):
    """A deviation that is normally distributed about zero."""

    standard_deviation: checked.NotNegative

    @property
    def is_certain(self) -> bool:
        """Whether there is no deviation."""
        return self.standard_deviation == 0.0

    def at(self, shares: FloatArray) -> FloatArray:
        """Return the deviations below which these shares of all lie."""
        from scipy.special import ndtri

        return np.asarray(self.standard_deviation * ndtri(shares))


@checked.reports_field
@dataclass(frozen=True, slots=True)
class Uniform:
    """A deviation that is as likely anywhere between two ends."""

    low: checked.Finite
    high: checked.Finite

    def __post_init__(self) -> None:
        checked.check_fields(self)
        checked.Number(least=self.low).require("high", self.high)

    @property
    def is_certain(self) -> bool:
        """Whether there is no deviation."""
        return self.low == self.high == 0.0

    def at(self, shares: FloatArray) -> FloatArray:
        """Return the deviations below which these shares of all lie."""
        return np.asarray(self.low + (self.high - self.low) * shares)


Spread = Normal | Uniform


@checked.reports_field
@dataclass(frozen=True, slots=True)
class Uncertainty:
    """How surely the inputs are known; None where an input is taken for certain.

    Parameters
    ----------
    payload : Normal or Uniform or None
        Deviation of weight, inertia and constant loads of the platform, relative.
    modulus : Normal or Uniform or None
        Of the rope's modulus, relative; None for what its grade states of it.
    linear_mass, breaking_load : Normal or Uniform or None
        Of mass per length and breaking load of the rope, relative; on all cables alike.
    exit_points_m : Normal or Uniform or None
        Of each coordinate of each exit point, for itself [m].
    samples : int
        How often the inputs are drawn.
    seed : int
        Of the random numbers.
    """

    payload: Spread | None = None
    modulus: Spread | None = None
    linear_mass: Spread | None = None
    breaking_load: Spread | None = None
    exit_points_m: Spread | None = None
    samples: checked.Count = 4096
    seed: Annotated[int, checked.Number(least=0)] = 0

    def __post_init__(self) -> None:
        checked.check_fields(self)
        for name in INPUTS[:-1]:
            spread = getattr(self, name)
            if isinstance(spread, Normal):
                checked.Number(most=MAX_DEVIATION).require(name, spread.standard_deviation)
            elif spread is not None:
                checked.Number(least=LEAST_DEVIATION).require(name, spread.low)

    def spreads(self, modulus: Spread) -> Mapping[Input, Spread]:
        """Return what is not certain, with this of the modulus where the study says nothing."""
        spreads: dict[Input, Spread | None] = {
            "payload": self.payload,
            "modulus": modulus if self.modulus is None else self.modulus,
            "linear_mass": self.linear_mass,
            "breaking_load": self.breaking_load,
            "exit_points": self.exit_points_m,
        }
        return {
            name: spread
            for name, spread in spreads.items()
            if spread is not None and not spread.is_certain
        }
