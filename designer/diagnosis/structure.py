"""Lack of fit: is there structure beyond noise, and what does it go with?

Of a covariate that it goes with: in which reading, at which rows, and what is left of it then.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import astuple, dataclass, field
from typing import Literal

import numpy as np

from designer.arrays import BoolArray, FloatArray, IntArray
from designer.diagnosis.problem import channel_names
from designer.diagnosis.statistics import (
    INDEPENDENT,
    MAD_TO_STD,
    SIGNIFICANCE,
    Lasting,
    beside,
    lasting,
    rms,
    spread,
    without_outliers,
)
from designer.effects.effect import Readings
from designer.model.measured_data import Measured

ORDER = ("time_s", "row")
"""Covariates that tell the order of the rows."""
Place = Literal["mistake", "cable", "pose", "time", "scatter", ""]
_DRAWS = 999
"""As many as `SIGNIFICANCE` asks for to be counted."""


@dataclass(frozen=True, slots=True)
class Carrier:
    """A covariate that the residual goes with.

    Parameters
    ----------
    name : str
        The column, or what was computed from the data.
    fraction_of_variance : float
        Share of the residual's variance that a parabola in it explains, in the channels or the
        means over the cables that it explains best.
    chance : float
        Probability that the strongest of all covariates explains as much by accident.
    """

    name: str
    fraction_of_variance: float
    chance: float

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
    """Something that happened to the readings: a step at a row, a sensor at the end of its range.

    Parameters
    ----------
    text : str
        What it is, to be read after "goes with".
    fraction_of_variance : float
        Share of the variance of the reading in which it shows most.
    chance : float
        Probability of as much by accident.
    place : str
        Where it points to: plugs and frames, a cable, the poses, the time, unsteady rows; or empty.
    """

    text: str
    fraction_of_variance: float
    chance: float = field(metadata={"json": None})
    place: Place = field(default="", metadata={"json": None})


def _strongest(carriers: Sequence[Carrier]) -> dict[str, object]:
    name, fraction, chance = astuple(carriers[0]) if carriers else (None, None, None)
    return {"strongest_covariate": name, "fraction_of_variance": fraction, "chance": chance}


@dataclass(frozen=True, slots=True)
class Structure:
    """Result of the test.

    Parameters
    ----------
    carriers : tuple of Carrier
        All covariates, strongest first.
    excess : float
        Robust mean square of the residual about its median, in units of noise; 1 is noise alone.
    lasting : Lasting
        How far neighbouring rows are alike.
    events : tuple of Event
        What explains more than any covariate does, and more than accident would.
    """

    carriers: tuple[Carrier, ...] = field(metadata={"json": _strongest})
    excess: float = field(metadata={"json": None})
    lasting: Lasting = field(
        default=INDEPENDENT, metadata={"json": lambda lasting: {"rows_alike": lasting.rows}}
    )
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

    Parameters
    ----------
    residual : array (n_rows, 2 n_cables)
        In units of noise; NaN where not measured.
    covariates : mapping
        From `covariates_of`.
    settled : bool
        Whether rows are poses at rest.
    """
    channels = channels_of(residual)
    if channels.shape[1] == 0 or not covariates:
        return Structure((), float("nan"))
    bases = np.stack([_basis(column) for column in covariates.values()])
    observed = _largest_share(bases, channels)
    # What a covariate explains does not last of itself.
    lasts = lasting(beside(bases[int(np.argmax(observed))], channels))
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


_AS_GOOD = 1.25
"""Error over another that is as good: ten numbers for each reading are fitted to few rows."""
_MOST_ROWS = 6
"""As many as one looks up in a log."""


@dataclass(frozen=True, slots=True)
class Whereabouts:
    """Where a residual goes with a covariate.

    Parameters
    ----------
    reading : str
        The one of whose variance a parabola in the covariate explains most.
    rows : tuple of int
        Numbers of the rows at which that parabola is farthest off, as in the file, rising.
    size : float
        How far it is off there at most, in units of noise, with its sign.
    """

    reading: str
    rows: tuple[int, ...]
    size: float


@dataclass(frozen=True, slots=True, eq=False)
class Correction:
    """A smooth empirical correction: no physics, and not used by the design.

    Parameters
    ----------
    covariate : str
        Each channel is corrected by a parabola in it, fitted to the rows for fitting.
    heldout_before, heldout_after : float
        Root mean square over held-out rows, in units of noise.
    """

    covariate: str
    heldout_before: float
    heldout_after: float


def whereabouts(residual: FloatArray, covariate: FloatArray, row_numbers: IntArray) -> Whereabouts:
    """Return where a residual (n_rows, 2 n_cables) goes with a covariate (n_rows,)."""
    clean = without_outliers(residual)
    channel = strongest_channel(clean, covariate)
    trend = np.where(np.isnan(clean[:, channel]), np.nan, _parabola(clean[:, channel], covariate))
    far = np.argsort(-np.nan_to_num(np.abs(trend), nan=-1.0), kind="stable")[:_MOST_ROWS]
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
    return rms(remainder[unseen]) < _AS_GOOD * rms(after[unseen])


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
