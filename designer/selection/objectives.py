"""What candidates are compared by; each objective is a number of which less is better."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np

from designer.grades.grade import Grade, Size
from designer.model.cable import Cable
from designer.model.robot import Robot
from designer.study import Objective, Workspace
from designer.workspace.refine import LIGHT, Demand, refine_over_branches
from designer.workspace.stiffness import displacement_demand

STIFFNESS_POSES = 500
"""Samples that the smallest stiffness is taken from before the search between them."""

_NOT_KNOWN = float("inf")


@dataclass(frozen=True, slots=True)
class Meaning:
    """How an objective is shown: at length, in a word, its unit, and which sense is good."""

    title: str
    word: str
    unit: str
    more_is_better: bool = False


MEANINGS: Mapping[Objective, Meaning] = {
    "mass": Meaning("mass of all cables", "mass", "kg"),
    "cost": Meaning("price of all cables", "price", ""),
    "drum_diameter": Meaning("drum diameter", "drum diameter", "m"),
    "max_tension": Meaning("largest tension", "tension", "N"),
    "stiffness": Meaning("smallest stiffness", "stiffness", "N/m", more_is_better=True),
}


@dataclass(frozen=True, slots=True)
class Figures:
    """What a candidate is compared by; NaN where it is not known.

    Parameters
    ----------
    mass_kg : float
        Of all cables, each at the longest length that it needs [kg].
    cost : float
        Price of these lengths, in the currency of the comparison.
    drum_diameter_m : float
        Drum or sheave that the grade's D/d asks for [m].
    max_tension_N : float
        Largest tension, which the winch has to bear [N].
    stiffness_N_per_m : float
        Smallest force over displacement of the platform [N/m].
    """

    mass_kg: float
    cost: float
    drum_diameter_m: float
    max_tension_N: float
    stiffness_N_per_m: float

    def value(self, objective: Objective) -> float:
        """Return the figure of an objective, in the sense in which it is shown."""
        return _VALUES[objective](self)

    def burden(self, objective: Objective) -> float:
        """Return the figure such that less is better; one that is not known is the worst."""
        value = self.value(objective)
        if np.isnan(value):
            return _NOT_KNOWN
        return -value if MEANINGS[objective].more_is_better else value


_VALUES: Mapping[Objective, Callable[[Figures], float]] = {
    "mass": lambda figures: figures.mass_kg,
    "cost": lambda figures: figures.cost,
    "drum_diameter": lambda figures: figures.drum_diameter_m,
    "max_tension": lambda figures: figures.max_tension_N,
    "stiffness": lambda figures: figures.stiffness_N_per_m,
}


def drum_diameter_m(grade: Grade, size: Size) -> float:
    """Return the drum that the grade's suggested D/d asks for [m]; NaN where it gives none."""
    ratio = grade.sheave_ratio
    return ratio.suggested * size.diameter_m if ratio else float("nan")


def cost(grade: Grade, size: Size, length_m: float, currency: str | None) -> float:
    """Return the price of this length; NaN without one in the currency of the comparison."""
    if size.price_per_m is None or grade.currency != currency:
        return float("nan")
    return size.price_per_m * length_m


def common_currency(grades: Sequence[Grade]) -> str | None:
    """Return the currency in which most sizes are priced; None where none is."""
    priced = [g.currency for g in grades for s in g.sizes if g.currency and s.price_per_m]
    return max(sorted(set(priced)), key=priced.count, default=None)


def smallest_stiffness_N_per_m(
    robot: Robot, workspace: Workspace, cable: Cable, *, searched: bool
) -> float:
    """Return the smallest translational stiffness over the workspace [N/m].

    The smallest force over displacement in any direction, the platform free to turn, at fixed
    unstrained lengths, with sag; zero where the equilibrium is not stable, NaN where no pose
    counts. See `designer.statics.stiffness`.

    Parameters
    ----------
    robot, workspace, cable
        What to look at.
    searched : bool
        Whether to search between the samples as well, or to take `STIFFNESS_POSES` of them.
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
