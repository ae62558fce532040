"""Searches for the worst pose: where they start, and demands that jump."""

from __future__ import annotations

from functools import partial

import numpy as np

from designer.arrays import FloatArray
from designer.model.region import Prism
from designer.model.space import Orientations, Space
from designer.model.workspace import Workspace
from designer.workspace.refine import CELLS_A_SIDE, LIGHT, Pool, refine

SIZE = np.array([1, 1, 1, 0.1, 0.1, 0.1])


def falling(places: FloatArray, normal: FloatArray, at: FloatArray) -> FloatArray:
    """Return a demand whose summit lies beyond a plane, where it falls by 1; 0.91 on the plane."""
    away = places / SIZE - at
    return np.asarray(1.0 - ((away - 0.3 * normal) ** 2).sum(axis=1) - (away @ normal > 0.0))


def test_largest_demand_at_a_jump_is_found() -> None:
    turned = Orientations.within(-SIZE[3:], SIZE[3:])
    workspace = Workspace(Prism.box((-1, 1), (-1, 1), (-1, 1)), orientations=turned)
    rng = np.random.default_rng(3)
    for _ in range(4):
        normal, at = rng.normal(size=6), rng.uniform(-0.5, 0.5, 6)
        demand = partial(falling, normal=normal / np.linalg.norm(normal), at=at)
        (worst,) = refine(workspace.space, demand, workspace.thinned(500), LIGHT)
        assert 0.91 - worst.demand < 6e-6


def test_the_pool_keeps_the_first_of_the_largest_of_each_part() -> None:
    rng = np.random.default_rng(0)
    space = Space(Prism.box((-1, 1), (0, 3), (-2, 0)), Orientations(rng.normal(0, 0.1, (2, 3))))
    places = space.places(space.region.inside_m(rng, 3000))
    values = np.round(rng.random(len(places)), 1)  # with ties
    values[rng.random(len(places)) < 0.3] = -np.inf  # do not count
    largest: dict[tuple[int, ...], int] = {}
    for at, cell in enumerate(map(tuple, space.cells(places, CELLS_A_SIDE).tolist())):
        if values[at] > values[largest.setdefault(cell, at)]:
            largest[cell] = at
    expected = sorted(at for at in largest.values() if values[at] > -np.inf)
    pool = Pool(space)
    for part in (slice(0, 2000), slice(2000, None)):
        pool.add(places[part], values[part])
    found = pool.places
    assert len(found) == len(expected)
    assert {tuple(row) for row in found} == {tuple(row) for row in places[expected]}
