"""What became of a pose: solved, or why not."""

from __future__ import annotations

from enum import IntEnum

import numpy as np

from designer.arrays import BoolArray, FloatArray, IntArray


class Verdict(IntEnum):
    """Outcome of solving one pose; every pose has exactly one."""

    SOLVED = 0
    OUTSIDE_HULL = 1
    NO_FINITE_CABLE = 2
    NOT_CONVERGED = 3

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
    Verdict.OUTSIDE_HULL: "No positive cable tensions can hold the platform here.",
    Verdict.NO_FINITE_CABLE: (
        "No section is thick enough: the cable's own weight alone exceeds the allowable stress."
    ),
    Verdict.NOT_CONVERGED: "The solver found no solution and no proof that there is none.",
}

_ON_BOUNDARY = 1e-12


def judge(
    residual: FloatArray,
    tolerance: float,
    inverse_weight: FloatArray,
    overload: FloatArray,
    massless_tension: FloatArray,
    *,
    sizing: bool,
) -> IntArray:
    """Return the verdict of each pose (n_poses,).

    When sizing, the kernel returns the balance at the stress limit. It is a finite cable only if
    its inverse weight is above zero (zero is the infinite section) and no slack cable breaks the
    limit: pulling harder would lift that cable but overload the taut one, so no section remains.

    Parameters
    ----------
    residual, inverse_weight, overload : array (n_poses,)
        From `designer.kernel.batch.UnitSolution`. An infinite overload marks a cable so slack that
        it was not evaluated.
    tolerance : float
        Largest residual of a solved pose.
    massless_tension : array (n_cables, n_poses)
        Tensions of straight cables; their signs tell whether the pose lies inside the hull.
    sizing : bool
        Whether the section was sought or given.
    """
    converged = residual <= tolerance
    lowest = massless_tension.min(axis=0) / np.abs(massless_tension).max(axis=0)
    verdict = np.full(residual.shape, int(Verdict.NOT_CONVERGED))
    if not sizing:
        converged = converged & np.isfinite(overload)
    else:
        finite = (inverse_weight > 0.0) & (overload <= 1.0 + 1e-9)
        verdict[converged & ~finite] = Verdict.NO_FINITE_CABLE
        verdict[np.abs(lowest) <= _ON_BOUNDARY] = Verdict.NO_FINITE_CABLE
        converged = converged & finite
    verdict[~(lowest >= -_ON_BOUNDARY)] = Verdict.OUTSIDE_HULL
    verdict[converged] = Verdict.SOLVED
    return verdict


def hangs_below(force_z_N: FloatArray) -> BoolArray:
    """Tell in which poses (...) a cable's lowest point lies below the platform end.

    Parameters
    ----------
    force_z_N : array (..., n_cables)
        Vertical force on each cable at the platform; above zero, the platform holds the cable up.
    """
    return np.asarray(np.any(force_z_N > 0.0, axis=-1))
