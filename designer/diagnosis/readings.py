"""Lengths and tensions of a machine in its poses, by statics alone.

Of a robot with cables to spare the internal forces of each row are taken from its own readings; see
`designer.statics.internal`.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from designer.arrays import FloatArray
from designer.diagnosis.statistics import MAD_TO_STD
from designer.effects.effect import Readings, Setting
from designer.model.cable import STANDARD_GRAVITY_M_PER_S2
from designer.model.machine import Machine
from designer.model.measured_data import Measured, Noise
from designer.model.robot import Poses
from designer.statics.internal import solve_internal
from designer.statics.inverse import solve_sagging
from designer.statics.taut import solve_taut
from designer.statics.underactuated import imbalance, solve_underactuated

AIR_DENSITY_KG_PER_M3 = 1.225
"""Dry air at 15 °C and sea level, ISO 2533 [kg/m³]."""


def readings_of(machine: Machine, poses: Poses, measured: Measured | None = None) -> Readings:
    """Return unstrained lengths and winch-side tensions of a machine in poses (n_rows,).

    Robots with as many cables as degrees of freedom are solved exactly, those with fewer as
    `designer.statics.underactuated` has it. With more, the tensions nearest to balance are taken,
    see `designer.statics.taut`.
    """
    force = None if measured is None else added_force_N(machine, measured)
    if machine.robot.is_redundant:
        length, tension, span = solve_taut(machine.robot, poses, machine.cable, force)
        return Readings(length - straightened_m(machine, tension, span), tension)
    if machine.robot.is_square:  # hangs in the way that it was tightened to, better ones or not
        statics = solve_sagging(machine.robot, poses, machine.cable, force, seeks_better=False)
    else:
        statics = solve_underactuated(machine.robot, poses, machine.cable, force)
    length, tension = statics.length_m, statics.exit_tension_N
    if machine.flexural_rigidity_N_m2:
        span = statics.geometry().horizontal_distance_m
        length = length - straightened_m(machine, tension, span)
    return Readings(length, tension)


def imbalance_of(machine: Machine, measured: Measured) -> FloatArray | None:
    """Return what is out of balance in each row, over the weight (n_rows,).

    None where there are enough cables to balance every pose; see `designer.statics.underactuated`.
    """
    if machine.robot.has_enough_cables:
        return None
    force = added_force_N(machine, measured)
    return imbalance(solve_underactuated(machine.robot, measured.poses, machine.cable, force))


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
    load = machine.cable.weight_N_per_m * span_m  # w_⊥ c
    return np.asarray(load**2 * 3.0 * layer / (8.0 * tension_N**2))


_MOST_TURNS = 12
"""Turns at most: what sensors add depends little on internal forces, so that few will do."""
_STILL = 1e-7
"""Of the noise: far below what the slopes of a fit would show."""
_ABOUT = (0.7, 2.8)
"""Residual over the distrust within which the latter stays. A new distrust, a power of two, is at
most a factor of two below the residual; √2 more on either side keep it from swinging."""


class InternalForces:
    """Predicts readings row by row from what was read; remembers a guess for each set of effects.

    Parameters
    ----------
    built : callable
        The machine with given effects.
    sensors : callable
        What sensors make of lengths and tensions that are there, with given effects.
    """

    def __init__(
        self,
        built: Callable[[Sequence[Setting]], Machine],
        sensors: Callable[[Readings, Sequence[Setting]], Readings],
    ) -> None:
        self._built = built
        self._shown = sensors
        self._guesses: dict[tuple[object, ...], _Guess] = {}

    def trust_anew(self, settings: Sequence[Setting], noise: Noise, measured: Measured) -> bool:
        """Judge anew how far readings can be trusted with these effects; tell if that changed.

        Between two calls it stays, so that residuals have slopes.
        """
        kind = _kind(settings, noise)
        before = self._guesses[kind].distrust if kind in self._guesses else None
        self._guesses[kind] = self._settled(settings, noise, measured, judges=True)[0]
        return before != self._guesses[kind].distrust

    def readings(
        self, settings: Sequence[Setting], noise: Noise, measured: Measured
    ) -> tuple[Readings, Readings]:
        """Return lengths and tensions that are there, and those that the sensors show."""
        kind = _kind(settings, noise)
        judges = kind not in self._guesses
        guess, true, displayed = self._settled(settings, noise, measured, judges=judges)
        self._guesses[kind] = guess  # near what it will be for the next values of these effects
        return true, displayed

    def _settled(
        self, settings: Sequence[Setting], noise: Noise, measured: Measured, *, judges: bool
    ) -> tuple[_Guess, Readings, Readings]:
        """Repeat until what sensors and stiff ends add, and how far readings are off, agree.

        What they add depends on the internal forces in turn, though little.
        """
        machine = self._built(settings)
        shape = (2, *measured.length_m.shape)
        guess = self._guesses.get(_kind(settings, noise), _Guess(np.zeros(shape)))
        for _ in range(_MOST_TURNS):
            true, straightened = _balanced(machine, measured, guess, noise)
            displayed = self._shown(straightened, settings)
            before, guess = guess, guess.after(measured, true, displayed, noise, judges=judges)
            if guess.is_near(before, noise):
                break
        return guess, true, displayed


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
        self, measured: Measured, true: Readings, readings: Readings, noise: Noise, *, judges: bool
    ) -> _Guess:
        """Return the guess that an answer leads to; with ``judges``, also of the distrust."""
        more = (readings.length_m - true.length_m, readings.tension_N - true.tension_N)
        if not judges:
            return _Guess(np.nan_to_num(more), self.distrust)
        length = np.abs(measured.length_m - readings.length_m) / noise.length_m
        tension = np.abs(measured.tension_N - readings.tension_N) / noise.tension_N
        distrust = (_distrust(length, self.distrust[0]), _distrust(tension, self.distrust[1]))
        return _Guess(np.nan_to_num(more), distrust)

    def is_near(self, previous: _Guess, noise: Noise) -> bool:
        """Tell whether another guess would give the same, to a small share of the noise."""
        change = np.abs(self.added - previous.added).max(axis=(1, 2))
        still = change[0] <= _STILL * noise.length_m and change[1] <= _STILL * noise.tension_N
        return bool(still) and self.distrust == previous.distrust


def _distrust(off: FloatArray, before: float) -> float:
    """Return how far readings are off in units of noise; as before where that is about right."""
    finite = off[~np.isnan(off)]
    size = MAD_TO_STD * float(np.median(finite)) if finite.size else 0.0
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
        added_force_N(machine, measured),
    )
    length, tension = statics.length_m, statics.exit_tension_N
    span = statics.geometry().horizontal_distance_m
    straightened = length - straightened_m(machine, tension, span)
    return Readings(length, tension), Readings(straightened, tension)
