"""Where the diagrams of a chart stand on its sheet.

Matplotlib's constrained layout does the same for diagrams nested in any way, and measures each text
up to eight times for that, which took half the time of a chart. In one grid, once is enough.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.artist import Artist
from matplotlib.layout_engine import LayoutEngine
from matplotlib.ticker import FixedLocator

_GAP = 3.0
"""Around each diagram with its texts, and around what stands beside all of them [points]."""
_ENDS = {"left": (0, 0), "right": (0, 1), "lower": (1, 0), "upper": (1, 1)}
"""Direction and end of each side of the sheet."""


class GridLayout(LayoutEngine):
    """Gives the diagrams of a grid all the room that their texts leave.

    A map, with equal scales, has a row and a column as large as itself, and the grid stands in the
    middle of the sheet then. ``beside`` is what stands along a side of the sheet.
    """

    _adjust_compatible = _colorbar_gridspec = False  # Matplotlib asks a subclass for both

    def __init__(self) -> None:
        super().__init__()
        self.beside: list[tuple[Artist, str]] = []

    def execute(self, fig: Any) -> None:
        """Place all diagrams, once more where that leaves room for fewer numbers along an axis.

        Where there would be room for more, those that were measured stay.
        """
        every = [axis for axes in fig.axes for axis in (axes.xaxis, axes.yaxis)]
        for _ in range(2 if every else 0):
            before = _ticks(fig)
            self._place(fig)
            changed = [x for x in zip(every, before, _ticks(fig), strict=True) if x[1] != x[2]]
            if all(len(old) < len(new) for _, old, new in changed):
                for axis, old, _ in changed:
                    axis.set_major_locator(FixedLocator(old))
                return

    def _place(self, fig: Any) -> None:
        renderer, sheet = fig.canvas.get_renderer(), np.array(fig.bbox.size)
        rims = np.full((2, 2), _GAP)  # of the sheet: low and high end, along x and y
        for artist, side in self.beside:
            along, end = _ENDS[side]
            rims[along, end] += artist.get_window_extent(renderer).size[along] + _GAP
        grid = fig.axes[0].get_gridspec()
        rows, columns = grid.get_geometry()
        # Of each diagram: how far its texts reach beyond its ends, and its height over its width.
        texts, slope = np.zeros((2, 2, columns, rows)), np.zeros((columns, rows))
        specs = [axes.get_subplotspec() for axes in fig.axes]
        places = [(spec.colspan.start, rows - spec.rowspan.stop) for spec in specs]
        for axes, at in zip(fig.axes, places, strict=True):
            look_at = {"bbox_extra_artists": axes.texts, "for_layout_only": True}
            whole, bare = axes.get_tightbbox(renderer, **look_at), axes.bbox
            texts[(..., *at)] = np.stack([bare.min - whole.min, whole.max - bare.max], axis=1)
            slope[at] = 0.0 if axes.get_aspect() == "auto" else axes.get_data_ratio()
        # Colour bars are shorter than their map by half of their outermost numbers.
        is_map = slope > 0.0
        is_along = np.stack(
            [is_map.any(axis=1, keepdims=True) & ~is_map, is_map.any(axis=0) & ~is_map]
        )
        inset = np.where(is_along[:, None], texts, 0.0)
        ends = [(texts - inset)[k].max(axis=2 - k) for k in (0, 1)]
        shares = [np.array(grid.get_width_ratios()), np.array(grid.get_height_ratios()[::-1])]
        between = [ends[k].sum() + 2.0 * _GAP * (len(shares[k]) - 1) for k in (0, 1)]
        rest = np.maximum(sheet - rims.sum(axis=1) - between, 0.1 * sheet)
        wide, tall = (rest[k] * shares[k] / shares[k].sum() for k in (0, 1))
        fit = np.minimum(wide[:, None], tall / np.maximum(slope, 1e-9)) * is_map
        width, height = fit.max(axis=1), (fit * slope).max(axis=0)
        sizes = [np.where(width > 0.0, width, wide), np.where(height > 0.0, height, tall)]
        starts = []
        for k, (low, high) in enumerate(ends):
            first = rims[k, 0] + 0.5 * (rest[k] - sizes[k].sum())
            steps = np.append(0.0, sizes[k] + high + 2.0 * _GAP)[:-1]
            starts.append(first + np.cumsum(low + steps))
        for axes, (i, j) in zip(fig.axes, places, strict=True):
            low, high = inset[:, :, i, j].T
            start = np.array([starts[0][i], starts[1][j]]) + low
            size = np.array([sizes[0][i], sizes[1][j]]) - low - high
            axes.set_position([*(start / sheet), *(size / sheet)])


def _ticks(fig: Any) -> list[list[float]]:
    for axes in fig.axes:
        axes.apply_aspect()
    return [
        list(axis.get_majorticklocs()) for axes in fig.axes for axis in (axes.xaxis, axes.yaxis)
    ]
