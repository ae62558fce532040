"""The largest tension that there is: bounds over boxes, halved until they are near what was found.

Each box is solved in its middle by the product's solver, whose answer `enclosure.box` encloses.
Where a box's bound is not near enough to the largest utilisation found, it is halved; its
worst corner is solved as well, and becomes what was found where it is worse.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from typing import Literal

import numpy as np

from designer.arrays import FloatArray, IntArray
from designer.model.cable import Cable
from designer.model.robot import Robot
from designer.model.space import Space
from designer.proof.encloser import (
    FIRST_RAISE,
    BoxBounds,
    Cover,
    Encloser,
    covers_of,
    halves,
    unsupported_reason,
)

Status = Literal["proved", "partial", "refuted", "off"]

WITHIN = 1e-3
"""Relative distance of the bound from what was found, at which the search rests."""
_BATCH, _SLOW_BATCH = 4096, 512
MOST_BOXES = 150_000
"""Three times what the largest of the shipped studies takes."""
_TRIES = 32
"""Corners of a batch that are solved, the worst first."""
_BETTER = 1.0 + 1e-9
_SHRINKS = 0.7
"""Of what a box needs its least tensions raised by, to try in its halves."""
_SMALLEST = 1e-9
"""Share of the region's extent below which a box is not halved any more."""


@dataclass(frozen=True, slots=True)
class Budget:
    """What a proof may take: so many boxes, and where the user says so no longer than a time."""

    seconds: float = np.inf
    boxes: int = MOST_BOXES

    def start(self) -> Clock:
        """Return a clock that starts now."""
        return Clock(time.monotonic() + self.seconds)


@dataclass(frozen=True, slots=True)
class Clock:
    """When a time that the user gave is over."""

    end_s: float

    @property
    def is_over(self) -> bool:
        """Whether it is."""
        return time.monotonic() >= self.end_s


@dataclass(frozen=True, slots=True, eq=False)
class Proof:
    """What is proved of the largest utilisation."""

    #: ``proved``: in each pose there is an equilibrium with no tension above the bound, and the
    #: cable holds; ``partial``: for a share of the poses; ``refuted``: a pose was found that the
    #: cable does not hold; ``off``: nothing was tried
    status: Status
    #: largest over allowable tension that is proved; infinite where it is not for all poses
    bound: float = field(default=np.inf, metadata={"json": "utilisation_bound"})
    #: the largest that was found
    found: float = field(default=np.nan, metadata={"json": "utilisation_found"})
    #: (6,) the pose of the latter, where it is worse than what had been found before [m, rad]
    worst: FloatArray | None = field(default=None, metadata={"json": None})
    #: share of the poses, by volume, for which it is proved that the cable holds
    fraction: float = field(default=0.0, metadata={"json": "fraction_proved"})
    boxes: int = 0  #: how many were tried
    #: why nothing was tried, or what ended it before all was decided
    reason: str = field(default="", metadata={"json": lambda reason: {"reason": reason or None}})
    #: in which load case, with its direction; empty where the study has none
    load_case: str = field(
        default="", metadata={"json": lambda load_case: {"load_case": load_case or None}}
    )


def prove(
    robot: Robot,
    cable: Cable,
    space: Space,
    value: float,
    budget: Budget,
    *,
    within: float = WITHIN,
    enough: float = 1.0,
    progress: Callable[[float], None] = lambda _: None,
) -> Proof:
    """Prove a bound on the largest utilisation of a cable in all poses of a space.

    Parameters
    ----------
    robot, cable, space
        The robot, one cable for all its exit points, and where it shall be able to go.
    value : float
        Largest over allowable tension that is known of.
    budget : Budget
        What it may take.
    within : float
        Relative distance of bound and found at which to rest.
    enough : float
        Utilisation up to which the cable holds; just above one where it is sized for that.
    progress : callable
        Called with the share of the boxes that are tried; the rest is the most that is to come. The
        share of the volume says nothing of that, since the last of it may take the most.
    """
    reason = unsupported_reason(robot, space)
    if reason:
        return Proof("off", found=value, reason=reason)
    search = _BranchAndBound(robot, cable, covers_of(space), value, within, enough)
    search.step(1)  # compiles, which takes none of a time that is given
    clock = budget.start()
    while search.is_open and search.boxes < budget.boxes:
        if clock.is_over or search.is_refuted:
            break
        search.step(min(budget.boxes - search.boxes, search.batch))
        progress(search.boxes / budget.boxes)
    proof = search.result()
    if proof.status != "partial":
        return proof
    cut = f"the time given, {budget.seconds:g} s," if clock.is_over else f"{proof.boxes} boxes"
    return replace(proof, reason=f"{cut} ended it before all was decided")


