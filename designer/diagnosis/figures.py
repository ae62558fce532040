"""Charts of a diagnosis: residuals over rows and covariates, and the error from stage to stage."""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from typing import TYPE_CHECKING, Literal

import numpy as np

from designer.arrays import BoolArray, FloatArray, IntArray
from designer.diagnosis import words
from designer.diagnosis.problem import channel_names
from designer.diagnosis.result import Diagnosis
from designer.diagnosis.structure import strongest_channel
from designer.diagnosis.words import ReadingKind, quantities
from designer.report import format as fmt
from designer.report.figures import canvas, palette
from designer.report.figures.canvas import Style

if TYPE_CHECKING:
    from matplotlib.axes import Axes

MOST_POINTS = 500
"""Points of a panel; more would only make the file heavy."""
_BEFORE, _AFTER, _HELDOUT = "#8A8A8A", palette.SAG, "#DFECF6"
_BAND: Style = {"facecolor": palette.FAINT, "alpha": 0.25}
_SMALL = palette.FONT_POINTS - 1.0
_BINS = 12

Layout = Literal["stacked", "overlaid", "after"]


def carriers_chart(diagnosis: Diagnosis, names: Sequence[str], key: str, layout: Layout) -> str:
    """Return the residual against what it goes with, as SVG: a panel or two for each covariate.

    ``key`` is put before ids, so that several charts can stand in one page. The layout is before
    above after (``stacked``), both in one panel (``overlaid``), or only ``after``.
    """
    stages = {"stacked": [["before"], ["after"]], "overlaid": [["before", "after"]]}
    rows = stages.get(layout, [["after"]])
    with canvas.drawing(), warnings.catch_warnings():
        # names of columns may hold letters that the figure's font lacks
        warnings.filterwarnings("ignore", message="Glyph .* missing from")
        # A lone row is lower, so that it finds room on the first page.
        figure = canvas.sheet(37.0 if len(rows) == 1 else 12.0 + 36.0 * len(rows))
        grid = figure.subplots(len(rows), len(names), sharex="col", squeeze=False)
        for column, name in enumerate(names):
            values = diagnosis.covariates[name]
            channel = strongest_channel(_looks(diagnosis)[rows[0][0]][0], values)
            for axes, stage_names in zip(grid[:, column], rows, strict=True):
                _carrier(axes, diagnosis, values, channel, stage_names)
            grid[-1, column].set_xlabel(words.covariate_axis(name), parse_math=False)
        text = "residual [times the noise]"
        label = figure.supylabel(text, x=0.006, fontsize=palette.FONT_POINTS)
        canvas.beside(figure, label, "left")
        return canvas.svg(figure, key, "Residual against what it goes with most")


def _looks(diagnosis: Diagnosis) -> dict[str, tuple[FloatArray, str]]:
    """Residual (n_rows, 2 n_cables) and colour of either stage."""
    return {
        "before": (diagnosis.residual_before, _BEFORE),
        "after": (diagnosis.residual_after, _AFTER),
    }


def _carrier(
    axes: Axes, diagnosis: Diagnosis, covariate: FloatArray, channel: int, stage_names: list[str]
) -> None:
    from matplotlib.ticker import FixedLocator, MaxNLocator

    rows = thinned(len(covariate))
    _noise_band(axes)
    residuals = []
    for residual, colour in (_looks(diagnosis)[stage] for stage in stage_names):
        y = residual[:, channel]
        _points(axes, covariate[rows], y[rows], diagnosis.heldout[rows], colour)
        trend: Style = {
            "color": palette.WARNING if len(stage_names) == 1 else colour,
            "linewidth": 1.4,
        }
        axes.plot(*running_median(covariate, y), **trend, path_effects=canvas.halo())
        residuals.append(y)
    axes.set_ylim(window(np.concatenate(residuals)))
    reading = channel_names(diagnosis.machine.robot.n_cables)[channel]
    stages = f", {' and '.join(stage_names)}" if diagnosis.findings else ""
    axes.set_title(f"{reading}{stages}", loc="left")
    # Few labels, so that they keep apart; a covariate of few values has one for each.
    values = np.unique(covariate[np.isfinite(covariate)])
    locator = FixedLocator(values.tolist()) if len(values) <= 3 else None
    axes.xaxis.set_major_locator(locator or MaxNLocator(3, min_n_ticks=2))
    axes.tick_params(labelsize=_SMALL)


