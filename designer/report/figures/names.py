"""Names of exit points in a drawing."""

from __future__ import annotations

import numpy as np

from designer.arrays import FloatArray


def names_of(points_m: FloatArray, apart_m: float) -> list[tuple[str, FloatArray]]:
    """Return a name and a place for each exit point, one for those that are close together.

    Parameters
    ----------
    points_m : array (n_cables, 2 or 3)
        Exit points [m].
    apart_m : float
        Names this close would overlap [m].
    """
    groups: list[list[int]] = []
    for index, point in enumerate(points_m):
        near = (g for g in groups if np.linalg.norm(points_m[g[0]] - point) < apart_m)
        group = next(near, None)
        if group is None:
            groups.append([index])
        else:
            group.append(index)
    return [
        (", ".join(f"A{index + 1}" for index in group), points_m[group].mean(axis=0))
        for group in groups
    ]
