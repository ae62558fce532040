"""Continuous search for the worst pose, so that the answer does not depend on the samples."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from designer.arrays import BoolArray, FloatArray
from designer.space import Space

Demand = Callable[[FloatArray], FloatArray]
"""Maps places (n, n_coordinates) to what they ask for (n,): inf where nothing is enough, -inf where
the place does not count."""

_TRIALS = 127
_SHRINK = 0.5
_TOLERANCE = 1e-10
_MOST_TURNS = 300
"""A demand that grows in ever smaller steps, as at the edge of what can be held, has no end."""


@dataclass(frozen=True, slots=True, eq=False)
class Worst:
    """The largest demand found, inf if the search met a place where nothing is enough."""

    place: FloatArray
    demand: float


def refine(space: Space, demand: Demand, starts: FloatArray) -> Worst:
    """Climb from several starts to the largest demand in the space.

    Each turn tries a cloud of places around every start, moved back into the space where they
    leave it, keeps the best, and shrinks the cloud where none is better. It needs no derivative,
    since the demand has a kink wherever another cable becomes the most loaded one.

    Orientations out of a range are searched together with the positions; of a list of
    orientations each start keeps its own.

    Parameters
    ----------
    space : Space
        Where to search; a list of points has nothing between its points.
    demand : callable
        What is to be maximised.
    starts : array (n_starts, n_coordinates)
        Best samples, well apart.
    """
    values = demand(starts)
    if space.is_discrete:
        best = int(np.argmax(values))
        return Worst(starts[best], float(values[best]))
    at = np.array(starts)
    size = np.ptp(space.bounds, axis=0)
    cloud = _cloud(size > 0.0)
    radius = np.full(len(at), 0.1)
    for _ in range(_MOST_TURNS):
        if radius.max() <= _TOLERANCE or np.isposinf(values).any():
            break
        # A new direction of the cloud each turn: on a curved boundary a fixed one would stall.
        axis = int(-np.log2(radius.min())) % len(size)
        sign = np.where(np.arange(len(size)) == axis, -1.0, 1.0)
        trials = space.nearest(at[:, None] + radius[:, None, None] * size * sign * cloud[None])
        asked = demand(trials.reshape(-1, len(size))).reshape(len(at), -1)
        best = np.argmax(asked, axis=1)
        rows = np.arange(len(at))
        better = asked[rows, best] > values
        at = np.where(better[:, None], trials[rows, best], at)
        values = np.where(better, asked[rows, best], values)
        radius = np.where(better, radius, radius * _SHRINK)
    best = int(np.argmax(values))
    return Worst(at[best], float(values[best]))


def spread_starts(space: Space, places: FloatArray, demand: FloatArray, count: int) -> FloatArray:
    """Return up to `count` places of large demand, no two within a tenth of the space."""
    size = np.ptp(space.bounds, axis=0)
    size = np.where(size > 0.0, size, 1.0)
    chosen: list[FloatArray] = []
    for index in np.argsort(-demand):
        if np.isneginf(demand[index]) or len(chosen) == count:
            break
        candidate = places[index]
        if all(np.abs((candidate - other) / size).max() > 0.1 for other in chosen):
            chosen.append(candidate)
    return np.array(chosen).reshape(-1, places.shape[1])


def _cloud(moves: BoolArray) -> FloatArray:
    """Directions to faces, edges and corners of a cube, then quasi-random ones inside it.

    Only along the coordinates that move; beyond three of them the edges are left out.
    """
    from scipy.stats import qmc

    n = int(moves.sum())
    if n <= 3:
        outer = np.array(np.meshgrid(*[[-1.0, 0.0, 1.0]] * n)).reshape(n, -1).T
    else:
        corners = np.array(np.meshgrid(*[[-1.0, 1.0]] * n)).reshape(n, -1).T
        outer = np.concatenate([np.eye(n), -np.eye(n), corners])
    inner = 2.0 * qmc.Halton(n, scramble=False).random(_TRIALS) - 1.0
    cloud = np.zeros((len(outer) + len(inner), len(moves)))
    cloud[:, moves] = np.concatenate([outer, inner])
    return cloud
