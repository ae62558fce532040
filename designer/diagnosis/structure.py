"""Lack of fit: is there structure beyond noise, what does it go with, and what happened?

Of a covariate that it goes with: in which reading, at which rows, and what is left of it then.
Events are steps, ends of ranges, waves, exchanged plugs, mirrored frames, outliers that are alike.

Residuals and predictions (n_rows, 2 n_cables), lengths first, are in units of noise and NaN where
nothing was measured; ``rows`` (n_rows,) are the numbers that rows have in the file.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import astuple, dataclass, field, replace
from itertools import combinations
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from designer.arrays import BoolArray, FloatArray, IntArray
from designer.diagnosis.problem import Problem, channel_names
from designer.diagnosis.statistics import (
    INDEPENDENT,
    MAD_TO_STD,
    SIGNIFICANCE,
    Lasting,
    is_outlier,
    lasting,
    outside_span,
    rms,
    spread,
    without_outliers,
)
from designer.effects.effect import Readings, Setting
from designer.effects.platform_loads import LEAST_ROWS, best_step
from designer.effects.winches import best_wave
from designer.measured.sense import left_handed
from designer.model.measurements import Measured
from designer.spelling import in_runs

ORDER = ("time_s", "row")
"""Covariates that tell the order of the rows."""
Place = Literal["mistake", "cable", "pose", "time", "scatter", ""]
_DRAWS = 999
"""As many as `SIGNIFICANCE` asks for to be counted."""


@dataclass(frozen=True, slots=True)
class Carrier:
    """A covariate that the residual goes with."""

    name: str  #: the column, or what was computed from the data
    #: share of the residual's variance that a parabola in it explains, in the channels or the means
    #: over the cables that it explains best
    fraction_of_variance: float
    chance: float  #: probability that the strongest of all covariates explains as much by accident

    @property
    def is_order(self) -> bool:
        """Whether it is the order of the rows, by time or by number."""
        return self.name in ORDER

    @property
    def is_speed(self) -> bool:
        """Whether it is a speed, which averages to nothing and so bends no constant to fit it."""
        return self.name.startswith("speed_")

    @property
    def place(self) -> Place:
        """Where it points to."""
        of_pose = ("x_m", "y_m", "z_m", "length_", "tension_", "direction_", "speed_")
        return "pose" if self.name.startswith(of_pose) else "time"


@dataclass(frozen=True, slots=True)
class Event:
    """Something that happened to the readings: a step at a row, a sensor at its range's end."""

    text: str  #: what it is, to be read after "goes with"
    fraction_of_variance: float  #: share of the variance of the reading in which it shows most
    chance: float = field(metadata={"json": None})  #: probability of as much by accident
    #: where it points to: plugs and frames, a cable, the poses, the time, unsteady rows; or empty
    place: Place = field(default="", metadata={"json": None})


def _strongest(carriers: Sequence[Carrier]) -> dict[str, object]:
    name, fraction, chance = astuple(carriers[0]) if carriers else (None, None, None)
    return {"strongest_covariate": name, "fraction_of_variance": fraction, "chance": chance}


@dataclass(frozen=True, slots=True)
class Structure:
    """Result of the test."""

    #: all covariates, strongest first
    carriers: tuple[Carrier, ...] = field(metadata={"json": _strongest})
    #: robust mean square of the residual about its median, in units of noise; 1 is noise alone
    excess: float = field(metadata={"json": None})
    lasting: Lasting = field(
        default=INDEPENDENT, metadata={"json": lambda lasting: {"rows_alike": lasting.rows}}
    )  #: how far neighbouring rows are alike
    #: what explains more than any covariate does, and more than accident would
    events: tuple[Event, ...] = ()

    @property
    def present(self) -> tuple[Carrier, ...]:
        """Covariates that explain more than accident would."""
        return tuple(c for c in self.carriers if c.chance < SIGNIFICANCE)

    @property
    def is_present(self) -> bool:
        """Whether anything explains more than accident would."""
        return bool(self.events or self.present)

    @property
    def may_bend(self) -> bool:
        """Whether it is such that effects of the list may be bent to fit it."""
        return any(c.chance < SIGNIFICANCE and not c.is_speed for c in self.carriers)


