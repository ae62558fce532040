"""One load case along the path: tensions, rope speeds, power and energy of each winch."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from designer.arrays import FloatArray
from designer.model.load_case import Loaded
from designer.model.motion import Motion
from designer.model.winches import Winches
from designer.selection.criteria import rope_diameter_m
from designer.statics.inverse import Statics


@dataclass(frozen=True, eq=False)
class PathCase:
    """A load case along the path, in one direction of its loads.

    Parameters
    ----------
    loaded : Loaded
        Robot and cables under its loads.
    motion : Motion
        The instants (n_instants,).
    statics : Statics
        Their equilibria (n_instants,).
    """

    loaded: Loaded
    motion: Motion
    statics: Statics

    @property
    def name(self) -> str:
        """Of the load case."""
        return self.loaded.case.name

    @property
    def is_held(self) -> bool:
        """Whether every instant is solved: else speeds are not known."""
        return bool(self.statics.is_solved.all())

    @property
    def winches(self) -> Winches:
        """What pulls."""
        return self.statics.robot.winches

    @cached_property
    def tension_N(self) -> FloatArray:
        """At the exit points (n_instants, n_cables) [N]."""
        return self.statics.exit_tension_N

    @cached_property
    def speed_m_per_s(self) -> FloatArray:
        """Of the unstrained lengths, positive paying out (n_instants, n_cables) [m/s]."""
        return self.motion.speeds_m_per_s(self.statics.length_m)

    @cached_property
    def drum_tension_N(self) -> FloatArray:
        """At the drums, behind all sheaves (n_instants, n_cables) [N]."""
        return self.winches.drum_tension_N(self.tension_N, self.speed_m_per_s > 0.0)

    @cached_property
    def drum_speed_m_per_s(self) -> FloatArray:
        """Of the ropes at the drums, strained as they are there (n_instants, n_cables) [m/s]."""
        strain = self.drum_tension_N / self.statics.axial_stiffness_N
        return np.asarray((1.0 + strain) * self.speed_m_per_s)

    @cached_property
    def power_W(self) -> FloatArray:
        """Of each motor, negative where the load drives it (n_instants, n_cables) [W]."""
        given = -self.drum_tension_N * self.drum_speed_m_per_s
        efficiency = self.winches.efficiency
        return np.where(given > 0.0, given / efficiency, given * efficiency)

    @cached_property
    def torque_Nm(self) -> FloatArray | None:
        """Of each motor, rope in the outermost layer (n_instants, n_cables) [N·m].

        None where no drum is given.
        """
        winches = self.winches
        if winches.drum_diameter_m is None:
            return None
        rope_m, is_driven = rope_diameter_m(self.loaded.cable), self.speed_m_per_s > 0.0
        return winches.torque_Nm(self.tension_N, rope_m, is_driven)

    @cached_property
    def motor_speed_rad_per_s(self) -> FloatArray | None:
        """Of each motor, rope in the innermost layer (n_instants, n_cables) [rad/s]."""
        winches = self.winches
        if winches.drum_diameter_m is None:
            return None
        radius = 0.5 * (winches.drum_diameter_m + rope_diameter_m(self.loaded.cable))
        return np.asarray(self.drum_speed_m_per_s * winches.gear_ratio / radius)

    @cached_property
    def energy_J(self) -> tuple[FloatArray, FloatArray]:
        """What each motor draws and what comes back to it, each (n_cables,) [J]."""
        drawn, back = (np.maximum(sign * self.power_W, 0.0) for sign in (1.0, -1.0))
        time_s = self.motion.time_s
        return np.trapezoid(drawn, time_s, axis=0), np.trapezoid(back, time_s, axis=0)

    @cached_property
    def rms_torque_Nm(self) -> FloatArray | None:
        """Root mean square over the path of each motor's torque (n_cables,) [N·m]."""
        if self.torque_Nm is None:
            return None
        time_s = self.motion.time_s
        mean = np.trapezoid(self.torque_Nm**2, time_s, axis=0) / (time_s[-1] - time_s[0])
        return np.asarray(np.sqrt(mean))

    @cached_property
    def cable_share(self) -> float:
        """Largest share of the cables, as far as paid out, in the mass of all that moves."""
        cables_kg = self.loaded.moving_density_kg_per_m * self.statics.length_m
        total_kg = np.sum(cables_kg, axis=-1)
        return float(np.max(total_kg / (total_kg + self.loaded.moving_body.mass_kg)))

    def rows(self) -> Iterator[dict[str, object]]:
        """Yield what result files hold of each cable."""
        drawn, back = self.energy_J
        torque, rms, turning = self.torque_Nm, self.rms_torque_Nm, self.motor_speed_rad_per_s
        for k in range(self.statics.robot.n_cables):
            tension, drum_tension = self.tension_N[:, k], self.drum_tension_N[:, k]
            speed, power = self.drum_speed_m_per_s[:, k], self.power_W[:, k]
            yield {
                "load_case": self.name,
                "cable": k + 1,
                "tension_max_N": tension.max(),
                "tension_min_N": tension.min(),
                "drum_tension_max_N": drum_tension.max(),
                "drum_tension_min_N": drum_tension.min(),
                "length_max_m": self.statics.length_m[:, k].max(),
                "length_min_m": self.statics.length_m[:, k].min(),
                "paying_out_max_m_per_s": max(speed.max(), 0.0),
                "hauling_in_max_m_per_s": max(-speed.min(), 0.0),
                "power_max_W": power.max(),
                "power_min_W": power.min(),
                "torque_max_Nm": None if torque is None else torque[:, k].max(),
                "torque_rms_Nm": None if rms is None else rms[k],
                "motor_speed_max_rad_per_s": None if turning is None else abs(turning[:, k]).max(),
                "energy_drawn_J": drawn[k],
                "energy_returned_J": back[k],
            }