class _BranchAndBound:
    """Boxes that are still open, and what is known so far."""

    def __init__(
        self,
        robot: Robot,
        cable: Cable,
        covers: Sequence[Cover],
        found: float,
        within: float,
        enough: float,
    ) -> None:
        self._enclosers = [Encloser(robot, cable, cover) for cover in covers]
        self._within, self._enough = within, enough
        self._found, self._worst = found, None
        self.batch = _SLOW_BATCH if robot.is_redundant else _BATCH
        self.boxes = 0
        self._proved_bound = 0.0
        self._stuck = 0.0
        self._held = 0.0
        parts = []
        for k, cover in enumerate(covers):
            low, high, corners = cover.cut(cover.low, cover.high)
            parts.append((low, high, np.full(len(low), k), cover.share(low, high, corners)))
        self._low, self._high, self._cover, self._volume = map(
            np.concatenate, zip(*parts, strict=True)
        )
        self._bound = np.full(len(self._low), np.inf)
        self._raise = np.full(len(self._low), FIRST_RAISE)
        self._extent = self._high.max(axis=0) - self._low.min(axis=0)
        self._total = float(self._volume.sum())

    @property
    def is_open(self) -> bool:
        return len(self._bound) > 0

    @property
    def is_refuted(self) -> bool:
        return self._found > self._enough

    @property
    def _level(self) -> float:
        """Bound of a box at which it is left alone."""
        threshold = self._found * (1.0 + self._within)
        return threshold if self.is_refuted else min(threshold, self._enough)

    @property
    def fraction(self) -> float:
        open_held = self._volume[self._bound <= self._enough].sum()
        return min((self._held + float(open_held)) / self._total, 1.0)

    def step(self, count: int) -> None:
        """Bound the boxes that matter most, halve those whose bound is too high."""
        at = self._next(count)
        low, high, cover, volume, raised = (
            values[at] for values in (self._low, self._high, self._cover, self._volume, self._raise)
        )
        self._keep(np.delete(np.arange(len(self._bound)), at))
        bound, cut = np.empty(len(at)), np.empty(len(at), dtype=np.int64)
        for k in np.unique(cover):
            members = np.flatnonzero(cover == k)
            bounds = self._enclosers[k].bound(
                low[members], high[members], raised[members], self._level
            )
            bound[members], cut[members] = bounds.bound, bounds.cut
            raised[members] = np.where(
                np.isnan(bounds.needs), raised[members], _SHRINKS * bounds.needs
            )
            self._try(self._enclosers[k], bounds)
        self.boxes += len(at)
        good = bound <= self._level
        self._proved_bound = max(self._proved_bound, bound[good].max(initial=0.0))
        self._held += float(volume[good].sum())
        rows = np.arange(len(at))
        tiny = high[rows, cut] - low[rows, cut] <= _SMALLEST * self._extent[cut]
        self._stuck = max(self._stuck, bound[~good & tiny].max(initial=0.0))
        undecided = ~good & ~tiny
        low, high, cover, bound, raised, cut = (
            values[undecided] for values in (low, high, cover, bound, raised, cut)
        )
        first, second = halves(low, high, cut)
        for a, b in ((low, first), (second, high)):
            for k in np.unique(cover):
                members = np.flatnonzero(cover == k)
                self._add(int(k), a[members], b[members], bound[members], raised[members])

    def _next(self, number: int) -> IntArray:
        """Return the boxes that are not known to hold, the largest first; else the worst."""
        if len(self._bound) <= number:
            return np.arange(len(self._bound))
        unknown = self._bound > self._enough
        key = np.where(unknown, 2.0 + self._volume / self._volume.max(), self._bound)
        return np.argpartition(-key, number)[:number]

    def _keep(self, at: IntArray) -> None:
        for name in ("_low", "_high", "_cover", "_volume", "_bound", "_raise"):
            setattr(self, name, getattr(self, name)[at])

    def _try(self, encloser: Encloser, bounds: BoxBounds) -> None:
        """Solve the corners that seem to be worse than what was found."""
        order = np.argsort(-bounds.estimate)[:_TRIES]
        order = order[bounds.estimate[order] > self._found * _BETTER]
        bad = np.isneginf(bounds.estimate) & (
            bounds.bound > self._level
        )  # nothing is known of corners
        unknown = np.argsort(np.where(bad, -bounds.bound, np.inf))[: min(_TRIES, int(bad.sum()))]
        trials = [
            bounds.worst[order],
            bounds.middle[unknown],
            bounds.middle[~bounds.solved][:_TRIES],
        ]
        if not sum(map(len, trials)):
            return
        places = encloser.cover.places(np.concatenate(trials))
        used = encloser.utilisation(places)
        if used.max() > self._found * _BETTER:
            self._found, self._worst = float(used.max()), places[used.argmax()]

    def _add(
        self, k: int, low: FloatArray, high: FloatArray, bound: FloatArray, raised: FloatArray
    ) -> None:
        cover = self._enclosers[k].cover
        low, high, corners = cover.cut(low, high)
        undecided = (low <= high).all(axis=1)
        low, high, corners = low[undecided], high[undecided], corners[undecided]
        more = (
            ("_low", low), ("_high", high), ("_cover", np.full(len(low), k)),
            ("_volume", cover.share(low, high, corners)), ("_bound", bound[undecided]),
            ("_raise", raised[undecided]),
        )  # fmt: skip
        for name, values in more:
            setattr(self, name, np.concatenate([getattr(self, name), values]))

    def result(self) -> Proof:
        open_bound = max(self._stuck, self._bound.max(initial=0.0))
        bound = max(self._proved_bound, open_bound, self._found)
        is_bound = np.isfinite(bound) and bound <= self._enough
        status: Status = "proved" if is_bound else "partial"
        return Proof(
            "refuted" if self.is_refuted else status,
            bound=bound,
            found=self._found,
            worst=self._worst,
            fraction=1.0 if status == "proved" else self.fraction,
            boxes=self.boxes,
        )
