"""Error on held-out rows from stage to stage."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from designer.diagnosis.result import Diagnosis
from designer.report.diagnosis.quantity import Quantity, quantities
from designer.report.figures import canvas, diagnosis_style, palette

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_TITLE = "Error on held-out rows, from the model as declared to the one with all effects"
_LOG_ABOVE = 6.0


def errors_chart(diagnosis: Diagnosis) -> str:
    """Return a row for each stage and a panel for each kind of reading, as SVG."""
    kinds = [quantity for quantity, _, _ in quantities(diagnosis)]
    labels = [stage.label for stage in diagnosis.stages]
    with canvas.drawing():
        figure = canvas.sheet(22.0 + 7.0 * len(labels))
        grid = figure.subplots(1, max(len(kinds), 1), sharey=True, squeeze=False)[0]
        for axes, quantity in zip(grid, kinds, strict=False):
            _panel(axes, diagnosis, quantity)
        grid[0].set_yticks(range(len(labels)), labels)
        grid[0].set_ylim(len(labels) - 0.4, -0.6)
        return canvas.svg(figure, "diagnosis-errors", _TITLE)


def _panel(axes: Axes, diagnosis: Diagnosis, quantity: Quantity) -> None:
    shown = [quantity.noise]
    for row, stage in enumerate(diagnosis.stages):
        error = quantity.error_of(stage)
        if error is None:
            continue
        colour = diagnosis_style.BEFORE if row == 0 else diagnosis_style.AFTER
        low, value, high = (
            quantity.scale * x for x in (error.heldout.low, error.heldout.value, error.heldout.high)
        )
        axes.plot([low, high], [row, row], color=colour, linewidth=4.0, alpha=0.45)
        axes.plot(value, row, marker="o", markersize=5.0, color=colour)
        axes.annotate(
            f"{quantity.shown(error.heldout.value)} {quantity.unit}", (high, row), (5, 0),
            textcoords="offset points", va="center", fontsize=palette.FONT_POINTS - 1.0,
            path_effects=canvas.halo(),
        )  # fmt: skip
        shown += [error.heldout.low, error.heldout.high]
    noise = quantity.scale * quantity.noise
    axes.axvline(noise, color=palette.INK, linewidth=0.8, linestyle=(0, (4, 2)), zorder=0)
    _scale(axes, quantity.scale * np.array(shown))
    axes.set_title(f"error of {quantity.name} [{quantity.unit}]; dashed: noise", loc="left")
    axes.tick_params(axis="y", length=0)
    axes.spines["left"].set_visible(False)
    canvas.grid_lines(axes, "x")


def _scale(axes: Axes, shown: np.ndarray[tuple[int], np.dtype[np.float64]]) -> None:
    """Take a logarithmic axis where errors differ by much, and write plain numbers on it."""
    low, high = float(shown.min()), float(shown.max())
    if low <= 0.0 or high / low < _LOG_ABOVE:
        axes.set_xlim(0.0, 1.4 * high)
        return
    axes.set_xscale("log")
    axes.set_xlim(low / 1.5, high * (high / low) ** 0.25)
    axes.xaxis.set_major_formatter(lambda value, _: canvas.number(value))
    axes.xaxis.set_minor_formatter(lambda *_: "")
