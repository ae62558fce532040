"""Where boxes of one kind end: areas of common faces, cut at the region."""

from __future__ import annotations

import numpy as np
import pytest

from designer.arrays import FloatArray
from designer.model.prism import Prism
from designer.model.space import Orientations, Space
from designer.proof.encloser import Cover, border_m, covers_of


def cover_of(region: Prism) -> Cover:
    (cover,) = covers_of(Space(region, Orientations()))
    return cover


def areas_m2(triangles_m: FloatArray) -> FloatArray:
    """Sums of the triangles' areas as seen along x, y and z."""
    edges = triangles_m[:, 1:] - triangles_m[:, :1]
    return np.asarray(0.5 * np.abs(np.cross(edges[:, 0], edges[:, 1])).sum(axis=0))


def test_a_box_ends_where_smaller_ones_begin() -> None:
    cover = cover_of(Prism.box((0.0, 4.0), (0.0, 4.0), (0.0, 4.0)))
    one = np.array([[0.0, 0.0, 0.0]]), np.array([[2.0, 2.0, 2.0]])
    low = np.array([[2.0, 0.0, 0.0], [0.0, 2.0, 1.5], [1.0, 1.0, 2.0], [3.0, 0.0, 0.0]])
    others = low, low + 1.0
    assert areas_m2(border_m(cover, one, others)) == pytest.approx([1.0, 0.5, 1.0])
    assert areas_m2(border_m(cover, others, one)) == pytest.approx([1.0, 0.5, 1.0])
    assert len(border_m(cover, one, (low[3:], low[3:] + 1.0))) == 0


@pytest.mark.parametrize("axis", [0, 1, 2])
@pytest.mark.parametrize("seed", range(3))
def test_it_ends_at_the_border_of_the_region(axis: int, seed: int) -> None:
    """Both halves of the box around a triangular prism meet in what a cut through it shows."""
    region = Prism.over(np.random.default_rng(seed).uniform(0.0, 10.0, (3, 2)), 0.0, (0.0, 3.0))
    low, high = region.bounds_m
    at = 0.4 * low[axis] + 0.6 * high[axis]
    below, above = high.copy(), low.copy()
    below[axis] = above[axis] = at
    found = border_m(cover_of(region), (low[None], below[None]), (above[None], high[None]))
    expected = np.zeros(3)
    if axis == 2:
        expected[2] = region.area_m2
    else:
        starts, ends = region.polygon_m, np.roll(region.polygon_m, -1, axis=0)
        share = (at - starts[:, axis]) / (ends - starts)[:, axis]
        crossed = (share > 0.0) & (share < 1.0)
        hits = (starts + share[:, None] * (ends - starts))[crossed, 1 - axis]
        expected[axis] = 3.0 * np.ptp(hits)
    assert areas_m2(found) == pytest.approx(expected, rel=1e-9)
    assert np.allclose(found[..., axis], at, rtol=0.0, atol=1e-12)