def covariates_of(measured: Measured, predicted: Readings) -> dict[str, FloatArray]:
    """Return everything that a residual may go with, by name (n_rows,).

    Pose, predicted lengths and tensions, direction of motion, in a motion also speeds, order,
    surroundings, and every unnamed column.
    """
    position = measured.poses.position_m
    covariates = {f"{axis}_m": position[:, k] for k, axis in enumerate("xyz")}
    for k in range(predicted.length_m.shape[1]):
        covariates[f"length_{k + 1}_m"] = predicted.length_m[:, k]
        covariates[f"tension_{k + 1}_N"] = predicted.tension_N[:, k]
        covariates[f"direction_{k + 1}"] = np.sign(
            np.diff(predicted.length_m[:, k], prepend=np.nan)
        )
    if measured.time_s is not None:
        covariates["time_s"] = measured.time_s
        step = np.linalg.norm(np.gradient(position, axis=0), axis=1)
        if not measured.settled:
            passed_s = np.maximum(np.gradient(measured.time_s), 1e-9)
            covariates["speed_m_per_s"] = step / passed_s
            for k, length_m in enumerate(predicted.length_m.T, start=1):
                covariates[f"speed_{k}_m_per_s"] = np.gradient(length_m) / passed_s
    else:
        covariates["row"] = np.arange(measured.n_rows, dtype=np.float64)
    if measured.temperature_C is not None:
        covariates["temperature_C"] = measured.temperature_C
    if measured.wind_m_per_s is not None:
        for k, axis in enumerate("xyz"):
            covariates[f"wind_{axis}_m_per_s"] = measured.wind_m_per_s[:, k]
    covariates.update(measured.covariates)
    return {
        name: column
        for name, column in covariates.items()
        if np.isfinite(column).any()
        and np.nanstd(column) > 1e-12 * (1.0 + np.abs(np.nanmean(column)))
    }


def find_structure(
    residual: FloatArray, covariates: Mapping[str, FloatArray], *, settled: bool
) -> Structure:
    """Test the residual against every covariate.

    For each covariate a parabola is fitted to each channel and to the mean over cables of each
    kind of reading; the largest share of variance is what counts. How large the best of all gets by
    accident is learnt from rows in another order or, where neighbouring rows are alike, from noise
    that lasts as long: any two things that drift go with each other. A drift much larger than the
    noise goes with the order of the rows, whatever else it goes with.

    ``settled`` rows are poses at rest.
    """
    channels = channels_of(residual)
    if channels.shape[1] == 0 or not covariates:
        return Structure((), float("nan"))
    bases = np.stack([_basis(column) for column in covariates.values()])
    observed = _largest_share(bases, channels)
    # What a covariate explains does not last of itself.
    lasts = lasting(outside_span(bases[int(np.argmax(observed))], channels))
    rng = np.random.default_rng(0)
    chances = chances_of(
        observed, [_largest_share(bases, draw).max() for draw in draws(channels, lasts, rng)]
    )
    excess = float(np.mean(channels**2))
    # What lasts at such a multiple of the noise is a drift; by less, a declared noise may be wrong.
    if settled and lasts.share and excess > 1.3**2:
        best = [_largest_share(bases, draw).max() for draw in draws(channels, INDEPENDENT, rng)]
        of_order = np.isin(list(covariates), ORDER)
        chances = np.where(of_order, chances_of(observed, best), chances)
    carriers = [
        Carrier(name, float(share), float(chance))
        for name, share, chance in zip(covariates, observed, chances, strict=True)
    ]
    carriers.sort(key=lambda c: (c.chance >= SIGNIFICANCE, -c.fraction_of_variance))
    return Structure(tuple(carriers), excess, lasts)


def draws(
    channels: FloatArray, lasts: Lasting, rng: np.random.Generator, count: int = _DRAWS
) -> Iterator[FloatArray]:
    """Yield what channels (n_rows, n_channels) might be by accident; see `find_structure`."""
    n_rows = len(channels)
    if lasts.share == 0.0:
        for _ in range(count):
            yield channels[rng.permutation(n_rows)]
        return
    values, vectors = np.linalg.eigh(channels.T @ channels / n_rows)
    across = vectors * np.sqrt(np.maximum(values, 0.0))
    for _ in range(count):
        drawn = lasts.draw(rng, channels.shape) @ across.T
        yield drawn - drawn.mean(axis=0)


