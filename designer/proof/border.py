"""Where boxes of one kind end and those of another begin, as triangles."""

from __future__ import annotations

import numpy as np

from designer.arrays import FloatArray
from designer.proof.cover import Cover

Boxes = tuple[FloatArray, FloatArray]
"""Low and high corners, each (n, 3)."""


def border_m(cover: Cover, ones: Boxes, others: Boxes) -> FloatArray:
    """Return the faces that boxes have in common with others, inside the region.

    Parameters
    ----------
    cover : Cover
        Whose coordinates they have.
    ones, others : pair of array (n, 3)
        Low and high corners of boxes that do not overlap.

    Returns
    -------
    array (n_triangles, 3, 3)
        Corners of triangles [m].
    """
    triangles = [np.empty((0, 3, 3))]
    for axis in range(3):
        low, high, plan = cover.cut(*_touching(ones, others, axis))
        overlaps = (low <= high).all(axis=1)
        low, high, plan = low[overlaps], high[overlaps], plan[overlaps]
        if axis == 2:
            level = np.broadcast_to(low[:, None, 2:], (*plan.shape[:2], 1))
            faces = np.concatenate([plan, level], axis=2)
        else:
            faces = np.stack([low, high, high, low], axis=1)
            faces[:, 1, 2], faces[:, 3, 2] = low[:, 2], high[:, 2]
        triangles += [faces[:, [0, k, k + 1]] for k in range(1, faces.shape[1] - 1)]
    corners = np.concatenate(triangles)
    edges = corners[:, 1:] - corners[:, :1]
    corners = corners[np.linalg.norm(np.cross(edges[:, 0], edges[:, 1]), axis=1) > 0.0]
    return cover.places(corners.reshape(-1, 3))[:, :3].reshape(-1, 3, 3)


def _touching(ones: Boxes, boxes: Boxes, axis: int) -> Boxes:
    """Return the common faces across an axis, as boxes that are flat along it."""
    across = [k for k in range(3) if k != axis]
    faces = []
    for side, facing in ((1, 0), (0, 1)):
        at, planes = ones[side][:, axis], boxes[facing][:, axis]
        order = np.argsort(planes)
        first, last = (np.searchsorted(planes[order], at, end) for end in ("left", "right"))
        count = last - first
        at_one = np.repeat(np.arange(len(at)), count)
        nth = np.arange(len(at_one)) - np.repeat(np.cumsum(count) - count, count)
        at_other = order[first[at_one] + nth]
        low = np.maximum(ones[0][at_one], boxes[0][at_other])
        high = np.minimum(ones[1][at_one], boxes[1][at_other])
        low[:, axis] = high[:, axis] = at[at_one]
        overlaps = (low < high)[:, across].all(axis=1)
        faces.append((low[overlaps], high[overlaps]))
    return np.concatenate([low for low, _ in faces]), np.concatenate([high for _, high in faces])
