"""What the sensors of a robot with cables to spare would show.

The internal forces of each row are taken from its own readings; see `designer.statics.internal`.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from designer.arrays import FloatArray
from designer.diagnosis.physical import added_force_N, straightened_m
from designer.diagnosis.robust import MAD_TO_STD
from designer.effects.effect import Readings, Setting
from designer.model.machine import Machine
from designer.model.measured_data import Measured, Noise
from designer.statics.internal import solve_internal

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
    shown : callable
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
