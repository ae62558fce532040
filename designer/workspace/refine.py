"""Search for the worst poses of a space, so that the answer does not depend on the samples.

Extremes are sought in five steps. The border is explored, vertices, edges and faces each on their
own. Places that nothing near them exceeds are starts, as many as there are. From each the search
climbs by clouds of trials that shrink. About the highest ends it climbs again, from starts closer
together, since another maximum may lie beside one. Then a fresh sample, near the best and far from
it, tries to exceed it; as long as one does, the search goes on from there.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from designer.arrays import BoolArray, FloatArray, IntArray
from designer.model.space import Space
from designer.model.workspace import Workspace
from designer.workspace.pool import CELLS_A_SIDE, Pool, local_maxima

Demand = Callable[[FloatArray], FloatArray]
"""Maps places (n, n_coordinates) to what they ask for (n,): inf where nothing is enough, -inf where
the place does not count. For several extremes at once (n, n_extremes)."""

_CHUNK = 2**13
_APART = 0.025
"""Between starts about the end of a climb, as a share of the space."""
_CLOSE = 0.01
"""Relative: how far an end may stay below the best to be one of the highest."""
_MOST_TURNS = 200
"""A demand that grows in ever smaller steps, as at the edge of what can be held, has no end."""
_MOST_ROUNDS = 8
_NEAR_SCALES = 10.0 ** -np.arange(1.0, 8.0)


@dataclass(frozen=True, slots=True, eq=False)
class Worst:
    """The largest demand found, inf if the search met a place where nothing is enough.

    At no place (NaN), and -inf, where no place counts.
    """

    place: FloatArray
    demand: float


@dataclass(frozen=True, slots=True)
class Effort:
    """How hard to search."""

    # Places explored on each edge and face and inside, and the same again as a fresh sample against
    # what was found
    per_edge: int = 32
    per_face: int = 256
    inside: int = 2048
    starts: int = 40  # Climbs of each extreme at most, beside those from the landmarks
    finalists: int = 12  # How many of them go on to the end
    revisited: int = 3  # The highest ends, about which starts closer together are tried
    beside: int = 4  # Such starts about each of them at most
    tried_beside: int = 128  # Places of which they are the largest
    trials: int = 26  # Random places tried about each in a turn, beside those along the coordinates
    # Whether each landmark is a start, rather than only those that nothing near them exceeds
    from_landmarks: bool = True
    tolerance: float = 1e-9  # Size of the last cloud, as a share of the space


LIGHT = Effort(
    per_edge=8,
    per_face=24,
    inside=192,
    starts=6,
    finalists=2,
    revisited=1,
    beside=2,
    tried_beside=32,
    trials=12,
    from_landmarks=False,
    tolerance=1e-7,
)
"""For demands that take long to compute."""


def refine(
    space: Space, demand: Demand, starts: FloatArray, effort: Effort | None = None
) -> list[Worst]:
    """Return the largest of each of several demands (n, n_extremes) that one computation yields.

    It needs no derivative, since demands have kinks wherever another cable becomes the most loaded
    one. Orientations out of a range are searched together with the positions; of a list of
    orientations each start keeps its own. Of a list of points every one is tried, since there is
    nothing between. The result is the largest that was found; that there is none larger is not
    proved. Ends at the first place where any of the demands is infinite.

    ``starts`` (n, n_coordinates) are samples of the space that ask for much, such as `Pool.places`.
    """
    return _PoseSearch(space, demand, effort or Effort()).run(starts)


def refine_over_branches(
    space: Space,
    demand_with: Callable[..., Demand],
    starts: FloatArray,
    effort: Effort | None = None,
) -> list[Worst]:
    """Return the largest of each of several demands of solutions that may have better branches.

    To look for better branches takes a hundred times as long. Where it changes none of the starts,
    the search does without, and its results are computed again with it: a better branch asks for
    less, so that a largest diameter or tension stands if it stands there. If anything has changed,
    the whole search is made again with it. ``demand_with`` takes ``seeks_better``, whether to look
    for them, and returns the demand.
    """
    plain, thorough = demand_with(seeks_better=False), demand_with(seeks_better=True)

    def changes(places: FloatArray) -> bool:
        return len(places) > 0 and not np.array_equal(plain(places), thorough(places))

    if not changes(starts):
        worsts = refine(space, plain, starts, effort)
        places = np.array([worst.place for worst in worsts])
        if not changes(places[np.isfinite(places).all(axis=1)]):
            return worsts
    return refine(space, thorough, starts, effort)


def worst_over_samples(workspace: Workspace, demand_with: Callable[..., Demand]) -> list[Worst]:
    """Return the largest of each demand over all samples, then over the region from the best.

    Starts are the samples that ask for most of the first demand; see `refine_over_branches`.
    """
    pool, demand = Pool(workspace.space), demand_with()
    for rows in workspace.places():
        pool.add(rows, demand(rows).reshape(len(rows), -1)[:, 0])
    return refine_over_branches(workspace.space, demand_with, pool.places)


_Climbs = Any
"""Records of climbs: where each is, its extreme, value, cloud's size and last step."""


