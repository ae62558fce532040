"""What happened to the readings: a step at a row, a sensor at the end of its range."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from designer.arrays import FloatArray, IntArray
from designer.diagnosis.clusters import lasting
from designer.diagnosis.problem import channel_names
from designer.diagnosis.structure import (
    SIGNIFICANCE,
    Event,
    Structure,
    chances_of,
    channels_of,
    draws,
)

_LEAST_ROWS = 5
_DRAWS = 299
_FULL_SLOPE = (0.75, 1.25)
_KNEES = np.linspace(0.5, 0.95, 10)
_MOST_READINGS = 16


@dataclass(frozen=True, slots=True)
class _Best:
    """The best of many that were looked at: its share of variance, which one, in which channel."""

    share: float
    which: int
    channel: int


def find_events(
    residual: FloatArray, predicted: FloatArray, structure: Structure, rows: IntArray
) -> tuple[Event, ...]:
    """Return what explains more of the residual than accident would, and than any covariate does.

    A step: the mean of a reading, or of all of a kind, differs before and after a row, more sharply
    than a cubic over the rows follows. The end of a range: from some value on, a reading falls
    short by all that is predicted beyond it. Accident is drawn as in
    `designer.diagnosis.structure.find_structure`.

    Parameters
    ----------
    residual, predicted : array (n_rows, 2 n_cables)
        In units of noise; NaN where not measured.
    structure : Structure
        What the residual goes with among covariates.
    rows : array (n_rows,)
        Numbers of the rows in the file.
    """
    found = (*_steps(residual, rows), *_ends(residual, predicted))
    strongest = max((c.fraction_of_variance for c in structure.present), default=0.0)
    events = [e for e in found if e.fraction_of_variance > strongest and e.chance < SIGNIFICANCE]
    return tuple(sorted(events, key=lambda e: -e.fraction_of_variance))


def _steps(residual: FloatArray, rows: IntArray) -> Iterator[Event]:
    channels = channels_of(residual)
    if len(channels) < 4 * _LEAST_ROWS or not channels.size:
        return
    best = _step_in(channels)
    if best.share < _smooth_share(channels[:, best.channel]):
        return
    late = np.arange(len(channels))[:, None] >= best.which
    means = [channels[side[:, 0]].mean(axis=0) for side in (~late, late)]
    # What a step explains does not last of itself.
    lasts = lasting(channels - np.where(late, means[1], means[0]))
    rng = np.random.default_rng(0)
    by_accident = [_step_in(one).share for one in draws(channels, lasts, rng, _DRAWS)]
    (chance,) = chances_of(np.array([best.share]), by_accident)
    yield Event(f"a step at row {rows[best.which]}", best.share, float(chance))


def _smooth_share(channel: FloatArray) -> float:
    """Return the share of variance that a cubic over the rows explains: a drift is no step."""
    powers = np.polynomial.legendre.legvander(np.linspace(-1.0, 1.0, len(channel)), 3)
    rest = channel - powers @ np.linalg.lstsq(powers, channel, rcond=None)[0]
    return float(1.0 - rest @ rest / (channel @ channel))


def _step_in(channels: FloatArray) -> _Best:
    """Return where one step explains most; channels have no mean (n_rows, n_channels)."""
    n = len(channels)
    at = np.arange(_LEAST_ROWS, n - _LEAST_ROWS + 1)
    sums = np.cumsum(channels, axis=0)[at - 1]
    share = sums**2 * (n / (at * (n - at)))[:, None] / np.sum(channels**2, axis=0)
    which, channel = np.unravel_index(int(np.argmax(share)), share.shape)
    return _Best(float(share[which, channel]), int(at[which]), int(channel))


def _ends(residual: FloatArray, predicted: FloatArray) -> Iterator[Event]:
    """Yield each reading that stops at a value while what is predicted goes on."""
    names = channel_names(residual.shape[1] // 2)
    for channel, name in enumerate(names):
        known = ~np.isnan(residual[:, channel])
        if known.sum() < 4 * _LEAST_ROWS:
            continue
        own, left = predicted[known, channel], residual[known, channel]
        for sign, end in ((1.0, "upper"), (-1.0, "lower")):
            event = _end_of(sign * own, sign * left, f"the {end} end of the range of {name}")
            if event is not None:
                yield event


def _end_of(own: FloatArray, left: FloatArray, text: str) -> Event | None:
    """Return the saturation of one reading that grows with ``own``; see `find_events`.

    Of all knees, the one is taken at which a bend explains most. Beyond it readings must not follow
    what is predicted at all; a gain or another law makes them follow by another measure.
    """
    centred = left - np.median(left)
    variance = float(np.sum((centred - centred.mean()) ** 2))
    best, slope, at = 0.0, 0.0, 0.0
    for knee in np.quantile(own, _KNEES):
        beyond = np.maximum(own - knee, 0.0)
        beyond = beyond - beyond.mean()
        size = float(beyond @ beyond)
        if np.sum(own > knee) >= _LEAST_ROWS and size > 0.0:
            along = float(beyond @ centred)
            if along**2 / size > best:
                best, slope, at = along**2 / size, along / size, float(knee)
    past = own > at
    if not _FULL_SLOPE[0] < -slope < _FULL_SLOPE[1] or not past.any():
        return None
    return Event(text, best / variance, _chance(best / variance, len(own)))


def _chance(share: float, n_rows: int) -> float:
    """Return how probable such a correlation is by accident, of all knees, ends and readings."""
    from scipy.stats import beta

    looks = 2 * len(_KNEES) * _MOST_READINGS
    return float(min(1.0, looks * beta.sf(share, 0.5, 0.5 * (n_rows - 2))))
