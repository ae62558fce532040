"""What happened to the readings: steps, ends of ranges, exchanged plugs, alike outliers."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from itertools import combinations

import numpy as np
from numpy.typing import ArrayLike

from designer.arrays import BoolArray, FloatArray, IntArray
from designer.diagnosis.problem import channel_names
from designer.diagnosis.statistics import SIGNIFICANCE, is_outlier, lasting, spread
from designer.diagnosis.structure import (
    Event,
    Structure,
    chances_of,
    channels_of,
    draws,
)
from designer.effects.platform_loads import LEAST_ROWS, best_step
from designer.effects.winches import best_wave
from designer.spelling import in_runs

_MOST_ENDS = 500
"""Rows that stand off between which ranges are looked at."""
_DRAWS = 299
"""Of steps by accident: beyond the largest, Gumbel's law goes on."""
_FULL_SLOPE = (0.75, 1.25)
"""How much a reading at the end of its range falls short, over what is predicted beyond: all of
it; a gain, even one of half, keeps below."""
_KNEES = np.linspace(0.5, 0.95, 10)
"""Quantiles of the prediction at which a range may end: half of the readings count as sound."""


_GROSS = 20.0
"""Times the noise beyond which a reading is no reading of this model at all."""
_ACCIDENTS = 0.03
"""Share of the readings of a sensor that may be so by accident: a log seldom has more than one in a
hundred, and one reading alone tells nothing."""
_SPREADS = 1.5
"""Scatter of the last third of the rows over that of the first, or the other way."""


def with_given_up(
    structure: Structure, residual: FloatArray, unfitted: FloatArray, rows: IntArray
) -> Structure:
    """Return a structure with what a fit gives up that counts outliers little.

    Readings tens of noises off that are nearly all of one cable; more readings that stand off than
    come by accident, with the rows among them whose poses are wrong; or so much that the fit, with
    all readings counted in full, is no nearer to them than the model before it.

    Parameters
    ----------
    residual, unfitted : array (n_rows, 2 n_cables)
        With and without what was fitted, in units of noise; NaN where not measured.
    rows : array (n_rows,)
        Numbers of the rows in the file.
    """
    if any(event.place == "mistake" for event in structure.events):
        return structure
    by_cable = residual.reshape(len(residual), 2, -1)
    n_read = np.isfinite(by_cable).any(axis=1).sum(axis=0)
    largest = np.abs(np.nan_to_num(by_cable)).max(axis=1)
    is_gross = largest > _GROSS
    counts = is_gross.sum(axis=0)
    worst = int(np.argmax(counts))
    events = list(structure.events)
    is_many = counts[worst] >= max(2, _ACCIDENTS * n_read[worst])
    if is_many and 3 * counts[worst] >= 2 * counts.sum():
        off = is_gross[:, worst]
        sizes = largest[off, worst]
        text = (
            f"cable {worst + 1}, off by {sizes.min():.0f} to {sizes.max():.0f} times the noise in "
            f"rows {', '.join(in_runs(rows[off]))}: its winch or its sensors"
        )
        share = float(np.nansum(by_cable[off, :, worst] ** 2) / np.nansum(residual**2))
        events.append(Event(text, share, 0.0, "cable"))
    outliers, wrong = is_outlier(residual), wrong_poses(residual)
    if not (events or structure.present):  # a spread as large as all of them hides none
        outliers |= np.abs(np.nan_to_num(residual)) > _GROSS
    n_outliers, n_readings = int(outliers.sum()), int(np.isfinite(residual).sum())
    if n_outliers > max(2, _ACCIDENTS * n_readings):
        by = f"{np.abs(residual[outliers]).max():.0f} times the noise"
        cable = np.argmax(outliers.reshape(len(outliers), 2, -1).sum(axis=(0, 1))) + 1
        where = f"cable {cable} above all"
        if wrong.any():
            where = f"rows with wrong poses: {', '.join(in_runs(rows[wrong]))}"
        text = f"{n_outliers} of {n_readings} readings that stand off, by up to {by}, of {where}"
        share = float(n_outliers / n_readings)
        events.append(Event(text, share, 0.0, "pose" if wrong.any() else ""))
    if is_gross.any() and np.nansum(residual**2) > np.nansum(unfitted**2):
        text = "readings that stand off: counted in full, all that was fitted helps nothing"
        events.append(Event(text, 1.0, 0.0))
    return replace(structure, events=tuple(events))


