"""A load that is put on the platform, or taken off, during the measurements."""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple

import numpy as np

from designer.arrays import FloatArray
from designer.effects.effect import Effect, Parameter, Size, Values
from designer.model.machine import Machine
from designer.model.measured_data import Measured
from designer.units import MASS, TIME

LEAST_ROWS = 5
"""On either side of a step: fewer have no mean to speak of."""


class BestStep(NamedTuple):
    """Where a step explains most: its share of the variance, its first row, its channel."""

    share: float
    row: int
    channel: int


def best_step(channels: FloatArray) -> BestStep:
    """Return where one step explains most; channels have no mean (n_rows, n_channels)."""
    n = len(channels)
    at = np.arange(LEAST_ROWS, n - LEAST_ROWS + 1)
    sums = np.cumsum(channels, axis=0)[at - 1]
    share = (
        sums**2 * (n / (at * (n - at)))[:, None] / np.maximum(np.sum(channels**2, axis=0), 1e-300)
    )
    which, channel = np.unravel_index(int(np.argmax(share)), share.shape)
    return BestStep(float(share[which, channel]), int(at[which]), int(channel))


def _change(machine: Machine, values: Values) -> Machine:
    return replace(machine, late_load_kg=values["offset_kg"], late_load_from_s=values["time_s"])


def _starts(measured: Measured, residual: FloatArray) -> tuple[dict[str, float], ...]:
    """Start where the mean of all tensions, or else of all lengths, steps most."""
    assert measured.time_s is not None
    n = residual.shape[1] // 2
    for kind in (residual[:, n:], residual[:, :n]):
        is_read = ~np.isnan(kind)
        rows = np.flatnonzero(is_read.any(axis=1))
        if len(rows) < 2 * LEAST_ROWS:
            continue
        mean = np.nan_to_num(kind).sum(axis=1)[rows] / is_read.sum(axis=1)[rows]
        row = rows[best_step((mean - mean.mean())[:, None]).row]
        middle = 0.5 * (measured.time_s[row - 1] + measured.time_s[row])
        return ({"time_s": float(middle)},)
    return ()


def _offset(machine: Machine) -> Size:
    """As much as the platform weighs is believed."""
    mass = machine.robot.platform.mass_kg
    return Size(0.02 * mass, bounds=(-0.95 * mass, 20 * mass), plausible=(-mass, mass))


_TIMES = 6
"""How much more probable by chance the gain at the best of all times is than that of two numbers.

In white noise of 60 rows it is 4, of 200 rows 7, at one in 100, with five rows on each side."""
_TIME = Size(1.0, bounds=(-1e9, 1e9), plausible=(-1e9, 1e9))

EFFECT = Effect(
    id="load_step",
    summary="the load on the platform changes at a time",
    law="platform mass plus offset from that time on, at the origin of the body's frame",
    source="definition",
    parameters=(
        Parameter("offset_kg", MASS, _offset),
        Parameter("time_s", TIME, _TIME, is_shape=True, is_step_time=True),
    ),
    on_machine=_change,
    needs=frozenset({"time"}),
    starts_from=_starts,
    looks=_TIMES,
)
