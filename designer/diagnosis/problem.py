"""The residual of measured data, in units of noise."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from designer.arrays import BoolArray, FloatArray
from designer.diagnosis.predict import Predictor
from designer.effects.effect import Readings, Setting
from designer.model.measured_data import Measured, Noise


@dataclass(frozen=True, slots=True, eq=False)
class Problem:
    """Data, model and noise.

    Parameters
    ----------
    measured : Measured
        The data.
    predict : Predictor
        The model.
    noise : Noise
        Scale of the residual.
    """

    measured: Measured
    predict: Predictor
    noise: Noise

    @property
    def sigma(self) -> FloatArray:
        """Noise of each channel: lengths [m], then tensions [N] (2 n_cables,)."""
        n = self.measured.length_m.shape[1]
        return np.repeat([self.noise.length_m, self.noise.tension_N], n)

    @property
    def readings(self) -> FloatArray:
        """Measured lengths [m], then tensions [N] (n_rows, 2 n_cables); NaN where missing."""
        return np.hstack([self.measured.length_m, self.measured.tension_N])

    def free_readings(self, mask: BoolArray) -> int:
        """Return how many of the readings taken (n_rows, 2 n_cables) are left to test the model.

        A row of a redundant robot gives up one for each cable to spare, for its internal forces,
        and as many as its degrees of freedom where its pose was not measured.
        """
        given_up = self.predict.row_unknowns
        return int(np.maximum(mask.sum(axis=1) - given_up, 0).sum())

    def predicted(self, settings: Sequence[Setting]) -> Readings:
        """Return what the sensors would show with these effects."""
        return self.predict(settings, self.noise)

    def surroundings(self, settings: Sequence[Setting]) -> Readings:
        """Return lengths and tensions that a residual may go with; see `Predictor`."""
        return self.predict.surroundings(settings, self.noise)

    def residual(self, settings: Sequence[Setting]) -> FloatArray:
        """Return (measured - predicted) / noise (n_rows, 2 n_cables); NaN where not measured."""
        read, sigma, predicted = self.readings, self.sigma, self.predicted(settings).stacked
        residual = np.asarray((read - predicted) / sigma)
        unheld = np.isnan(predicted) & ~np.isnan(read)
        if unheld.any():
            # No other error is worse than a pose that the model cannot hold.
            residual[unheld] = (1e3 + 10.0 * np.abs(read) / sigma)[unheld]
        return residual


def channel_names(n_cables: int) -> list[str]:
    """Return the names of the columns of a residual."""
    return [f"{kind} {k}" for kind in ("length", "tension") for k in range(1, n_cables + 1)]
