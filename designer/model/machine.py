"""The machine as it is built: what measured data are compared with."""

from __future__ import annotations

from dataclasses import dataclass

from designer.model.cable import Cable
from designer.model.robot import Robot


@dataclass(frozen=True, slots=True)
class Surroundings:
    """What is around the machine, for effects whose law asks for it.

    A design takes those that the study declares. Where data are compared with the machine, each
    row has its own, which effects on readings are given.

    Parameters
    ----------
    temperature_C : float
        Temperature of the cables [°C].
    """

    temperature_C: float = 20.0


TEMPERATE = Surroundings()
"""20 °C, at which lengths are counted."""


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
    surroundings : Surroundings
        As the study declares them.
    late_load_kg, late_load_from_s : float
        Mass that is on the platform from a time on [kg], [s]; no design has it.
    """

    robot: Robot
    cable: Cable
    drag_area_m2: float = 0.0
    flexural_rigidity_N_m2: float = 0.0
    surroundings: Surroundings = TEMPERATE
    late_load_kg: float = 0.0
    late_load_from_s: float = 0.0
