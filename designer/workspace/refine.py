"""Continuous search for the worst pose, so that the answer does not depend on the samples."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from designer.arrays import FloatArray
from designer.region import PointList, Region

Demand = Callable[[FloatArray], FloatArray]
"""Maps positions (n, 3) to what they ask for (n,): inf where nothing is enough, -inf where the
position does not count."""

_TRIALS = 127
_SHRINK = 0.5
_TOLERANCE = 1e-10


@dataclass(frozen=True, slots=True, eq=False)
class Worst:
    """The largest demand found, inf if the search met a position where nothing is enough."""

    position_m: FloatArray
    demand: float


def refine(region: Region, demand: Demand, starts_m: FloatArray) -> Worst:
    """Climb from several starts to the largest demand in the region.

    Each turn tries a cloud of positions around every start, moved back into the region where
    they leave it, keeps the best, and shrinks the cloud where none is better. It needs no
    derivative, since the demand has a kink wherever another cable becomes the most loaded one.

    Parameters
    ----------
    region : Region
        Where to search; a list of points has nothing between its points.
    demand : callable
        What is to be maximised.
    starts_m : array (n_starts, 3)
        Best samples, well apart.
    """
    values = demand(starts_m)
    if isinstance(region, PointList):
        best = int(np.argmax(values))
        return Worst(starts_m[best], float(values[best]))
    cloud = _cloud()
    at = np.array(starts_m)
    size = np.ptp(region.bounds_m, axis=0)
    radius = np.full(len(at), 0.1)
    while radius.max() > _TOLERANCE and not np.isposinf(values).any():
        # A new direction of the cloud each turn: on a curved boundary a fixed one would stall.
        sign = np.where(np.arange(3) == int(-np.log2(radius.min())) % 3, -1.0, 1.0)
        trials = region.nearest(at[:, None] + radius[:, None, None] * size * sign * cloud[None])
        asked = demand(trials.reshape(-1, 3)).reshape(len(at), -1)
        best = np.argmax(asked, axis=1)
        rows = np.arange(len(at))
        better = asked[rows, best] > values
        at = np.where(better[:, None], trials[rows, best], at)
        values = np.where(better, asked[rows, best], values)
        radius = np.where(better, radius, radius * _SHRINK)
    best = int(np.argmax(values))
    return Worst(at[best], float(values[best]))


def spread_starts(
    region: Region, positions_m: FloatArray, demand: FloatArray, count: int
) -> FloatArray:
    """Return up to `count` positions of large demand, no two within a tenth of the region."""
    size = np.ptp(region.bounds_m, axis=0)
    size = np.where(size > 0.0, size, 1.0)
    chosen: list[FloatArray] = []
    for index in np.argsort(-demand):
        if np.isneginf(demand[index]) or len(chosen) == count:
            break
        candidate = positions_m[index]
        if all(np.abs((candidate - other) / size).max() > 0.1 for other in chosen):
            chosen.append(candidate)
    return np.array(chosen).reshape(-1, 3)


def _cloud() -> FloatArray:
    """Directions to the faces, edges and corners of a cube, then quasi-random ones inside it."""
    from scipy.stats import qmc

    corners = np.array(np.meshgrid(*[[-1.0, 0.0, 1.0]] * 3)).reshape(3, -1).T
    inner = 2.0 * qmc.Halton(3, scramble=False).random(_TRIALS) - 1.0
    return np.concatenate([corners, inner])
