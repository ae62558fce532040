"""Inputs drawn from their distributions, and a load case with them in place of what was stated."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, fields, replace

import numpy as np

from designer.analysis.sensitivities import payload_scaled
from designer.arrays import FloatArray
from designer.model.load_case import Loaded
from designer.model.robot import Robot
from designer.model.uncertainty import Input, Spread

_TINY = 1e-15
"""Nearest share to 0 and 1: there a normal deviation has no end."""
_LEAST_FACTOR = 0.01
"""On any input; a normal one of the widest deviation goes lower once in 2 million draws."""


@dataclass(frozen=True, slots=True, eq=False)
class Draws:
    """Inputs as drawn: what is stated times factors (n,), exit points moved (n, n_cables, 3) [m].

    The rope is the same on all cables.
    """

    payload: FloatArray
    modulus: FloatArray
    linear_mass: FloatArray
    breaking_load: FloatArray
    exit_points_m: FloatArray

    def __len__(self) -> int:
        """Return how many there are."""
        return len(self.payload)

    @property
    def moves(self) -> bool:
        """Whether exit points move."""
        return bool(self.exit_points_m.any())

    def part(self, at: slice | list[int]) -> Draws:
        """Return some of the draws."""
        return Draws(*(getattr(self, field.name)[at] for field in fields(self)))

    def on(self, loaded: Loaded, k: int) -> Loaded:
        """Return a load case with the inputs of one draw."""
        loaded = payload_scaled(loaded, float(self.payload[k]))
        robot, rope = loaded.bare
        drawn = replace(
            rope.with_rope_scaled(float(self.linear_mass[k])),
            axial_stiffness_N=self.modulus[k] * rope.axial_stiffness_N,
            allowable_tension_N=self.breaking_load[k] * rope.allowable_tension_N,
        )
        moved = replace(robot, exit_points_m=robot.exit_points_m + self.exit_points_m[k])
        return loaded.on(moved, drawn)


def columns_of(spreads: Mapping[Input, Spread], robot: Robot) -> dict[Input, slice]:
    """Return which coordinates of a draw belong to each input."""
    columns, at = {}, 0
    for name in spreads:
        width = 3 * robot.n_cables if name == "exit_points" else 1
        columns[name] = slice(at, at + width)
        at += width
    return columns


def draws_at(spreads: Mapping[Input, Spread], robot: Robot, shares: FloatArray) -> Draws:
    """Return the inputs at shares of their distributions, from 0 to 1 (n, n_columns).

    Exit points of a planar robot stay in its plane.
    """
    shares = np.clip(shares, _TINY, 1.0 - _TINY)
    deviation = {
        name: spreads[name].at(shares[:, at]) for name, at in columns_of(spreads, robot).items()
    }

    def factor(name: Input) -> FloatArray:
        off = deviation.get(name, np.zeros((len(shares), 1)))[:, 0]
        return np.maximum(1.0 + off, _LEAST_FACTOR)

    moved = deviation.get("exit_points", np.zeros((len(shares), 3 * robot.n_cables)))
    moved = moved.reshape(-1, robot.n_cables, 3)
    if robot.is_planar:
        across = robot.level[1]
        moved = moved - (moved @ across)[..., None] * across
    return Draws(
        factor("payload"),
        factor("modulus"),
        factor("linear_mass"),
        factor("breaking_load"),
        moved,
    )
