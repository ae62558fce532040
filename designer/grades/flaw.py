"""One thing that is wrong with a grade."""

from __future__ import annotations

from dataclasses import dataclass

Keys = tuple[str | int, ...]
"""A path in a grade file, such as ``("sizes", 3, "linear_mass")``."""


@dataclass(frozen=True, slots=True)
class Flaw:
    """One thing that is wrong with a grade.

    Parameters
    ----------
    keys : tuple of str or int
        Path in a grade file.
    problem, expected : str
        What was found, and what was expected instead.
    """

    keys: Keys
    problem: str
    expected: str = ""


def within(value: float, bounds: tuple[float, float]) -> bool:
    """Tell whether a value lies between two bounds, or on one of them."""
    return bounds[0] <= value <= bounds[1]