def chances_of(observed: FloatArray, best: Sequence[float]) -> FloatArray:
    """Return how probable shares (n,) are by accident, of which the best were drawn.

    Beyond the largest that was drawn, by Gumbel's law of the largest.
    """
    from scipy.stats import gumbel_r

    drawn = np.sort(best)
    counted = (1.0 + len(drawn) - np.searchsorted(drawn, observed)) / (1.0 + len(drawn))
    scale = max(float(np.std(drawn)) * np.sqrt(6.0) / np.pi, 1e-12)
    beyond = gumbel_r.sf(observed, float(np.mean(drawn)) - np.euler_gamma * scale, scale)
    return np.where(observed > drawn[-1], np.minimum(beyond, counted), counted)


def channels_of(residual: FloatArray) -> FloatArray:
    """Clip outliers, fill gaps with zero, and append the mean over cables of each kind."""
    n = residual.shape[1] // 2
    kinds = []
    for kind in (residual[:, :n], residual[:, n:]):
        if np.isnan(kind).all():
            continue
        read_channels = kind[:, ~np.isnan(kind).all(axis=0)]
        centred = read_channels - np.nanmedian(read_channels, axis=0)
        # So that no outlier makes structure.
        limit = 4.0 * np.maximum(MAD_TO_STD * np.nanmedian(np.abs(centred), axis=0), 1.0)
        filled = np.clip(np.nan_to_num(centred, nan=0.0), -limit, limit)
        filled = filled - filled.mean(axis=0)
        mean = filled.sum(axis=1, keepdims=True) / np.sqrt(n)
        kinds += [filled, mean]
    channels = np.hstack(kinds) if kinds else np.empty((len(residual), 0))
    return np.asarray(channels[:, channels.any(axis=0)])


def _basis(column: FloatArray) -> FloatArray:
    """Return an orthonormal basis (n_rows, 2) of the parabolas in a covariate, mean removed.

    A covariate of two values has no parabola; the second column is then 0.
    """
    filled = np.where(np.isnan(column), np.nanmean(column), column)
    z = (filled - filled.mean()) / filled.std()
    parabola = np.stack([z, z**2], axis=1)
    q, r = np.linalg.qr(parabola - parabola.mean(axis=0))
    return np.asarray(q * (np.abs(np.diag(r)) > 1e-9 * len(z)))


def _largest_share(bases: FloatArray, channels: FloatArray) -> FloatArray:
    """Return the share of variance in the channel that each covariate explains best (n_bases,)."""
    parts = np.swapaxes(bases, 1, 2) @ channels
    explained = np.sum(parts**2, axis=1)
    return np.asarray((explained / np.sum(channels**2, axis=0)).max(axis=1))


_SMOOTH_RATIO = 1.25
"""Error over another that is as good: ten numbers for each reading are fitted to few rows."""
_MAX_ROWS = 6
"""As many as one looks up in a log."""


@dataclass(frozen=True, slots=True)
class Whereabouts:
    """Where a residual goes with a covariate."""

    reading: str  #: the one of whose variance a parabola in the covariate explains most
    #: numbers of the rows at which that parabola is farthest off, as in the file, rising
    rows: tuple[int, ...]
    size: float  #: how far it is off there at most, in units of noise, with its sign


@dataclass(frozen=True, slots=True, eq=False)
class Correction:
    """A smooth empirical correction: no physics, and not used by the design."""

    covariate: str  #: each channel is corrected by a parabola in it, fitted to the rows for fitting
    heldout_before: float  #: root mean square over held-out rows, in units of noise
    heldout_after: float


