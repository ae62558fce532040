"""Is there structure beyond noise, and what does it go with?"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from designer.arrays import FloatArray, IntArray
from designer.diagnosis.blocks import block_of
from designer.effects.effect import Readings
from designer.measured_data import Measured

SIGNIFICANCE = 0.01
_PERMUTATIONS = 999
_CUT = 4.0


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
    def is_speed(self) -> bool:
        """Whether it is a speed, which averages to nothing and so bends no constant to fit it."""
        return self.name.startswith("speed_")


@dataclass(frozen=True, slots=True)
class Structure:
    """Result of the test.

    Parameters
    ----------
    carriers : tuple of Carrier
        All covariates, strongest first.
    excess : float
        Robust mean square of the residual about its median, in units of noise; 1 is noise alone.
    """

    carriers: tuple[Carrier, ...]
    excess: float

    @property
    def is_present(self) -> bool:
        """Whether the strongest covariate explains more than accident would."""
        return bool(self.carriers) and self.carriers[0].chance < SIGNIFICANCE

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
    found = {f"{axis}_m": position[:, k] for k, axis in enumerate("xyz")}
    for k in range(predicted.length_m.shape[1]):
        found[f"length_{k + 1}_m"] = predicted.length_m[:, k]
        found[f"tension_{k + 1}_N"] = predicted.tension_N[:, k]
        found[f"direction_{k + 1}"] = np.sign(np.diff(predicted.length_m[:, k], prepend=np.nan))
    if measured.time_s is not None:
        found["time_s"] = measured.time_s
        step = np.linalg.norm(np.gradient(position, axis=0), axis=1)
        if not measured.settled:
            passed_s = np.maximum(np.gradient(measured.time_s), 1e-9)
            found["speed_m_per_s"] = step / passed_s
            for k, length_m in enumerate(predicted.length_m.T, start=1):
                found[f"speed_{k}_m_per_s"] = np.gradient(length_m) / passed_s
    else:
        found["row"] = np.arange(measured.n_rows, dtype=np.float64)
    if measured.temperature_C is not None:
        found["temperature_C"] = measured.temperature_C
    if measured.wind_m_per_s is not None:
        for k, axis in enumerate("xyz"):
            found[f"wind_{axis}_m_per_s"] = measured.wind_m_per_s[:, k]
    found.update(measured.covariates)
    return {name: column for name, column in found.items() if _varies(column)}


def find_structure(
    residual: FloatArray, covariates: Mapping[str, FloatArray], *, settled: bool, seed: int = 0
) -> Structure:
    """Test the residual against every covariate, by permutation of rows.

    For each covariate a parabola is fitted to each channel and to the mean over cables of each
    kind of reading; the largest share of variance is what counts. Rows are
    then permuted, all covariates at once, to learn how large the best of all gets by accident.
    Samples of a motion are permuted in blocks, since neighbours are alike.

    Parameters
    ----------
    residual : array (n_rows, 2 n_cables)
        In units of noise; NaN where not measured.
    covariates : mapping
        From `covariates_of`.
    settled : bool
        Whether rows are independent.
    """
    channels = _channels(residual)
    if channels.shape[1] == 0 or not covariates:
        return Structure((), float("nan"))
    bases = np.stack([_basis(column) for column in covariates.values()])
    observed = _largest_share(bases, channels)
    rng = np.random.default_rng(seed)
    best = np.array(
        [
            _largest_share(bases, channels[_permutation(rng, len(channels), settled)]).max()
            for _ in range(_PERMUTATIONS)
        ]
    )
    carriers = [
        Carrier(name, float(share), (1 + int(np.sum(best >= share))) / (1 + len(best)))
        for name, share in zip(covariates, observed, strict=True)
    ]
    carriers.sort(key=lambda c: (c.chance, -c.fraction_of_variance))
    return Structure(tuple(carriers), float(np.mean(channels**2)))


def _channels(residual: FloatArray) -> FloatArray:
    """Clip outliers, fill gaps with zero, and append the mean over cables of each kind."""
    n = residual.shape[1] // 2
    kinds = []
    for kind in (residual[:, :n], residual[:, n:]):
        if np.isnan(kind).all():
            continue
        known = kind[:, ~np.isnan(kind).all(axis=0)]
        centred = known - np.nanmedian(known, axis=0)
        limit = _CUT * np.maximum(1.4826 * np.nanmedian(np.abs(centred), axis=0), 1.0)
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
    count, rows, width = bases.shape
    parts = bases.transpose(0, 2, 1).reshape(-1, rows) @ channels
    explained = np.sum(parts.reshape(count, width, -1) ** 2, axis=1)
    return np.asarray((explained / np.sum(channels**2, axis=0)).max(axis=1))


def _permutation(rng: np.random.Generator, count: int, settled: bool) -> IntArray:
    if settled:
        return np.asarray(rng.permutation(count))
    block = block_of(count, 20)
    order = rng.permutation(int(block.max()) + 1)
    shift = int(rng.integers(count))
    return np.asarray(np.roll(np.concatenate([np.flatnonzero(block == k) for k in order]), shift))


def _varies(column: FloatArray) -> bool:
    known = column[~np.isnan(column)]
    return bool(known.size and np.std(known) > 1e-12 * (1.0 + np.abs(np.mean(known))))
