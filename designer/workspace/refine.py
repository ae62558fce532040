"""Search for the worst poses of a space, so that the answer does not depend on the samples.

Extremes are sought in five steps. The border is explored, vertices, edges and faces each on their
own. Places that nothing near them exceeds are starts, as many as there are. From each the search
climbs by clouds of trials that shrink. About the highest ends it climbs again, from starts closer
together, since another maximum may lie beside one. Then a fresh sample, near the best and far from
it, tries to exceed it; as long as one does, the search goes on from there.

Several searches, such as one for each rope, take each step together: what they ask for is computed
in one batch. The random places of a step are the same for all, so that no search depends on those
beside it.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, fields, replace

import numpy as np

from designer.arrays import BoolArray, FloatArray, IntArray
from designer.model.space import Space
from designer.model.workspace import Workspace

CELLS_A_SIDE = 12
"""Parts of the space along each axis, of which a `Pool` keeps the largest demand."""


class Pool:
    """The places of largest demand of a sweep, one for each small part of the space.

    Memory does not grow with the number of places.
    """

    def __init__(self, space: Space) -> None:
        self._space = space
        self._places, self._values = np.empty((0, space.n_coordinates)), np.empty(0)

    def add(self, places: FloatArray, values: FloatArray) -> None:
        """Take in places (n, n_coordinates) and what they ask for (n,)."""
        places = np.concatenate([self._places, places])
        values = np.concatenate([self._values, values])
        best_of_cells = _best_of_cells(self._space, places, values)
        self._places, self._values = places[best_of_cells], values[best_of_cells]

    @property
    def places(self) -> FloatArray:
        """Return the largest of each part, those left out that do not count (n, n_coordinates)."""
        return self._places[~np.isneginf(self._values)]


def _best_of_cells(space: Space, places: FloatArray, values: FloatArray) -> IntArray:
    """Return the index of the largest value in each part of the space, the largest first."""
    x, y, z, rotation = space.cells(places, CELLS_A_SIDE).T
    cell = ((rotation * CELLS_A_SIDE + x) * CELLS_A_SIDE + y) * CELLS_A_SIDE + z
    best = np.full(cell.max(initial=0) + 1, -np.inf)
    np.fmax.at(best, cell, values)
    tops = np.flatnonzero(values >= best[cell])  # a few, and those of one cell that are as large
    order = tops[np.argsort(-values[tops], kind="stable")]
    _, first = np.unique(cell[order], return_index=True)
    return np.asarray(order[np.sort(first)])


def local_maxima(space: Space, places: FloatArray, values: FloatArray, number: int) -> IntArray:
    """Return the indices of places that none in the parts around theirs exceed, largest first."""
    from scipy.ndimage import maximum_filter

    best_of_cells = _best_of_cells(space, places, values)
    best_of_cells = best_of_cells[~np.isneginf(values[best_of_cells])]
    x, y, z, rotation = cell = space.cells(places[best_of_cells], CELLS_A_SIDE).T
    highest = np.full((*[CELLS_A_SIDE] * 3, int(rotation.max(initial=0)) + 1), -np.inf)
    highest[*cell] = values[best_of_cells]
    is_top = maximum_filter(highest, size=(3, 3, 3, 1))[x, y, z, rotation] == values[best_of_cells]
    return np.asarray(best_of_cells[is_top][:number])


@dataclass(slots=True, eq=False)
class Climbs:
    """Climbs of all searches, those of one search beside each other."""

    search: IntArray  #: (n_climbs,) number of the search
    extreme: IntArray  #: (n_climbs,) number of its demand
    at: FloatArray  #: (n_climbs, n_coordinates) where it is [m, rad]
    value: FloatArray  #: (n_climbs,) the demand there
    radius: FloatArray  #: (n_climbs,) size of the next cloud, as a share of the space
    step: FloatArray  #: (n_climbs, n_coordinates) the last step [m, rad]

    def __len__(self) -> int:
        return len(self.search)

    @property
    def kind(self) -> IntArray:
        """Number of its search and extreme together (n_climbs,)."""
        return np.asarray(self.search * (self.extreme.max(initial=0) + 1) + self.extreme)

    def part(self, rows: IntArray) -> Climbs:
        """Return some of them."""
        return Climbs(*(getattr(self, field.name)[rows] for field in fields(self)))

    @classmethod
    def beginning(
        cls, search: IntArray, extreme: IntArray, at: FloatArray, value: FloatArray, radius: float
    ) -> Climbs:
        """Return climbs that have not moved yet."""
        return cls(search, extreme, at, value, np.full(len(at), radius), np.zeros_like(at))

    @classmethod
    def joined(cls, parts: Sequence[Climbs]) -> Climbs:
        """Return the climbs of several parts as one."""
        names = (field.name for field in fields(cls))
        climbs = cls(*(np.concatenate([getattr(part, name) for part in parts]) for name in names))
        return climbs.part(np.argsort(climbs.search, kind="stable"))


Demand = Callable[..., FloatArray]
"""Maps places (n, n_coordinates) to what they ask for (n,): inf where nothing is enough, -inf where
the place does not count. For several extremes at once (n, n_extremes); for several searches at once
it takes the number of the search of each place (n,), ascending, as well."""

_CHUNK = 2**15
"""Places whose demand is computed at once, at most: memory stays flat."""
_APART = 0.025
"""Between starts about the end of a climb, as a share of the space."""
_CLOSE = 0.01
"""Relative: how far an end may stay below the best to be one of the highest."""
_MAX_ITERATIONS = 200
"""A demand that grows in ever smaller steps, as at the edge of what can be held, has no end."""
_SHRINKS = 0.4
"""Of a cloud where nothing rises."""
_SHRINKS_AT_CORNER = 0.1
"""Of a cloud about a landmark of the space where nothing rises; each spans a factor of 30."""
_CLOUDS = 3
"""Tried in an iteration, each smaller by as much as where nothing rises, once climbs end."""
_STEEP = 30.0
"""How many times wider a gap is than the demands above it differ, where they jump."""
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
    neighbours: int = 4  # Such starts about each of them at most
    neighbour_trials: int = 128  # Places of which they are the largest
    trials: int = (
        4  # Random places a coordinate tried about each in an iteration, beside those along it
    )
    # Whether each landmark is a start, rather than only those that nothing near them exceeds
    from_landmarks: bool = True
    tolerance: float = 1e-9  # Size of the last cloud, as a share of the space
    rounds: int = 8  # Fresh samples against what was found, at most


LIGHT = Effort(
    per_edge=8,
    per_face=24,
    inside=192,
    starts=6,
    finalists=2,
    revisited=1,
    neighbours=2,
    neighbour_trials=32,
    from_landmarks=False,
    tolerance=1e-7,
)
"""For demands that take long to compute."""
ONE_CLIMB = replace(LIGHT, starts=1, finalists=1, revisited=0, tolerance=1e-2, rounds=0)
"""For each extreme one, from the highest place that is known or explored."""
_FOLLOWING = replace(LIGHT, starts=4, finalists=4, from_landmarks=True, tolerance=1e-9)
"""For searches that know where others like them have ended."""
_MANY, _SCOUTS = 12, 6
"""Of more searches than this so many are made in full."""


def refine(
    space: Space, demand: Demand, starts: FloatArray, effort: Effort | None = None
) -> list[Worst]:
    """Return the largest of each of several demands (n, n_extremes); see `refine_each`."""
    return refine_each(space, lambda places, _: demand(places), [starts], effort)[0]


def refine_each(
    space: Space,
    demand: Demand,
    starts: Sequence[FloatArray],
    effort: Effort | None = None,
) -> list[list[Worst]]:
    """Return of each of several searches the largest of each of its demands (n, n_extremes).

    It needs no derivative, since demands have kinks wherever another cable becomes the most loaded
    one. Orientations out of a range are searched together with the positions; of a list of
    orientations each start keeps its own. Of a list of points every one is tried, since there is
    nothing between. The result is the largest that was found; that there is none larger is not
    proved. A search ends at the first place where any of its demands is infinite.

    ``starts`` (n, n_coordinates), of each search, are samples of the space that ask for much, such
    as `Pool.places`. Of more than twelve searches six are made in full, and the others from their
    ends as well.
    """
    if not starts:
        return []
    if effort is not None or len(starts) <= _MANY:
        return _PoseSearch(space, demand, effort or Effort(), len(starts)).run(starts)
    searches = np.arange(len(starts))
    scouts = searches[:: -(-len(searches) // _SCOUTS)]
    followers = np.setdiff1d(searches, scouts)

    def among(numbers: IntArray, effort: Effort, extra: FloatArray) -> dict[int, list[Worst]]:
        places = [np.concatenate([starts[k], extra]) for k in numbers]
        search = _PoseSearch(space, lambda at, k: demand(at, numbers[k]), effort, len(numbers))
        return dict(zip(numbers.tolist(), search.run(places), strict=True))

    worsts = among(scouts, Effort(), np.empty((0, space.n_coordinates)))
    ends = np.concatenate([places_of(of_search) for of_search in worsts.values()])
    worsts |= among(followers, _FOLLOWING, ends)
    return [worsts[k] for k in searches.tolist()]


def places_of(worsts: Iterable[Worst]) -> FloatArray:
    """Return where the largest demands are (n, n_coordinates), without those at no place."""
    places = np.array([worst.place for worst in worsts])
    return np.asarray(places[np.isfinite(places).all(axis=1)])


def worst_over_samples(
    workspace: Workspace,
    demand: Demand,
    count: int,
    *,
    most: int | None = None,
    known: Sequence[FloatArray] | None = None,
) -> list[list[Worst]]:
    """Return the largest of each demand over the samples, then over the region from the best.

    For a ``count`` of searches; over so many samples at ``most``. Starts are those that ask for
    most of the first demand, and of each search the places (n, n_coordinates) in ``known``; see
    `refine_each`.
    """
    sampled = workspace if most is None else workspace.with_fewer_samples(most)
    pools = [Pool(workspace.space) for _ in range(count)]
    for rows in sampled.places():
        for first in range(0, count, size := max(_CHUNK // len(rows), 1)):
            batch = np.arange(first, min(first + size, count))
            values = demand(np.tile(rows, (len(batch), 1)), np.repeat(batch, len(rows)))
            for k, of_search in zip(batch, values.reshape(len(batch), len(rows), -1), strict=True):
                pools[k].add(rows, of_search[:, 0])
    starts = [pool.places for pool in pools]
    if known is not None:
        starts = [np.concatenate(places) for places in zip(starts, known, strict=True)]
    return refine_each(workspace.space, demand, starts)


def _foot_of_cliff(value: FloatArray, trials: FloatArray) -> FloatArray:
    """Return the demand (n,) that trials (n, n_trials) fall to where it jumps; -inf where not.

    A jump is the widest gap among them and that of the climb itself (n,), if it is far wider than
    those above differ.
    """
    ascending = np.sort(np.column_stack([trials, value]), axis=1)
    with np.errstate(invalid="ignore"):
        gap = np.nan_to_num(np.diff(ascending), nan=0.0, posinf=np.inf)
        rows, widest = np.arange(len(gap)), gap.argmax(axis=1)
        above = ascending[:, -1] - ascending[rows, widest + 1]
    return np.where(gap[rows, widest] > _STEEP * above, ascending[rows, widest], -np.inf)


class _PoseSearch:
    """Several searches, with all that their steps share."""

    def __init__(self, space: Space, demand: Demand, effort: Effort, count: int) -> None:
        self._space, self._demand, self._effort, self._count = space, demand, effort, count
        self._size = np.ptp(space.bounds, axis=0)
        self._is_free = space.is_free
        self._best = np.empty((count, 0))
        self._best_places = np.empty((count, 0, len(self._size)))
        self._has_border = np.zeros(count, dtype=np.bool_)
        self._marks = space.landmarks()
        self._phase = 0

    def run(self, starts: Sequence[FloatArray]) -> list[list[Worst]]:
        space, active = self._space, np.arange(self._count)
        if space.is_discrete:
            points = np.concatenate(list(map(space.places, space.region.samples_m(1, "grid", 0))))
            self._evaluate_each([points] * self._count, active)
            return self._worsts
        marks, common = self._marks, np.concatenate([self._marks, self._scatter(0)])
        places = [np.concatenate([of_search, common]) for of_search in starts]
        values = self._evaluate_each(places, active)
        landmarks = [len(of_search) + np.arange(len(marks)) for of_search in starts]
        self._climb_all(active, places, values, landmarks)
        for iteration in range(1, self._effort.rounds + 1):
            active = active[~self._is_over[active]]
            before = self._best[active]
            scatter, near = self._scatter(iteration), self._near_the_best(iteration, active)
            places = [np.concatenate([scatter, of_search]) for of_search in near]
            values = self._evaluate_each(places, active) if len(active) else []
            threshold = before + np.where(np.isneginf(before), 0.0, 1e-10 * np.abs(before))
            higher = [of_search > least for of_search, least in zip(values, threshold, strict=True)]
            is_over = self._is_over[active]
            rising = [k for k, mask in enumerate(higher) if mask.any() and not is_over[k]]
            if not rising:
                break
            active, no_landmarks = active[rising], np.empty(0, dtype=np.int64)
            values = [np.where(higher[k], values[k], -np.inf) for k in rising]
            self._climb_all(
                active, [places[k] for k in rising], values, [no_landmarks] * len(rising)
            )
        return self._worsts

    @property
    def _worsts(self) -> list[list[Worst]]:
        return [
            [Worst(place, float(demand)) for place, demand in zip(*of_search, strict=True)]
            for of_search in zip(self._best_places, self._best, strict=True)
        ]

    @property
    def _is_over(self) -> BoolArray:
        return np.asarray(np.isposinf(self._best).any(axis=1))

    def _scatter(self, iteration: int) -> FloatArray:
        counts = self._effort.per_edge, self._effort.per_face, self._effort.inside
        return self._space.scattered(np.random.default_rng([0, iteration]), *counts)

    def _near_the_best(self, iteration: int, among: IntArray) -> list[FloatArray]:
        """Return places about each of the best of some searches, at all distances."""
        n = len(self._size)
        rng = np.random.default_rng([1, iteration])
        cloud = rng.uniform(-1.0, 1.0, (len(_NEAR_SCALES), 24, n))
        cloud = (cloud * _NEAR_SCALES[:, None, None] * self._size).reshape(-1, n)
        clouds = []
        for best in self._best_places[among]:
            places = best[np.isfinite(best).all(axis=1)]
            clouds.append(self._space.nearest((places[:, None] + cloud).reshape(-1, n)))
        return clouds

    def _evaluate_each(self, places: Sequence[FloatArray], among: IntArray) -> list[FloatArray]:
        """Return what places (n, n_coordinates) of some searches ask for (n, n_extremes)."""
        counts = [len(of_search) for of_search in places]
        values = self._evaluate(np.concatenate(places), np.repeat(among, counts))
        return np.split(values, np.cumsum(counts)[:-1])

    def _evaluate(self, places: FloatArray, search: IntArray) -> FloatArray:
        """Return what places ask for (n, n_extremes), and remember the largest of each search."""
        parts = [slice(at, at + _CHUNK) for at in range(0, len(places), _CHUNK)]
        values = np.concatenate([self._demand(places[part], search[part]) for part in parts])
        values = values.reshape(len(places), -1)
        self._has_border[search[np.isneginf(values).any(axis=1)]] = True
        if not self._best.size:
            self._best = np.full((self._count, values.shape[1]), -np.inf)
            self._best_places = np.full((*self._best.shape, len(self._size)), np.nan)
        first = np.flatnonzero(np.diff(search, prepend=-1))
        highest, owner = np.maximum.reduceat(values, first, axis=0), search[first]
        last = np.append(first[1:], len(search))
        for run, extreme in np.argwhere(highest > self._best[owner]).tolist():
            row = first[run] + values[first[run] : last[run], extreme].argmax()
            self._best[owner[run], extreme] = values[row, extreme]
            self._best_places[owner[run], extreme] = places[row]
        return values

    def _climb_all(
        self,
        among: IntArray,
        places: Sequence[FloatArray],
        values: Sequence[FloatArray],
        landmarks: Sequence[IntArray],
    ) -> None:
        """Climb from the places that nothing near them exceeds, then on with the best of these."""
        effort, kinds, starts, demands = self._effort, [], [], []
        is_over = self._is_over
        for k, of_search, demand, marks in zip(among, places, values, landmarks, strict=True):
            for extreme in range(0 if is_over[k] else demand.shape[1]):
                values_of_extreme = demand[:, extreme]
                rows = local_maxima(self._space, of_search, values_of_extreme, effort.starts)
                if effort.from_landmarks and demand.shape[1] == 1:
                    highest = marks[np.argsort(-values_of_extreme[marks])][: effort.starts]
                    rows = np.union1d(rows, highest[~np.isneginf(values_of_extreme[highest])])
                kinds.append(np.full((len(rows), 2), (k, extreme)))
                starts.append(of_search[rows])
                demands.append(values_of_extreme[rows])
        if not kinds:
            return
        search, extreme = np.concatenate(kinds).T
        at, value = np.concatenate(starts), np.concatenate(demands)
        climbs = Climbs.beginning(search, extreme, at, value, 0.5 / CELLS_A_SIDE)
        self._climb(climbs, 1e-3)
        climbs = self._finalists(climbs.part(self._in_reach(climbs)))
        self._climb(climbs, effort.tolerance, slides=True)
        neighbours = self._neighbours(climbs)
        self._climb(neighbours, 1e-3)
        finalists = self._finalists(Climbs.joined([climbs, neighbours]))
        self._climb(finalists, effort.tolerance, slides=True)  # those at their end stay there

    def _neighbours(self, climbs: Climbs) -> Climbs:
        """Return starts about the ends of climbs, closer together than the parts of the space.

        Two maxima lie that near each other where different cables are the most loaded.
        """
        n, effort = len(self._size), self._effort
        ends = climbs.part(np.flatnonzero(self._are_close_to_best(climbs)))
        if not len(ends):
            return ends
        reach = 1.5 / CELLS_A_SIDE
        offsets = self._rng(_MAX_ITERATIONS).uniform(-reach, reach, (effort.neighbour_trials, n))
        places = self._space.nearest(ends.at[:, None] + offsets * self._size)
        demand = self._evaluate_about(ends, places)
        rows, chosen = np.arange(len(ends)), []
        is_apart = self._is_apart(places, ends.at) & ~np.isneginf(demand)
        for _ in range(effort.neighbours):
            highest = np.where(is_apart, demand, -np.inf).argmax(axis=1)
            at, value = places[rows, highest], demand[rows, highest]
            starts = Climbs.beginning(ends.search, ends.extreme, at, value, _APART)
            chosen.append(starts.part(np.flatnonzero(is_apart[rows, highest])))
            is_apart &= self._is_apart(places, at)
        return Climbs.joined(chosen)

    def _is_apart(self, places: FloatArray, at: FloatArray) -> BoolArray:
        """Tell which places (n, n_places, n_coordinates) are far enough from others (n, …)."""
        is_far = np.abs(places - at[:, None]) > _APART * self._size
        return np.asarray((is_far & self._is_free).any(axis=2))

    def _are_close_to_best(self, climbs: Climbs) -> BoolArray:
        """Tell which are among the highest of their extreme, and hardly below the best."""
        order, kind = np.lexsort((-climbs.value, climbs.kind)), climbs.kind
        rank = np.empty(len(order), dtype=np.int64)
        rank[order] = np.arange(len(order)) - np.searchsorted(kind[order], kind[order])
        best = self._best[climbs.search, climbs.extreme]
        with np.errstate(invalid="ignore"):  # of a best at infinity none is close
            is_close = climbs.value > best - _CLOSE * np.abs(best)
        return np.asarray(is_close & (rank < self._effort.revisited))

    def _in_reach(self, climbs: Climbs) -> IntArray:
        """Return the climbs that are hardly below the best of their extreme.

        And all of searches that have met a border of what counts: along it climbs slide later, and
        anything may follow.
        """
        best = self._best[climbs.search, climbs.extreme]
        is_open = self._has_border[climbs.search]
        with np.errstate(invalid="ignore"):
            is_close = climbs.value >= best - _CLOSE * np.abs(best)
        return np.flatnonzero(is_open | is_close)

    def _finalists(self, climbs: Climbs) -> Climbs:
        """Leave out climbs that have come to the same place as a better one, or stay far behind."""
        size = np.where(self._size > 0.0, self._size, 1e-300)
        remaining, kind = np.argsort(-climbs.value, kind="stable"), climbs.kind
        highest = np.zeros(kind.max(initial=0) + 1, dtype=np.int64)  # climb, of each kind
        chosen = [np.empty(0, dtype=np.int64)]
        for _ in range(self._effort.finalists):
            first = remaining[np.unique(kind[remaining], return_index=True)[1]]
            highest[kind[first]] = first
            chosen.append(first)
            apart = np.abs(climbs.at[remaining] - climbs.at[highest[kind[remaining]]]) / size
            remaining = remaining[~((apart < 3e-3) | ~self._is_free).all(axis=1)]
        return climbs.part(np.sort(np.concatenate(chosen)))

    def _climb(self, climbs: Climbs, tolerance: float, *, slides: bool = False) -> None:
        """Climb until the clouds are smaller than the tolerance.

        Along the border of what counts, and of where the demand jumps.
        """
        self._phase += 1
        clouds = _CLOUDS if slides else 1
        is_corner = (climbs.at[:, None] == self._marks).all(axis=2).any(axis=1)  # a landmark
        for iteration in range(_MAX_ITERATIONS):
            active = np.flatnonzero((climbs.radius > tolerance) & ~self._is_over[climbs.search])
            if not len(active):
                break
            climb, rng = climbs.part(active), self._rng(iteration)
            rows = np.arange(len(active))
            shrinks = np.where(is_corner[active], _SHRINKS_AT_CORNER, _SHRINKS)
            # Smaller clouds are tried with the first: where it has nothing, an iteration is spared.
            radii = climb.radius[:, None] * shrinks[:, None] ** np.arange(clouds)
            directions = self._directions(rng, clouds)
            offsets = radii[..., None, None] * (directions * self._size)
            trials = (climb.at[:, None, None] + offsets).reshape(len(active), -1, len(self._size))
            trials = self._space.nearest(trials)
            onward = self._space.nearest(climb.at + 2.0 * climb.step)[:, None]
            trials = np.concatenate([trials, onward], axis=1)
            demand = self._evaluate_about(climb, trials)
            first = slice(None, directions.shape[1])
            in_cloud = demand[:, :-1].reshape(len(active), clouds, -1).max(axis=2)
            in_cloud[:, 0] = np.maximum(in_cloud[:, 0], demand[:, -1])
            rises = in_cloud[:, 0] > climb.value
            foot = _foot_of_cliff(climb.value, demand[:, first])
            outside = demand[:, first] <= foot[:, None]
            on_border = np.flatnonzero(slides & ~rises & outside.any(axis=1) & ~outside.all(axis=1))
            if len(on_border):
                around = trials[on_border, first], outside[on_border]
                slid = self._slide(climb.part(on_border), *around, foot[on_border], rng)
                trials[on_border, -1], demand[on_border, -1] = slid
                in_cloud[on_border, 0] = np.maximum(in_cloud[on_border, 0], slid[1])
            highest = demand.argmax(axis=1)
            better = demand[rows, highest] > climb.value
            to = np.where(better[:, None], trials[rows, highest], climb.at)
            climbs.step[active] = to - climb.at
            climbs.at[active] = to
            climbs.value[active] = np.where(better, demand[rows, highest], climb.value)
            is_corner[active] &= ~better
            grown = 1.1 * radii[rows, (in_cloud > climb.value[:, None]).argmax(axis=1)]
            climbs.radius[active] = np.where(better, grown, radii[:, -1] * shrinks)

    def _evaluate_about(self, climbs: Climbs, places: FloatArray) -> FloatArray:
        """Return each climb's own demand (n_climbs, …) at places (n_climbs, …, n_coordinates)."""
        rows = np.column_stack([climbs.search, places.reshape(len(climbs), -1)])
        # Climbs of several extremes that stand at the same place try the same places.
        _, first, owner = np.unique(
            rows.view(f"V{rows[0].nbytes}").ravel(), return_index=True, return_inverse=True
        )
        distinct = np.sort(first)
        flat = places[distinct].reshape(len(distinct), -1, len(self._size))
        search = np.repeat(climbs.search[distinct], flat.shape[1])
        demand = self._evaluate(flat.reshape(-1, len(self._size)), search)
        demand = demand.reshape(*flat.shape[:2], -1)
        values = demand[np.searchsorted(distinct, first[owner]), :, climbs.extreme]
        return values.reshape(places.shape[:-1])

    def _slide(
        self,
        climbs: Climbs,
        trials: FloatArray,
        is_outside: BoolArray,
        foot: FloatArray,
        rng: np.random.Generator,
    ) -> tuple[FloatArray, FloatArray]:
        """Return the best place (n, n_coordinates) on a border, and its value.

        Beyond it the demand is no larger than the ``foot`` (n,), minus infinite where places do not
        count; ``is_outside`` tells which trials (n, n_trials) lie there.

        Where the largest demand lies on that border, the directions that lead upward and stay
        inside become few. The border's normal is the difference between the trials on either side
        of it; moves across the normal are brought to the border along it, by search in 16 parts.
        """
        size = np.where(self._size > 0.0, self._size, 1.0)
        reach = climbs.radius[:, None, None]
        offsets = np.where(self._is_free, (trials - climbs.at[:, None]) / size, 0.0)
        outside = is_outside[..., None]
        normal = np.where(outside, 0.0, offsets).sum(axis=1) / (~outside).sum(axis=1)
        normal -= np.where(outside, offsets, 0.0).sum(axis=1) / outside.sum(axis=1)
        normal /= np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-300)
        sampled = offsets[:, rng.permutation(offsets.shape[1])[:10]]  # ten slides are tried
        across = sampled - np.einsum("rtk,rk->rt", sampled, normal)[..., None] * normal[:, None]
        low, part = np.full((*across.shape[:2], 1), -1.0), 2.0

        def at(share: FloatArray) -> tuple[FloatArray, FloatArray]:
            steps = (
                across[:, :, None] + (share[..., None] * reach[..., None]) * normal[:, None, None]
            )
            places = self._space.nearest(climbs.at[:, None, None] + steps * size)
            return places, self._evaluate_about(climbs, places)

        for _ in range(3):
            part /= 16.0
            outside_there = at(low + part * np.arange(1, 16))[1] <= foot[:, None, None]
            low = low + part * outside_there.sum(axis=2, keepdims=True)
        places, demand = (values[:, :, 0] for values in at(low + part))
        highest = demand.argmax(axis=1)
        rows = np.arange(len(places))
        return places[rows, highest], demand[rows, highest]

    def _rng(self, iteration: int) -> np.random.Generator:
        """Return the same random numbers for all searches, new ones in each iteration."""
        return np.random.default_rng([2, self._phase, iteration])

    def _directions(self, rng: np.random.Generator, clouds: int) -> FloatArray:
        """Return directions (n_clouds, n_trials, n_coordinates) along the axes, and random ones.

        Random lengths span a factor of 30, so that one iteration tries several scales.
        """
        free = self._size > 0.0
        n = int(free.sum())
        trials = n * self._effort.trials
        random = rng.uniform(-1.0, 1.0, (clouds, trials, n))
        random *= 30.0 ** -rng.random((clouds, trials, 1))
        axes = np.broadcast_to([np.eye(n), -np.eye(n)], (clouds, 2, n, n)).reshape(clouds, -1, n)
        directions = np.zeros((clouds, 2 * n + trials, len(free)))
        directions[..., free] = np.concatenate([axes, random], axis=1)
        return directions
