"""The closure of cables of given unstrained lengths, cable by cable; see `designer.physics`."""

from __future__ import annotations

from typing import Any

import numpy as np

from designer.arrays import FloatArray
from designer.kernel.compiling import element, inner, kernel
from designer.physics import catenary

_closure: Any = element(catenary.closure)  # of numbers, here
_LARGEST_THETA = catenary.LARGEST_THETA
_MOST_TURNS = 200
_STILL = 4e-15


@kernel
def solve_thetas(
    length: FloatArray, X: FloatArray, D: FloatArray, kappa: FloatArray, out: FloatArray
) -> None:
    """Set the root θ of each closure (n,), as `designer.physics.catenary` does for arrays.

    Infinity for a folded vertical cable, NaN for a cable that does not reach.
    """
    for i in range(len(length)):
        out[i] = _theta(length[i], X[i], D[i], kappa[i])


@inner
def _theta(length: float, X: float, D: float, kappa: float) -> float:
    low = min(np.log(1e-9), np.log(max(kappa * length, 1e-30)) - 20.0)
    high = np.log(_LARGEST_THETA)
    if not _closure(np.exp(low), length, X, D, kappa)[0] < 0.0:
        return np.nan
    if _closure(np.exp(high), length, X, D, kappa)[0] < 0.0:
        return np.nan if X > 0.0 else np.inf
    u = 0.5 * np.log(max(6.0 * (length / np.hypot(X, D) - 1.0), 1e-8))
    u = min(max(u, low), high)
    for _ in range(_MOST_TURNS):
        f, slope = _closure(np.exp(u), length, X, D, kappa)
        if f < 0.0:
            low = u
        else:
            high = u
        # Newton on the logarithm of the closure, which is nearly straight at both ends.
        new = u - np.log1p(f) * (1.0 + f) / (slope * np.exp(u))
        if not low <= new <= high:
            new = 0.5 * (low + high)
        moved = abs(new - u)
        u = new
        if moved <= _STILL * max(abs(u), 1.0):
            break
    return float(np.exp(u))
