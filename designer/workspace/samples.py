"""Positions to try in a region, handed out in chunks so that memory stays flat."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from designer.arrays import FloatArray
from designer.model.region import PointList, Prism, Rectangle
from designer.study import Workspace

CHUNK = 2**15
"""Positions per chunk; a power of two keeps Sobol sequences balanced."""


def positions_m(workspace: Workspace) -> Iterator[FloatArray]:
    """Yield the sample positions of a workspace in chunks (at most `CHUNK`, 3) [m]."""
    region = workspace.region
    if isinstance(region, PointList):
        yield from _split(region.points_m)
    elif isinstance(region, Rectangle):
        yield from _in_rectangle(region, workspace)
    elif workspace.sampling == "grid":
        yield from _grid(region, workspace.samples)
    else:
        yield from _sobol(region, workspace.samples, workspace.seed)


def places(workspace: Workspace) -> Iterator[FloatArray]:
    """Yield the sample places in chunks (at most about `CHUNK`, n_coordinates) [m, rad].

    The orientations of a position follow one another in one chunk.
    """
    for piece in pieces_m(workspace):
        yield workspace.space.places(piece)


def pieces_m(workspace: Workspace) -> Iterator[FloatArray]:
    """Yield the sample positions in pieces that have about `CHUNK` places at most (n, 3) [m]."""
    size = max(CHUNK // workspace.orientations.count, 1)
    for chunk in positions_m(workspace):
        yield from _split(chunk, size)


def thinned(workspace: Workspace, most: int) -> FloatArray:
    """Return about `most` places (n, n_coordinates), fairly drawn from all samples [m, rad].

    Drawn are positions, from the whole of the region; each comes in all its orientations.
    """
    count = max(most // workspace.orientations.count, 1)
    rng = np.random.default_rng(workspace.seed)
    kept, draws = np.empty((0, 3)), np.empty(0)
    for some in positions_m(workspace):
        kept, draws = np.concatenate([kept, some]), np.concatenate([draws, rng.random(len(some))])
        first = np.sort(np.argsort(draws)[:count])
        kept, draws = kept[first], draws[first]
    return workspace.space.places(kept)


def sample_count(workspace: Workspace) -> int:
    """Return how many positions `positions_m` will yield, for a progress bar (an estimate)."""
    if isinstance(workspace.region, PointList):
        return len(workspace.region.points_m)
    return workspace.samples


def _split(points: FloatArray, size: int = CHUNK) -> Iterator[FloatArray]:
    for start in range(0, len(points), size):
        yield points[start : start + size]


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


def _in_rectangle(region: Rectangle, workspace: Workspace) -> Iterator[FloatArray]:
    if workspace.sampling == "grid":
        width, height = region.size_m
        spacing = np.sqrt(width * height / workspace.samples)
        steps = np.maximum(np.ceil(region.size_m / spacing).astype(int), 1)
        axes = [np.linspace(0.0, 1.0, count + 1) for count in steps]
        shares = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 2)
        yield from _split(region.at(shares))
        return
    from scipy.stats import qmc

    sequence = qmc.Sobol(2, scramble=True, rng=np.random.default_rng(workspace.seed))
    for start in range(0, workspace.samples, CHUNK):
        yield region.at(sequence.random(CHUNK)[: workspace.samples - start])
