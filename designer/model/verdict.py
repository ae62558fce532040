"""What became of a pose: solved, or why not."""

from __future__ import annotations

from enum import IntEnum
from typing import Self

import numpy as np

from designer.arrays import BoolArray, FloatArray


class Verdict(IntEnum):
    """Outcome of solving one pose; every pose has exactly one.

    Each has a code, its reason in two or three words and in a clause, and what a user can do.
    """

    reason: str
    clause: str
    advice: str

    def __new__(cls, code: int, reason: str = "", clause: str = "", advice: str = "") -> Self:
        """Return the member of this code with its words."""
        verdict = int.__new__(cls, code)
        verdict._value_ = code
        verdict.reason, verdict.clause, verdict.advice = reason, clause, advice
        return verdict

    SOLVED = 0, "solved", "the cables hold the platform; both residuals are within tolerance"
    OUTSIDE_HULL = (
        1,
        "no cables hold it",
        "no cables can hold the platform, straight or sagging, which is proved",
        "Move the configured pose below the exit points and inside their outline.",
    )
    NO_FINITE_CABLE = (
        2,
        "no finite cable",
        "no cable of the family is thick enough: its own weight alone exceeds the allowable stress",
        "Move the configured pose away from the edge of the workspace, or lower.",
    )
    NOT_CONVERGED = (
        3,
        "not converged",
        "the solver found no solution and no proof that there is none",
        NO_FINITE_CABLE[-1],
    )
    RANK_DEFICIENT = (
        4,
        "rank deficient",
        "no cables were found that hold the platform; straight ones leave some force or moment, "
        "if not the present load, that no tensions can take up",
        NO_FINITE_CABLE[-1],
    )
    NOT_FOUND = (
        5,
        "none found",
        "straight cables cannot hold the platform; sagging ones might, but none were found",
        OUTSIDE_HULL[-1],
    )

    @property
    def is_proved(self) -> bool:
        """Whether it is certain: the pose is solved, or shown to be impossible."""
        return self not in OPEN

    @property
    def label(self) -> str:
        """The name used in result files, such as ``no_finite_cable``."""
        return self.name.lower()

    @property
    def sentence(self) -> str:
        """One sentence for the reader of a report."""
        return f"{self.clause[0].upper()}{self.clause[1:]}."


OPEN = (Verdict.NOT_FOUND, Verdict.NOT_CONVERGED)
"""Verdicts that prove nothing: another way may still find a solution."""


def hanging_cables(force_z_N: FloatArray, drop_m: FloatArray) -> BoolArray:
    """Tell which cables (..., n_cables) come from above and are lowest below the platform end.

    Where the platform holds the cable up, force above zero, and the drop to it is positive. A cable
    that comes from below pulls the platform down by design and does not count.
    """
    return np.asarray((force_z_N > 0.0) & (drop_m >= 0.0))
