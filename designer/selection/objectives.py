"""What candidates are compared by; each objective is a number of which less is better."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from designer.study import Objective


@dataclass(frozen=True, slots=True)
class Meaning:
    """An objective: the field of `CandidateFigures`, its name at length and in a word, its unit."""

    field: str
    title: str
    word: str
    unit: str
    more_is_better: bool = False


MEANINGS: Mapping[Objective, Meaning] = {
    "mass": Meaning("mass_kg", "mass of all cables", "mass", "kg"),
    "cost": Meaning("cost", "price of all cables", "price", ""),
    "drum_diameter": Meaning("drum_diameter_m", "drum diameter", "drum diameter", "m"),
    "max_tension": Meaning("max_tension_N", "largest tension", "tension", "N"),
    "stiffness": Meaning("stiffness_N_per_m", "smallest stiffness", "stiffness", "N/m", True),
}


@dataclass(frozen=True, slots=True)
class CandidateFigures:
    """What a candidate is compared by; NaN where it is not known."""

    mass_kg: float = math.nan  # Of all cables, each at the longest length that it needs [kg]
    cost: float = math.nan  # Price of these lengths, in the currency of the comparison
    drum_diameter_m: float = math.nan  # Drum or sheave that the grade's D/d asks for [m]
    max_tension_N: float = math.nan  # Largest tension, which the winch has to bear [N]
    stiffness_N_per_m: float = math.nan  # Smallest force over displacement of the platform [N/m]

    def value(self, objective: Objective) -> float:
        """Return the figure of an objective, in the sense in which it is shown."""
        return float(getattr(self, MEANINGS[objective].field))

    def burden(self, objective: Objective) -> float:
        """Return the figure such that less is better; one that is not known is the worst."""
        value = self.value(objective)
        if np.isnan(value):
            return np.inf
        return -value if MEANINGS[objective].more_is_better else value


UNKNOWN = CandidateFigures()
"""Of a candidate that was not solved yet."""
