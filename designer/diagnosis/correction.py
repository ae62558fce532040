"""A smooth empirical correction for structure that no effect explains."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from designer.arrays import BoolArray, FloatArray
from designer.diagnosis.errors_of import rms, without_outliers
from designer.diagnosis.result import Correction
from designer.diagnosis.structure import Structure


def smooth_correction(
    residual: FloatArray,
    structure: Structure,
    covariates: Mapping[str, FloatArray],
    heldout: BoolArray,
) -> Correction | None:
    """Fit a parabola in the strongest covariate to each channel; None where nothing is left.

    Parameters
    ----------
    residual : array (n_rows, 2 n_cables)
        In units of noise.
    structure : Structure
        What the residual goes with.
    covariates, heldout
        As in the diagnosis.
    """
    if not structure.present:
        return None
    name = structure.carriers[0].name
    z = covariates[name]
    z = np.nan_to_num((z - np.nanmean(z)) / np.nanstd(z))
    powers = np.vander(z, 3)
    clean = without_outliers(residual)
    corrected = np.full_like(clean, np.nan)
    for channel in range(clean.shape[1]):
        seen = ~heldout & ~np.isnan(clean[:, channel])
        if seen.sum() > 3:
            fitted = np.linalg.lstsq(powers[seen], clean[seen, channel], rcond=None)[0]
            corrected[:, channel] = clean[:, channel] - powers @ fitted
    return Correction(name, rms(clean[heldout]), rms(corrected[heldout]))
