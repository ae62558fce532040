"""Noise of the sensors, where nobody declared it."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from designer.arrays import BoolArray, FloatArray
from designer.diagnosis.fit import fit
from designer.diagnosis.problem import Predictor, Problem
from designer.diagnosis.statistics import spread
from designer.effects.effect import Effect
from designer.model.measured_data import Measured, Noise
from designer.model.measurements import Measurements


def first_noise(
    measurements: Measurements,
    measured: Measured,
    predict: Predictor,
    rows: BoolArray,
    effects: Sequence[Effect] = (),
) -> Noise:
    """Return the noise as declared, else as the fast part of the first residual shows it.

    Samples of a motion: second differences of the residual, from which anything slow drops out.
    Poses at rest: differences between neighbours in space, which share what depends on the pose.

    Parameters
    ----------
    measurements, measured, predict
        What is declared, the data, the model as declared.
    rows : array (n_rows,) of bool
        What a fit may see.
    effects : sequence of Effect
        Unknown from the start: fitted first.
    """
    declared = (measurements.length_noise_m, measurements.tension_noise_N)
    if declared[0] is not None and declared[1] is not None:
        return Noise(declared[0], declared[1], "declared")
    length, tension = (
        float(np.nanmedian(np.abs(kind))) if np.isfinite(kind).any() else 1.0
        for kind in (measured.length_m, measured.tension_N)
    )
    # By how much a model may be off at first: mostly their ratio counts, and tensions are foretold
    # worse than lengths.
    rough = Problem(measured, predict, Noise(0.01 * length, 0.1 * tension, "rough"))
    settings = fit(rough, effects, rows).settings if effects else ()
    kinds = np.hsplit(rough.residual(settings) * rough.sigma, 2)
    estimates = [
        _fast_part(kind, measured) if value is None else value
        for value, kind in zip(declared, kinds, strict=True)
    ]
    missing = [
        name
        for name, value, kind in zip(("length", "tension"), declared, kinds, strict=True)
        if value is None and not np.isnan(kind).all()
    ]
    how = "neighbouring poses" if measured.settled else "second differences in time"
    source = f"{' and '.join(missing)} estimated from {how} of the residual"
    return Noise(estimates[0], estimates[1], source if missing else "declared")


def rescaled(noise: Noise, measurements: Measurements, residual: FloatArray) -> Noise:
    """Return estimated noise corrected by the residual that a better model leaves.

    Parameters
    ----------
    residual : array (n_rows, 2 n_cables)
        In units of ``noise``.
    """
    length, tension = (_robust_std(kind) for kind in np.hsplit(residual, 2))
    return Noise(
        noise.length_m if measurements.length_noise_m is not None else noise.length_m * length,
        noise.tension_N if measurements.tension_noise_N is not None else noise.tension_N * tension,
        noise.source,
    )


def _fast_part(kind: FloatArray, measured: Measured) -> float:
    from scipy.spatial import cKDTree

    if not measured.settled:
        return _robust_std(np.diff(kind, n=2, axis=0)) / math.sqrt(6.0)  # 1² + 2² + 1² variances
    seen = ~np.isnan(kind).all(axis=1)
    if seen.sum() < 2:
        return 1.0
    position, kind = measured.poses.position_m[seen], kind[seen]
    _, nearest = cKDTree(position).query(position, k=2)
    return _robust_std(kind - kind[nearest[:, 1]]) / math.sqrt(2.0)  # of two readings


def _robust_std(values: FloatArray) -> float:
    """Standard deviation of the bulk; 1 where there are no values."""
    return 1.0 if np.isnan(values).all() else max(spread(values), 1e-12)
