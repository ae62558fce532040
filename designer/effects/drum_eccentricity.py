"""Drums off centre: the length goes in waves, one a turn."""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple

import numpy as np

from designer.arrays import FloatArray
from designer.effects.effect import Effect, Parameter, Readings, Size, Values
from designer.effects.load_step import LEAST_ROWS
from designer.effects.winch_scale import ZERO
from designer.model.measured_data import Measured
from designer.units import ANGLE, LENGTH

_SHORTEST_M = 0.05
"""Round the smallest drum."""
_LEAST_WAVES, _MOST_WAVES = 3, 8000
"""Quarters of a wave in the span of the lengths, at most: fewer waves than three are a bend."""
_REPEATS = 8
"""Until a count agrees with its own wave, which changes it by a tenth of itself at most."""


class BestWave(NamedTuple):
    """The wave that explains most of a column: its share of the variance, and its values.

    Beside them its length [m], its cosine, sine and constant (3,), and how many were looked at.
    """

    share: float
    values: FloatArray
    length_m: float
    parts: FloatArray
    looks: int


def best_wave(length_m: FloatArray, column: FloatArray) -> BestWave | None:
    """Return the wave in lengths (n_rows,) that explains most of a column of zero mean (n_rows,).

    By least squares with a constant (Zechmeister and Kürster, Astron. Astrophys. 496, 2009), whose
    sums over all waves at once are Fourier transforms of the lengths in fine bins. None where rows
    or their span are too few.
    """
    start = float(length_m.min(initial=np.inf))
    span_m = float(length_m.max(initial=-np.inf)) - start
    if len(column) < 4 * LEAST_ROWS or span_m < _LEAST_WAVES * _SHORTEST_M:
        return None
    # A quarter of a wave over the whole span between one and the next.
    waves = np.arange(4 * _LEAST_WAVES, int(min(4.0 * span_m / _SHORTEST_M, _MOST_WAVES)) + 1)
    n_bins = 8 * 2 ** int(np.ceil(np.log2(waves[-1])))
    bins = np.rint((length_m - start) / (4.0 * span_m) * n_bins).astype(np.int64)
    rows, read = (np.fft.rfft(np.bincount(bins, weights, n_bins)) for weights in (None, column))
    n, once, twice, y = len(column), rows[waves], rows[2 * waves], read[waves]
    cc = 0.5 * (n + twice.real) - once.real**2 / n
    ss = 0.5 * (n - twice.real) - once.imag**2 / n
    cs = 0.5 * twice.imag - once.real * once.imag / n
    square = np.maximum(cc * ss - cs**2, 1e-6 * n**2)
    explained = (ss * y.real**2 + cc * y.imag**2 - 2.0 * cs * y.real * y.imag) / square
    wave_m = 4.0 * span_m / float(waves[np.argmax(explained)])
    turns = 2.0 * np.pi / wave_m * length_m
    basis = np.stack([np.cos(turns), np.sin(turns), np.ones_like(turns)], axis=1)
    parts = np.linalg.lstsq(basis, column, rcond=None)[0]
    values = basis @ parts
    share = float(values @ values / max(column @ column, 1e-300))
    return BestWave(share, values, wave_m, parts, len(waves))


def _change(readings: Readings, values: Values, measured: Measured, *, cable: int) -> Readings:
    """Return what the winch counts, which the wave goes with."""
    per_m = 2.0 * np.pi / values["circumference_m"]
    homed_m = readings.length_m[:, cable - 1] + values.get("offset_m", 0.0)
    count_m = homed_m
    for _ in range(_REPEATS):
        turn = per_m * count_m + values["phase_rad"]
        count_m = homed_m + values["amplitude_m"] * np.sin(turn)
    length = np.array(readings.length_m)
    length[:, cable - 1] = count_m
    return replace(readings, length_m=length)


def _starts(
    measured: Measured, residual: FloatArray, *, cable: int
) -> tuple[dict[str, float], ...]:
    """Start with the wave that explains most of what does not stand off."""
    count_m, column = measured.length_m[:, cable - 1], residual[:, cable - 1]
    is_read = np.isfinite(column) & np.isfinite(count_m)
    off = column[is_read] - np.median(column[is_read]) if is_read.any() else np.empty(0)
    is_sound = np.abs(off) <= 6.0 * np.median(np.abs(off)) if off.size else np.empty(0, bool)
    sound_m = count_m[is_read][is_sound]
    best = best_wave(sound_m, off[is_sound] - np.mean(off[is_sound])) if off.size else None
    if best is None:
        return ()
    cosine, sine, _ = best.parts.tolist()
    amplitude_m, phase = float(np.hypot(cosine, sine)), float(np.arctan2(cosine, sine))
    start = {"amplitude_m": amplitude_m, "phase_rad": phase, "circumference_m": best.length_m}
    return (start,)


_ECCENTRICITY = Size(1e-3, bounds=(0.0, 0.1), plausible=(0.0, 0.03))
_PHASE = Size(0.3, bounds=(-1e3, 1e3), plausible=(-1e3, 1e3))
_CIRCUMFERENCE = Size(0.02, bounds=(_SHORTEST_M, 100.0), plausible=(_SHORTEST_M, 20.0), neutral=1.0)

EFFECT = Effect(
    id="drum_eccentricity",
    summary="the drum of cable {cable} is off centre",
    law="measured length is the true one plus amplitude · sin(2π · measured length / circumference "
    "+ phase); the amplitude is the eccentricity",
    source="line tangent to a circle that turns about a point beside its centre",
    parameters=(
        Parameter("amplitude_m", LENGTH, _ECCENTRICITY, at_least=0.0),
        Parameter("phase_rad", ANGLE, _PHASE, is_shape=True),
        Parameter("circumference_m", LENGTH, _CIRCUMFERENCE, above=0.0, is_shape=True),
        ZERO,
    ),
    on_readings=_change,
    needs=frozenset({"length"}),
    takes_cable=True,
    starts_from=_starts,
    looks=_MOST_WAVES // 4,
)
