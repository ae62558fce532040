"""Where to measure next, so that rivals part."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from designer.arrays import BoolArray, FloatArray
from designer.diagnosis.predict import Predictor
from designer.diagnosis.result import Proposal
from designer.effects.effect import Setting
from designer.model.measured_data import Measured, Noise
from designer.model.region import Region
from designer.model.robot import Poses

_CANDIDATES = 2000
_POSES = 3
_APART = 0.15


def propose(
    model: Predictor,
    measured: Measured,
    noise: Noise,
    region: Region | None,
    found: Sequence[Setting],
    rival: Sequence[Setting],
    names: tuple[str, str],
) -> Proposal:
    """Return the poses at which two models, each fitted to the data, foretell most differently.

    Parameters
    ----------
    model, measured, noise
        As in the diagnosis; the surroundings of a new pose are taken from the middle row.
    region : Region or None
        Where to look; the box of the measured poses if there is none.
    found, rival : sequence of Setting
        The two models.
    names : tuple of str
        What to call them.
    """
    positions = _candidates(measured, region)
    there = _measured_at(measured, positions)
    predict = model.at(there)
    one, other = (predict(_at_rest(settings), noise) for settings in (found, rival))
    gap = np.hstack(
        [
            (one.length_m - other.length_m) / noise.length_m,
            (one.tension_N - other.tension_N) / noise.tension_N,
        ]
    )
    separation = np.sqrt(np.nansum(np.where(_measures(measured), gap**2, 0.0), axis=1))
    size = np.maximum(np.ptp(positions, axis=0), 1e-9)
    chosen: list[int] = []
    for k in np.argsort(-separation):
        apart = [np.abs((positions[k] - positions[c]) / size).max() > _APART for c in chosen]
        if all(apart):
            chosen.append(int(k))
        if len(chosen) == _POSES:
            break
    return Proposal(*names, positions[chosen], separation[chosen])


def _candidates(measured: Measured, region: Region | None) -> FloatArray:
    if region is not None:
        return np.concatenate(list(region.samples_m(_CANDIDATES, "low_discrepancy", 0)))
    position = measured.poses.position_m
    rng = np.random.default_rng(0)
    return rng.uniform(position.min(axis=0), position.max(axis=0), (_CANDIDATES, 3))


def _measured_at(measured: Measured, positions: FloatArray) -> Measured:
    """Return rows at other positions, turned as the middle row, in its surroundings."""
    middle, count = measured.n_rows // 2, len(positions)
    rotation = measured.poses.rotation
    turned = rotation if rotation.ndim == 2 else rotation[middle]
    n = measured.length_m.shape[1]

    def same(column: FloatArray | None) -> FloatArray | None:
        return None if column is None else np.repeat(column[middle : middle + 1], count, axis=0)

    return replace(
        measured,
        settled=True,
        poses=Poses(positions, turned),
        length_m=np.full((count, n), np.nan),
        tension_N=np.full((count, n), np.nan),
        time_s=same(measured.time_s),
        temperature_C=same(measured.temperature_C),
        wind_m_per_s=same(measured.wind_m_per_s),
        covariates={},
        row_numbers=np.arange(1, count + 1),
    )


def _at_rest(settings: Sequence[Setting]) -> list[Setting]:
    """Return what shows in a pose at rest."""
    return [s for s in settings if "motion" not in s.effect.needs]


def _measures(measured: Measured) -> BoolArray:
    """Return which channels the machine measures at all (1, 2 n_cables)."""
    readings = np.hstack([measured.length_m, measured.tension_N])
    return np.asarray(~np.isnan(readings).all(axis=0))[None]
