"""What winches count, which is not what they pay out: zero, scale, layers, waves, play, stretch."""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple

import numpy as np

from designer.arrays import FloatArray
from designer.effects.effect import (
    Effect,
    Parameter,
    Readings,
    Size,
    Values,
    frame_size_m,
    per_cable,
    sized_by,
)
from designer.effects.platform_loads import LEAST_ROWS
from designer.model.measurements import Measured
from designer.model.robot import Machine
from designer.units import ANGLE, COMPLIANCE, LENGTH, NUMBER, PER_LENGTH

# Scale and zero.

_ZERO = Parameter(
    "offset_m",
    LENGTH,
    Size(0.01, bounds=(-1e3, 1e3), plausible=(-100.0, 100.0)),
    is_optional=True,
    part_of=("length_offset",),
)
_CABLE_SCALE = Size(1e-3, bounds=(0.05, 20.0), plausible=(0.2, 5.0))
_DRUM_SCALE = Size(1e-3, bounds=(0.2, 5.0), plausible=(0.95, 1.05))
_ADVANTAGES = (1.001, 2.0, 0.5)
"""Just off, or with a part of the tackle too many or too few."""


def _scale_cable(readings: Readings, values: Values, measured: Measured, *, cable: int) -> Readings:
    length = np.array(readings.length_m)
    length[:, cable - 1] *= values.get("scale", 1.0)
    length[:, cable - 1] += values.get("offset_m", 0.0)
    return replace(readings, length_m=length)


def _shift_zeros(readings: Readings, values: Values, measured: Measured) -> Readings:
    offsets = per_cable(values, "offset_{cable}_m", readings.length_m.shape[1])
    return replace(readings, length_m=readings.length_m + offsets)


WINCH_SCALE = Effect(
    id="winch_scale",
    summary="the winch of cable {cable} has a wrong scale",
    law="measured length is scale times the true one, plus an offset: right where it was homed",
    source="definition",
    parameters=(
        Parameter("scale", NUMBER, _CABLE_SCALE, neutral=1.0, above=0.0),
        _ZERO,
    ),
    on_readings=_scale_cable,
    cause="setting_up",
    needs=frozenset({"length"}),
    takes_cable=True,
    starts=tuple({"scale": scale} for scale in _ADVANTAGES),
)
WINCH_ZERO = replace(
    WINCH_SCALE,
    id="winch_zero",
    summary="the winch of cable {cable} was homed at the wrong length",
    law="measured length plus an offset",
    parameters=(replace(_ZERO, is_optional=False, part_of=("length_offset", "winch_scale")),),
    starts=(),
    shifts_lengths=True,
)
DRUM_SCALE = replace(
    WINCH_SCALE,
    id="drum_scale",
    summary="the winches' scale is wrong",
    law="measured length is scale times the true one",
    parameters=(Parameter("scale", NUMBER, _DRUM_SCALE, neutral=1.0, above=0.0),),
    on_readings=lambda readings, values, measured: replace(
        readings, length_m=readings.length_m * values["scale"]
    ),
    takes_cable=False,
    starts=(),
)
LENGTH_OFFSET = replace(
    WINCH_ZERO,
    id="length_offset",
    summary="the winches were homed at the wrong length",
    law="measured length plus an offset for each cable",
    parameters=(
        Parameter(
            "offset_{cable}_m",
            LENGTH,
            Size(0.01, bounds=(-1e3, 1e3), plausible=(-1.0, 1.0)),
            is_optional=True,
        ),
    ),
    on_readings=_shift_zeros,
    takes_cable=False,
)


# Lengths that are read wrong in proportion to tension.


def _cable_compliance_m_per_N(machine: Machine) -> float:
    """Return as much as twice the frame's size of further cable would give."""
    return 2.0 * frame_size_m(machine) / machine.cable.axial_stiffness_N


TENSION_LENGTH = Effect(
    id="tension_length",
    summary="lengths are read wrong in proportion to tension: encoder, drum or rope lay",
    law="measured length plus compliance times the tension at the winch",
    source="Feyrer, Wire Ropes, 2015, section 2.4: turn of the lay under tension; Hooke's "
    "law of drum and cable behind the exit point",
    parameters=(
        Parameter(
            "compliance_m_per_N",
            COMPLIANCE,
            sized_by(_cable_compliance_m_per_N, 0.02, bounds=(-50.0, 50.0), plausible=(-1.0, 1.0)),
        ),
    ),
    on_readings=lambda readings, values, measured: replace(
        readings, length_m=readings.length_m + values["compliance_m_per_N"] * readings.tension_N
    ),
    needs=frozenset({"length"}),
)


# Lengths by a wheel on the rope, which counts it as stretched as it runs past.

_STRETCH_SHARE = Size(0.1, bounds=(-20.0, 20.0), plausible=(0.3, 3.0))
_ENCODER_OFFSET = Size(0.01, bounds=(-1e3, 1e3), plausible=(-1.0, 1.0))


def _count_stretched_rope(
    readings: Readings, values: Values, measured: Measured, *, machine: Machine
) -> Readings:
    """Integrate strain over what runs past, by trapezia from row to row, from the first on."""
    is_held = ~np.isnan(readings.length_m).any(axis=1)
    length_m = readings.length_m[is_held]
    strain = readings.tension_N[is_held] / machine.cables.axial_stiffness_N
    passed_m = np.diff(length_m, axis=0, prepend=length_m[:1])
    mean_strain = 0.5 * (strain + np.vstack([strain[:1], strain[:-1]]))
    n_cables = length_m.shape[1]
    offsets_m = np.array([values.get(f"offset_{k}_m", 0.0) for k in range(1, n_cables + 1)])
    counted = np.array(readings.length_m)
    counted[is_held] += values["share"] * np.cumsum(mean_strain * passed_m, axis=0) + offsets_m
    return replace(readings, length_m=counted)