def running_median(covariate: FloatArray, residual: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the median of the residual in bins of equal counts, and the bins' middles.

    A covariate of few values, such as a direction, has a bin for each.
    """
    finite = np.isfinite(covariate) & np.isfinite(residual)
    x, y = covariate[finite], residual[finite]
    if len(np.unique(x)) <= _BINS:
        parts = [np.flatnonzero(x == value) for value in np.unique(x)]
    else:
        n_bins = max(min(_BINS, len(x) // 8), 1)
        parts = np.array_split(np.argsort(x, kind="stable"), n_bins)
    return (
        np.array([x[part].mean() for part in parts]),
        np.array([np.median(y[part]) for part in parts]),
    )


def rows_chart(diagnosis: Diagnosis) -> str:
    """Return the residual of every reading over the rows, as SVG.

    A row of panels for each cable, a column for each kind of reading.
    """
    n = diagnosis.machine.robot.n_cables
    before, after = diagnosis.residual_before, diagnosis.residual_after
    blocks = {"length": slice(0, n), "tension": slice(n, 2 * n)}
    kinds = [name for name, block in blocks.items() if not np.isnan(before[:, block]).all()]
    with canvas.drawing():
        figure = canvas.sheet(min(20.0 + 24.0 * n, 215.0))  # a page at most
        grid = figure.subplots(n, max(len(kinds), 1), sharex=True, sharey="col", squeeze=False)
        for panels, name in zip(grid.T, kinds, strict=False):
            block = blocks[name]
            for cable, axes in enumerate(panels):
                _row_panel(axes, diagnosis, block.start + cable)
                canvas.note(
                    axes, f"{name} {cable + 1}", (0.0, 1.0), (3, -2), xycoords="axes fraction",
                    va="top", fontsize=_SMALL, path_effects=canvas.halo(), zorder=6,
                )  # fmt: skip
            panels[0].set_ylim(window(np.hstack([before[:, block], after[:, block]])))
            panels[0].set_title(f"residual of {name} [times the noise]", loc="left")
            panels[-1].set_xlabel("row of the data")
        dots = canvas.DOTS | {"markersize": 3.5}
        looks = [("before", dots | {"color": _BEFORE}), ("after", dots | {"color": _AFTER})]
        grounds = [("held out", {"facecolor": _HELDOUT}), ("± 2 times the noise", _BAND)]
        entries = [*(looks if diagnosis.findings else []), *grounds]
        canvas.legend(figure, entries, "outside upper center", ncols=4)
        title = "Residual of every reading over the rows, before and after"
        return canvas.svg(figure, "diagnosis-rows", title)


def _row_panel(axes: Axes, diagnosis: Diagnosis, channel: int) -> None:
    """Both residuals of a reading over the rows, the blocks that were held out shaded."""
    rows = thinned(diagnosis.measured.n_rows)
    x = np.asarray(diagnosis.measured.row_numbers, dtype=np.float64)
    edges = np.flatnonzero(np.diff(diagnosis.heldout.astype(int), prepend=0, append=0))
    for start, end in edges.reshape(-1, 2):
        first, last = x[start] - 0.5, x[end - 1] + 0.5
        axes.axvspan(first, last, color=_HELDOUT, linewidth=0, zorder=-1)
    _noise_band(axes)
    no_rows = np.zeros(len(rows), dtype=bool)
    for stage, (residual, colour) in _looks(diagnosis).items():
        if diagnosis.findings or stage == "after":
            _points(axes, x[rows], residual[rows, channel], no_rows, colour)
    axes.set_xlim(x[0], x[-1])


def thinned(n_rows: int) -> IntArray:
    """Return indices of at most `MOST_POINTS` rows, evenly spread."""
    return np.arange(0, n_rows, -(-n_rows // MOST_POINTS))


def window(values: FloatArray) -> tuple[float, float]:
    """Return limits that show the bulk: a single wild reading must not flatten the rest."""
    finite = values[np.isfinite(values)]
    if finite.size == 0:
        return -3.0, 3.0
    low, high = np.percentile(finite, [1.0, 99.0])
    room = 0.35 * max(high - low, 1.0)
    return min(float(low - room), -3.0), max(float(high + room), 3.0)


def _noise_band(axes: Axes) -> None:
    """Mark where 95 % of plain noise lies, in units of noise."""
    axes.axhspan(-2.0, 2.0, **_BAND, linewidth=0, zorder=0)
    axes.axhline(0.0, color=palette.FAINT, linewidth=0.5, zorder=1)


def _points(axes: Axes, x: FloatArray, y: FloatArray, heldout: BoolArray, colour: str) -> None:
    """Draw readings: dots where they were fitted, rings where they were held out."""
    dot: Style = {"markersize": 1.7, "color": colour, "markeredgewidth": 0, "alpha": 0.75}
    axes.plot(x[~heldout], y[~heldout], **canvas.DOTS, **dot)
    rim: Style = {
        "markerfacecolor": "white",
        "markeredgecolor": colour,
        "markeredgewidth": 0.7,
    }
    axes.plot(x[heldout], y[heldout], **canvas.DOTS, **rim, markersize=2.8)


def errors_chart(diagnosis: Diagnosis) -> str:
    """Return a row for each stage and a panel for each kind of reading, as SVG."""
    kinds = [kind for kind, _, _ in quantities(diagnosis)]
    labels = [stage.label for stage in diagnosis.stages]
    title = "Error on held-out rows, from the model as declared to the one with all effects"
    with canvas.drawing():
        figure = canvas.sheet(22.0 + 7.0 * len(labels))
        grid = figure.subplots(1, max(len(kinds), 1), sharey=True, squeeze=False)[0]
        for axes, kind in zip(grid, kinds, strict=False):
            _error_panel(axes, diagnosis, kind)
        grid[0].set_yticks(range(len(labels)), labels)
        grid[0].set_ylim(len(labels) - 0.4, -0.6)
        return canvas.svg(figure, "diagnosis-errors", title)


def _error_panel(axes: Axes, diagnosis: Diagnosis, kind: ReadingKind) -> None:
    levels = [kind.noise]
    for row, stage in enumerate(diagnosis.stages):
        error = kind.error_of(stage)
        if error is None:
            continue
        colour = _BEFORE if row == 0 else _AFTER
        heldout = error.heldout
        low, value, high = (kind.scale * x for x in (heldout.low, heldout.value, heldout.high))
        axes.plot([low, high], [row, row], color=colour, linewidth=4.0, alpha=0.45)
        axes.plot(value, row, marker="o", markersize=5.0, color=colour)
        text, style = f"{kind.shown(heldout.value)} {kind.unit}", {"path_effects": canvas.halo()}
        canvas.note(axes, text, (high, row), (5, 0), va="center", fontsize=_SMALL, **style)
        levels += [heldout.low, heldout.high]
    noise = kind.scale * kind.noise
    axes.axvline(noise, color=palette.INK, linewidth=0.8, linestyle=(0, (4, 2)), zorder=0)
    least, highest = kind.scale * min(levels), kind.scale * max(levels)
    if least <= 0.0 or highest / least < 6.0:
        axes.set_xlim(0.0, 1.4 * highest)
    else:  # with plain numbers on the logarithmic axis
        axes.set_xscale("log")
        axes.set_xlim(least / 1.5, highest * (highest / least) ** 0.25)
        axes.xaxis.set_major_formatter(lambda value, _: fmt.trimmed(value, 6))
        axes.xaxis.set_minor_formatter(lambda *_: "")
    axes.set_title(f"error of {kind.name} [{kind.unit}]; dashed: noise", loc="left")
    axes.tick_params(axis="y", length=0)
    axes.spines["left"].set_visible(False)
    canvas.grid_lines(axes, "x")
