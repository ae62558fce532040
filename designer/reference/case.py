"""A case: figures of others beside ours, with what they may differ by and why."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Figure:
    """One figure of a case.

    Parameters
    ----------
    name, unit : str
        What it is, and its unit.
    theirs, ours : float
        As published or as another code has it, and as this package computes it.
    tolerance : float or None
        Largest relative difference that holds; None where theirs is known to be wrong, and is only
        shown.
    is_limit : bool
        Whether theirs is what ours may not exceed, such as the largest force of a winch.
    """

    name: str
    unit: str
    theirs: float
    ours: float
    tolerance: float | None
    is_limit: bool = False

    @property
    def difference(self) -> float:
        """Relative difference of ours from theirs."""
        return (self.ours - self.theirs) / abs(self.theirs)

    @property
    def holds(self) -> bool:
        """Whether the difference is within the tolerance, if there is one."""
        difference = self.difference if self.is_limit else abs(self.difference)
        return self.tolerance is None or difference <= self.tolerance


@dataclass(frozen=True, slots=True)
class ReferenceCase:
    """Figures of one source; ``figures`` computes ours when called."""

    title: str
    source: str
    note: str
    figures: Callable[[], Sequence[Figure]]


def as_printed(name: str, unit: str, theirs: str, ours: float, units: float = 0.5) -> Figure:
    """Return a figure that holds to half of the last digit of ``theirs``, or so many ``units``."""
    decimals = len(theirs.partition(".")[2])
    value = float(theirs)
    return Figure(name, unit, value, ours, units * 10.0**-decimals / abs(value))
