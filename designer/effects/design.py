"""What declared effects do to the design: the robot as built, and its cables."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from designer.cable import Cable, Material
from designer.effects.effect import Setting, as_built
from designer.machine import Machine
from designer.robot import Robot

_UNIT = Cable(1.0, 1.0, 1.0, 1.0)


@dataclass(frozen=True, slots=True, eq=False)
class AsBuilt:
    """The robot as built, and by how much its cables differ from their data sheet.

    Parameters
    ----------
    robot : Robot
        With moved exit points, pulleys, tilt, mass.
    linear_density_scale, axial_stiffness_scale : float
        Mass per length and EA over the declared ones, whatever the product.
    """

    robot: Robot
    linear_density_scale: float = 1.0
    axial_stiffness_scale: float = 1.0

    def cable(self, cable: Cable) -> Cable:
        """Return a cable as it is on this machine."""
        return replace(
            cable,
            linear_density_kg_per_m=cable.linear_density_kg_per_m * self.linear_density_scale,
            axial_stiffness_N=cable.axial_stiffness_N * self.axial_stiffness_scale,
        )

    def material(self, material: Material) -> Material:
        """Return a family of cables as it is on this machine."""
        return replace(
            material,
            density_kg_per_m3=material.density_kg_per_m3 * self.linear_density_scale,
            youngs_modulus_Pa=material.youngs_modulus_Pa * self.axial_stiffness_scale,
        )


def built_with(robot: Robot, settings: Sequence[Setting]) -> AsBuilt:
    """Return the robot and its cables with the effects that act on the machine."""
    machine = as_built(Machine(robot, _UNIT), settings)
    return AsBuilt(
        machine.robot, machine.cable.linear_density_kg_per_m, machine.cable.axial_stiffness_N
    )
