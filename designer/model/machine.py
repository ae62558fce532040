"""The machine as it is built: what measured data are compared with."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from designer.arrays import FloatArray
from designer.model.cable import Cable, Cables
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
    relative_mass, relative_stiffness : array (n_cables,) or None
        Mass per length and EA of each cable over those of ``cable``; None where all are alike. No
        design has them.
    rope_density_kg_per_m3 : float
        Mass of the rope on the machine over the circle of its diameter, which tells its material;
        NaN where nothing tells it [kg/m³].
    """

    robot: Robot
    cable: Cable
    drag_area_m2: float = 0.0
    flexural_rigidity_N_m2: float = 0.0
    surroundings: Surroundings = TEMPERATE
    late_load_kg: float = 0.0
    late_load_from_s: float = 0.0
    relative_mass: FloatArray | None = None
    relative_stiffness: FloatArray | None = None
    rope_density_kg_per_m3: float = math.nan

    @property
    def cables(self) -> Cable | Cables:
        """The cable that is on all winches, or what is on each where they differ.

        With what is attached along it, of which the effects know nothing.
        """
        attached = self.robot.attached
        if self.relative_mass is None and self.relative_stiffness is None:
            return self.cable.with_attached(attached)
        mass, stiffness = (
            np.ones(self.robot.n_cables) if share is None else share
            for share in (self.relative_mass, self.relative_stiffness)
        )
        return Cables(
            [
                replace(
                    self.cable.with_attached(attached).with_rope_scaled(m),
                    axial_stiffness_N=self.cable.axial_stiffness_N * s,
                )
                for m, s in zip(mass.tolist(), stiffness.tolist(), strict=True)
            ]
        )
