"""Regions: insets, containment, nearest points."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.stats import qmc

from designer.arrays import frozen_array
from designer.model.region import PointList, Prism, Rectangle, ring
from designer.model.sobol import halton, sobol
from designer.model.space import Orientations, Space, named_pose

TRIANGLE = [[0, 0, 0], [500, 0, 0], [250, 433.01, 0]]


def test_inset_moves_every_edge_inward() -> None:
    prism = Prism.over(TRIANGLE, 10.35, (-200.0, -40.0))
    edges = np.roll(TRIANGLE, -1, axis=0)[:, :2] - np.array(TRIANGLE)[:, :2]
    for start, edge in zip(np.array(TRIANGLE)[:, :2], edges, strict=True):
        offset = prism.polygon_m - start
        distance = (edge[0] * offset[:, 1] - edge[1] * offset[:, 0]) / np.linalg.norm(edge)
        assert np.sort(distance)[:2] == pytest.approx(10.35)


def test_area_of_the_triangle() -> None:
    prism = Prism.over(TRIANGLE, 0.0, (-200.0, -40.0))
    assert prism.area_m2 == pytest.approx(0.5 * 500 * 433.01)
    assert prism.volume_m3 == pytest.approx(0.5 * 500 * 433.01 * 160)


def test_box_is_a_prism() -> None:
    box = Prism.box((0, 2), (1, 4), (-1, 1))
    assert box.volume_m3 == pytest.approx(12.0)
    assert list(box.contains(np.array([[1, 2, 0], [3, 2, 0], [1, 2, 2], [0, 1, -1]]))) == [
        True,
        False,
        False,
        True,
    ]


@pytest.mark.parametrize(
    ("points", "inset", "message"),
    [([[0, 0], [1, 1], [2, 2]], 0.0, "one line"), (TRIANGLE, 200.0, "nothing is left")],
)
def test_impossible_prisms(points, inset, message) -> None:
    with pytest.raises(ValueError, match=message):
        Prism.over(points, inset, (0.0, 1.0))


def test_nearest_is_inside_and_no_inside_point_is_nearer() -> None:
    prism = Prism.over(TRIANGLE, 20.0, (-200.0, -40.0))
    rng = np.random.default_rng(0)
    points = rng.uniform([-200, -200, -400], [700, 600, 100], (200, 3))
    nearest = prism.nearest(points)
    grown = Prism(prism.polygon_m, (prism.z_m[0] - 1e-9, prism.z_m[1] + 1e-9))
    assert grown.contains(nearest).all()
    inside = prism.contains(points)
    assert np.array_equal(nearest[inside], points[inside])
    low, high = prism.bounds_m
    others = rng.uniform(low, high, (4000, 3))
    others = others[prism.contains(others)]
    distance = np.linalg.norm(points - nearest, axis=1)
    rivals = np.linalg.norm(points[:, None] - others, axis=2).min(axis=1)
    assert np.all(distance <= rivals + 1e-9)


def test_point_list_bounds() -> None:
    points = PointList(frozen_array([[0, 1, 2], [3, -1, 5]]))
    assert points.bounds_m.tolist() == [[0, -1, 2], [3, 1, 5]]


REGIONS = [
    Prism.over(TRIANGLE, 20.0, (-200.0, -40.0)),
    Rectangle.over([[0, 0], [3, 4]], 0.5, (1.0, 3.0)),
    PointList(np.random.default_rng(0).uniform(size=(300, 3))),
]


@pytest.mark.parametrize("region", REGIONS, ids=lambda region: type(region).__name__)
@pytest.mark.parametrize("sampling", ["low_discrepancy", "grid"])
def test_what_a_region_hands_out_lies_in_it(region, sampling) -> None:
    rng = np.random.default_rng(1)
    sampled = np.concatenate(list(region.samples_m(500, sampling, 0)))
    border = region.border()
    on_border = np.concatenate([border.landmarks_m(), border.samples_m(rng, 4, 8)])
    for points in (sampled, region.inside_m(rng, 50), on_border):
        assert points.shape[1] == 3
        assert region.contains(region.nearest(points)).all()
        assert region.nearest(points) == pytest.approx(points, abs=1e-9)
    assert (len(sampled) == 300) == region.is_discrete or sampling == "grid"


def test_the_edges_of_a_ring_lead_from_corner_to_corner_and_back() -> None:
    corners = np.random.default_rng(6).normal(size=(5, 3))
    edges = ring(corners)
    assert (edges[:, 0] == corners).all()
    assert (edges[:-1, 1] == edges[1:, 0]).all()
    assert (edges[-1, 1] == corners[0]).all()


@pytest.mark.parametrize("at_m", [-1e3, 0.0, 1e3])
def test_a_place_is_inside_wherever_its_region_lies(at_m: float) -> None:
    """Coordinates that are all negative, all positive, or both."""
    z_m = at_m - 1.0, at_m + 1.0
    points = np.random.default_rng(2).uniform(at_m - 1.0, at_m + 1.0, (9, 3))
    wall = Rectangle(np.array([[at_m - 1.0, at_m], [at_m + 2.0, at_m + 4.0]]), z_m)
    for region in (Prism.box(z_m, z_m, z_m), wall, PointList(frozen_array(points))):
        space = Space(region, Orientations())
        for x, y, z in np.concatenate(list(region.samples_m(20, "low_discrepancy", 0))):
            assert space.outside(np.array([x, y, z, 0.0, 0.0, 0.0])) == (False, False)
            assert space.outside(np.array([x, y, z, 0.0, 0.0, 0.1])) == (False, True)
            assert space.outside(np.array([x, y, z + 3.0, 0.0, 0.0, 0.0])) == (True, False)


def test_a_region_measures_and_describes_itself() -> None:
    prism, rectangle, points = REGIONS
    assert [(name, unit) for name, _, unit in prism.sizes] == [
        ("Base area", "m²"),
        ("Volume", "m³"),
    ]
    assert prism.volume_m3 == pytest.approx(prism.area_m2 * 160)
    assert rectangle.sizes == (("Area", pytest.approx(8.0), "m²"),)
    assert rectangle.along == pytest.approx([0.6, 0.8])
    assert rectangle.volume_m3 is points.volume_m3 is None
    words = [region.words(str, "{} {}s".format) for region in REGIONS]
    assert words[0] == "upright prism over 3 corners"
    assert words[1].startswith("upright rectangle from [")
    assert words[2] == "a list of 300 points"


@pytest.mark.parametrize("dimensions", [2, 3])
@pytest.mark.parametrize("seed", [0, 12345])
def test_samples_are_the_sequence_of_scipy(dimensions: int, seed: int) -> None:
    theirs = qmc.Sobol(dimensions, scramble=True, rng=np.random.default_rng(seed))
    ours = sobol(dimensions, seed, 256)
    for _ in range(4):
        np.testing.assert_array_equal(next(ours), theirs.random(256))


@pytest.mark.parametrize("dimensions", [1, 2, 3])
def test_orientations_spread_as_the_sequence_of_scipy(dimensions: int) -> None:
    theirs = qmc.Halton(dimensions, scramble=False).random(201)[1:]
    np.testing.assert_array_equal(halton(dimensions, 200), theirs)


def test_outlines_from_above_and_from_the_side() -> None:
    triangle = Prism(frozen_array([[0.0, 0.0], [4.0, 0.0], [0.0, 3.0]]), (1.0, 2.0))
    assert triangle.outline_m([0, 1]) is triangle.polygon_m
    assert triangle.outline_m([0, 2]).tolist() == [[0, 1], [4, 1], [4, 2], [0, 2]]


def test_points_inside_are_spread_evenly_over_the_polygon() -> None:
    """All of them lie in it, and each half of a square has half of them."""
    square = Prism(frozen_array([[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0]]), (1.0, 3.0))
    points = square.inside_m(np.random.default_rng(0), 4000)
    assert square.contains(points).all()
    assert (points < [1.0, 1.0, 2.0]).mean(axis=0) == pytest.approx([0.5, 0.5, 0.5], abs=0.03)


def test_the_frame_of_a_rectangle_spans_its_corners() -> None:
    rectangle = Rectangle.over([[1.0, 2.0], [4.0, 6.0]], 0.0, (-1.0, 2.0))
    frame = rectangle.frame()
    corners = frame.origin_m + np.stack([frame.low[0], frame.high[0]]) @ frame.axes.T
    assert corners == pytest.approx(np.array([[1.0, 2.0, -1.0], [4.0, 6.0, 2.0]]))


def test_a_pose_is_named_with_its_orientation_where_it_is_turned_about_any_axis() -> None:
    position = [1.0, 2.0, 3.0]
    for turn in ([0.1, 0.0, 0.0], [0.0, -0.1, 0.0], [0.0, 0.0, 0.1], [0.1, 0.2, 0.3]):
        (_, turned) = named_pose(np.array([*position, *turn])).values()
        assert turned.tolist() == turn
    for place in (np.array([*position, 0.0, 0.0, 0.0]), np.array(position)):
        (alone,) = named_pose(place).values()
        assert alone.tolist() == position
