"""How much of the workspace each size of one grade serves: I have this rope, where may I go?"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from designer.arrays import BoolArray, FloatArray
from designer.grades.grade import Grade, Size
from designer.model.cable import Cable
from designer.model.robot import Poses, Robot
from designer.model.workspace import Workspace
from designer.statics.inverse import solve_sagging
from designer.statics.sizes import is_quick
from designer.workspace.demand import is_counted

_FEW_PLACES, _FEW_POSITIONS = 1000, 100
"""Asked at least of robots that are slow to solve: places, and positions in all orientations."""


@dataclass(frozen=True, slots=True, eq=False)
class UsableSize:
    """What one size serves.

    Parameters
    ----------
    size : Size
        The size.
    cable : Cable
        Its figures as the solver takes them.
    fraction : float
        Share of the samples at which it stays within its allowable tension.
    volume_m3 : float or None
        That share of the region [m³]; None for a list of points.
    lost_fraction : float
        Share of the samples that a thinner size of the grade serves and this one does not: it may
        be weaker, or too heavy for what it bears.
    """

    size: Size = field(metadata={"json": lambda s: {"size_id": s.id, "diameter_m": s.diameter_m}})
    cable: Cable = field(metadata={"json": None})
    fraction: float
    volume_m3: float | None
    lost_fraction: float = 0.0


@dataclass(frozen=True, slots=True, eq=False)
class Usable:
    """What the sizes of a grade serve, thinnest first; by so many sample positions."""

    grade: Grade
    sizes: tuple[UsableSize, ...]
    samples: int

    @property
    def differs(self) -> bool:
        """Whether some sizes serve more than others."""
        return len({size.fraction for size in self.sizes}) > 1

    @property
    def is_nested(self) -> bool:
        """Whether each size serves all that thinner ones serve."""
        return all(size.lost_fraction == 0.0 for size in self.sizes)

    @property
    def first_for_good(self) -> int | None:
        """Index of the size from which on all serve everything; None where the last does not."""
        partly = [k for k, size in enumerate(self.sizes) if size.fraction < 1.0]
        index = partly[-1] + 1 if partly else 0
        return index if index < len(self.sizes) else None


def serves(robot: Robot, workspace: Workspace, cable: Cable, places: FloatArray) -> BoolArray:
    """Tell which places (n, n_coordinates) count and keep a cable within its allowable tension."""
    statics = solve_sagging(robot, Poses.at(places), cable)
    counts = is_counted(statics, workspace.hangs_below)
    with np.errstate(invalid="ignore"):
        return np.asarray(counts & (statics.largest_tension_N <= cable.allowable_tension_N))


def usable(
    robot: Robot, workspace: Workspace, grade: Grade, cables: Sequence[tuple[Size, Cable]]
) -> Usable:
    """Find at how many samples each size of a grade, thinnest first, serves with its own figures.

    A position is served where the size holds it in every orientation that the study asks for. One
    that the study leaves out because a cable hangs below the platform is not served. On robots that
    are slow to solve only a part of the samples is asked, fairly drawn.
    """
    samples = 0
    served, lost = np.zeros((2, len(cables)))
    few = max(_FEW_PLACES, _FEW_POSITIONS * workspace.orientations.count)
    for some in workspace.places() if is_quick(robot) else [workspace.thinned(few)]:
        each = np.stack([serves(robot, workspace, cable, some) for _, cable in cables])
        at = each.reshape(len(cables), -1, workspace.orientations.count).all(axis=2)
        samples += at.shape[1]
        served += at.sum(axis=1)
        lost += (np.logical_or.accumulate(at, axis=0) & ~at).sum(axis=1)
    volume_m3 = workspace.region.volume_m3
    return Usable(
        grade,
        tuple(
            UsableSize(size, cable, share, None if volume_m3 is None else share * volume_m3, gone)
            for (size, cable), share, gone in zip(
                cables, (served / samples).tolist(), (lost / samples).tolist(), strict=True
            )
        ),
        samples,
    )
