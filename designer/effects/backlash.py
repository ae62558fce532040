"""Play between what is counted and what pays out the cable, or friction that holds it back."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from designer.arrays import FloatArray
from designer.effects.effect import Effect, Parameter, Readings, Size, Values, per_cable
from designer.model.measured_data import Measured
from designer.units import LENGTH

_SIZE = Size(2e-3, bounds=(-0.5, 0.5), plausible=(-0.1, 0.1))


def direction_of(length_m: FloatArray) -> FloatArray:
    """Return how each cable moved last (n_rows, n_cables): 1 out, -1 in, 0 before it moves."""
    known_m = _last_known(length_m)
    sign = np.sign(np.diff(known_m, axis=0, prepend=known_m[:1]))
    return np.nan_to_num(_last_known(np.where(sign == 0.0, np.nan, sign)))


def _last_known(values: FloatArray) -> FloatArray:
    """Return values (n_rows, n_columns), those before in their columns in the place of NaN."""
    rows = np.where(np.isnan(values), 0, np.arange(len(values))[:, None])
    return np.take_along_axis(values, np.maximum.accumulate(rows, axis=0), axis=0)


def dragged_m(length_m: FloatArray, play_m: FloatArray) -> FloatArray:
    """Return what lengths (n_rows, n_cables) drag along with a play of (n_cables,) [m].

    The play operator, from the middle of the play in the first row.
    """
    answer = np.array(length_m)
    for row in range(1, len(length_m)):
        before, now = answer[row - 1], length_m[row]
        dragged = np.clip(
            np.where(np.isnan(before), now, before), now - play_m / 2, now + play_m / 2
        )
        answer[row] = np.where(np.isnan(now), before, dragged)
    return np.where(np.isnan(length_m), np.nan, answer)


def _change(readings: Readings, values: Values, measured: Measured) -> Readings:
    true_m = readings.length_m
    play_m = per_cable(values, "play_{cable}_m", true_m.shape[1])
    read_m = true_m + 0.5 * play_m * direction_of(true_m)
    is_dragged = play_m < 0.0
    read_m[:, is_dragged] = dragged_m(true_m[:, is_dragged], -play_m[is_dragged])
    return replace(readings, length_m=read_m)


EFFECT = Effect(
    id="backlash",
    summary="play or friction between winch and encoder: lengths depend on the direction of motion",
    law="measured length is ahead of the true one by half the play in the direction of motion; "
    "with a negative play it is dragged along behind",
    source="play operator: Visintin, Differential Models of Hysteresis, 1994",
    parameters=(Parameter("play_{cable}_m", LENGTH, _SIZE, is_optional=True),),
    on_readings=_change,
    needs=frozenset({"length", "reversals"}),
    follows_rows=True,
)
