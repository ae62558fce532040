"""How much of the workspace each size of one grade serves: I have this rope, where may I go?"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from designer.cable import Cable
from designer.catalogue.grade import Grade, Size
from designer.region import Prism
from designer.robot import Robot
from designer.selection.verify_sizes import Sampled, verify_sizes
from designer.study import Workspace


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
    """

    size: Size
    cable: Cable
    fraction: float
    volume_m3: float | None


@dataclass(frozen=True, slots=True, eq=False)
class Usable:
    """What the sizes of a grade serve, thinnest first."""

    grade: Grade
    sizes: tuple[UsableSize, ...]

    @property
    def differs(self) -> bool:
        """Whether some sizes serve more than others."""
        return len({one.fraction for one in self.sizes}) > 1


def usable(
    robot: Robot, workspace: Workspace, grade: Grade, cables: Sequence[tuple[Size, Cable]]
) -> Usable:
    """Count the samples that each size of a grade serves, with its own figures.

    A pose that the study leaves out because a cable hangs below the platform is not served.
    """
    sampled = verify_sizes(robot, workspace, [cable for _, cable in cables], gives_up=False)
    return Usable(
        grade,
        tuple(
            _usable_size(workspace, size, cable, one)
            for (size, cable), one in zip(cables, sampled, strict=True)
        ),
    )


def _usable_size(workspace: Workspace, size: Size, cable: Cable, sampled: Sampled) -> UsableSize:
    region = workspace.region
    volume = sampled.served * region.volume_m3 if isinstance(region, Prism) else None
    return UsableSize(size, cable, sampled.served, volume)
