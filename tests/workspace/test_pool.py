"""What a sweep remembers of its samples: the largest of each part of the space."""

from __future__ import annotations

import numpy as np

from designer.model.prism import Prism
from designer.model.space import Orientations, Space
from designer.workspace.pool import CELLS_A_SIDE, Pool


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
