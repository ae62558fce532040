"""The time from which an effect acts at once: it has no slope, and lies between two rows."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from designer.arrays import FloatArray
from designer.effects.platform_loads import LEAST_ROWS


class StepTime(NamedTuple):
    """A time [s] and its standard deviation [s]."""

    time_s: float
    std_s: float


def step_time(
    time_s: FloatArray, before: FloatArray, after: FloatArray, variance: float
) -> StepTime | None:
    r"""Return the time at which a step leaves least loss; None where too few rows show it.

    With a step between two rows the loss is Σ before up to the one and Σ after from the other; the
    time is midway. Within a gap between rows every time is as probable, and one gap against another
    as exp(-loss / 2 variance) times its width (Hinkley, Biometrika 57 (1970) 1), from which the
    deviation follows.

    Parameters
    ----------
    time_s : array (n_rows,)
        When the rows were taken [s].
    before, after : array (n_rows,)
        Loss of each row without the effect and with it; rows in which these are equal tell nothing.
    variance : float
        Of the residual, in the unit of the losses.
    """
    rows = np.flatnonzero(before != after)
    if len(rows) < 2 * LEAST_ROWS:
        return None
    rows = rows[np.argsort(time_s[rows], kind="stable")]
    last = np.arange(LEAST_ROWS - 1, len(rows) - LEAST_ROWS)  # before the step
    starts, ends = time_s[rows[last]], time_s[rows[last + 1]]
    width, middle = ends - starts, 0.5 * (starts + ends)
    if not width.any():
        return None
    loss = np.where(width > 0.0, np.cumsum((before - after)[rows])[last], np.inf)
    best = int(np.argmin(loss))
    weight = width * np.exp(-0.5 * (loss - loss[best]) / variance)
    square = weight @ ((middle - middle[best]) ** 2 + width**2 / 12.0) / weight.sum()
    return StepTime(float(middle[best]), float(np.sqrt(square)))