ENCODER_ON_ROPE = Effect(
    id="encoder_on_rope",
    summary="the encoders count stretched rope",
    law="measured length grows by 1 + share · T/EA of what is paid out, T at the winch",
    source="Hooke's law",
    parameters=(
        Parameter("share", NUMBER, _STRETCH_SHARE),
        Parameter(
            "offset_{cable}_m",
            LENGTH,
            _ENCODER_OFFSET,
            is_optional=True,
            part_of=("length_offset",),
        ),
    ),
    on_readings=_count_stretched_rope,
    needs=frozenset({"length"}),
    takes_machine=True,
    follows_rows=True,
)


# Drums that grow as cable is wound onto them.


def _layer_drums(readings: Readings, values: Values, measured: Measured) -> Readings:
    """Return what winches count that are right at a reference length.

    A turn pays out 1 + gain · (reference - length) times what is counted, so the counted length
    is the integral of its inverse.
    """
    gain = values["radius_gain_per_m"]
    if abs(gain) < 1e-12:
        return readings
    reference_m = per_cable(values, "reference_{cable}_m", readings.length_m.shape[1])
    paid_out = np.maximum(1.0 + gain * (reference_m - readings.length_m), 1e-6)
    return replace(readings, length_m=reference_m - np.log(paid_out) / gain)


def _layering_size(machine: Machine) -> Size:
    """Small machines have thin lines on small spools: a fifth more over the frame is plausible."""
    size = frame_size_m(machine)
    return Size(1e-2 / size, bounds=(0.0, 0.9 / size), plausible=(0.0, max(0.02, 0.2 / size)))


# A tiny gain about a reference far off would be a wrong scale of each winch, not layering. Fits
# start at a tenth of the typical size: among the lengths, as from far off they end at no gain.
_REFERENCE_SIZE = sized_by(frame_size_m, 5.0, bounds=(0.0, 2.0), plausible=(0.0, 2.0))

DRUM_LAYERING = Effect(
    id="drum_layering",
    summary="the drums grow as cable is wound onto them",
    law="drum radius times 1 + gain · length wound on since the reference length",
    source="definition",
    parameters=(
        Parameter("radius_gain_per_m", PER_LENGTH, _layering_size),
        Parameter("reference_{cable}_m", LENGTH, _REFERENCE_SIZE, is_optional=True, is_shape=True),
    ),
    on_readings=_layer_drums,
    needs=frozenset({"length"}),
)


# Drums off centre: the length goes in waves, one a turn.

_SHORTEST_M = 0.05
"""Round the smallest drum."""
_LEAST_WAVES, _MOST_WAVES = 3, 8000
"""Quarters of a wave in the span of the lengths, at most: fewer waves than three are a bend."""
_COUNT_ITERATIONS = 8
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


def _wave_lengths(
    readings: Readings, values: Values, measured: Measured, *, cable: int
) -> Readings:
    """Return what the winch counts, which the wave goes with."""
    per_m = 2.0 * np.pi / values["circumference_m"]
    homed_m = readings.length_m[:, cable - 1] + values.get("offset_m", 0.0)
    count_m = homed_m
    for _ in range(_COUNT_ITERATIONS):
        turn = per_m * count_m + values["phase_rad"]
        count_m = homed_m + values["amplitude_m"] * np.sin(turn)
    length = np.array(readings.length_m)
    length[:, cable - 1] = count_m
    return replace(readings, length_m=length)


def _wave_starts(
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

DRUM_ECCENTRICITY = Effect(
    id="drum_eccentricity",
    summary="the drum of cable {cable} is off centre",
    law="measured length is the true one plus amplitude · sin(2π · measured length / circumference "
    "+ phase); the amplitude is the eccentricity",
    source="line tangent to a circle that turns about a point beside its centre",
    parameters=(
        Parameter("amplitude_m", LENGTH, _ECCENTRICITY, at_least=0.0),
        Parameter("phase_rad", ANGLE, _PHASE, is_shape=True),
        Parameter("circumference_m", LENGTH, _CIRCUMFERENCE, above=0.0, is_shape=True),
        _ZERO,
    ),
    on_readings=_wave_lengths,
    needs=frozenset({"length"}),
    takes_cable=True,
    starts_from=_wave_starts,
    looks=_MOST_WAVES // 4,
)


# Play between what is counted and what pays out the cable, or friction that holds it back.

_PLAY = Size(2e-3, bounds=(-0.5, 0.5), plausible=(-0.1, 0.1))


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


def _read_with_play(readings: Readings, values: Values, measured: Measured) -> Readings:
    true_m = readings.length_m
    play_m = per_cable(values, "play_{cable}_m", true_m.shape[1])
    read_m = true_m + 0.5 * play_m * direction_of(true_m)
    is_dragged = play_m < 0.0
    read_m[:, is_dragged] = dragged_m(true_m[:, is_dragged], -play_m[is_dragged])
    return replace(readings, length_m=read_m)


BACKLASH = Effect(
    id="backlash",
    summary="play or friction between winch and encoder: lengths depend on the direction of motion",
    law="measured length is ahead of the true one by half the play in the direction of motion; "
    "with a negative play it is dragged along behind",
    source="play operator: Visintin, Differential Models of Hysteresis, 1994",
    parameters=(Parameter("play_{cable}_m", LENGTH, _PLAY, is_optional=True),),
    on_readings=_read_with_play,
    needs=frozenset({"length", "reversals"}),
    follows_rows=True,
)
