"""The residual against what it goes with: one panel for each covariate, before over after."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

import numpy as np

from designer.arrays import FloatArray
from designer.diagnosis.problem import channel_names
from designer.diagnosis.result import Diagnosis
from designer.diagnosis.trends import strongest_channel
from designer.report.diagnosis import words
from designer.report.figures import canvas, diagnosis_style, palette

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_TITLE = "Residual against what it goes with most"
_PANEL_MM, _LONE_MM = 36.0, 25.0  # so that a lone row finds room on the first page
_BINS = 12
_FEW = 3

Layout = Literal["stacked", "overlaid", "after"]


@dataclass(frozen=True, slots=True, eq=False)
class _Layer:
    """A residual (n_rows, 2 n_cables), what it is called and its colour."""

    name: str
    residual: FloatArray
    colour: str


def carriers_chart(
    diagnosis: Diagnosis, names: Sequence[str], key: str, layout: Layout = "stacked"
) -> str:
    """Return a panel or two for each covariate, as SVG.

    Parameters
    ----------
    diagnosis : Diagnosis
        With residuals and covariates.
    names : sequence of str
        Covariates to show.
    key : str
        Put before ids, so that several charts can stand in one page.
    layout : str
        ``stacked``: before above after; ``overlaid``: both in one panel; ``after``: only that.
    """
    import warnings

    rows = _rows(diagnosis, layout)
    with canvas.drawing(), warnings.catch_warnings():
        diagnosis_style.quiet_about_glyphs()
        figure = canvas.sheet(12.0 + (_LONE_MM if len(rows) == 1 else _PANEL_MM * len(rows)))
        grid = figure.subplots(len(rows), len(names), sharex="col", squeeze=False)
        for column, name in enumerate(names):
            values = diagnosis.covariates[name]
            channel = strongest_channel(rows[0][0].residual, values)
            for axes, layers in zip(grid[:, column], rows, strict=True):
                _panel(axes, diagnosis, values, channel, layers)
            grid[-1, column].set_xlabel(words.covariate_axis(name), parse_math=False)
        grid[0, 0].figure.supylabel("residual [times the noise]", fontsize=palette.FONT_POINTS)
        return canvas.svg(figure, key, _TITLE)


def _rows(diagnosis: Diagnosis, layout: Layout) -> list[list[_Layer]]:
    before = _Layer("before", diagnosis.residual_before, diagnosis_style.BEFORE)
    after = _Layer("after", diagnosis.residual_after, diagnosis_style.AFTER)
    return {"stacked": [[before], [after]], "overlaid": [[before, after]], "after": [[after]]}[
        layout
    ]


def _panel(
    axes: Axes, diagnosis: Diagnosis, covariate: FloatArray, channel: int, layers: list[_Layer]
) -> None:
    rows = diagnosis_style.thinned(len(covariate))
    held = diagnosis.heldout[rows]
    diagnosis_style.noise_band(axes)
    for layer in layers:
        y = layer.residual[:, channel]
        diagnosis_style.points(axes, covariate[rows], y[rows], held, layer.colour)
        colour = diagnosis_style.TREND if len(layers) == 1 else layer.colour
        trend = running_median(covariate, y)
        axes.plot(*trend, color=colour, linewidth=1.4, path_effects=canvas.halo())
    axes.set_ylim(
        diagnosis_style.window(np.concatenate([layer.residual[:, channel] for layer in layers]))
    )
    reading = channel_names(layers[0].residual.shape[1] // 2)[channel]
    stages = " and ".join(layer.name for layer in layers)
    axes.set_title(f"{reading}, {stages}" if diagnosis.findings else reading, loc="left")
    _ticks(axes, covariate)


def _ticks(axes: Axes, covariate: FloatArray) -> None:
    """Keep labels apart: there are few of them, and a covariate of few values has one for each."""
    from matplotlib.ticker import FixedLocator, MaxNLocator

    values = np.unique(covariate[np.isfinite(covariate)])
    few = len(values) <= _FEW
    axes.xaxis.set_major_locator(
        FixedLocator(values.tolist()) if few else MaxNLocator(3, min_n_ticks=2)
    )
    axes.tick_params(labelsize=palette.FONT_POINTS - 1.0)


def running_median(covariate: FloatArray, residual: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the median of the residual in bins of equal counts, and the bins' middles.

    A covariate of few values, such as a direction, has a bin for each.
    """
    known = np.isfinite(covariate) & np.isfinite(residual)
    x, y = covariate[known], residual[known]
    if len(np.unique(x)) <= _BINS:
        parts = [np.flatnonzero(x == value) for value in np.unique(x)]
    else:
        n_bins = max(min(_BINS, len(x) // 8), 1)
        parts = np.array_split(np.argsort(x, kind="stable"), n_bins)
    return (
        np.array([x[part].mean() for part in parts]),
        np.array([np.median(y[part]) for part in parts]),
    )
