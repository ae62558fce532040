"""What of the map the mouse is over."""

from __future__ import annotations

from dataclasses import dataclass

from designer.arrays import FloatArray


@dataclass(frozen=True, slots=True, eq=False)
class Hit:
    """A place on the map (3,) [m], and the grid point next to it: of which grid, and which one."""

    position_m: FloatArray
    grid: str
    number: int
