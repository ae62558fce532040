"""Positions to try in a region, handed out in chunks so that memory stays flat."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from designer.arrays import FloatArray
from designer.region import PointList, Prism
from designer.study import Workspace

CHUNK = 2**15
"""Positions per chunk; a power of two keeps Sobol sequences balanced."""


def positions_m(workspace: Workspace) -> Iterator[FloatArray]:
    """Yield the sample positions of a workspace in chunks (at most `CHUNK`, 3) [m]."""
    region = workspace.region
    if isinstance(region, PointList):
        yield from _split(region.points_m)
    elif workspace.sampling == "grid":
        yield from _grid(region, workspace.samples)
    else:
        yield from _sobol(region, workspace.samples, workspace.seed)


def sample_count(workspace: Workspace) -> int:
    """Return how many positions `positions_m` will yield, for a progress bar (an estimate)."""
    if isinstance(workspace.region, PointList):
        return len(workspace.region.points_m)
    return workspace.samples


def _split(points: FloatArray) -> Iterator[FloatArray]:
    for start in range(0, len(points), CHUNK):
        yield points[start : start + CHUNK]


def _sobol(region: Prism, count: int, seed: int) -> Iterator[FloatArray]:
    """Accept the points of a scrambled Sobol sequence in the bounding box that lie inside."""
    from scipy.stats import qmc

    sequence = qmc.Sobol(3, scramble=True, rng=np.random.default_rng(seed))
    low, high = region.bounds_m
    while count > 0:
        points = low + sequence.random(CHUNK) * (high - low)
        inside = points[region.contains(points)][:count]
        count -= len(inside)
        if len(inside) > 0:
            yield inside


def _grid(region: Prism, count: int) -> Iterator[FloatArray]:
    """Regular grid through the bounding box, boundary included, of about `count` points inside."""
    low, high = region.bounds_m
    size = high - low
    spacing = np.cbrt(region.volume_m3 / count)
    steps = np.maximum(np.ceil(size / spacing).astype(int), 1)
    axes = [np.linspace(low[k], high[k], steps[k] + 1) for k in range(3)]
    layer = np.stack(np.meshgrid(axes[0], axes[1], indexing="ij"), axis=-1).reshape(-1, 2)
    for z in axes[2]:
        points = np.column_stack([layer, np.full(len(layer), z)])
        yield from _split(points[region.contains(points)])
