"""What the sensors would show in the measured poses, with given effects in the model."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from designer.arrays import FloatArray
from designer.effects.effect import Readings, Setting, as_built
from designer.machine import Machine
from designer.measured_data import EVEN, Measured, Noise
from designer.robot import Poses
from designer.statics.internal import solve_internal
from designer.statics.inverse import solve_sagging
from designer.statics.nearest import solve_nearest

AIR_DENSITY_KG_PER_M3 = 1.225
"""Dry air at 15 °C and sea level, ISO 2533 [kg/m³]."""

_MOST_TURNS = 12
_STILL = 1e-7
_ABOUT = (0.7, 2.8)


class Predictor:
    """Predicts readings of one data set; remembers the last few machines it solved.

    Of a robot with as many cables as degrees of freedom the pose alone tells lengths and tensions,
    and effects on readings leave the machine alone, so that their slopes cost no statics. With
    more cables each row's internal forces are taken from its own readings, see
    `designer.statics.internal`.

    Parameters
    ----------
    machine : Machine
        As declared.
    measured : Measured
        The data.
    fixed : sequence of Setting
        Effects on readings that are declared: they act before all others.
    """

    def __init__(self, machine: Machine, measured: Measured, fixed: Sequence[Setting] = ()) -> None:
        self._machine = machine
        self._measured = measured
        self._fixed = tuple(fixed)
        self._guesses: dict[tuple[object, ...], _Guess] = {}
        self._known: dict[tuple[object, ...], tuple[Readings, Readings]] = {}

    @property
    def spare_cables(self) -> int:
        """Cables beyond the degrees of freedom: internal forces of each row."""
        robot = self._machine.robot
        return max(robot.n_cables - robot.degrees_of_freedom, 0)

    def __call__(self, settings: Sequence[Setting], noise: Noise = EVEN) -> Readings:
        """Return what the sensors would show with these effects, applied in their order."""
        if self.spare_cables:
            return self._remembered(settings, noise, self._nearest_to_readings)[1]
        bodily = [s for s in settings if s.effect.on_machine is not None]
        return self._shown(self._remembered(bodily, noise, self._physical)[1], settings)

    def surroundings(self, settings: Sequence[Setting], noise: Noise = EVEN) -> Readings:
        """Return lengths and tensions that a residual may go with.

        What is predicted; but internal forces that were taken from lengths alone hold their noise,
        with which the residual would go of itself. Then it is what the pose alone tells.
        """
        if not self.spare_cables or np.isfinite(self._measured.tension_N).any():
            return self(settings, noise)
        machine = as_built(self._machine, settings)
        return self._shown(readings_of(machine, self._measured.poses, self._measured), settings)

    def true_readings(self, settings: Sequence[Setting], noise: Noise = EVEN) -> Readings:
        """Return what was measured, less what sensors and stiff ends add to it in the model."""
        shown = self(settings, noise)
        if self.spare_cables:
            true = self._remembered(settings, noise, self._nearest_to_readings)[0]
        else:
            limp = replace(as_built(self._machine, settings), flexural_rigidity_N_m2=0.0)
            true = readings_of(limp, self._measured.poses, self._measured)
        return Readings(
            self._measured.length_m - shown.length_m + true.length_m,
            self._measured.tension_N - shown.tension_N + true.tension_N,
        )

    def _remembered(
        self,
        settings: Sequence[Setting],
        noise: Noise,
        solve: Callable[[Sequence[Setting], Noise], tuple[Readings, Readings]],
    ) -> tuple[Readings, Readings]:
        key = (noise, *((s.effect.key, *s.values.values()) for s in settings))
        if key not in self._known:
            if len(self._known) > 64:
                self._known.clear()
            self._known[key] = solve(settings, noise)
        return self._known[key]

    def _physical(self, settings: Sequence[Setting], _: Noise) -> tuple[Readings, Readings]:
        machine = as_built(self._machine, settings)
        readings = readings_of(machine, self._measured.poses, self._measured)
        return readings, readings

    def trust_anew(self, settings: Sequence[Setting], noise: Noise) -> bool:
        """Judge anew how far readings can be trusted with these effects; tell if that changed.

        Between two calls it stays, so that residuals have slopes.
        """
        if not self.spare_cables:
            return False
        kind = _kind(settings, noise)
        before = self._guesses[kind].distrust if kind in self._guesses else None
        self._guesses[kind] = self._settled(settings, noise, judges=True)[0]
        if before == self._guesses[kind].distrust:
            return False
        self._known.clear()
        return True

    def _nearest_to_readings(
        self, settings: Sequence[Setting], noise: Noise
    ) -> tuple[Readings, Readings]:
        """Take internal forces from what was read; return what is there, and what is shown."""
        kind = _kind(settings, noise)
        guess, true, shown = self._settled(settings, noise, judges=kind not in self._guesses)
        self._guesses[kind] = guess  # near what it will be for the next values of these effects
        return true, shown

    def _settled(
        self, settings: Sequence[Setting], noise: Noise, *, judges: bool
    ) -> tuple[_Guess, Readings, Readings]:
        """Repeat until what sensors and stiff ends add, and how far readings are off, agree.

        What they add depends on the internal forces in turn, though little.
        """
        machine = as_built(self._machine, settings)
        shape = (2, *self._measured.length_m.shape)
        guess = self._guesses.get(_kind(settings, noise), _Guess(np.zeros(shape)))
        for _ in range(_MOST_TURNS):
            true, straightened = _balanced(machine, self._measured, guess, noise)
            shown = self._shown(straightened, settings)
            before, guess = guess, guess.after(self._measured, true, shown, noise, judges=judges)
            if guess.is_near(before, noise):
                break
        return guess, true, shown

    def _shown(self, readings: Readings, settings: Sequence[Setting]) -> Readings:
        for setting in (*self._fixed, *settings):
            if setting.effect.on_readings is not None:
                readings = setting.effect.on_readings(readings, setting.values, self._measured)
        return readings


def _kind(settings: Sequence[Setting], noise: Noise) -> tuple[object, ...]:
    return (noise, *(setting.effect.key for setting in settings))


@dataclass(frozen=True, slots=True, eq=False)
class _Guess:
    """What internal forces are taken with.

    Parameters
    ----------
    added : array (2, n_rows, n_cables)
        What sensors and stiff ends add to lengths [m] and tensions [N].
    distrust : (float, float)
        By how much more than noise lengths and tensions are off. As long as the model is off,
        readings are trusted to no more than that: else cables would be let slack to make up for an
        exit point in the wrong place.
    """

    added: FloatArray
    distrust: tuple[float, float] = (1.0, 1.0)

    def after(
        self, measured: Measured, true: Readings, shown: Readings, noise: Noise, *, judges: bool
    ) -> _Guess:
        """Return the guess that an answer leads to; with ``judges``, also of the distrust."""
        more = (shown.length_m - true.length_m, shown.tension_N - true.tension_N)
        if not judges:
            return _Guess(np.nan_to_num(more), self.distrust)
        length = np.abs(measured.length_m - shown.length_m) / noise.length_m
        tension = np.abs(measured.tension_N - shown.tension_N) / noise.tension_N
        distrust = (_distrust(length, self.distrust[0]), _distrust(tension, self.distrust[1]))
        return _Guess(np.nan_to_num(more), distrust)

    def is_near(self, other: _Guess, noise: Noise) -> bool:
        """Tell whether another guess would give the same, to a small share of the noise."""
        change = np.abs(self.added - other.added).max(axis=(1, 2))
        still = change[0] <= _STILL * noise.length_m and change[1] <= _STILL * noise.tension_N
        return bool(still) and self.distrust == other.distrust


def _distrust(off: FloatArray, before: float) -> float:
    """Return how far readings are off in units of noise; as before where that is about right."""
    known = off[~np.isnan(off)]
    size = 1.4826 * float(np.median(known)) if known.size else 0.0
    if _ABOUT[0] <= size / before <= _ABOUT[1]:
        return before
    return float(2.0 ** np.floor(np.log2(max(size, 1.0))))


def _balanced(
    machine: Machine, measured: Measured, guess: _Guess, noise: Noise
) -> tuple[Readings, Readings]:
    """Return true lengths and tensions, and those of cables with stiff ends."""
    statics = solve_internal(
        machine.robot,
        measured.poses,
        machine.cable,
        measured.length_m - guess.added[0],
        measured.tension_N - guess.added[1],
        (noise.length_m * guess.distrust[0], noise.tension_N * guess.distrust[1]),
        wind_force_N(machine, measured),
    )
    length, tension = statics.length_m, statics.exit_tension_N
    span = statics.geometry().horizontal_distance_m
    straightened = length - _straightened_m(machine, tension, span)
    return Readings(length, tension), Readings(straightened, tension)


def readings_of(machine: Machine, poses: Poses, measured: Measured | None = None) -> Readings:
    """Return unstrained lengths and winch-side tensions of a machine in poses (n_rows,).

    Robots with as many cables as degrees of freedom are solved exactly. With fewer cables the
    tensions nearest to balance are taken, see `designer.statics.nearest`.
    """
    force = None if measured is None else wind_force_N(machine, measured)
    if machine.robot.is_square:
        statics = solve_sagging(machine.robot, poses, machine.cable, force)
        length, tension = statics.length_m, statics.exit_tension_N
        span = statics.geometry().horizontal_distance_m
    else:
        length, tension, span = solve_nearest(machine.robot, poses, machine.cable, force)
    return Readings(length - _straightened_m(machine, tension, span), tension)


def wind_force_N(machine: Machine, measured: Measured) -> FloatArray | None:
    """Return the wind's force on the platform, base frame (n_rows, 3) [N]; None without."""
    if machine.drag_area_m2 == 0.0 or measured.wind_m_per_s is None:
        return None
    wind = measured.wind_m_per_s
    speed = np.linalg.norm(wind, axis=1, keepdims=True)
    return np.asarray(0.5 * AIR_DENSITY_KG_PER_M3 * machine.drag_area_m2 * speed * wind)


def _straightened_m(machine: Machine, tension_N: FloatArray, span_m: FloatArray) -> FloatArray:
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
    load = machine.cable.weight_N_per_m * span_m  # w_⊥ c
    return np.asarray(load**2 * 3.0 * layer / (8.0 * tension_N**2))
