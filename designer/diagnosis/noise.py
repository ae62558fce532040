"""Noise of the sensors, where nobody declared it."""

from __future__ import annotations

import math

import numpy as np

from designer.arrays import FloatArray
from designer.model.measured_data import Measured, Noise
from designer.study import Measurements

_MAD_TO_STD = 1.4826
_ROUGH_LENGTH, _ROUGH_TENSION = 0.01, 0.1


def rough_noise(measured: Measured) -> Noise:
    """Return what a model may be off by at first: 1 % of a length, 10 % of a tension."""
    length, tension = (
        float(np.median(kind[~np.isnan(kind)])) if np.isfinite(kind).any() else 1.0
        for kind in (np.abs(measured.length_m), np.abs(measured.tension_N))
    )
    return Noise(_ROUGH_LENGTH * length, _ROUGH_TENSION * tension, "rough")


def noise_of(measurements: Measurements, measured: Measured, residual_SI: FloatArray) -> Noise:
    """Return the noise as declared, else as the fast part of the residual shows it.

    Samples of a motion: second differences of the residual, from which anything slow drops out.
    Poses at rest: differences between neighbours in space, which share what depends on the pose.

    Parameters
    ----------
    measurements, measured
        What is declared, and the data.
    residual_SI : array (n_rows, 2 n_cables)
        Residual of the model as declared [m, N].
    """
    n = measured.length_m.shape[1]
    declared = (measurements.length_noise_m, measurements.tension_noise_N)
    kinds = (residual_SI[:, :n], residual_SI[:, n:])
    estimate = _neighbours if measured.settled else _second_differences
    found = [
        value if value is not None else estimate(kind, measured)
        for value, kind in zip(declared, kinds, strict=True)
    ]
    missing = [
        name
        for name, value, kind in zip(("length", "tension"), declared, kinds, strict=True)
        if value is None and not np.isnan(kind).all()
    ]
    how = "neighbouring poses" if measured.settled else "second differences in time"
    source = (
        f"{' and '.join(missing)} estimated from {how} of the residual" if missing else "declared"
    )
    return Noise(found[0], found[1], source)


def rescaled(noise: Noise, measurements: Measurements, residual: FloatArray) -> Noise:
    """Return estimated noise corrected by the residual that a better model leaves.

    Parameters
    ----------
    residual : array (n_rows, 2 n_cables)
        In units of ``noise``.
    """
    n = residual.shape[1] // 2
    length, tension = (_robust_std(kind) for kind in (residual[:, :n], residual[:, n:]))
    return Noise(
        noise.length_m if measurements.length_noise_m is not None else noise.length_m * length,
        noise.tension_N if measurements.tension_noise_N is not None else noise.tension_N * tension,
        noise.source,
    )


def _second_differences(kind: FloatArray, measured: Measured) -> float:
    return _robust_std(np.diff(kind, n=2, axis=0)) / math.sqrt(6.0)


def _neighbours(kind: FloatArray, measured: Measured) -> float:
    from scipy.spatial import cKDTree

    seen = ~np.isnan(kind).all(axis=1)
    if seen.sum() < 2:
        return 1.0
    position, kind = measured.poses.position_m[seen], kind[seen]
    _, nearest = cKDTree(position).query(position, k=2)
    return _robust_std(kind - kind[nearest[:, 1]]) / math.sqrt(2.0)


def _robust_std(values: FloatArray) -> float:
    """Standard deviation of the bulk; 1 where there are no values."""
    known = values[~np.isnan(values)]
    if known.size == 0:
        return 1.0
    spread = _MAD_TO_STD * float(np.median(np.abs(known - np.median(known))))
    return max(spread, 1e-12)