def wrong_poses(residual: FloatArray) -> BoolArray:
    """Tell of which rows (n_rows,) the poses are wrong: all cables stand off, two at least.

    By more than half of the lengths, where those were measured: all cells feel a load as well.
    """
    flags = np.stack([is_outlier(residual), np.isfinite(residual)]).reshape(2, len(residual), 2, -1)
    is_off, is_read = np.asarray(flags.any(axis=2))
    lengths_off, lengths_read = flags[:, :, 0].sum(axis=-1)
    has_all = (is_off == is_read).all(axis=1) & (is_read.sum(axis=1) > 1)
    return np.asarray(has_all & ((2 * lengths_off > lengths_read) | (lengths_read == 0)))


def find_events(
    residual: FloatArray,
    predicted: FloatArray,
    lengths_m: FloatArray,
    structure: Structure,
    rows: IntArray,
) -> tuple[Event, ...]:
    """Return what explains more of the residual than accident would, and than any covariate does.

    A step: the mean of a reading, or of all of a kind, differs before and after a row, more sharply
    than a cubic over the rows follows. The end of a range: from some value on, a reading falls
    short by all that is predicted beyond it. A wave in a cable's own length, as a drum off centre
    makes it. Accident is drawn as in `designer.diagnosis.structure.find_structure`.

    Parameters
    ----------
    residual, predicted : array (n_rows, 2 n_cables)
        In units of noise; NaN where not measured.
    lengths_m : array (n_rows, n_cables)
        Predicted lengths [m].
    structure : Structure
        What the residual goes with among covariates.
    rows : array (n_rows,)
        Numbers of the rows in the file.
    """
    waves = _waves(residual, lengths_m)
    candidates = (*_steps(residual, rows), *_ends(residual, predicted), *waves)
    strongest = max((c.fraction_of_variance for c in structure.present), default=0.0)
    events = [
        e for e in candidates if e.fraction_of_variance > strongest and e.chance < SIGNIFICANCE
    ]
    return tuple(sorted(events, key=lambda e: -e.fraction_of_variance))


