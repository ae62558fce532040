"""What an optimisation varies, within which bounds, for what: known whole before it begins."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from designer.arrays import FloatArray
from designer.documents.document import Document
from designer.documents.node import Key, Node, path_text
from designer.optimum.measures import Measure
from designer.sweep.point import Base, Change

_ROUNDING = 1e-9
_STEPS = 1000
"""A bound's range has so many steps, or up to ten times as many: no mast is set to a micrometre."""
Values = tuple[float, ...]
"""One for each variable, in its unit."""


@dataclass(frozen=True, slots=True)
class Tie:
    """A field that goes with a variable: it is ``origin + slope · value``, in ``unit``."""

    keys: tuple[Key, ...]
    origin: float
    slope: float
    unit: str

    def node(self, value: float) -> Node:
        """Return what the study has in this field at a value of the variable."""
        text = f"{self.origin + self.slope * value + 0.0:.10g} {self.unit}".rstrip()
        return Node(1, text, is_plain=not self.unit)


@dataclass(frozen=True, slots=True)
class Variable:
    """One thing to choose.

    Parameters
    ----------
    name : str
        As the file calls it.
    ties : tuple of Tie
        The fields of the study that it sets.
    low, high : float
        Its bounds.
    unit : str
        Of both, as the file has it; empty for SI.
    given : float or None
        Its value in the study as it is; None where its fields have no common one.
    is_offset : bool
        Whether it is a change of what the study has.
    """

    name: str
    ties: tuple[Tie, ...]
    low: float
    high: float
    unit: str
    given: float | None
    is_offset: bool

    def at(self, share: float) -> float:
        """Return the value at a share of the range, in round steps."""
        step = 10.0 ** math.floor(math.log10((self.high - self.low) / _STEPS))
        value = round((self.low + share * (self.high - self.low)) / step) * step
        return min(max(float(f"{value:.10g}"), self.low), self.high)

    def share(self, value: float) -> float:
        """Return where in the range a value lies, from 0 to 1."""
        return (value - self.low) / (self.high - self.low)

    def bound_at(self, value: float) -> str:
        """Return which bound a value stands at: ``lower``, ``upper``, or empty for none."""
        share = self.share(value)
        return "lower" if abs(share) < 1e-3 else "upper" if abs(share - 1.0) < 1e-3 else ""

    def is_within(self, value: float) -> bool:
        """Tell whether a value lies within the bounds, give or take rounding."""
        return -_ROUNDING <= self.share(value) <= 1.0 + _ROUNDING

    def asks_for(self, value: float) -> str:
        """Return what a value asks for beside the study: ``less``, ``more``, ``other`` or nothing.

        Empty where the variable is of the robot, or its value that of the study.
        """
        senses = {tie: demand_sense(tie.keys) for tie in self.ties}
        demands = {tie: sense for tie, sense in senses.items() if sense is not None}
        if not demands or value == self.given:
            return ""
        change = math.nan if self.given is None else value - self.given
        changes = {tie.slope * sense * change for tie, sense in demands.items()}
        if all(x > 0.0 for x in changes):
            return "more"
        return "less" if all(x < 0.0 for x in changes) else "other"

    @property
    def fields(self) -> tuple[str, ...]:
        """The paths of its fields."""
        return tuple(path_text(tie.keys) for tie in self.ties)


_SENSES = {
    "safety_factor": 1, "inset": -1, "clearance": 1, "floor": 1,
    "sag": -1, "stiffness": 1, "drum_capacity": -1, "mass": 1, "dynamic_factor": 1,
    "acceleration": 1, "speed": 1, "thickness": 1, "tension_min": 1,
}  # fmt: skip
"""Whether more of a demand asks for more, by the last name of its field."""
_ASKED = ("workspace", "selection", "load_cases", "pose", "uncertainty", "surroundings")
_OF_ROBOT = (("selection", "sheave_diameter"), ("selection", "termination_efficiency"))
_ASKED_OF_ROBOT = (("tension_min",), ("platform", "mass"), ("platform", "wrench"))


def demand_sense(keys: tuple[Key, ...]) -> int | None:
    """Return 1 where more in a field of a study asks for more, -1 where less does, 0 where neither.

    None where a field is what the robot is, and not what is asked of it.
    """
    is_asked = keys[0] in _ASKED and keys[:2] not in _OF_ROBOT
    is_asked |= keys[0] == "robot" and any(keys[1 : 1 + len(k)] == k for k in _ASKED_OF_ROBOT)
    is_asked |= keys == ("cable", "safety_factor")
    return _SENSES.get(str(keys[-1]), 0) if is_asked else None


@dataclass(frozen=True, slots=True)
class Limit:
    """What a result may be at most, or at least [SI]."""

    measure: Measure
    most: float = math.inf
    least: float = -math.inf

    def excess(self, value: float) -> float:
        """Return by how much a value breaks it, over the limit; zero where it is kept."""
        over = max(value - self.most, self.least - value, 0.0)
        bound = abs(self.most if value > self.most else self.least)
        return over / bound if bound else over

    def is_broken_by(self, result: Mapping[str, Any]) -> bool:
        """Tell whether a whole result breaks it, or does not have it."""
        value = self.measure.value(result)
        return value is None or self.excess(value) > _ROUNDING

    @property
    def words(self) -> str:
        """The limit, such as ``at most``, without its value."""
        return "at most" if math.isfinite(self.most) else "at least"

    @property
    def value(self) -> float:
        """The one of the two that is set."""
        return self.most if math.isfinite(self.most) else self.least


@dataclass(frozen=True, slots=True)
class Budget:
    """When to stop: designs that are tried, and seconds; None for no limit of time."""

    evaluations: int
    time_s: float | None


@dataclass(frozen=True, slots=True, eq=False)
class Plan:
    """An optimisation.

    Parameters
    ----------
    name : str
        Of its file.
    document : Document
        The study as it is.
    text : str
        The study that designs are made from, as text: its region does not follow its anchors.
    base : Base
        The same, to put values into.
    region_stays : bool
        Whether the text had to be changed for that.
    variables, objective, limits, budget
        What is chosen, for what, within what, for how long.
    starts, seed, samples : int
        Searches from different populations; of their random numbers; poses tried of each design.
    """

    name: str
    document: Document
    text: str
    base: Base
    region_stays: bool
    variables: tuple[Variable, ...]
    objective: Measure
    limits: tuple[Limit, ...]
    budget: Budget
    starts: int
    seed: int
    samples: int

    def values(self, shares: FloatArray) -> Values:
        """Return the values at shares of the ranges (n_variables,)."""
        return tuple(v.at(float(x)) for v, x in zip(self.variables, shares, strict=True))

    def is_within(self, values: Values) -> bool:
        """Tell whether a design lies within all bounds, which the study as it is need not do."""
        return all(v.is_within(x) for v, x in zip(self.variables, values, strict=True))

    def changes(self, values: Values) -> list[Change]:
        """Return what these values put into the study."""
        pairs = zip(self.variables, values, strict=True)
        return [(tie.keys, tie.node(value)) for variable, value in pairs for tie in variable.ties]

    @property
    def given(self) -> Values | None:
        """Return the values of the study as it is; None where a variable has none."""
        values = tuple(v.given for v in self.variables if v.given is not None)
        return values if len(values) == len(self.variables) else None
