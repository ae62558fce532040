"""What pulls the cables: winches, their drums, and the ropes that run over them.

A drum tells how much rope it takes up in layers, and how far aside the rope runs. The winches are
one for each cable and all alike but for the largest tension. The duty class M1 to M8 of the
mechanism gives the safety factor of running ropes, and a study may say how many bends they bear.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Annotated, Literal

import numpy as np

from designer import checked
from designer.arrays import BoolArray, FloatArray, frozen_array

MAX_LAYERS = 50
DEAD_TURNS = 3
"""Turns that stay on the drum; crane standards ask for two at least."""
ROPE_OVERSIZE = 0.05
"""By how much a steel wire rope may be thicker than nominal, EN 12385-4."""


@dataclass(frozen=True, slots=True)
class Drum(checked.Value):
    r"""A drum between two flanges, which a rope fills turn by turn and layer by layer.

    A turn of layer k is a helix about the rope's centre, :math:`\sqrt{(\pi D_k)^2 + p^2}` with
    :math:`D_k = D + d + 2 (k - 1) h`. The rope of a layer lies between two turns of the one below,
    which is :math:`h = \sqrt{d^2 - p^2 / 4}` lower: 0.866 d where turns touch. Layers have n and
    n - 1 turns by turns, n of them between the flanges.

    On a smooth drum d is that of the thickest rope that may be delivered, of which fewer turns, and
    fewer layers to the nearest, have room. In grooves it has as many, and longer: d is nominal.

    Parameters
    ----------
    diameter_m : float
        D, at the bottom of the grooves [m].
    length_m : float
        Between the flanges [m].
    layers : int
        Of rope at most.
    groove_pitch_m : float or None
        p, from turn to turn [m]; None for a smooth drum, on which turns touch.
    dead_turns : int
        Turns of the lowest layer that are never paid out.
    sheave_distance_m : float or None
        From the axis to the first sheave, opposite the middle of the drum [m].
    fleet_angle_max_rad : float or None
        Largest angle of the rope to the plane across the axis [rad].
    rope_oversize : float
        By how much of its nominal diameter a rope may be thicker.
    """

    diameter_m: checked.Positive
    length_m: checked.Positive
    layers: Annotated[int, checked.Number(least=1, most=MAX_LAYERS)] = 1
    groove_pitch_m: checked.Positive | None = None
    dead_turns: Annotated[int, checked.Number(least=0)] = DEAD_TURNS
    sheave_distance_m: checked.Positive | None = None
    fleet_angle_max_rad: checked.Positive | None = None
    rope_oversize: checked.NotNegative = ROPE_OVERSIZE

    def fits(self, rope_m: float) -> bool:
        """Tell whether turns of a rope lie beside each other, and layers on each other."""
        pitch_m = self.groove_pitch_m
        return pitch_m is None or rope_m <= pitch_m < 2.0 * rope_m

    def _thickest_m(self, rope_m: float) -> float:
        """Return the diameter of the rope that the drum takes up least of, of a nominal one [m]."""
        return rope_m * (1.0 + self.rope_oversize) if self.groove_pitch_m is None else rope_m

    def layers_of(self, rope_m: float) -> int:
        """Return how many layers of that are as high as those of a nominal rope [m]."""
        return max(round(self.layers * rope_m / self._thickest_m(rope_m)), 1)

    def diameters_m(self, rope_m: float) -> FloatArray:
        """Return the diameter of each layer about the rope's centre (`MAX_LAYERS`,) [m]."""
        thick_m = self._thickest_m(rope_m)
        pitch_m = self.groove_pitch_m or thick_m
        step_m = math.sqrt(max(thick_m**2 - pitch_m**2 / 4.0, 0.0))
        return np.asarray(self.diameter_m + thick_m + 2.0 * step_m * np.arange(MAX_LAYERS))

    def turn_m(self, rope_m: float) -> float:
        """Return the rope of one turn of the lowest layer [m]."""
        return float(self.taken_m(rope_m)[1][0])

    def taken_m(self, rope_m: float) -> tuple[FloatArray, FloatArray]:
        """Return turns of each layer, and the length of one (`MAX_LAYERS`,) [m].

        Beside the dead turns; none at all where the rope does not fit.
        """
        pitch_m = self.groove_pitch_m or self._thickest_m(rope_m)
        turn_m = np.hypot(math.pi * self.diameters_m(rope_m), pitch_m)
        count = math.floor(self.length_m / pitch_m * (1.0 + 1e-12)) if self.fits(rope_m) else 0
        turns = np.where(np.arange(MAX_LAYERS) % 2 == 0, float(count), count - 1.0)
        turns[0] -= self.dead_turns
        return (turns if turns[0] >= 0.0 and count > 1 else np.zeros(MAX_LAYERS)), turn_m

    def capacity_m(self, rope_m: float) -> float:
        """Return how much rope it takes up and pays out [m]."""
        turns, turn_m = self.taken_m(rope_m)
        return float((turns * turn_m)[: self.layers_of(rope_m)].sum())

    def spooled(self, rope_m: float, stroke_m: float) -> tuple[float, int]:
        """Return turns beside the dead ones, and layers, of so much rope [m]; NaN and 0 for none.

        In more layers than it may have, if need be.
        """
        turns, turn_m = self.taken_m(rope_m)
        full_m = np.cumsum(turns * turn_m)
        if stroke_m > full_m[-1] or math.isnan(stroke_m):
            return math.nan, 0
        k = int(np.searchsorted(full_m, stroke_m))
        below_m = full_m[k - 1] if k else 0.0
        return float(turns[:k].sum() + (stroke_m - below_m) / turn_m[k]), k + 1

    @property
    def fleet_angle_rad(self) -> float | None:
        """The angle at a flange; None where the sheave is not given [rad]."""
        if self.sheave_distance_m is None:
            return None
        return math.atan(0.5 * self.length_m / self.sheave_distance_m)


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
        efficiency = self.reeving_efficiency
        return np.asarray(tension_N * np.where(is_driven, efficiency, 1.0 / efficiency))

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


DutyClass = Literal["none", "M1", "M2", "M3", "M4", "M5", "M6", "M7", "M8"]
RUNNING_ROPE: Mapping[str, float] = {
    "M1": 3.15,
    "M2": 3.35,
    "M3": 3.55,
    "M4": 4.0,
    "M5": 4.5,
    "M6": 5.6,
    "M7": 7.1,
    "M8": 9.0,
}
"""Coefficient of utilisation Zp, breaking load over tension, by mechanism group."""
SOURCE = (
    "Zp of running ropes, ISO 4308-1, as printed in table 4 of the Russian federal rules for "
    "lifting appliances and by Certex; the standard itself was not available"
)


@dataclass(frozen=True, slots=True)
class RopeLife(checked.Value):
    """Constants of the bending cycles that a rope bears, and how often it runs along the path."""

    #: Of `designer.physics.bending.borne_cycles`
    b0: checked.Finite
    b1: checked.Finite
    b2: checked.Finite
    b3: checked.Finite
    wire_strength_Pa: checked.Positive  #: Nominal strength of the wires [Pa]
    source: str  #: Where the constants are from
    core_factor: checked.Positive = 1.0  #: f_C, of core and number of strands
    runs_per_day: checked.Positive | None = None  #: Runs along the path
    days_min: checked.Positive | None = None  #: Days that the rope shall last at these
