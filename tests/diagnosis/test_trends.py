"""Trends of what is left, in a covariate."""

from __future__ import annotations

import numpy as np
import pytest

from designer.diagnosis.structure import smooth_correction


@pytest.mark.filterwarnings("error")
def test_a_covariate_that_stands_still_in_the_fitted_rows_corrects_by_their_mean() -> None:
    rng = np.random.default_rng(0)
    residual = rng.normal(2.0, 0.1, (24, 2))
    heldout = np.arange(24) >= 16
    covariate = np.where(heldout, np.arange(24.0), 5.0)
    found = smooth_correction(residual, "time_s", covariate, heldout)
    assert found.heldout_before > 1.8
    assert found.heldout_after < 0.3
