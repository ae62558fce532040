"""Where straight cables pull most: starts for searches of what each sagging cable meets."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import chain

import numpy as np

from designer.arrays import FloatArray, IntArray
from designer.model.robot import Poses, Robot
from designer.model.space import Space
from designer.statics.distribution import tension_over_least
from designer.workspace.refine import ONE_CLIMB, places_of, refine_each

_TWO_CLIMBS = replace(ONE_CLIMB, inside=512, starts=2)
"""For each cable: what is found here is searched again with the cable's weight."""


def where_each_pulls_most(robots: Sequence[Robot], space: Space, places: FloatArray) -> FloatArray:
    """Return where each straight cable pulls most (n, n_coordinates), by a short climb from places.

    Of one robot under one or several loads. Some cables of redundant robots have their least
    tension in almost every pose, and nothing there leads a search to the few in which they carry.
    With straight cables something does: how far each is from it. None for other robots, nor in a
    space in which every place is tried.
    """
    if space.is_discrete or not robots[0].is_redundant:
        return np.empty((0, space.n_coordinates))

    def pull(places: FloatArray, load: IntArray) -> FloatArray:
        loads, first = np.unique(load, return_index=True)
        parts = zip(loads, np.split(places, first[1:]), strict=True)
        over = [tension_over_least(robots[k], Poses.at(part)) for k, part in parts]
        return np.nan_to_num(np.concatenate(over), nan=-np.inf)

    worsts = refine_each(space, pull, [places] * len(robots), _TWO_CLIMBS)
    return places_of(chain.from_iterable(worsts))
