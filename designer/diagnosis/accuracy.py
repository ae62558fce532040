"""Errors before and after, on rows that were fitted and on rows that no fit has seen.

Also those of a forward prediction, pose and tensions by the measured lengths alone. This is what a
user of the machine sees of a model: winches give lengths, forward statics makes a pose of them.
Nothing is fitted to it; the poses of the rows are used as starts, and compared.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from designer.arrays import BoolArray, FloatArray, IntArray
from designer.diagnosis.problem import Problem, added_force_N, channel_names
from designer.diagnosis.statistics import block_of, is_outlier, rms, without_outliers
from designer.effects.effect import Setting
from designer.model.measurements import KINDS, Noise
from designer.model.robot import Poses
from designer.statics.forward import solve_forward

_BOOTSTRAP_DRAWS = 400
"""Of the bootstrap: the ends of a 95 % interval scatter by a thirtieth of its width."""


@dataclass(frozen=True, slots=True)
class Interval:
    """A root mean square with its 95 % interval by block bootstrap."""

    also_in_files = ("interval",)
    value: float = field(metadata={"json": "rms"})
    low: float = field(metadata={"json": None})
    high: float = field(metadata={"json": None})

    @property
    def interval(self) -> tuple[float, float]:
        """Both ends."""
        return self.low, self.high


@dataclass(frozen=True, slots=True, eq=False)
class Error:
    """Error of one kind of reading, in SI units."""

    rms: float  #: over the rows that were fitted
    heldout: Interval = field(
        metadata={"json": lambda i: {"heldout_rms": i.value, "heldout_interval": i.interval}}
    )  #: over the rows that no fit has seen
    #: (n_cables,): the same, cable by cable
    heldout_of_cable: FloatArray = field(metadata={"json": "heldout_rms_of_cable"})


@dataclass(frozen=True, slots=True, eq=False)
class Stage:
    """The model at one point of the search: as declared, then with each effect."""

    label: str  #: what was added
    settings: tuple[Setting, ...] = field(metadata={"json": None})  #: all effects with their values
    length_m: Error | None  #: none where nothing of the kind was measured
    tension_N: Error | None
    #: rows that this model cannot hold: they are in no error, of whatever stage
    n_not_held: int = field(default=0, metadata={"json": "rows_not_held"})


@dataclass(frozen=True, slots=True)
class Outlier:
    """A reading that no model here explains; shown, and given little weight."""

    row: int
    channel: str = field(metadata={"json": "reading"})
    size: float


def stage(
    problem: Problem,
    label: str,
    settings: tuple[Setting, ...],
    heldout: BoolArray,
    sound: BoolArray,
) -> Stage:
    """Return the errors of a model in SI units over readings that are ``sound``.

    The latter (n_rows, 2 n_cables) are the same at every stage, so that no model looks better for
    having dropped more.
    """
    residual = np.where(sound, problem.residual(settings), np.nan) * problem.sigma
    length_m, tension_N = np.hsplit(residual, 2)
    errors = _error(length_m, heldout), _error(tension_N, heldout)
    return Stage(label, settings, *errors, int((~problem.holds(settings)).sum()))


def _before_and_after(errors: tuple[float, float]) -> dict[str, object]:
    return {"before": errors[0], "after": errors[1]}


@dataclass(frozen=True, slots=True)
class SessionError:
    """Root mean square errors of one session on rows that no fit has seen, before and after."""

    session: int  #: its number, from 1
    #: its rows, and those of them that were held out
    n_rows: int = field(metadata={"json": "rows"})
    n_heldout: int = field(metadata={"json": "heldout"})
    length_m: tuple[float, float] = field(
        metadata={"json": lambda e: {"length_m": _before_and_after(e)}}
    )  #: before and after [m, N]; NaN where none were measured
    tension_N: tuple[float, float] = field(
        metadata={"json": lambda e: {"tension_N": _before_and_after(e)}}
    )

    @property
    def in_words(self) -> str:
        """Return the errors in one line."""
        errors = [
            f"{kind.name} {kind.scale * was:.3g} → {kind.scale * now:.3g} {kind.unit}"
            for kind in KINDS
            for was, now in [kind.of(self)]
            if np.isfinite(now)
        ]
        return f"{', '.join(errors)} on unseen rows" if errors else "no reading on unseen rows"

    def over(self, noise: Noise) -> float:
        """Return the error after over the noise, the larger of those of the two kinds."""
        ratios = [kind.of(self)[1] / kind.of(noise) for kind in KINDS]
        return max((ratio for ratio in ratios if np.isfinite(ratio)), default=0.0)


def errors_of_sessions(
    problem: Problem, first: Sequence[Setting], last: Sequence[Setting], heldout: BoolArray
) -> tuple[SessionError, ...]:
    """Return the errors of each session by two models, outliers of the last not counted."""
    session = problem.measured.session
    if session is None:
        return ()
    residual = problem.residual(last)
    is_sound = np.zeros(residual.shape, dtype=np.bool_)
    for number in np.unique(session):  # a whole session is no outlier, however far it is off
        rows = session == number
        is_sound[rows] = ~np.isnan(without_outliers(residual[rows]))
    before, after = (
        np.where(is_sound, problem.residual(settings), np.nan) * problem.sigma
        for settings in (first, last)
    )
    answer = []
    for number in np.unique(session).tolist():
        unseen = heldout & (session == number)
        kinds = zip(*(np.hsplit(residual[unseen], 2) for residual in (before, after)), strict=True)
        lengths, tensions = ((rms(was), rms(now)) for was, now in kinds)
        count = int((session == number).sum())
        answer.append(SessionError(number, count, int(unseen.sum()), lengths, tensions))
    return tuple(answer)


def outliers_of(residual: FloatArray, row_numbers: IntArray) -> tuple[Outlier, ...]:
    """Name the readings that stand off, in units of noise."""
    names = channel_names(residual.shape[1] // 2)
    return tuple(
        Outlier(int(row_numbers[row]), names[channel], float(residual[row, channel]))
        for row, channel in np.argwhere(is_outlier(residual))
    )


def bootstrap(unseen: FloatArray, block: IntArray) -> Interval:
    """Return the root mean square of held-out rows with its 95 % interval.

    Blocks are drawn with replacement, since within a block rows may be alike.

    Residuals (n_rows, n_channels) are NaN where there is none; ``block`` is that of each row.
    """
    square = np.nansum(unseen**2, axis=1)
    count = np.sum(~np.isnan(unseen), axis=1)
    third = thirds_of(block)
    sums = np.array([[square[third == k].sum(), count[third == k].sum()] for k in np.unique(third)])
    rng = np.random.default_rng(0)
    draw = rng.integers(len(sums), size=(_BOOTSTRAP_DRAWS, len(sums)))
    total = sums[draw].sum(axis=1)
    low, high = np.quantile(np.sqrt(total[:, 0] / np.maximum(total[:, 1], 1)), [0.025, 0.975])
    return Interval(rms(unseen), float(low), float(high))


def thirds_of(block: IntArray) -> IntArray:
    """Split each of the blocks (n_rows,) in three: few would leave an interval to chance."""
    return np.asarray((np.arange(len(block)) * 3 * len(np.unique(block))) // max(len(block), 1))


def _error(residual: FloatArray, heldout: BoolArray) -> Error | None:
    if np.isnan(residual).all():
        return None
    unseen = residual[heldout]
    return Error(
        rms=rms(residual[~heldout]),
        heldout=bootstrap(unseen, block_of(len(residual))[heldout]),
        heldout_of_cable=np.array([rms(column) for column in unseen.T]),
    )


@dataclass(frozen=True, slots=True)
class ForwardError:
    """Root mean square errors of forward statics over rows that no fit has seen."""

    #: held-out rows with all lengths, and those of them in which a balance was found
    n_rows: int = field(metadata={"json": "rows"})
    n_solved: int = field(metadata={"json": "solved"})
    position_m: Interval  #: distance of the platform from where it was [m]
    #: angle of the platform against where it was [rad]; None for one that cannot turn
    turn_rad: Interval | None
    tension_N: Interval | None  #: of the tensions at the winches [N]; None where none were measured


def with_sound_lengths(problem: Problem, settings: Sequence[Setting]) -> BoolArray:
    """Return the rows (n_rows,) with all lengths, none of which stands off from the model."""
    n = problem.measured.length_m.shape[1]
    residual = without_outliers(problem.residual(settings))
    return np.asarray(np.isfinite(residual[:, :n]).all(axis=1))


def forward_error(
    problem: Problem, settings: Sequence[Setting], chosen: BoolArray
) -> ForwardError | None:
    """Return how well lengths alone foretell pose and tensions; None without any row or pose.

    Of the rows ``chosen`` (n_rows,), each of which has all lengths.
    """
    measured = problem.measured
    rows = np.flatnonzero(chosen)
    if not rows.size or not measured.has_poses:
        return None
    true = problem.predict.true_readings(settings, problem.noise)
    placed = problem.predict.placed(settings)
    tension = np.full(true.tension_N.shape, np.nan)
    away, turn = np.full((2, measured.n_rows, 1), np.nan)
    n_solved = 0
    for of_machine, machine in problem.predict.machines(settings):
        places = np.flatnonzero(of_machine & chosen)
        if not places.size:
            continue
        force, poses = added_force_N(machine, measured), placed.poses.part(places)
        forward_statics = solve_forward(
            machine.robot,
            machine.cables,
            true.length_m[places],
            poses,
            None if force is None else force[places],
        )
        reached = forward_statics.poses
        n_solved += int(forward_statics.statics.is_solved.sum())
        away[places, 0] = np.linalg.norm(reached.position_m - poses.position_m, axis=-1)
        tension[places] = true.tension_N[places] - forward_statics.statics.exit_tension_N
        if not machine.robot.is_point_mass:
            turn[places, 0] = _turn_rad(reached, poses)
    block = block_of(len(chosen))[rows]
    is_point_mass = problem.predict.machine.robot.is_point_mass
    return ForwardError(
        n_rows=rows.size,
        n_solved=n_solved,
        position_m=bootstrap(away[rows], block),
        turn_rad=None if is_point_mass else bootstrap(turn[rows], block),
        tension_N=None if np.isnan(tension).all() else bootstrap(tension[rows], block),
    )


def _turn_rad(poses: Poses, targets: Poses) -> FloatArray:
    """Return the angle between two sets of poses (n_rows,); NaN where there is none."""
    between = np.swapaxes(targets.rotation, -1, -2) @ poses.rotation
    cosine = 0.5 * (np.trace(between, axis1=-2, axis2=-1) - 1.0)
    axis = np.stack([between[..., i, j] - between[..., j, i] for i, j in ((2, 1), (0, 2), (1, 0))])
    return np.asarray(np.arctan2(0.5 * np.linalg.norm(axis, axis=0), cosine))
