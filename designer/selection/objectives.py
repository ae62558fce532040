"""What candidates are compared by; each objective is a number of which less is better."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import partial

import numpy as np

from designer.model.cable import Cable
from designer.model.robot import Robot
from designer.study import Objective, Workspace
from designer.workspace.refine import LIGHT, Demand, refine_over_branches
from designer.workspace.stiffness import displacement_demand

STIFFNESS_POSES = 500
"""Samples that the smallest stiffness is taken from before the search between them."""


@dataclass(frozen=True, slots=True)
class Meaning:
    """An objective: the field of `Figures`, how it is shown at length and in a word, its unit."""

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
class Figures:
    """What a candidate is compared by; NaN where it is not known."""

    mass_kg: float  # Of all cables, each at the longest length that it needs [kg]
    cost: float  # Price of these lengths, in the currency of the comparison
    drum_diameter_m: float  # Drum or sheave that the grade's D/d asks for [m]
    max_tension_N: float  # Largest tension, which the winch has to bear [N]
    stiffness_N_per_m: float  # Smallest force over displacement of the platform [N/m]

    def value(self, objective: Objective) -> float:
        """Return the figure of an objective, in the sense in which it is shown."""
        return float(getattr(self, MEANINGS[objective].field))

    def burden(self, objective: Objective) -> float:
        """Return the figure such that less is better; one that is not known is the worst."""
        value = self.value(objective)
        if np.isnan(value):
            return np.inf
        return -value if MEANINGS[objective].more_is_better else value


def smallest_stiffness_N_per_m(
    robot: Robot, workspace: Workspace, cable: Cable, *, searched: bool
) -> float:
    """Return the smallest translational stiffness over the workspace [N/m].

    The smallest force over displacement in any direction, the platform free to turn, at fixed
    unstrained lengths, with sag; zero where the equilibrium is not stable, NaN where no pose
    counts. Searched between the samples as well, or taken from `STIFFNESS_POSES` of them. See
    `designer.statics.stiffness`.
    """
    demand_with = partial(displacement_demand, robot, workspace, cable)
    some = workspace.thinned(STIFFNESS_POSES)

    def softness_with(**how: bool) -> Demand:
        demand = demand_with(**how)
        return lambda places: demand(places)[:, 0]

    if searched:
        (worst,) = refine_over_branches(workspace.space, softness_with, some, LIGHT)
        softest = worst.demand
    else:
        softest = float(softness_with()(some).max(initial=-np.inf))
    return float("nan") if np.isneginf(softest) else 1.0 / softest
