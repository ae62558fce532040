"""The drum of a winch: how much rope it takes up in layers, and how far aside the rope runs."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Annotated

import numpy as np

from designer import checked
from designer.arrays import FloatArray

MOST_LAYERS = 50
DEAD_TURNS = 3
"""Turns that stay on the drum; crane standards ask for two at least."""
ROPE_OVERSIZE = 0.05
"""By how much a steel wire rope may be thicker than nominal, EN 12385-4."""


@dataclass(frozen=True, slots=True)
class Drum(checked.Value):
    r"""A drum between two flanges, which a rope fills turn by turn and layer by layer.

    A turn of layer k is a helix about the rope's centre, :math:`\sqrt{(\pi D_k)^2 + p^2}` with
    :math:`D_k = D + d + 2 (k - 1) h`. The rope of a layer lies between two turns of the one below,
    which is :math:`h = \sqrt{d^2 - p^2 / 4}` lower: 0.866 d where turns touch. Layers have n and
    n - 1 turns by turns, n of them between the flanges.

    On a smooth drum d is that of the thickest rope that may be delivered, of which fewer turns, and
    fewer layers to the nearest, have room. In grooves it has as many, and longer: d is nominal.

    Parameters
    ----------
    diameter_m : float
        D, at the bottom of the grooves [m].
    length_m : float
        Between the flanges [m].
    layers : int
        Of rope at most.
    groove_pitch_m : float or None
        p, from turn to turn [m]; None for a smooth drum, on which turns touch.
    dead_turns : int
        Turns of the lowest layer that are never paid out.
    sheave_distance_m : float or None
        From the axis to the first sheave, opposite the middle of the drum [m].
    fleet_angle_max_rad : float or None
        Largest angle of the rope to the plane across the axis [rad].
    rope_oversize : float
        By how much of its nominal diameter a rope may be thicker.
    """

    diameter_m: checked.Positive
    length_m: checked.Positive
    layers: Annotated[int, checked.Number(least=1, most=MOST_LAYERS)] = 1
    groove_pitch_m: checked.Positive | None = None
    dead_turns: Annotated[int, checked.Number(least=0)] = DEAD_TURNS
    sheave_distance_m: checked.Positive | None = None
    fleet_angle_max_rad: checked.Positive | None = None
    rope_oversize: checked.NotNegative = ROPE_OVERSIZE

    def fits(self, rope_m: float) -> bool:
        """Tell whether turns of a rope lie beside each other, and layers on each other."""
        pitch_m = self.groove_pitch_m
        return pitch_m is None or rope_m <= pitch_m < 2.0 * rope_m

    def _thickest_m(self, rope_m: float) -> float:
        """Return the diameter of the rope that the drum takes up least of, of a nominal one [m]."""
        return rope_m * (1.0 + self.rope_oversize) if self.groove_pitch_m is None else rope_m

    def layers_of(self, rope_m: float) -> int:
        """Return how many layers of that are as high as those of a nominal rope [m]."""
        return max(round(self.layers * rope_m / self._thickest_m(rope_m)), 1)

    def diameters_m(self, rope_m: float) -> FloatArray:
        """Return the diameter of each layer about the rope's centre (`MOST_LAYERS`,) [m]."""
        thick_m = self._thickest_m(rope_m)
        pitch_m = self.groove_pitch_m or thick_m
        step_m = math.sqrt(max(thick_m**2 - pitch_m**2 / 4.0, 0.0))
        return np.asarray(self.diameter_m + thick_m + 2.0 * step_m * np.arange(MOST_LAYERS))

    def turn_m(self, rope_m: float) -> float:
        """Return the rope of one turn of the lowest layer [m]."""
        return float(self.taken_m(rope_m)[1][0])

    def taken_m(self, rope_m: float) -> tuple[FloatArray, FloatArray]:
        """Return turns of each layer, and the length of one (`MOST_LAYERS`,) [m].

        Beside the dead turns; none at all where the rope does not fit.
        """
        pitch_m = self.groove_pitch_m or self._thickest_m(rope_m)
        turn_m = np.hypot(math.pi * self.diameters_m(rope_m), pitch_m)
        count = math.floor(self.length_m / pitch_m * (1.0 + 1e-12)) if self.fits(rope_m) else 0
        turns = np.where(np.arange(MOST_LAYERS) % 2 == 0, float(count), count - 1.0)
        turns[0] -= self.dead_turns
        return (turns if turns[0] >= 0.0 and count > 1 else np.zeros(MOST_LAYERS)), turn_m

    def capacity_m(self, rope_m: float) -> float:
        """Return how much rope it takes up and pays out [m]."""
        turns, turn_m = self.taken_m(rope_m)
        return float((turns * turn_m)[: self.layers_of(rope_m)].sum())

    def spooled(self, rope_m: float, stroke_m: float) -> tuple[float, int]:
        """Return turns beside the dead ones, and layers, of so much rope [m]; NaN and 0 for none.

        In more layers than it may have, if need be.
        """
        turns, turn_m = self.taken_m(rope_m)
        full_m = np.cumsum(turns * turn_m)
        if stroke_m > full_m[-1] or math.isnan(stroke_m):
            return math.nan, 0
        k = int(np.searchsorted(full_m, stroke_m))
        below_m = full_m[k - 1] if k else 0.0
        return float(turns[:k].sum() + (stroke_m - below_m) / turn_m[k]), k + 1

    @property
    def fleet_angle_rad(self) -> float | None:
        """The angle at a flange; None where the sheave is not given [rad]."""
        if self.sheave_distance_m is None:
            return None
        return math.atan(0.5 * self.length_m / self.sheave_distance_m)
