"""What became of a pose: solved, or why not."""

from __future__ import annotations

from enum import IntEnum

import numpy as np

from designer.arrays import BoolArray, FloatArray


class Verdict(IntEnum):
    """Outcome of solving one pose; every pose has exactly one."""

    SOLVED = 0
    OUTSIDE_HULL = 1
    NO_FINITE_CABLE = 2
    NOT_CONVERGED = 3
    RANK_DEFICIENT = 4
    NOT_FOUND = 5

    @property
    def label(self) -> str:
        """The name used in result files, such as ``no_finite_cable``."""
        return self.name.lower()

    @property
    def sentence(self) -> str:
        """One sentence for the reader of a report."""
        return _SENTENCES[self]


_SENTENCES = {
    Verdict.SOLVED: "The cables hold the platform; both residuals are within tolerance.",
    Verdict.OUTSIDE_HULL: (
        "No cables can hold the platform here, straight or sagging: proved by a wrench that does "
        "work on the load and on none of them."
    ),
    Verdict.NO_FINITE_CABLE: (
        "No section is thick enough: the cable's own weight alone exceeds the allowable stress."
    ),
    Verdict.RANK_DEFICIENT: (
        "The straight cables' directions leave a force or moment that no tensions can take up."
    ),
    Verdict.NOT_CONVERGED: "The solver found no solution and no proof that there is none.",
    Verdict.NOT_FOUND: (
        "Straight cables cannot hold the platform here; sagging ones might, but none were found."
    ),
}


def hanging_cables(force_z_N: FloatArray, drop_m: FloatArray) -> BoolArray:
    """Tell which cables (..., n_cables) come from above and are lowest below the platform end.

    A cable that comes from below pulls the platform down by design and does not count.

    Parameters
    ----------
    force_z_N : array (..., n_cables)
        Vertical force on each cable at the platform; above zero, the platform holds the cable up.
    drop_m : array (..., n_cables)
        From exit point to attachment point [m].
    """
    return np.asarray((force_z_N > 0.0) & (drop_m >= 0.0))
