"""The machine as it is built: what measured data are compared with."""

from __future__ import annotations

from dataclasses import dataclass

from designer.cable import Cable
from designer.robot import Robot


@dataclass(frozen=True, slots=True, eq=False)
class Machine:
    """A robot with its cables, and what acts on it beside gravity.

    Parameters
    ----------
    robot : Robot
        Exit points, pulleys, platform, tilt.
    cable : Cable
        The cable that is on the machine, the same on every winch.
    drag_area_m2 : float
        Drag coefficient times area of the platform, C_d A [m²].
    flexural_rigidity_N_m2 : float
        EI of the cable, clamped at both ends along its chord [N·m²].
    """

    robot: Robot
    cable: Cable
    drag_area_m2: float = 0.0
    flexural_rigidity_N_m2: float = 0.0