def find_swapped(residual: FloatArray, predicted: FloatArray, rows: IntArray) -> Event | None:
    """Return readings of a kind that fit each other's prediction; None where none do.

    Each reading is given the prediction that suits it best, no two the same. Those that exchange
    theirs, two or more in a ring, must so leave less than a tenth of the mean square that they
    leave as they are, each about its own mean, since a bias is no exchange. Two may be exchanged
    from a row on: before it, they must leave less as they are.

    Parameters
    ----------
    residual, predicted : array (n_rows, 2 n_cables)
        In units of noise; NaN where not measured.
    rows : array (n_rows,)
        Numbers of the rows in the file.
    """
    from scipy.optimize import linear_sum_assignment

    names = channel_names(residual.shape[1] // 2)
    read = residual + predicted
    texts: list[str] = []
    largest = 0.0
    since: list[int] = []  # rows from which on lengths are exchanged: tensions likewise, probably
    for kind in np.split(np.arange(residual.shape[1]), 2):
        channels = kind[~np.isnan(residual[:, kind]).all(axis=0)]
        pairs = [[*pair] for pair in combinations(channels, 2)]
        starts = {_exchanged_from(read[:, pair], predicted[:, pair]) for pair in pairs}
        for start in [*since, *sorted(starts | {0}, reverse=True)] if pairs else ():
            early, late = (
                _costs(read[part][:, channels], predicted[part][:, channels])
                for part in (slice(start), slice(start, None))
            )
            fits, count = linear_sum_assignment(late)[1], len(texts)
            for ring in _rings(fits):
                as_it_is, exchanged = late[ring, ring].sum(), late[ring, fits[ring]].sum()
                was_right = early[ring, ring].sum() < 0.1 * early[ring, fits[ring]].sum()
                # On wrong plugs readings are far off; exchanged, they fit nearly as right ones do.
                is_wrong = as_it_is > len(ring) * 3.0**2 and exchanged < 0.1 * as_it_is
                if is_wrong and (was_right or not start):
                    *leading, last = (names[channels[k]] for k in sorted(ring))
                    how = "with each other" if len(ring) == 2 else "in a ring"
                    how += f" from row {rows[start]} on" if start else ""
                    texts.append(f"{', '.join(leading)} and {last} exchanged {how}")
                    largest = max(largest, 1.0 - exchanged / as_it_is)
            if len(texts) > count:
                since.append(start)
                break
    return Event(", ".join(texts), largest, 0.0, "mistake") if texts else None


def _costs(read: FloatArray, predicted: FloatArray) -> FloatArray:
    """Return the mean square that each reading leaves with each prediction (n, n)."""
    return np.array([[spread(y - x) ** 2 for x in predicted.T] for y in read.T])


def _exchanged_from(read: FloatArray, predicted: FloatArray) -> int:
    """Return the row from which on two readings (n_rows, 2) fit each other's prediction best.

    0 where fewer than `LEAST_ROWS` are on either side of it, or most do not fit so.
    """
    straight, crossed = (np.abs(read - to).sum(axis=1) for to in (predicted, predicted[:, ::-1]))
    # Roots, so that no row decides alone.
    better = np.nan_to_num(np.sqrt(straight) - np.sqrt(crossed))
    start = int(np.argmax(np.cumsum(better[::-1])[::-1]))
    is_inside = LEAST_ROWS <= start <= len(read) - LEAST_ROWS
    return start if is_inside and np.mean(better[start:] > 0.0) > 0.8 else 0


def find_spreading(residual: FloatArray) -> Event | None:
    """Return scatter that grows or falls as the rows go on, as of a wind that nobody read.

    By Spearman's correlation of the order of pairs of rows with how far their readings differ, in
    which nothing slow is left.
    """
    from scipy.stats import spearmanr

    channels = channels_of(residual)
    third = len(channels) // 6
    if third < LEAST_ROWS or not channels.size:
        return None
    even = channels[: len(channels) // 2 * 2]
    steps = np.sqrt(np.mean((even[1::2] - even[::2]) ** 2, axis=1) / 2.0)
    ends = [float(np.sqrt(np.mean(part**2))) for part in (steps[:third], steps[-third:])]
    share, chance = spearmanr(np.arange(len(steps)), steps)
    if chance > SIGNIFICANCE or max(ends) < _SPREADS * min(ends):
        return None
    text = "scatter that changes as the rows go on, from {:.2g} to {:.2g} times the noise"
    return Event(text.format(*ends), float(share**2), float(chance), "scatter")


def _rings(order: IntArray) -> Iterator[list[int]]:
    """Yield the rings, of two or more, in which a permutation moves things."""
    seen: set[int] = set()
    for start in range(len(order)):
        at, ring = start, []
        while at not in seen:
            seen.add(at)
            ring.append(at)
            at = int(order[at])
        if len(ring) > 1:
            yield ring


def find_common(
    residual: FloatArray, covariates: Mapping[str, FloatArray], rows: IntArray
) -> Event | None:
    """Return what readings that stand off have in common; None where they are scattered.

    They may be of one sensor, in one range of rows, or at one end of a covariate: then they are no
    accidents. Chances are binomial, times the number of places that were looked at.

    Parameters
    ----------
    residual : array (n_rows, 2 n_cables)
        In units of noise; NaN where not measured.
    covariates : mapping
        From `designer.diagnosis.structure.covariates_of`.
    rows : array (n_rows,)
        Numbers of the rows in the file.
    """
    gone = is_outlier(residual)
    count = int(gone.sum())
    if count < LEAST_ROWS:
        return None
    off = np.asarray(gone.any(axis=1))
    kinds = (_of_a_sensor(gone, residual), _in_a_range(off, rows), _at_an_end(off, covariates))
    likeliest = (
        min(kind, key=lambda e: (e.chance, e.fraction_of_variance, e.text), default=None)
        for kind in kinds
    )
    common = [event for event in likeliest if event and event.chance < SIGNIFICANCE]
    if not common:
        return None
    text = f"the {count} readings that stand off: {', '.join(event.text for event in common)}"
    share = max(event.fraction_of_variance for event in common)
    return Event(text, share, min(event.chance for event in common))


def _steps(residual: FloatArray, rows: IntArray) -> Iterator[Event]:
    channels = channels_of(residual)
    if len(channels) < 4 * LEAST_ROWS or not channels.size:
        return
    best = best_step(channels)
    # Of the variance a cubic over the rows explains that share: a drift is no step.
    channel = channels[:, best.channel]
    powers = np.polynomial.legendre.legvander(np.linspace(-1.0, 1.0, len(channel)), 3)
    rest = channel - powers @ np.linalg.lstsq(powers, channel, rcond=None)[0]
    if best.share < float(1.0 - rest @ rest / (channel @ channel)):
        return
    late = np.arange(len(channels))[:, None] >= best.row
    means = [channels[side[:, 0]].mean(axis=0) for side in (~late, late)]
    # What a step explains does not last of itself.
    lasts = lasting(channels - np.where(late, means[1], means[0]))
    rng = np.random.default_rng(0)
    by_accident = [best_step(draw).share for draw in draws(channels, lasts, rng, _DRAWS)]
    (chance,) = chances_of(np.array([best.share]), by_accident)
    yield Event(f"a step at row {rows[best.row]}", best.share, float(chance), "time")


def _ends(residual: FloatArray, predicted: FloatArray) -> Iterator[Event]:
    """Yield each reading that stops at a value while what is predicted goes on."""
    for channel, name in enumerate(channel_names(residual.shape[1] // 2)):
        is_read = ~np.isnan(residual[:, channel])
        if is_read.sum() < 4 * LEAST_ROWS:
            continue
        values, remainder = predicted[is_read, channel], residual[is_read, channel]
        for sign, end in ((1.0, "upper"), (-1.0, "lower")):
            event = _end_of(
                sign * values, sign * remainder, f"the {end} end of the range of {name}"
            )
            if event is not None:
                yield event


def _end_of(values: FloatArray, remainder: FloatArray, text: str) -> Event | None:
    """Return the saturation of one reading that grows with ``values``; see `find_events`.

    Of all knees, the one is taken at which a bend explains most. Beyond it readings must not follow
    what is predicted at all; a gain or another law makes them follow by another measure.
    """
    from scipy.stats import beta

    centred = remainder - np.median(remainder)
    variance = float(np.sum((centred - centred.mean()) ** 2))
    best, slope, at = 0.0, 0.0, 0.0
    for knee in np.quantile(values, _KNEES):
        beyond = np.maximum(values - knee, 0.0)
        beyond = beyond - beyond.mean()
        size = float(beyond @ beyond)
        if np.sum(values > knee) >= LEAST_ROWS and size > 0.0:
            along = float(beyond @ centred)
            if along**2 / size > best:
                best, slope, at = along**2 / size, along / size, float(knee)
    if not _FULL_SLOPE[0] < -slope < _FULL_SLOPE[1] or not (values > at).any():
        return None
    # Such a correlation is as probable by accident in any knee, end and reading, 16 of them on
    # eight cables.
    looks = 2 * len(_KNEES) * 16
    chance = looks * beta.sf(best / variance, 0.5, 0.5 * (len(values) - 2))
    return Event(text, best / variance, float(min(1.0, chance)), "cable")


def _waves(residual: FloatArray, lengths_m: FloatArray) -> Iterator[Event]:
    """Yield the wave in its own length that explains most of each length's residual.

    White noise has a share above r with the chance (1 - r)^((n - 3) / 2) in each wave that is
    looked at.
    """
    for k, length_m in enumerate(lengths_m.T):
        is_read = np.isfinite(residual[:, k]) & np.isfinite(length_m)
        if not is_read.any():
            continue
        column = residual[is_read, k] - np.median(residual[is_read, k])
        limit = 4.0 * max(spread(column), 1.0)
        column = np.clip(column, -limit, limit)
        column = column - column.mean()
        best = best_wave(length_m[is_read], column)
        if best is None:
            continue
        # What a wave explains does not last of itself.
        freedom = len(column) / lasting((column - best.values)[:, None]).rows - 3.0
        looks = best.looks * lengths_m.shape[1]
        chance = (1.0 - best.share) ** (0.5 * max(freedom, 0.0)) * looks
        height = float(np.ptp(best.values)) / 2.0
        text = (
            f"a wave in length {k + 1}, {best.length_m:.3g} m long and {height:.2g} "
            "times the noise high, as a drum off centre makes it"
        )
        yield Event(text, best.share, min(1.0, float(chance)), "cable")


def _of_a_sensor(gone: BoolArray, residual: FloatArray) -> Iterator[Event]:
    is_read = ~np.isnan(residual)
    total = int(gone.sum())
    for channel, name in enumerate(channel_names(gone.shape[1] // 2)):
        inside = int(gone[:, channel].sum())
        share = is_read[:, channel].sum() / is_read.sum()
        chance = float(_chance(inside, total, share, gone.shape[1]))
        yield Event(f"{inside} are of {name}", inside / total, chance)


def _in_a_range(off: BoolArray, rows: IntArray) -> Iterator[Event]:
    places = np.flatnonzero(off)
    n = len(places)
    if n < 2:
        return
    # Of many, ranges between some: all pairs would be the square of them.
    bounds = np.unique(np.linspace(0, n - 1, min(n, _MOST_ENDS)).astype(np.int64))
    starts, last = (bounds[k] for k in np.triu_indices(len(bounds), 1))
    width = (places[last] - places[starts] + 1) / len(off)
    inside = last - starts + 1
    # Its two ends are where they are by choice.
    chance = _chance(inside - 2, n - 2, width, n * n // 2)
    # Of many rows several are too improbable for a number: then the one with most too many.
    best = int(np.lexsort((n * width - inside, chance))[0])
    ends = f"{rows[places[starts[best]]]} to {rows[places[last[best]]]}"
    text = f"{inside[best]} of {n} rows from {ends}"
    yield Event(text, float(inside[best]) / n, float(chance[best]))


def _at_an_end(off: BoolArray, covariates: Mapping[str, FloatArray]) -> Iterator[Event]:
    n = int(off.sum())
    for name, column in covariates.items():
        for sign, end in ((1.0, "lower"), (-1.0, "upper")):
            is_there = sign * column <= np.nanquantile(sign * column, 0.25)
            inside = int(np.sum(off & is_there))
            chance = float(_chance(inside, n, np.mean(is_there), 2 * len(covariates)))
            text = f"{inside} of {n} rows in the {end} quarter of {name}"
            yield Event(text, inside / n, chance)


def _chance(inside: ArrayLike, total: int, share: ArrayLike, looks: int) -> FloatArray:
    """Return how probable so many are inside by accident, of all places that were looked at."""
    from scipy.stats import binom

    at_least = binom.sf(np.asarray(inside) - 1, total, share)
    return np.asarray(np.minimum(1.0, looks * at_least))
