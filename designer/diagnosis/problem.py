"""Readings as a model predicts them by statics, and the residual of data in units of noise.

Of a robot with cables to spare the internal forces of each row are taken from its own readings; see
`designer.statics.balance`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np

from designer.arrays import BoolArray, FloatArray
from designer.diagnosis.kept_slopes import KeptSlopes
from designer.diagnosis.statistics import MAD_TO_STD
from designer.effects.effect import Effect, Readings, Setting, as_built
from designer.effects.registry import SHIPPED, KnownEffects
from designer.model.cable import STANDARD_GRAVITY_M_PER_S2
from designer.model.load_case import AIR_DENSITY_KG_PER_M3
from designer.model.machine import Machine
from designer.model.measured_data import EVEN, Measured, Noise
from designer.model.robot import Poses
from designer.statics.balance import InternalBalance, imbalance, solve_taut, solve_underactuated
from designer.statics.inverse import Statics, solve_sagging


def readings_of(machine: Machine, poses: Poses, measured: Measured | None = None) -> Readings:
    """Return unstrained lengths and winch-side tensions of a machine in poses (n_rows,).

    Robots with as many cables as degrees of freedom are solved exactly, those with fewer as
    `designer.statics.balance` has it. With more, the tensions nearest to balance are taken,
    see `designer.statics.balance`.
    """
    force = None if measured is None else added_force_N(machine, measured)
    if machine.robot.is_redundant:
        length, tension, span = solve_taut(machine.robot, poses, machine.cables, force)
        return Readings(length - straightened_m(machine, tension, span), tension)
    if machine.robot.is_square:  # hangs in the way that it was tightened to, better ones or not
        statics = solve_sagging(machine.robot, poses, machine.cables, force)
    else:
        statics = solve_underactuated(machine.robot, poses, machine.cables, force)
    return with_stiff_ends(machine, statics, true_readings(statics))


def with_stiff_ends(machine: Machine, statics: Statics, true: Readings) -> Readings:
    """Return the true readings of a balance, less what bending stiffness takes off the lengths."""
    if machine.flexural_rigidity_N_m2 == 0.0:
        return true
    span = statics.geometry().horizontal_distance_m
    return replace(true, length_m=true.length_m - straightened_m(machine, true.tension_N, span))


def added_force_N(machine: Machine, measured: Measured) -> FloatArray | None:
    """Return wind and late load on the platform, base frame (n_rows, 3) [N]; None without."""
    forces = []
    if machine.drag_area_m2 != 0.0 and measured.wind_m_per_s is not None:
        wind = measured.wind_m_per_s
        speed = np.linalg.norm(wind, axis=1, keepdims=True)
        forces.append(0.5 * AIR_DENSITY_KG_PER_M3 * machine.drag_area_m2 * speed * wind)
    if machine.late_load_kg != 0.0 and measured.time_s is not None:
        down = -machine.robot.upright[2]
        weight_N = STANDARD_GRAVITY_M_PER_S2 * machine.late_load_kg * down
        is_late = measured.time_s >= machine.late_load_from_s
        forces.append(is_late[:, None] * weight_N)
    return np.asarray(sum(forces)) if forces else None


def straightened_m(machine: Machine, tension_N: FloatArray, span_m: FloatArray) -> FloatArray:
    r"""Return what bending stiffness takes off the lengths [m].

    A cable of chord c under tension T, w_⊥ = w X / c across it, sags with the slope
    w_⊥ (c - 2 s)/(2 T); clamped ends bring the slope to zero within δ = √(EI/T). The arc is longer
    than the chord by half the square of the slope, which two thin layers reduce by
    3 δ w_⊥² c² / (8 T²).
    """
    rigidity = machine.flexural_rigidity_N_m2
    if rigidity == 0.0:
        return np.zeros_like(tension_N)
    # Odd in the rigidity, so that its slope at zero can be taken from both sides.
    layer = np.sign(rigidity) * np.sqrt(abs(rigidity) / tension_N)
    load = machine.cables.weight_N_per_m * span_m  # w_⊥ c
    return np.asarray(load**2 * 3.0 * layer / (8.0 * tension_N**2))


_STILL = 1e-5
"""Of the noise: far below what the slopes of a fit would show."""
_ABOUT = (0.7, 2.8)
"""Residual over the distrust within which the latter stays. A new distrust, a power of two, is at
most a factor of two below the residual; √2 more on either side keep it from swinging."""


@dataclass(frozen=True, slots=True, eq=False)
class Guess:
    """What internal forces are taken with.

    Parameters
    ----------
    added : array (n_rows, 2 n_cables)
        What sensors and stiff ends add to lengths [m] and tensions [N].
    distrust : (float, float)
        By how much more than noise lengths and tensions are off. As long as the model is off,
        readings are trusted to no more than that: else cables would be let slack to make up for an
        exit point in the wrong place.
    near : Statics or None
        The balance that it came from.
    """

    added: FloatArray
    distrust: tuple[float, float] = (1.0, 1.0)
    near: Statics | None = None

    def with_distrust(self, measured: Measured, displayed: Readings, noise: Noise) -> Guess:
        """Return the guess with a distrust that suits what is displayed."""
        sigma = noise.of_channels(measured.length_m.shape[1])
        length, tension = np.hsplit(np.abs(measured.readings - displayed.stacked) / sigma, 2)
        distrust = (_distrust(length, self.distrust[0]), _distrust(tension, self.distrust[1]))
        return replace(self, distrust=distrust)

    def is_near(self, previous: Guess, noise: Noise) -> bool:
        """Tell whether another guess would give the same, to a small share of the noise."""
        change = np.abs(self.added - previous.added)
        is_still = change <= _STILL * noise.of_channels(change.shape[1] // 2)
        return bool(is_still.all()) and self.distrust == previous.distrust


def _distrust(off: FloatArray, before: float) -> float:
    """Return how far readings are off in units of noise; as before where that is about right."""
    finite = off[~np.isnan(off)]
    size = MAD_TO_STD * float(np.median(finite)) if finite.size else 0.0
    if _ABOUT[0] <= size / before <= _ABOUT[1]:
        return before
    return float(2.0 ** np.floor(np.log2(max(size, 1.0))))


@dataclass(frozen=True, eq=False)
class Built:
    """A machine with effects on it, and the rows in the poses that it had.

    Parameters
    ----------
    machine : Machine
        With the effects.
    measured : Measured
        The rows.
    """

    machine: Machine
    measured: Measured

    @cached_property
    def _balance(self) -> InternalBalance:
        machine, measured = self.machine, self.measured
        force_N = added_force_N(machine, measured)
        return InternalBalance(machine.robot, measured.poses, machine.cables, force_N)

    def balanced(self, guess: Guess, noise: Noise, near: Statics | None = None) -> Statics:
        """Return the balance whose true lengths and tensions suit the readings."""
        length_m, tension_N = np.hsplit(self.measured.readings - guess.added, 2)
        doubt = noise.length_m * guess.distrust[0], noise.tension_N * guess.distrust[1]
        return self._balance.nearest(length_m, tension_N, doubt, near)


def true_readings(statics: Statics) -> Readings:
    """Return unstrained lengths and winch-side tensions."""
    return Readings(statics.length_m, statics.exit_tension_N)


Kind = tuple[object, ...]
"""A set of effects, whatever their values, with the noise that is assumed."""

_MOST_BUILT = 8
"""Machines that are kept: effects on readings, one after the other, leave the machine alone."""
_MOST_TURNS = 12
"""Turns at most: what sensors add depends little on internal forces, so that few will do."""


def kind_of(settings: Sequence[Setting], noise: Noise) -> Kind:
    """Return what a guess is remembered by."""
    return (noise, *(setting.effect.key for setting in settings))


@dataclass(eq=False)
class Predictor:
    """Predicts readings of one data set; remembers the last few machines it solved.

    Of a robot with as many cables as degrees of freedom the pose alone tells lengths and tensions.
    With more cables each row's internal forces are taken from its own readings, see
    `designer.diagnosis.problem`.

    Parameters
    ----------
    machine : Machine
        As drawn, without any effect.
    measured : Measured
        The data.
    fixed : tuple of Setting
        Effects that are declared; with those that are tried they act in the order of ``effects``.
    effects : KnownEffects
        All effects, in the order in which they act.
    session : int or None
        The session that the rows are of, from 1, where there are several; effects of others do not
        act.
    """

    machine: Machine
    measured: Measured
    fixed: tuple[Setting, ...] = ()
    effects: KnownEffects = SHIPPED
    session: int | None = None
    _guesses: dict[Kind, Guess] = field(init=False, default_factory=dict)
    _known: dict[Kind, tuple[Readings, Readings]] = field(init=False, default_factory=dict)
    _built: dict[Kind, tuple[Measured, Built]] = field(init=False, default_factory=dict)
    slopes: KeptSlopes = field(init=False, default_factory=KeptSlopes)

    def at(self, measured: Measured) -> Predictor:
        """Return the same model for other rows; for the same rows, one without a memory."""
        return replace(self, measured=measured)

    def built(self, settings: Sequence[Setting]) -> Machine:
        """Return the machine with the declared effects and these."""
        return as_built(self.machine, self._all(settings))

    def placed(self, settings: Sequence[Setting]) -> Measured:
        """Return the rows in the poses that the platform had, as these effects have it."""
        poses = self.measured.poses
        for setting in self._all(settings):
            if setting.effect.on_poses is not None:
                poses = setting.effect.on_poses(poses, setting.values)
        return replace(self.measured, poses=poses)

    def _kept(self, settings: Sequence[Setting]) -> Built:
        """Return machine and rows as these effects have them, from the latest where it is there."""
        bodily = (s for s in settings if s.effect.on_machine or s.effect.on_poses)
        key = tuple((s.effect.key, *s.values.values()) for s in bodily)
        rows, kept = self._built.get(key, (None, None))
        if kept is None or rows is not self.measured:
            kept = Built(self.built(settings), self.placed(settings))
            if len(self._built) >= _MOST_BUILT:
                self._built.clear()
            self._built[key] = self.measured, kept
        return kept

    def _all(self, settings: Sequence[Setting]) -> list[Setting]:
        """Return the effects that show in these rows, in the order in which they act."""
        all_settings = (*self.fixed, *settings)
        is_still = self.measured.settled
        return self.effects.in_order(
            s
            for s in all_settings
            if s.effect.session in (None, self.session)
            if not (is_still and s.effect.needs_motion)
        )

    def machines(self, settings: Sequence[Setting]) -> Iterator[tuple[BoolArray, Machine]]:
        """Yield the machine with the declared effects and these, and its rows (n_rows,)."""
        yield np.ones(self.measured.n_rows, dtype=np.bool_), self.built(settings)

    @property
    def row_unknowns(self) -> int:
        """Readings that each row gives up, for what they alone tell of it."""
        return self.spare_cables

    @property
    def spare_cables(self) -> int:
        """Cables beyond the degrees of freedom: internal forces of each row."""
        robot = self.machine.robot
        return max(robot.n_cables - robot.degrees_of_freedom, 0)

    def __call__(self, settings: Sequence[Setting], noise: Noise = EVEN) -> Readings:
        """Return what the sensors would show with these effects."""
        if self.spare_cables:
            return self._remembered(settings, noise, self._with_forces)[1]
        # Effects on readings leave the machine alone, so that their slopes cost no statics.
        bodily = [s for s in settings if s.effect.on_readings is None]
        return self._shown(self._remembered(bodily, noise, self._physical)[1], settings)

    def surroundings(self, settings: Sequence[Setting], noise: Noise = EVEN) -> Readings:
        """Return lengths and tensions that a residual may go with.

        What is predicted; but internal forces that were taken from lengths alone hold their noise,
        with which the residual would go of itself. Then it is what the pose alone tells.
        """
        if not self.spare_cables or np.isfinite(self.measured.tension_N).any():
            return self(settings, noise)
        return self._shown(self._physical(settings, noise)[1], settings)

    def true_readings(self, settings: Sequence[Setting], noise: Noise) -> Readings:
        """Return what was measured, less what sensors and stiff ends add to it in the model."""
        displayed = self(settings, noise)
        if self.spare_cables:
            true = self._remembered(settings, noise, self._with_forces)[0]
        else:
            limp = replace(self.built(settings), flexural_rigidity_N_m2=0.0)
            placed = self.placed(settings)
            true = readings_of(limp, placed.poses, placed)
        measured = self.measured.readings
        return Readings(*np.hsplit(measured - displayed.stacked + true.stacked, 2))

    def _remembered(
        self,
        settings: Sequence[Setting],
        noise: Noise,
        solve: Callable[[Sequence[Setting], Noise], tuple[Readings, Readings]],
    ) -> tuple[Readings, Readings]:
        key = (noise, *((s.effect.key, *s.values.values()) for s in settings))
        if key not in self._known:
            if len(self._known) > 64:  # more than the slopes of one fit ask for
                self._known.clear()
            self._known[key] = solve(settings, noise)
        return self._known[key]

    def distrust(self, settings: Sequence[Setting], noise: Noise) -> tuple[float, float]:
        """Return how much more than noise readings were off with these effects; see `Guess`."""
        guess = self._guesses.get(kind_of(settings, noise))
        return guess.distrust if guess else (1.0, 1.0)

    def _physical(self, settings: Sequence[Setting], _: Noise) -> tuple[Readings, Readings]:
        kept = self._kept(settings)
        readings = readings_of(kept.machine, kept.measured.poses, kept.measured)
        return readings, readings

    def _with_forces(self, settings: Sequence[Setting], noise: Noise) -> tuple[Readings, Readings]:
        kind = kind_of(settings, noise)
        guess, *answer = self._settled(settings, noise, judges=kind not in self._guesses)
        self._guesses[kind] = guess  # near what it will be for the next values of these effects
        return answer[0], answer[1]

    def trust_anew(self, settings: Sequence[Setting], noise: Noise) -> bool:
        """Judge anew how far readings can be trusted with these effects; tell if that changed.

        Between two calls it stays, so that residuals have slopes.
        """
        if not self.spare_cables:
            return False
        kind = kind_of(settings, noise)
        before = self._guesses.get(kind)
        guess = self._guesses[kind] = self._settled(settings, noise, judges=True)[0]
        if before is not None and before.distrust == guess.distrust:
            return False
        self._known.clear()
        return True

    def trust_as(self, known: Sequence[Setting], effects: Sequence[Effect], noise: Noise) -> None:
        """Trust readings with effects that were not tried yet as with those of a known model.

        Losses of two models are to be compared, of which one has the other's effects and more.
        """
        kind = (noise, *(effect.key for effect in effects))
        guess = self._guesses.get(kind_of(known, noise))
        if guess is not None:
            self._guesses.setdefault(kind, guess)

    def _settled(
        self, settings: Sequence[Setting], noise: Noise, *, judges: bool
    ) -> tuple[Guess, Readings, Readings]:
        """Repeat until what sensors and stiff ends add, and how far readings are off, agree.

        What they add depends on the internal forces in turn, though little.
        """
        kept, sensing = self._kept(settings), self._sensing(settings)
        nothing = Guess(np.zeros_like(kept.measured.readings))
        guess = self._guesses.get(kind_of(settings, noise), nothing)
        # Of two ways to hold a row, where there are two, the first judgement chooses.
        near = None if judges else guess.near
        if near is not None:  # what these values add to it
            _, displayed, guess = _displayed(kept, sensing, near, guess)
        for _ in range(_MOST_TURNS):
            held = kept.balanced(guess, noise, near)
            near = None if judges else held
            before = guess
            true, displayed, guess = _displayed(kept, sensing, held, before)
            if judges:
                guess = guess.with_distrust(kept.measured, displayed, noise)
            if guess.is_near(before, noise):
                break
        return guess, true, displayed

    def _shown(self, readings: Readings, settings: Sequence[Setting]) -> Readings:
        return _shown(self._kept(settings), self._sensing(settings), readings)

    def _sensing(self, settings: Sequence[Setting]) -> list[Setting]:
        """Return the effects that act on readings, in the order in which they do."""
        return [s for s in self._all(settings) if s.effect.on_readings is not None]


def _displayed(
    kept: Built, sensing: Sequence[Setting], held: Statics, guess: Guess
) -> tuple[Readings, Readings, Guess]:
    """Return true and displayed readings of a balance, and the guess that it leads to."""
    true = true_readings(held)
    displayed = _shown(kept, sensing, with_stiff_ends(kept.machine, held, true))
    added = np.nan_to_num(displayed.stacked - true.stacked)
    return true, displayed, replace(guess, added=added, near=held)


def _shown(kept: Built, sensing: Sequence[Setting], readings: Readings) -> Readings:
    for setting in sensing:
        assert setting.effect.on_readings is not None
        # Of a law that takes the machine, as the other effects have it.
        more = {"machine": kept.machine} if setting.effect.takes_machine else {}
        readings = setting.effect.on_readings(readings, setting.values, kept.measured, **more)
    return readings


@dataclass(frozen=True, slots=True, eq=False)
class Problem:
    """Data, model and noise.

    Parameters
    ----------
    measured : Measured
        The data.
    predict : Predictor
        The model.
    noise : Noise
        Scale of the residual.
    """

    measured: Measured
    predict: Predictor
    noise: Noise

    @property
    def sigma(self) -> FloatArray:
        """Noise of each channel: lengths [m], then tensions [N] (2 n_cables,)."""
        return self.noise.of_channels(self.measured.length_m.shape[1])

    def free_readings(self, mask: BoolArray) -> int:
        """Return how many of the readings taken (n_rows, 2 n_cables) are left to test the model.

        A row of a redundant robot gives up one for each cable to spare, for its internal forces,
        and as many as its degrees of freedom where its pose was not measured.
        """
        given_up = self.predict.row_unknowns
        return int(np.maximum(mask.sum(axis=1) - given_up, 0).sum())

    def predicted(self, settings: Sequence[Setting]) -> Readings:
        """Return what the sensors would show with these effects."""
        return self.predict(settings, self.noise)

    def surroundings(self, settings: Sequence[Setting]) -> Readings:
        """Return lengths and tensions that a residual may go with; see `Predictor`."""
        return self.predict.surroundings(settings, self.noise)

    def used(self, rows: BoolArray) -> BoolArray:
        """Return what is read in some rows (n_rows,), by the columns of `misfit`."""
        return rows[:, None] & self.measured.is_read

    def in_noise(self, settings: Sequence[Setting]) -> FloatArray:
        """Return what is predicted, by the columns of `misfit`; coordinates from what was read."""
        predicted = self.predicted(settings)
        off = predicted.coordinates_off
        return np.hstack([predicted.stacked / self.sigma, *([] if off is None else [-off])])

    def misfit(self, settings: Sequence[Setting]) -> FloatArray:
        """Return what a fit makes small: the residual, then that of coordinates of poses in part.

        In units of noise (n_rows, 2 n_cables, or 6 more); NaN where not measured.
        """
        off = self.predicted(settings).coordinates_off
        residual = self.residual(settings)
        if off is None:
            return residual
        return np.where(self.measured.is_read, np.hstack([residual, off]), np.nan)

    def residual(self, settings: Sequence[Setting]) -> FloatArray:
        """Return (measured - predicted) / noise (n_rows, 2 n_cables); NaN where not measured."""
        read, sigma, predicted = (
            self.measured.readings,
            self.sigma,
            self.predicted(settings).stacked,
        )
        residual = np.asarray((read - predicted) / sigma)
        unheld = np.isnan(predicted) & ~np.isnan(read)
        if unheld.any():
            # No other error is worse than a pose that the model cannot hold.
            residual[unheld] = (1e3 + 10.0 * np.abs(read) / sigma)[unheld]
        return residual

    def holds(self, settings: Sequence[Setting]) -> BoolArray:
        """Tell which rows (n_rows,) the model can hold, as far as they were read."""
        unheld = np.isnan(self.predicted(settings).stacked) & ~np.isnan(self.measured.readings)
        return np.asarray(~unheld.any(axis=1))


def imbalance_of(predict: Predictor, settings: Sequence[Setting]) -> FloatArray | None:
    """Return what a model leaves out of balance in each row, over the weight (n_rows,).

    None where there are enough cables to balance every pose; see `designer.statics.balance`.
    """
    if predict.machine.robot.has_enough_cables:
        return None
    placed = predict.placed(settings)
    left = np.full(placed.n_rows, np.nan)
    for rows, machine in predict.machines(settings):
        own = placed if rows.all() else placed.part(rows)
        force = added_force_N(machine, own)
        statics = solve_underactuated(machine.robot, own.poses, machine.cables, force)
        left[rows] = imbalance(statics)
    return left


def channel_names(n_cables: int) -> list[str]:
    """Return the names of the columns of a residual."""
    return [f"{kind} {k}" for kind in ("length", "tension") for k in range(1, n_cables + 1)]