class _PoseSearch:
    """One search, with all that its steps share."""

    def __init__(self, space: Space, demand: Demand, effort: Effort) -> None:
        self._space, self._demand, self._effort = space, demand, effort
        self._rng = np.random.default_rng(0)
        self._size = np.ptp(space.bounds, axis=0)
        self._best: list[Worst] = []

    def run(self, starts: FloatArray) -> list[Worst]:
        space = self._space
        if space.is_discrete:
            every = np.concatenate(list(map(space.places, space.region.samples_m(1, "grid", 0))))
            for at in range(0, len(every), _CHUNK):
                self._ask(every[at : at + _CHUNK])
            return self._best
        marks = space.landmarks()
        places = np.concatenate([starts, marks, self._scatter()])
        values = self._ask(places)
        self._climb_all(places, values, np.arange(len(starts), len(starts) + len(marks)))
        for _ in range(_MOST_ROUNDS if not self._is_over else 0):
            before = np.array([worst.demand for worst in self._best])
            places = np.concatenate([self._scatter(), self._near_the_best()])
            values = self._ask(places)
            gain = np.where(np.isneginf(before), 0.0, 1e-10 * np.abs(before))
            higher = values > before + gain
            if self._is_over or not higher.any():
                break
            self._climb_all(places, np.where(higher, values, -np.inf), np.empty(0, dtype=np.int64))
        return self._best

    @property
    def _is_over(self) -> bool:
        return any(np.isposinf(worst.demand) for worst in self._best)

    def _scatter(self) -> FloatArray:
        counts = self._effort.per_edge, self._effort.per_face, self._effort.inside
        return self._space.scattered(self._rng, *counts)

    def _near_the_best(self) -> FloatArray:
        """Return places about each of the best, at all distances."""
        places = np.array([worst.place for worst in self._best])
        places = places[np.isfinite(places).all(axis=1)]
        of_each = (len(_NEAR_SCALES), 24, len(self._size))
        cloud = self._rng.uniform(-1.0, 1.0, of_each)
        cloud = (cloud * _NEAR_SCALES[:, None, None] * self._size).reshape(-1, len(self._size))
        return self._space.nearest((places[:, None] + cloud).reshape(-1, len(self._size)))

    def _ask(self, places: FloatArray) -> FloatArray:
        """Return what places ask for (n, n_extremes), and remember the largest."""
        values = self._demand(places)
        values = values[:, None] if values.ndim == 1 else values
        if not self._best:
            nowhere = np.full(len(self._size), np.nan)
            self._best = [Worst(nowhere, -np.inf)] * values.shape[1]
        at = values.argmax(axis=0) if len(values) else []
        for k, row in enumerate(at):
            if values[row, k] > self._best[k].demand:
                self._best[k] = Worst(places[row].copy(), float(values[row, k]))
        return values

    def _climb_all(self, places: FloatArray, values: FloatArray, marks: IntArray) -> None:
        """Climb from the places that nothing near them exceeds, then on with the best of these."""
        if self._is_over:
            return
        effort, rows, extremes = self._effort, [], []
        for k in range(values.shape[1]):
            some = local_maxima(self._space, places, values[:, k], effort.starts)
            if effort.from_landmarks and values.shape[1] == 1:
                also = marks[np.argsort(-values[marks, k])][: effort.starts]
                some = np.union1d(some, also[~np.isneginf(values[also, k])])
            rows.append(some)
            extremes.append(np.full(len(some), k))
        row, extreme = np.concatenate(rows), np.concatenate(extremes)
        n = len(self._size)
        kinds = [("at", "f8", n), ("extreme", "i8"), ("value", "f8"), ("radius", "f8")]
        climbs = np.zeros(len(row), dtype=[*kinds, ("step", "f8", n)]).view(np.recarray)
        climbs.at, climbs.extreme, climbs.value = places[row], extreme, values[row, extreme]
        climbs.radius = 0.5 / CELLS_A_SIDE
        self._climb(climbs, 1e-3)
        climbs = self._finalists(climbs)
        self._climb(climbs, effort.tolerance, slides=True)
        if self._is_over:
            return
        beside = self._beside(climbs)
        self._climb(beside, 1e-3)
        finalists = self._finalists(np.concatenate([climbs, beside]).view(np.recarray))
        self._climb(finalists, effort.tolerance, slides=True)  # those at their end stay there

    def _beside(self, climbs: _Climbs) -> _Climbs:
        """Return starts about the ends of climbs, closer together than the parts of the space.

        Two maxima lie that near each other where different cables are the most loaded.
        """
        n, effort = len(self._size), self._effort
        tops = climbs[self._are_close_to_best(climbs)]
        if not len(tops):
            return tops
        reach = 1.5 / CELLS_A_SIDE
        offsets = self._rng.uniform(-reach, reach, (len(tops), effort.tried_beside, n))
        trials = self._space.nearest(tops.at[:, None] + offsets * self._size)
        demand = self._ask(trials.reshape(-1, n)).reshape(*trials.shape[:2], len(self._best))
        out = []
        for top, places, values in zip(tops, trials, demand, strict=True):
            own_demand = values[:, top.extreme]
            used = [top.at]
            for k in np.argsort(-own_demand, kind="stable"):
                if np.isneginf(own_demand[k]) or len(used) > effort.beside:
                    break
                if (np.abs(np.array(used) - places[k]) > _APART * self._size).any(axis=1).all():
                    used.append(places[k])
                    out.append((places[k], top.extreme, own_demand[k], _APART, 0.0))
        return np.array(out, dtype=climbs.dtype).view(np.recarray)

    def _are_close_to_best(self, climbs: _Climbs) -> BoolArray:
        """Tell which are among the highest of their extreme, and hardly below the best."""
        rivals = climbs.extreme[:, None] == climbs.extreme
        rank = (rivals & (climbs.value[:, None] < climbs.value)).sum(axis=1)
        best = np.array([worst.demand for worst in self._best])[climbs.extreme]
        is_close = climbs.value > best - _CLOSE * np.abs(best)
        return np.asarray(is_close & (rank < self._effort.revisited))

    def _finalists(self, climbs: _Climbs) -> _Climbs:
        """Leave out climbs that have come to the same place as a better one, or stay far behind."""
        order = np.argsort(-climbs.value, kind="stable")
        size = np.where(self._size > 0.0, self._size, 1e-300)
        chosen: list[int] = []
        for k in order:
            rivals = [j for j in chosen if climbs.extreme[j] == climbs.extreme[k]]
            apart = np.abs(climbs.at[rivals] - climbs.at[k]) / size
            if len(rivals) < self._effort.finalists and not (apart < 3e-3).all(axis=1).any():
                chosen.append(int(k))
        return climbs[np.array(chosen, dtype=np.int64)]

    def _climb(self, climbs: _Climbs, tolerance: float, *, slides: bool = False) -> None:
        """Climb until the clouds are smaller than the tolerance, along what does not count."""
        n = len(self._size)
        for _ in range(_MOST_TURNS):
            active = np.flatnonzero(climbs.radius > tolerance)
            if not len(active) or self._is_over:
                break
            climb = climbs[active]
            reach = climb.radius[:, None, None] * self._size
            trials = self._space.nearest(climb.at[:, None] + self._directions(len(active)) * reach)
            onward = self._space.nearest(climb.at + 2.0 * climb.step)[:, None]
            trials = np.concatenate([trials, onward], axis=1)
            demand = self._ask(trials.reshape(-1, n)).reshape(*trials.shape[:2], -1)
            own_demand = np.take_along_axis(demand, climb.extreme[:, None, None], axis=2)[..., 0]
            rises = own_demand.max(axis=1) > climb.value
            outside = np.isneginf(own_demand)
            on_border = np.flatnonzero(slides & ~rises & outside.any(axis=1) & ~outside.all(axis=1))
            if len(on_border):
                slid = self._slide(climb[on_border], trials[on_border], own_demand[on_border])
                trials[on_border, -1], own_demand[on_border, -1] = slid
            best = own_demand.argmax(axis=1)
            rows = np.arange(len(active))
            better = own_demand[rows, best] > climb.value
            to = np.where(better[:, None], trials[rows, best], climb.at)
            climbs.step[active] = to - climb.at
            climbs.at[active] = to
            climbs.value[active] = np.where(better, own_demand[rows, best], climb.value)
            climbs.radius[active] = climb.radius * np.where(better, 1.1, 0.5)

    def _slide(
        self, climbs: _Climbs, trials: FloatArray, values: FloatArray
    ) -> tuple[FloatArray, FloatArray]:
        """Return the best place (n, n_coordinates) on the border of what counts, and its value.

        Where the largest demand lies on that border, the directions that lead upward and stay
        inside become few. The border's normal is the difference between the trials on either side
        of it; moves across the normal are brought to the border along it, by search in eight parts.
        """
        n, size = len(self._size), np.where(self._size > 0.0, self._size, 1.0)
        reach = climbs.radius[:, None, None]
        offsets = (trials - climbs.at[:, None]) / size
        outside = np.isneginf(values)[..., None]
        normal = np.where(outside, 0.0, offsets).sum(axis=1) / (~outside).sum(axis=1)
        normal -= np.where(outside, offsets, 0.0).sum(axis=1) / outside.sum(axis=1)
        normal /= np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-300)
        some = offsets[:, self._rng.permutation(offsets.shape[1])[:10]]  # ten slides are tried
        across = some - np.einsum("rtk,rk->rt", some, normal)[..., None] * normal[:, None]
        low, part = np.full((*across.shape[:2], 1), -1.0), 2.0

        def at(share: FloatArray) -> tuple[FloatArray, FloatArray]:
            steps = (
                across[:, :, None] + (share[..., None] * reach[..., None]) * normal[:, None, None]
            )
            places = self._space.nearest(climbs.at[:, None, None] + steps * size)
            asked = self._ask(places.reshape(-1, n)).reshape(*places.shape[:3], -1)
            own_demand = np.take_along_axis(asked, climbs.extreme[:, None, None, None], axis=3)
            return places, own_demand[..., 0]

        for _ in range(4):
            outside_there = np.isneginf(at(low + part * np.arange(1, 8) / 8.0)[1])
            low = low + part / 8.0 * outside_there.sum(axis=2, keepdims=True)
            part /= 8.0
        places, demand = (values[:, :, 0] for values in at(low + part))
        best = demand.argmax(axis=1)
        rows = np.arange(len(places))
        return places[rows, best], demand[rows, best]

    def _directions(self, count: int) -> FloatArray:
        """Return directions (count, n_trials, n_coordinates) along the axes, and random ones.

        Random lengths span a factor of 30, so that one turn tries several scales.
        """
        free = self._size > 0.0
        n = int(free.sum())
        random = self._rng.uniform(-1.0, 1.0, (count, self._effort.trials, n))
        random *= 30.0 ** -self._rng.random((count, self._effort.trials, 1))
        axes = np.broadcast_to(np.concatenate([np.eye(n), -np.eye(n)]), (count, 2 * n, n))
        out = np.zeros((count, 2 * n + self._effort.trials, len(free)))
        out[..., free] = np.concatenate([axes, random], axis=1)
        return out
