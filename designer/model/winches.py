"""The winches of a robot, one for each cable and all alike but for the largest tension."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Annotated

import numpy as np

from designer import checked
from designer.arrays import BoolArray, FloatArray, frozen_array
from designer.model.drum import Drum


@checked.reports_field
@dataclass(frozen=True, slots=True, eq=False)
class Winches(checked.Value):
    """The winches of a robot; None for what is not known, or not asked for.

    Parameters
    ----------
    tension_max_N : float, array (n_cables,) or None
        Largest tension that a winch may see, where its cable leaves toward the platform, of all or
        of each; infinite for one without a limit [N].
    positions_m : array (n_cables, 3) or None
        Where each cable comes from to its exit point: its winch, or the last sheave before that,
        world frame [m].
    drum_diameter_m : float or None
        At the bottom of the grooves [m].
    layers : int
        Of rope on the drum at most; forces on the outermost are counted.
    gear_ratio, efficiency : float
        Turns of the motor for one of the drum, and the share of its work that the drum gives to
        the rope: gear and drum, with the sheaves where ``sheave_efficiency`` is 1.
    motor_torque_Nm : float or None
        Torque that the motor may give while it holds or slowly pulls [N·m].
    speed_max_m_per_s : float or None
        Fastest that a winch hauls in or pays out [m/s].
    motor_speed_rad_per_s, motor_power_W : float or None
        Fastest that the motor turns, and the power that it may give or take [rad/s, W].
    drum : Drum or None
        What the rope is spooled on, where its length is known.
    sheave_efficiency : float
        Tension behind a sheave over that before it, in the sense in which the rope runs.
    sheaves : int
        Between exit point and drum, that at the exit point among them.
    """

    tension_max_N: Annotated[float | FloatArray, checked.Number(above=0.0, finite=False)] | None = (
        None
    )
    positions_m: checked.Points | None = None
    drum_diameter_m: checked.Positive | None = None
    layers: checked.Count = 1
    gear_ratio: checked.Positive = 1.0
    efficiency: checked.Efficiency = 1.0
    motor_torque_Nm: checked.Positive | None = None
    speed_max_m_per_s: checked.Positive | None = None
    motor_speed_rad_per_s: checked.Positive | None = None
    motor_power_W: checked.Positive | None = None
    drum: Drum | None = None
    sheave_efficiency: checked.Efficiency = 1.0
    sheaves: checked.Count = 1

    @property
    def reeving_efficiency(self) -> float:
        """Of all sheaves of a cable together, η_s to the power of their number."""
        return float(self.sheave_efficiency**self.sheaves)

    def largest_tensions_N(self, n_cables: int) -> FloatArray:
        """Return the largest tension of each winch (n_cables,), infinite where it has no limit."""
        largest_N = np.inf if self.tension_max_N is None else self.tension_max_N
        return np.broadcast_to(largest_N, n_cables)

    def drum_tension_N(
        self, tension_N: FloatArray, is_driven: BoolArray | bool = False
    ) -> FloatArray:
        """Return the tension at the drum at one at the exit point (...) [N].

        With n sheaves of efficiency η_s between them T / η_s^n where the winch pulls, or is about
        to, and T η_s^n where the rope is paid out.
        """
        kept = self.reeving_efficiency
        return np.asarray(tension_N * np.where(is_driven, kept, 1.0 / kept))

    def torque_Nm(
        self,
        tension_N: FloatArray,
        rope_diameter_m: FloatArray | float,
        is_driven: BoolArray | bool = False,
    ) -> FloatArray:
        """Return the motor's torque at a tension at the exit point (...) [N·m].

        About the centre of the rope in the outermost layer, of layers as far apart as the rope is
        thick: M = T (D + (2 k - 1) d) / (2 i η) where it pulls, η² of that where it is driven, with
        T at the drum (`drum_tension_N`).
        """
        assert self.drum_diameter_m is not None
        radius_m = 0.5 * (self.drum_diameter_m + (2 * self.layers - 1) * rope_diameter_m)
        losses = np.where(is_driven, self.efficiency, 1.0 / self.efficiency)
        drum_tension_N = self.drum_tension_N(tension_N, is_driven)
        return np.asarray(drum_tension_N * radius_m / self.gear_ratio * losses)

    def without(self, cable: int) -> Winches:
        """Return the winches without that of one cable, counted from 1."""
        positions_m, tension_max_N = self.positions_m, self.tension_max_N
        if positions_m is not None:
            positions_m = frozen_array(np.delete(positions_m, cable - 1, 0))
        if isinstance(tension_max_N, np.ndarray):
            tension_max_N = frozen_array(np.delete(tension_max_N, cable - 1))
        return replace(self, positions_m=positions_m, tension_max_N=tension_max_N)
