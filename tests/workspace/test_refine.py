"""Searches for the worst pose: demands that jump."""

from __future__ import annotations

from functools import partial

import numpy as np

from designer.arrays import FloatArray
from designer.model.prism import Prism
from designer.model.space import Orientations
from designer.model.workspace import Workspace
from designer.workspace.refine import LIGHT, refine

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