def whereabouts(residual: FloatArray, covariate: FloatArray, row_numbers: IntArray) -> Whereabouts:
    """Return where a residual (n_rows, 2 n_cables) goes with a covariate (n_rows,)."""
    clean = without_outliers(residual)
    channel = strongest_channel(clean, covariate)
    trend = np.where(np.isnan(clean[:, channel]), np.nan, _parabola(clean[:, channel], covariate))
    far = np.argsort(-np.nan_to_num(np.abs(trend), nan=-1.0), kind="stable")[:_MAX_ROWS]
    return Whereabouts(
        reading=channel_names(residual.shape[1] // 2)[channel],
        rows=tuple(sorted(int(k) for k in row_numbers[far])),
        size=float(trend[far[0]]),
    )


def smooth_correction(
    residual: FloatArray, name: str, covariate: FloatArray, heldout: BoolArray
) -> Correction:
    """Correct each channel of a residual (n_rows, 2 n_cables) by a parabola in a covariate."""
    filled = np.where(np.isnan(covariate), np.nanmean(covariate), covariate)
    clean = without_outliers(residual)
    corrected = np.full_like(clean, np.nan)
    for channel, column in enumerate(clean.T):
        seen = np.where(heldout, np.nan, column)
        if np.isfinite(seen).sum() > 3:
            corrected[:, channel] = column - _parabola(seen, filled)
    return Correction(name, rms(clean[heldout]), rms(corrected[heldout]))


def is_one_smooth_error(
    before: FloatArray, after: FloatArray, position_m: FloatArray, heldout: BoolArray
) -> bool:
    """Tell whether quadratics in the position do on unseen rows what effects do to a residual."""
    z = (position_m - position_m.mean(axis=0)) / np.maximum(position_m.std(axis=0), 1e-9)
    i, j = np.triu_indices(3)
    terms = np.column_stack([np.ones(len(z)), z, z[:, i] * z[:, j]])
    is_sound = np.isfinite(without_outliers(after))
    remainder = np.where(is_sound, before, np.nan)
    for k in range(remainder.shape[1]):
        seen = is_sound[:, k] & ~heldout
        if seen.sum() > 2 * terms.shape[1]:
            remainder[:, k] -= terms @ np.linalg.lstsq(terms[seen], remainder[seen, k])[0]
    unseen = is_sound & heldout[:, None]
    return rms(remainder[unseen]) < _SMOOTH_RATIO * rms(after[unseen])


def strongest_channel(residual: FloatArray, covariate: FloatArray) -> int:
    """Return the reading of whose variance a parabola in the covariate explains most."""
    return int(np.nanargmax([_explained(column, covariate) for column in residual.T]))


def _explained(column: FloatArray, covariate: FloatArray) -> float:
    is_known = np.isfinite(column) & np.isfinite(covariate)
    if is_known.sum() < 4:  # a parabola goes through three of anything
        return -1.0
    # A reading farther off counts as one at this distance: noise reaches it once in 16 000.
    middle, limit = np.nanmedian(column), 4.0 * spread(column)
    clipped = np.where(is_known, np.clip(column, middle - limit, middle + limit), np.nan)
    y = clipped[is_known] - clipped[is_known].mean()
    remainder = clipped[is_known] - _parabola(clipped, covariate)[is_known]
    return float((y @ y - remainder @ remainder) / max(y @ y, 1e-300))


def _parabola(column: FloatArray, covariate: FloatArray) -> FloatArray:
    """Return the parabola in a covariate that comes nearest to a column (n_rows,)."""
    is_known = np.isfinite(column) & np.isfinite(covariate)
    x = covariate[is_known]
    powers = np.vander((covariate - x.mean()) / (x.std() or 1.0), 3)
    return np.asarray(powers @ np.linalg.lstsq(powers[is_known], column[is_known], rcond=None)[0])


# What happened to the readings.

_MAX_ENDS = 500
"""Rows that stand off between which ranges are looked at."""
_STEP_DRAWS = 299
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


def with_gross_errors(
    structure: Structure, residual: FloatArray, unfitted: FloatArray, rows: IntArray
) -> Structure:
    """Return a structure with what a fit gives up that counts outliers little.

    Readings tens of noises off that are nearly all of one cable; more readings that stand off than
    come by accident, with the rows among them whose poses are wrong; or so much that the fit, with
    all readings counted in full, is no nearer to them than the model before it.

    Residuals are those with and without what was fitted.
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
        place = f"cable {cable} above all"
        if wrong.any():
            place = f"rows with wrong poses: {', '.join(in_runs(rows[wrong]))}"
        text = f"{n_outliers} of {n_readings} readings that stand off, by up to {by}, of {place}"
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
    makes it. Accident is drawn as in `find_structure`.
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
            early, late = (  # mean square that each reading leaves with each prediction (n, n)
                np.array(
                    [
                        [spread(read[part, y] - predicted[part, x]) ** 2 for x in channels]
                        for y in channels
                    ]
                )
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
    by_accident = [best_step(draw).share for draw in draws(channels, lasts, rng, _STEP_DRAWS)]
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
        chance = float(_chance_inside(inside, total, share, gone.shape[1]))
        yield Event(f"{inside} are of {name}", inside / total, chance)


def _in_a_range(off: BoolArray, rows: IntArray) -> Iterator[Event]:
    places = np.flatnonzero(off)
    n = len(places)
    if n < 2:
        return
    # Of many, ranges between some: all pairs would be the square of them.
    bounds = np.unique(np.linspace(0, n - 1, min(n, _MAX_ENDS)).astype(np.int64))
    starts, last = (bounds[k] for k in np.triu_indices(len(bounds), 1))
    width = (places[last] - places[starts] + 1) / len(off)
    inside = last - starts + 1
    # Its two ends are where they are by choice.
    chance = _chance_inside(inside - 2, n - 2, width, n * n // 2)
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
            chance = float(_chance_inside(inside, n, np.mean(is_there), 2 * len(covariates)))
            text = f"{inside} of {n} rows in the {end} quarter of {name}"
            yield Event(text, inside / n, chance)


def _chance_inside(inside: ArrayLike, total: int, share: ArrayLike, looks: int) -> FloatArray:
    """Return how probable so many are inside by accident, of all places that were looked at."""
    from scipy.stats import binom

    at_least = binom.sf(np.asarray(inside) - 1, total, share)
    return np.asarray(np.minimum(1.0, looks * at_least))


_MIRROR_NOISE = 3.0
"""Times the noise from which on a frame may be to blame."""
_MIRROR_SHARE = 0.1
"""Of the mean square, what the right frame leaves at most: other errors may be there as well."""


def find_mirrored(problem: Problem, settings: Sequence[Setting], rows: BoolArray) -> Event | None:
    """Return the mirrored frame in which the poses suit the readings; None where there is none.

    As for exchanged plugs, each reading counts about its own mean, and of the mean square no more
    than a tenth may be left.
    """
    measured = problem.measured
    as_it_is = _mean_square(problem, settings, rows)
    if not measured.has_poses or not as_it_is > _MIRROR_NOISE**2:
        return None
    mean_squares: dict[str, float] = {}
    for text, view in left_handed(problem.predict.machine.robot, measured):
        mirrored = replace(problem, measured=view, predict=problem.predict.at(view))
        mean_squares[text] = min(
            _mean_square(mirrored, settings, rows), mean_squares.get(text, np.inf)
        )
    best = min(mean_squares, key=mean_squares.__getitem__)
    if mean_squares[best] > _MIRROR_SHARE * as_it_is:
        return None
    return Event(
        f"a mirrored frame of the poses: {best}",
        1.0 - mean_squares[best] / as_it_is,
        0.0,
        "mistake",
    )


def _mean_square(problem: Problem, settings: Sequence[Setting], rows: BoolArray) -> float:
    residual = problem.residual(settings)[rows]
    read = residual[:, ~np.isnan(residual).all(axis=0)]
    return float(np.mean([spread(channel) ** 2 for channel in read.T]))


# All tests of what a model leaves.


def structure_left(problem: Problem, settings: Sequence[Setting], rows: BoolArray) -> Structure:
    """Test what a model leaves of the readings of some rows (n_rows,)."""
    everywhere = covariates_of(problem.measured, problem.surroundings(settings))
    covariates = {name: column[rows] for name, column in everywhere.items()}
    residual, predicted = _residual_and_predicted(problem, settings, rows)
    numbers = problem.measured.row_numbers[rows]
    structure = find_structure(residual, covariates, settled=problem.measured.settled)
    mistaken = find_mistake(problem, settings, rows)
    common = find_common(residual, covariates, numbers)
    lengths_m = problem.surroundings(settings).length_m[rows]
    events = find_events(residual, predicted, lengths_m, structure, numbers)
    named = [mistaken] if mistaken else [*events, common]
    if not (any(named) or structure.present):
        named = [find_spreading(residual)]
    return replace(structure, events=tuple(event for event in named if event))


def find_mistake(problem: Problem, settings: Sequence[Setting], rows: BoolArray) -> Event | None:
    """Return a mirrored frame or exchanged plugs; a frame explains all readings, plugs some."""
    readings = _residual_and_predicted(problem, settings, rows)
    numbers = problem.measured.row_numbers[rows]
    return find_mirrored(problem, settings, rows) or find_swapped(*readings, numbers)


def _residual_and_predicted(
    problem: Problem, settings: Sequence[Setting], rows: BoolArray
) -> tuple[FloatArray, FloatArray]:
    """Return residual and prediction of some rows (…, 2 n_cables), both in units of noise."""
    in_noise = problem.predicted(settings).stacked / problem.sigma
    return problem.residual(settings)[rows], in_noise[rows]
