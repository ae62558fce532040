"""What the figures of a diagnosis share: colours, thinning, names of covariates."""

from __future__ import annotations

import warnings
from typing import TYPE_CHECKING

import numpy as np

from designer.arrays import BoolArray, FloatArray, IntArray
from designer.report.figures import palette

if TYPE_CHECKING:
    from matplotlib.axes import Axes

BEFORE = "#8A8A8A"
AFTER = palette.SAG
TREND = palette.WARNING
HELDOUT = "#DFECF6"
MOST_POINTS = 500
"""Points of a panel; more would only make the file heavy."""


def thinned(n_rows: int) -> IntArray:
    """Return indices of at most `MOST_POINTS` rows, evenly spread."""
    step = -(-n_rows // MOST_POINTS)
    return np.arange(0, n_rows, step)


def noise_band(axes: Axes) -> None:
    """Mark where 95 % of plain noise lies, in units of noise."""
    axes.axhspan(-2.0, 2.0, color=palette.FAINT, alpha=0.25, linewidth=0, zorder=0)
    axes.axhline(0.0, color=palette.FAINT, linewidth=0.5, zorder=1)


def points(axes: Axes, x: FloatArray, y: FloatArray, heldout: BoolArray, colour: str) -> None:
    """Draw readings: dots where they were fitted, rings where they were held out."""
    axes.plot(
        x[~heldout], y[~heldout], linestyle="none", marker="o", markersize=1.7,
        color=colour, markeredgewidth=0, alpha=0.75,
    )  # fmt: skip
    axes.plot(
        x[heldout], y[heldout], linestyle="none", marker="o", markersize=2.8,
        markerfacecolor="white", markeredgecolor=colour, markeredgewidth=0.7,
    )  # fmt: skip


def window(values: FloatArray) -> tuple[float, float]:
    """Return limits that show the bulk: a single wild reading must not flatten the rest."""
    known = values[np.isfinite(values)]
    if known.size == 0:
        return -3.0, 3.0
    low, high = np.percentile(known, [1.0, 99.0])
    room = 0.35 * max(high - low, 1.0)
    return min(float(low - room), -3.0), max(float(high + room), 3.0)


def quiet_about_glyphs() -> None:
    """Let names of columns hold letters that the figure's font lacks."""
    warnings.filterwarnings("ignore", message="Glyph .* missing from")
