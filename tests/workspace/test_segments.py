"""Distances of straight pieces and triangles: closed forms, and an optimiser as brute force."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import lsq_linear, minimize

from designer.kernel.calling import plain
from designer.kernel.distance import nearest_faces, nearest_pieces


def segment_distance_m(a, b, c, d):
    """Return distances (n,) of segments ab and cd (n, 3), and the middles; plain for one."""
    first, second = (plain(np.stack(ends, axis=-2).reshape(-1, 2, 3)) for ends in ((a, b), (c, d)))
    distance, middle = np.empty(len(first)), np.empty((len(first), 3))
    nearest_pieces(first, second, distance, middle, np.zeros((len(first), 2), dtype=np.int64))
    return distance.reshape(a.shape[:-1]), middle.reshape(a.shape)


def triangle_distance_m(a, b, corners):
    """Return the distance of one segment from triangles (..., 3, 3), and the nearest place."""
    distance, place = np.empty(1), np.empty((1, 3))
    surface = plain(corners.reshape(-1, 3, 3))
    nearest_faces(plain([[a, b]]), surface, distance, place, np.zeros(1, dtype=np.int64))
    return distance[0], place[0]


def array(*rows: list[float]) -> list[np.ndarray]:
    return [np.array(row, dtype=float) for row in rows]


@pytest.mark.parametrize(
    ("ends", "distance", "middle"),
    [
        (array([-1, 0, 0], [1, 0, 0], [0, -1, 2], [0, 1, 2]), 2.0, [0, 0, 1]),
        (array([-1, 0, 0], [1, 0, 0], [0, 0, -1], [0, 0, 1]), 0.0, [0, 0, 0]),
        (array([0, 0, 0], [1, 0, 0], [3, 0, 0], [4, 0, 0]), 2.0, [2, 0, 0]),
        (array([0, 0, 0], [1, 0, 0], [2, 1, 0], [2, 5, 0]), np.sqrt(2.0), [1.5, 0.5, 0]),
        (array([0, 0, 0], [0, 0, 0], [3, 4, 0], [3, 4, 0]), 5.0, [1.5, 2, 0]),
        (array([0, 0, 0], [0, 0, 0], [-1, 2, 0], [1, 2, 0]), 2.0, [0, 1, 0]),
    ],
)
def test_known_segments(ends: list[np.ndarray], distance: float, middle: list[float]) -> None:
    for order in (ends, [ends[1], ends[0], *ends[2:]], [*ends[2:], *ends[:2]]):
        found, place = segment_distance_m(*order)
        assert found == pytest.approx(distance, abs=1e-12)
        assert np.allclose(place, middle, atol=1e-12)


def test_parallel_segments_side_by_side() -> None:
    a, b, c, d = array([0, 0, 0], [4, 0, 0], [1, 3, 0], [9, 3, 0])
    assert segment_distance_m(a, b, c, d)[0] == pytest.approx(3.0)


def test_segments_against_an_optimiser() -> None:
    rng = np.random.default_rng(1)
    a, b, c, d = rng.normal(size=(4, 200, 3))
    found, _ = segment_distance_m(a, b, c, d)
    for k in range(200):
        matrix = np.stack([b[k] - a[k], c[k] - d[k]], axis=1)
        best = lsq_linear(matrix, c[k] - a[k], (0.0, 1.0), tol=1e-14)
        assert found[k] == pytest.approx(np.sqrt(2.0 * best.cost), abs=1e-7)


CORNERS = np.array([[0.0, 0, 0], [4, 0, 0], [0, 4, 0]])


@pytest.mark.parametrize(
    ("a", "b", "distance"),
    [
        ([1, 1, 2], [1, 1, 5], 2.0),
        ([1, 1, -3], [1, 1, 3], 0.0),
        ([1, 1, 2], [2, 1, 2], 2.0),
        ([-1, 1, 0], [-1, 3, 0], 1.0),
        ([3, 3, 0], [5, 5, 0], np.sqrt(2.0)),
        ([3, 3, -1], [3, 3, 1], np.sqrt(2.0)),
        ([1, 1, 0], [2, 1, 0], 0.0),
        ([1, 1, 3], [1, 1, 3], 3.0),
    ],
)
def test_known_triangles(a: list[float], b: list[float], distance: float) -> None:
    for turn in range(3):
        corners = np.roll(CORNERS, turn, axis=0)
        for ends in ((a, b), (b, a)):
            found, place = triangle_distance_m(*array(*ends), corners)
            assert found == pytest.approx(distance, abs=1e-12)
            assert np.isfinite(place).all()


def test_triangles_against_an_optimiser() -> None:
    rng = np.random.default_rng(2)
    a, b = rng.normal(size=(2, 60, 3))
    corners = rng.normal(size=(60, 3, 3))
    found = [triangle_distance_m(a[k], b[k], corners[k])[0] for k in range(60)]
    crossing = 0
    for k in range(60):
        u, v = corners[k, 1] - corners[k, 0], corners[k, 2] - corners[k, 0]

        def gap(x: np.ndarray, k: int = k, u: np.ndarray = u, v: np.ndarray = v) -> float:
            return float(
                np.sum((a[k] + x[0] * (b[k] - a[k]) - corners[k, 0] - x[1] * u - x[2] * v) ** 2)
            )

        best = minimize(
            gap,
            [0.5, 0.3, 0.3],
            bounds=[(0, 1)] * 3,
            constraints={"type": "ineq", "fun": lambda x: 1.0 - x[1] - x[2]},
            method="SLSQP",
            options={"ftol": 1e-15, "maxiter": 500},
        )
        assert found[k] == pytest.approx(np.sqrt(best.fun), abs=2e-5)
        crossing += found[k] == 0.0
    assert crossing > 0
