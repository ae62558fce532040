"""How many poses are looked at for which question, before the search between them.

One policy, so that what an answer rests on is read in one place. How hard is searched between them
is an `Effort` of `designer.workspace.refine`. What a pose takes decides: many cables or poses at
once in one compiled pass, where the robot `has_fast_solver`; else each for itself, or a programme
where there are cables to spare; and a thousand times as long where a platform on kept lengths is
followed to rest.
"""

from __future__ import annotations

from dataclasses import dataclass

from designer.model.robot import Robot
from designer.model.workspace import Workspace
from designer.statics.sizes import has_fast_solver


@dataclass(frozen=True, slots=True)
class SampleCount:
    """How many samples, by what each takes."""

    quick: int  #: of robots that are quick to solve
    slow: int  #: of others
    settling: int  #: where the platform settles on kept lengths

    def of(self, robot: Robot, *, keeps_lengths: bool = False) -> int:
        """Return the number for a robot."""
        return (
            self.settling if keeps_lengths else self.quick if has_fast_solver(robot) else self.slow
        )


COARSE = SampleCount(quick=2048, slow=128, settling=64)
"""That candidates are tried at first: most fail there, and those that are searched are tried at all
samples, as the study has them. Also for the worst pose of a continuous family."""
CHOSEN_SETTLING = 256
"""On kept lengths, of the candidates that are searched: the climbs start from the worst of them."""
CRITERIA = SampleCount(quick=2000, slow=500, settling=64)
"""At which criteria are evaluated, in all directions of a load case together."""
EACH_DIRECTION = 16
"""The same in each direction at least."""
STIFFNESS, CLEARANCE = 2000, 1000
"""Of the chosen cables, over the workspace; a distance between cables takes longer."""
CANDIDATE_STIFFNESS = 500
"""Of each candidate, where stiffness is an objective."""
GUESS = 16
"""That tell which grade serves most, where each takes long."""
MOTION = 64
"""That show whether a motion of the platform is free in all poses."""
EQUILIBRIUM = 512
"""In each direction of a load, where straight cables may not be in equilibrium."""
EQUILIBRIUM_REDUNDANT = 32
"""The same with cables to spare, where each is a programme."""
HANGING = 20_000
"""With poses in which a cable hangs below the platform left out, where the study includes them, and
the reverse."""
SLOW_COVERAGE, SLOW_HANGING = 1000, 2000
"""Places that show what share sizes serve, and for the above, of robots that are slow to solve."""


def slow_positions(workspace: Workspace, places: int) -> int:
    """Return how many positions have about so many places in all orientations, 100 at least."""
    return max(places // workspace.orientations.count, 100)
