"""Where the map is computed: grids on the outside of the region, and a slice that moves."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from designer.arrays import FloatArray
from designer.model.region import Region
from designer.model.rings import every_second

_MOST_POINTS = 3000
_RINGS, _SPOKES, _ROWS = 45, 120, 24


def map_grids(region: Region, slice_share: float, *, fine: bool) -> Mapping[str, FloatArray]:
    """Return grids of positions (n, m, 3) [m], by their names.

    Of a prism its ``top``, ``bottom`` and ``wall``, and ``slice``, level, at a share of the height;
    of a rectangle ``section``; of a list ``points`` (n, 1, 3), thinned out where there are very
    many. Unless ``fine``, every second row and column.
    """
    grids = dict(region.outside_m(_RINGS, _SPOKES, _ROWS))
    if not grids:
        points = np.concatenate([*region.samples_m(_MOST_POINTS, "grid", 0)])
        return {"points": points[:: -(-len(points) // _MOST_POINTS)][:, None]}
    section = region.section_m(slice_share, _RINGS, _SPOKES)
    if section is not None and not region.is_upright:
        grids["slice"] = section
    return grids if fine else {name: grid[every_second(grid)] for name, grid in grids.items()}
