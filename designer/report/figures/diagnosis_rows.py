"""The residual of every reading over the rows, before and after."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from designer.arrays import BoolArray, FloatArray
from designer.diagnosis.result import Diagnosis
from designer.report.figures import canvas, diagnosis_style, palette

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_TITLE = "Residual of every reading over the rows, before and after"
_MOST_MM = 215.0


def rows_chart(diagnosis: Diagnosis) -> str:
    """Return a row of panels for each cable, a column for each kind of reading, as SVG."""
    n = diagnosis.machine.robot.n_cables
    kinds = [
        (name, start)
        for name, start in (("length", 0), ("tension", n))
        if not np.isnan(diagnosis.residual_before[:, start : start + n]).all()
    ]
    height = min(20.0 + 24.0 * n, _MOST_MM)
    with canvas.drawing():
        figure = canvas.sheet(height)
        grid = figure.subplots(n, max(len(kinds), 1), sharex=True, sharey="col", squeeze=False)
        for column, (name, start) in enumerate(kinds):
            for cable in range(n):
                _panel(grid[cable, column], diagnosis, start + cable)
                _label(grid[cable, column], f"{name} {cable + 1}")
            block = np.s_[:, start : start + n]
            before, after = diagnosis.residual_before[block], diagnosis.residual_after[block]
            grid[0, column].set_ylim(diagnosis_style.window(np.hstack([before, after])))
            grid[0, column].set_title(f"residual of {name} [times the noise]", loc="left")
            grid[-1, column].set_xlabel("row of the data")
        _legend(grid[0, 0], bool(diagnosis.findings))
        return canvas.svg(figure, "diagnosis-rows", _TITLE)


def _panel(axes: Axes, diagnosis: Diagnosis, channel: int) -> None:
    rows = diagnosis_style.thinned(diagnosis.measured.n_rows)
    x = np.asarray(diagnosis.measured.row_numbers, dtype=np.float64)
    _heldout(axes, x, diagnosis.heldout)
    diagnosis_style.noise_band(axes)
    none = np.zeros(len(rows), dtype=bool)
    for residual, colour in (
        (diagnosis.residual_before, diagnosis_style.BEFORE),
        (diagnosis.residual_after, diagnosis_style.AFTER),
    ):
        if diagnosis.findings or residual is diagnosis.residual_after:
            diagnosis_style.points(axes, x[rows], residual[rows, channel], none, colour)
    axes.set_xlim(x[0], x[-1])


def _heldout(axes: Axes, x: FloatArray, heldout: BoolArray) -> None:
    """Shade the blocks of rows that were held out."""
    edges = np.flatnonzero(np.diff(np.concatenate([[0], heldout.astype(int), [0]])))
    for start, end in edges.reshape(-1, 2):
        axes.axvspan(
            x[start] - 0.5, x[end - 1] + 0.5, color=diagnosis_style.HELDOUT, linewidth=0, zorder=-1
        )


def _label(axes: Axes, text: str) -> None:
    axes.annotate(
        text, (0.0, 1.0), (3, -2), xycoords="axes fraction", textcoords="offset points",
        va="top", fontsize=palette.FONT_POINTS - 1.0, path_effects=canvas.halo(), zorder=6,
    )  # fmt: skip


def _legend(axes: Axes, has_change: bool) -> None:
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    dot: dict[str, Any] = {"linestyle": "none", "marker": "o", "markersize": 3.5}
    stages = [
        Line2D([], [], color=diagnosis_style.BEFORE, label="before", **dot),
        Line2D([], [], color=diagnosis_style.AFTER, label="after", **dot),
    ]
    axes.figure.legend(
        handles=[
            *(stages if has_change else []),
            Patch(color=diagnosis_style.HELDOUT, label="held out"),
            Patch(color=palette.FAINT, alpha=0.25, label="± 2 times the noise"),
        ],
        loc="outside upper center",
        ncols=4,
        frameon=False,
    )
