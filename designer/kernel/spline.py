"""Readings of a log at other times: a cubic spline through its rows, all columns at once."""

from __future__ import annotations

import numpy as np

from designer.arrays import FloatArray
from designer.kernel.compiling import kernel


@kernel
def at_earlier_times(time: FloatArray, values: FloatArray, offset: float, out: FloatArray) -> None:
    """Set what the columns were ``offset`` before each row, held at both ends.

    The spline's slopes s follow from its second derivative being continuous,

        h₊ s₋ + 2 (h₋ + h₊) s + h₋ s₊ = 3 (h₊ d₋ + h₋ d₊),

    with steps h and divided differences d before and after a row; at both ends the third derivative
    is continuous over the neighbouring row as well ("not a knot").

    Parameters
    ----------
    time : array (n_rows,)
        Growing; four rows at least [s].
    values, out : array (n_rows, n_columns)
        Without gaps.
    offset : float
        [s]
    """
    n, columns = values.shape
    slopes = _slopes(time, values)
    at = 0
    for row in range(n):
        t = min(max(time[row] - offset, time[0]), time[n - 1])
        while at < n - 2 and time[at + 1] < t:
            at += 1
        h = time[at + 1] - time[at]
        u = (t - time[at]) / h
        for c in range(columns):
            y, change = values[at, c], values[at + 1, c] - values[at, c]
            rise, fall = h * slopes[at, c] - change, change - h * slopes[at + 1, c]
            out[row, c] = y + u * (change + (1.0 - u) * (rise * (1.0 - u) + fall * u))


@kernel
def _slopes(time: FloatArray, values: FloatArray) -> FloatArray:
    """Return the slopes in the rows (n_rows, n_columns), by elimination of a tridiagonal system."""
    n, columns = values.shape
    slopes = np.empty((n, columns))
    above = np.empty(n)
    h, k = time[1] - time[0], time[2] - time[1]
    above[0] = (h + k) / k
    for c in range(columns):
        d, e = (values[1, c] - values[0, c]) / h, (values[2, c] - values[1, c]) / k
        slopes[0, c] = ((h + 2.0 * (h + k)) * k * d + h * h * e) / ((h + k) * k)
    for i in range(1, n - 1):
        h, k = time[i] - time[i - 1], time[i + 1] - time[i]
        pivot = 2.0 * (h + k) - k * above[i - 1]
        above[i] = h / pivot
        for c in range(columns):
            d = (values[i, c] - values[i - 1, c]) / h
            e = (values[i + 1, c] - values[i, c]) / k
            slopes[i, c] = (3.0 * (k * d + h * e) - k * slopes[i - 1, c]) / pivot
    h, k = time[n - 1] - time[n - 2], time[n - 2] - time[n - 3]
    pivot = k - (h + k) * above[n - 2]
    for c in range(columns):
        d = (values[n - 1, c] - values[n - 2, c]) / h
        e = (values[n - 2, c] - values[n - 3, c]) / k
        right = ((h + 2.0 * (h + k)) * k * d + h * h * e) / (h + k)
        slopes[n - 1, c] = (right - (h + k) * slopes[n - 2, c]) / pivot
    for i in range(n - 2, -1, -1):
        for c in range(columns):
            slopes[i, c] -= above[i] * slopes[i + 1, c]
    return slopes
