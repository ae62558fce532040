"""Sizing by the basic loop of Riehl et al., ICRA 2010, section IV.B."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from designer.model.cable import Material
from designer.model.robot import Poses, Robot
from designer.statics.inverse import solve_massless, solve_sagging


@dataclass(frozen=True, slots=True)
class Iterate:
    """One turn of the loop: the largest tension [N] and the diameter [m] that it asks for."""

    max_tension_N: float
    diameter_m: float


@dataclass(frozen=True, slots=True)
class LoopSizing:
    """All turns of the loop, the massless start first.

    Parameters
    ----------
    iterates : tuple of Iterate
        Every turn; empty if no straight cables can hold the pose.
    has_converged : bool
        Whether the last turn changed the diameter by less than the threshold.
    has_diverged : bool
        Whether it was given up since it runs away.
    """

    iterates: tuple[Iterate, ...]
    has_converged: bool
    has_diverged: bool = False

    @property
    def outcome(self) -> str:
        """How it ended, in a few words."""
        turns = len(self.iterates) - 1
        after = f"after {turns} turn{'' if turns == 1 else 's'}"
        if self.has_diverged:
            return f"diverges, given up {after}"
        return f"{'settled' if self.has_converged else 'not settled'} {after}"

    @property
    def diameter_m(self) -> float:
        """Diameter of the last turn [m], NaN if the loop did not converge."""
        return self.iterates[-1].diameter_m if self.has_converged else float("nan")


def size_by_loop(
    robot: Robot,
    pose: Poses,
    material: Material,
    *,
    threshold_m: float = 1e-6,
    max_turns: int = 400,
) -> LoopSizing:
    """Repeat diameter → inverse statics with sag → largest tension → diameter.

    Parameters
    ----------
    robot : Robot
        The robot.
    pose : Poses
        A single pose, no leading axes.
    material : Material
        The family of cables.
    threshold_m : float
        Change of diameter that ends the loop; the paper uses 1e-6 m.
    max_turns : int
        Gives up after so many: the loop crawls near poses that no cable can hold. Where none can,
        it runs away, and is given up as soon as that is plain.
    """
    tension = float(solve_massless(robot, pose).largest_tension_N)
    if not np.isfinite(tension):
        return LoopSizing((), has_converged=False)
    iterates = [Iterate(tension, material.diameter_for_tension_m(tension))]
    for _ in range(max_turns):
        cable = material.cable(iterates[-1].diameter_m)
        tension = float(solve_sagging(robot, pose, cable).largest_tension_N)
        if not np.isfinite(tension):
            return LoopSizing(tuple(iterates), has_converged=False)
        iterates.append(Iterate(tension, material.diameter_for_tension_m(tension)))
        # Far beyond what its turns can reach where it settles, since each of them then adds less
        # than the one before.
        if tension > 1e4 * iterates[0].max_tension_N:
            return LoopSizing(tuple(iterates), has_converged=False, has_diverged=True)
        if abs(iterates[-1].diameter_m - iterates[-2].diameter_m) < threshold_m:
            return LoopSizing(tuple(iterates), has_converged=True)
    return LoopSizing(tuple(iterates), has_converged=False)
