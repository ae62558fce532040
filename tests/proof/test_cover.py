"""Boxes that cover a region: nothing is lost or counted twice, and where one kind ends."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from designer.arrays import FloatArray
from designer.model.region import PointList, Prism, Rectangle, Region
from designer.model.space import Orientations, Space
from designer.proof.encloser import Cover, _rotation_axes, border_m, covers_of

_TRIANGLE = Prism(np.array([[0.0, 0.0], [5.0, 0.5], [2.0, 4.0]]), (-3.0, -1.0))
_BOX = Prism.box((0.0, 2.0), (1.0, 4.0), (5.0, 5.5))
_WALL = Rectangle(np.array([[1.0, 1.0], [4.0, 5.0]]), (0.0, 2.0))


def _halved(cover: Cover, times: int) -> tuple[FloatArray, FloatArray, FloatArray]:
    low, high, corners = cover.cut(cover.low, cover.high)
    for turn in range(times):
        d = [0, 2, 1][turn % 3]
        if cover.frame.axes[:, d].max() == 0.0:
            continue
        middle = 0.5 * (low[:, d] + high[:, d])
        first, second = high.copy(), low.copy()
        first[:, d] = second[:, d] = middle
        low, high, corners = cover.cut(np.concatenate([low, second]), np.concatenate([first, high]))
        left = (low <= high).all(axis=1)
        low, high, corners = low[left], high[left], corners[left]
    return low, high, corners


@pytest.mark.parametrize("region", [_TRIANGLE, _BOX, _WALL])
def test_the_parts_have_the_size_of_the_whole(region: Prism | Rectangle) -> None:
    (cover,) = covers_of(Space(region, Orientations()))
    low, high, corners = _halved(cover, 8)
    whole = cover.share(*cover.cut(cover.low, cover.high))
    assert cover.share(low, high, corners).sum() == pytest.approx(whole.sum(), rel=1e-9)
    if region.volume_m3 is not None:
        assert whole.sum() == pytest.approx(region.volume_m3, rel=1e-9)


@pytest.mark.parametrize("region", [_TRIANGLE, _BOX, _WALL])
def test_every_pose_lies_in_a_box(region: Region) -> None:
    (cover,) = covers_of(Space(region, Orientations()))
    low, high, _ = _halved(cover, 7)
    points = region.inside_m(np.random.default_rng(1), 500)
    coordinates = np.linalg.lstsq(cover.frame.axes, (points - cover.frame.origin_m).T, rcond=None)[
        0
    ].T
    slack = 1e-12
    inside = (coordinates[:, None] >= low - slack) & (coordinates[:, None] <= high + slack)
    assert inside.all(axis=2).any(axis=1).all()
    np.testing.assert_allclose(cover.places(coordinates)[:, :3], points, atol=1e-12)


def test_a_list_is_boxes_without_size() -> None:
    points = np.random.default_rng(2).uniform(size=(5, 3))
    turns = Orientations(np.array([[0.0, 0.0, 0.0], [0.0, 0.0, 0.5]]))
    covers = covers_of(Space(PointList(points), turns))
    assert [len(cover.low) for cover in covers] == [5, 5]
    assert sum(cover.share(*cover.cut(cover.low, cover.high)).sum() for cover in covers) == 10.0
    assert covers[1].places(points)[:, 5] == pytest.approx(0.5)


def test_the_axes_of_turning_are_the_slopes_of_the_rotation() -> None:
    rng = np.random.default_rng(3)
    for size in (0.0, 1e-3, 0.3, 2.0):
        turn, arm, step = size * rng.normal(size=3), rng.normal(size=3), 1e-6
        axes = _rotation_axes(turn[None])[0]
        for d in range(3):
            ahead, behind = (
                Rotation.from_rotvec(turn + sign * step * np.eye(3)[d]).apply(arm)
                for sign in (1.0, -1.0)
            )
            now = Rotation.from_rotvec(turn).apply(arm)
            slope = (ahead - behind) / (2.0 * step)
            np.testing.assert_allclose(np.cross(axes[:, d], now), slope, atol=1e-9)


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
