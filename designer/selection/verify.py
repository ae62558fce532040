"""Proof that cables hold everywhere: the whole workspace again, with their own figures.

Over the samples for many cables at once; between the samples for one.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import chain, compress, pairwise

import numpy as np

from designer.arrays import FloatArray, IntArray
from designer.kernel.calling import LoadSummary
from designer.model.cable import Cable, Cables
from designer.model.robot import Poses, Robot
from designer.model.workspace import Workspace
from designer.progress import Advance
from designer.statics.inverse import solve_sagging
from designer.statics.sizes import add_slowly, evaluate_sizes, has_fast_solver
from designer.workspace.demand import rope_demand
from designer.workspace.refine import (
    Demand,
    Effort,
    Worst,
    refine_each,
    worst_over_samples,
)

_TOGETHER = 32
"""Cables whose hard poses are solved in one batch: memory stays flat."""
_CELLS_A_SIDE, _ROTATIONS = 6, 8
_CELLS = _CELLS_A_SIDE**3 * _ROTATIONS
"""Parts of the space, by position and orientation; a search starts from the worst place of each."""


@dataclass(frozen=True, slots=True, eq=False)
class Verification:
    """What a given cable meets in the workspace."""

    worst_place: FloatArray
    """(n_coordinates,) where its tension is largest, see `designer.model.space` [m, rad]."""
    max_tension_N: float  #: there [N]; inf if the pose cannot be held at all
    utilisation: float  #: largest over allowable tension; the cable holds up to 1
    longest_m: FloatArray  #: (n_cables,) longest unstrained length that each cable has [m]
    shortest_m: FloatArray  #: (n_cables,) shortest; NaN where it was not searched for [m]
    is_refined: bool = True  #: whether they were searched for between the samples as well

    @property
    def holds(self) -> bool:
        """Whether the cable stays within its allowable tension everywhere."""
        return self.utilisation <= 1.0


_UNKNOWN = np.full(3, np.nan)
NOT_TRIED = Verification(_UNKNOWN, np.nan, np.nan, _UNKNOWN, _UNKNOWN, is_refined=False)
"""Of a cable that was not solved yet."""


@dataclass(frozen=True, slots=True, eq=False)
class Sampled:
    """What one cable meets over the samples of a workspace."""

    worst_places: FloatArray
    """(n_starts, n_coordinates) where it is used most, a place for each part of the space, the
    worst first; where it is not held if there is such a pose [m, rad]."""
    utilisation: float  #: largest over allowable tension; inf: a pose not held, or none counts
    longest_m: FloatArray  #: (n_cables,) longest unstrained length that each cable needs [m]
    samples: int  #: tried
    counted: int  #: of them
    overloaded: int  #: of those that count, above the allowable tension
    not_held: int  #: samples and landmarks that cannot be held, at least
    is_complete: bool
    """Whether every sample of the study was tried; else the figures are those of some of them, or
    of all up to where it was settled that the cable does not serve the workspace."""

    @property
    def served(self) -> float:
        """Share of the samples that count and stay within the allowable tension."""
        return (self.counted - self.overloaded) / self.samples if self.samples else 0.0

    def verification(self, cable: Cable) -> Verification:
        """Return what is known before the search between the samples."""
        return Verification(
            worst_place=self.worst_places[0] if len(self.worst_places) else np.full(3, np.nan),
            max_tension_N=self.utilisation * cable.allowable_tension_N,
            utilisation=self.utilisation,
            longest_m=self.longest_m,
            shortest_m=np.full_like(self.longest_m, np.nan),
            is_refined=False,
        )


def verify(robot: Robot, workspace: Workspace, cable: Cable) -> Verification:
    """Solve every sample with this cable, then search for its extremes between them.

    Where every pose is left out, nothing is served: infinite, at no position.
    """
    (worst,) = worst_over_samples(workspace, _demand(robot, workspace, [cable]), 1)
    return _verification(cable, worst)


def refined_each(
    robot: Robot,
    workspace: Workspace,
    cables: Sequence[Cable],
    sampled: Sequence[Sampled],
    effort: Effort | None = None,
) -> list[Verification]:
    """Search for the extremes of cables between the samples, from the worst, in a batch."""
    starts = [of_cable.worst_places for of_cable in sampled]
    demand = _demand(robot, workspace, cables)
    worsts = refine_each(workspace.space, demand, starts, effort)
    verifications = map(_verification, cables, worsts)
    return [
        replace(verification, longest_m=np.maximum(verification.longest_m, of_cable.longest_m))
        for verification, of_cable in zip(verifications, sampled, strict=True)
    ]


def _demand(robot: Robot, workspace: Workspace, cables: Sequence[Cable]) -> Demand:
    """Return what each of the cables meets, see `rope_demand`."""

    def demand(places: FloatArray, search: IntArray) -> FloatArray:
        cable = Cables(cables, search)
        return rope_demand(robot, cable, workspace.hangs_below, places)

    return demand


def _verification(cable: Cable, worst: list[Worst]) -> Verification:
    """Put together what `rope_demand` was largest in."""
    tension, *lengths = worst
    tension_N = np.inf if np.isneginf(tension.demand) else tension.demand
    length = np.array([extreme.demand for extreme in lengths]).reshape(2, -1)
    return Verification(
        worst_place=tension.place,
        max_tension_N=tension_N,
        utilisation=tension_N / cable.allowable_tension_N,
        longest_m=np.maximum(length[0], 0.0),
        shortest_m=np.where(np.isneginf(length[1]), np.nan, -length[1]),
    )


def verify_sizes(
    robot: Robot,
    workspace: Workspace,
    cables: Sequence[Cable],
    *,
    gives_up: bool = True,
    progress: Advance = lambda _: None,
) -> list[Sampled]:
    """Solve every sample, and the landmarks, with every cable in one pass, with its own figures.

    The landmarks of the border are not among the samples that are counted. Memory does not grow
    with the samples. ``progress`` is called with the number of samples done.

    With ``gives_up``, a cable is left alone after the landmarks, or the first chunk of samples,
    with one that it cannot hold or that takes it beyond its allowable tension, which settles that
    it does not serve the workspace.
    """
    # The heavy ones first: slack cables are the harder, and start best from slack ones.
    order = sorted(range(len(cables)), key=lambda k: -cables[k].mean_density_kg_per_m)
    space, is_slow = workspace.space, not has_fast_solver(robot)
    totals = _Totals(len(cables), robot.n_cables, space.n_coordinates)
    samples = ((places, True) for places in workspace.places())
    chunk_size = 2**9 if is_slow else 2**11
    for chunk, counts in chain([(space.landmarks(), False)], samples):
        for start in range(0, len(chunk), chunk_size):
            places = chunk[start : start + chunk_size]
            settled = (totals.not_held > 0) | (totals.utilisation.max(axis=1) > 1.0)
            alive = [k for k in order if not (gives_up and settled[k])]
            x, y, z, rotation = space.cells(places, _CELLS_A_SIDE).T
            cells = (
                (x * _CELLS_A_SIDE + y) * _CELLS_A_SIDE + z
            ) * _ROTATIONS + rotation % _ROTATIONS
            totals.samples += len(places) * counts
            while alive:
                # Of a slow robot one by one: what refutes a cable refutes most of the others.
                now, alive = (alive[:1], alive[1:]) if is_slow and gives_up else (alive, [])
                summary, lost = _summarise(
                    robot, workspace, places, [cables[k] for k in now], cells, gives_up
                )
                totals.add(now, places[lost], places, summary, counts)
                if alive and (summary.failed.any() or (summary.utilisation > 1.0).any()):
                    place = totals.of(now[0]).worst_places[:1]
                    alive = _survivors(robot, workspace, cables, alive, place, totals)
            progress(len(places) if counts else 0)
    return [totals.of(k) for k in range(len(cables))]


def _survivors(
    robot: Robot,
    workspace: Workspace,
    cables: Sequence[Cable],
    alive: Sequence[int],
    place: FloatArray,
    totals: _Totals,
) -> list[int]:
    """Return which of the cables one place (1, n_coordinates) does not refute; note the others."""
    cell = np.zeros(1, dtype=np.int64)
    summary, lost = _summarise(robot, workspace, place, [cables[k] for k in alive], cell, True)
    refuted = np.asarray(summary.failed.any(axis=1) | (summary.utilisation > 1.0).any(axis=1))
    of_refuted = LoadSummary._make(values[refuted] for values in summary)
    refuted_rows = list(compress(alive, refuted))
    totals.add(refuted_rows, place[lost[refuted]], place, of_refuted, counts=False)
    return list(compress(alive, ~refuted))


def _summarise(
    robot: Robot,
    workspace: Workspace,
    positions: FloatArray,
    cables: Sequence[Cable],
    cells: IntArray,
    gives_up: bool,
) -> tuple[LoadSummary, IntArray]:
    """Return what the cables meet, and of each a pose that it is not able to hold, if any (n,)."""
    poses, exclude = Poses.at(positions), workspace.hangs_below == "exclude"
    summary = evaluate_sizes(robot, poses, cables, cells, _CELLS, leaves_out_hanging=exclude)
    if not has_fast_solver(robot):
        return summary, summary.failed.argmax(axis=1)
    lost = np.zeros(len(cables), dtype=np.int64)
    open_rows = np.flatnonzero(summary.failed.any(axis=1))
    if gives_up and len(open_rows):  # the pose that refutes most of them first, of all at once
        shared = summary.failed[open_rows] * summary.failed.sum(axis=0)
        lost[open_rows] = shared.argmax(axis=1)
        tried = Cables([cables[k] for k in open_rows.tolist()], np.arange(len(open_rows)))
        probed = solve_sagging(robot, poses.part(lost[open_rows]), tried)
        open_rows = open_rows[probed.is_solved]
    for first in range(0, len(open_rows), _TOGETHER):
        hard = {
            row: np.flatnonzero(summary.failed[row]) for row in open_rows[first : first + _TOGETHER]
        }
        # After the first 16 and after each 256, a look which cables have failed.
        for start, end in pairwise([0, 16, *range(256, len(positions) + 256, 256)]):
            batches = {row: at[start:end] for row, at in hard.items() if len(at) > start}
            if not batches:
                break
            rows = np.repeat(list(batches), [len(batch) for batch in batches.values()])
            at = np.concatenate(list(batches.values()))
            add_slowly(summary, robot, poses, cables, rows, at, cells, exclude)
            for row, batch in batches.items():
                fails = batch[summary.failed[row, batch]]
                if len(fails):
                    lost[row] = fails[0]
                    if gives_up:
                        del hard[row]
    return summary, lost


class _Totals:
    """What all cables meet in the poses solved so far."""

    def __init__(self, n_tried: int, n_cables: int, n_coordinates: int) -> None:
        self.samples = 0
        self.tried = np.zeros(n_tried, dtype=np.int64)
        self.utilisation = np.full((n_tried, _CELLS), -np.inf)
        self.worst_places = np.full((n_tried, _CELLS, n_coordinates), np.nan)
        self.longest_m = np.zeros((n_tried, n_cables))
        self.counted, self.overloaded, self.not_held = np.zeros((3, n_tried), dtype=np.int64)
        self.not_held_places = np.full((n_tried, n_coordinates), np.nan)

    def add(
        self,
        rows: Sequence[int],
        lost: FloatArray,
        positions: FloatArray,
        summary: LoadSummary,
        counts: bool,
    ) -> None:
        """Add what cables meet at positions, and where each is lost, if it is."""
        self.tried[rows] += len(positions) * counts
        row, cell = np.nonzero(summary.utilisation > self.utilisation[rows])
        higher = np.asarray(rows, dtype=np.int64)[row], cell
        self.utilisation[higher] = summary.utilisation[row, cell]
        self.worst_places[higher] = positions[summary.pose[row, cell]]
        self.longest_m[rows] = np.maximum(self.longest_m[rows], summary.longest_m)
        self.counted[rows] += summary.counted * counts
        self.overloaded[rows] += summary.overloaded * counts
        fails = summary.failed.sum(axis=1)
        is_first = (self.not_held[rows] == 0) & (fails > 0)
        self.not_held_places[rows] = np.where(is_first[:, None], lost, self.not_held_places[rows])
        self.not_held[rows] += fails

    def of(self, row: int) -> Sampled:
        not_held = int(self.not_held[row])
        utilisation = self.utilisation[row]
        order = np.argsort(-utilisation, kind="stable")
        worst = self.worst_places[row][order[~np.isneginf(utilisation[order])]]
        serves_none = self.tried[row] > 0 and self.counted[row] == 0  # a landmark at most
        fails = bool(not_held) or serves_none or not len(worst)
        return Sampled(
            worst_places=self.not_held_places[row][None] if not_held else worst,
            utilisation=np.inf if fails else float(utilisation.max()),
            longest_m=self.longest_m[row],
            samples=int(self.tried[row]),
            counted=int(self.counted[row]),
            overloaded=int(self.overloaded[row]),
            not_held=not_held,
            is_complete=bool(self.tried[row] == self.samples),
        )
