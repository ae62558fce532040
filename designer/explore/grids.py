"""Where the map is computed: grids on the outside of the region, and a slice that moves."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from designer.analysis import grids
from designer.arrays import FloatArray
from designer.model.region import PointList, Rectangle, Region

_MOST_POINTS = 3000
_RINGS, _SPOKES, _ROWS = 45, 120, 24


def map_grids(region: Region, slice_share: float, *, fine: bool) -> Mapping[str, FloatArray]:
    """Return grids of positions (n, m, 3) [m], by their names.

    Of a prism its ``top``, ``bottom`` and ``wall``, and ``slice``, level, at a share of the height;
    of a rectangle ``section``; of a list ``points`` (n, 1, 3), thinned out where there are very
    many. Unless ``fine``, every second row and column.
    """
    if isinstance(region, PointList):
        every = -(-len(region.points_m) // _MOST_POINTS)
        return {"points": region.points_m[::every][:, None]}
    if isinstance(region, Rectangle):
        found = {"section": grids.upright_disc_m(region)}
    else:
        low, high = region.z_m
        heights = {"top": high, "bottom": low, "slice": low + slice_share * (high - low)}
        found = {name: grids.disc_m(region, z, _RINGS, _SPOKES) for name, z in heights.items()}
        rim = found["bottom"][-1]
        found["wall"] = np.stack(
            [rim + np.array([0.0, 0.0, z - low]) for z in np.linspace(low, high, _ROWS)]
        )
    return found if fine else {name: grid[grids.every_second(grid)] for name, grid in found.items()}
