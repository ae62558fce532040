"""Lengths and tensions of a machine in its poses, by statics alone.

Of a robot with cables to spare the internal forces of each row are taken from its own readings; see
`designer.statics.internal`.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from designer.arrays import FloatArray
from designer.diagnosis.statistics import MAD_TO_STD
from designer.effects.effect import Readings
from designer.model.cable import STANDARD_GRAVITY_M_PER_S2
from designer.model.machine import Machine
from designer.model.measured_data import Measured, Noise
from designer.model.robot import Poses
from designer.statics.internal import solve_internal
from designer.statics.inverse import solve_sagging
from designer.statics.taut import solve_taut
from designer.statics.underactuated import imbalance, solve_underactuated

AIR_DENSITY_KG_PER_M3 = 1.225
"""Dry air at 15 °C and sea level, ISO 2533 [kg/m³]."""


def readings_of(machine: Machine, poses: Poses, measured: Measured | None = None) -> Readings:
    """Return unstrained lengths and winch-side tensions of a machine in poses (n_rows,).

    Robots with as many cables as degrees of freedom are solved exactly, those with fewer as
    `designer.statics.underactuated` has it. With more, the tensions nearest to balance are taken,
    see `designer.statics.taut`.
    """
    force = None if measured is None else added_force_N(machine, measured)
    if machine.robot.is_redundant:
        length, tension, span = solve_taut(machine.robot, poses, machine.cable, force)
        return Readings(length - straightened_m(machine, tension, span), tension)
    if machine.robot.is_square:  # hangs in the way that it was tightened to, better ones or not
        statics = solve_sagging(machine.robot, poses, machine.cable, force, seeks_better=False)
    else:
        statics = solve_underactuated(machine.robot, poses, machine.cable, force)
    length, tension = statics.length_m, statics.exit_tension_N
    if machine.flexural_rigidity_N_m2:
        span = statics.geometry().horizontal_distance_m
        length = length - straightened_m(machine, tension, span)
    return Readings(length, tension)


def imbalance_of(machine: Machine, measured: Measured) -> FloatArray | None:
    """Return what is out of balance in each row, over the weight (n_rows,).

    None where there are enough cables to balance every pose; see `designer.statics.underactuated`.
    """
    if machine.robot.has_enough_cables:
        return None
    force = added_force_N(machine, measured)
    return imbalance(solve_underactuated(machine.robot, measured.poses, machine.cable, force))


def added_force_N(machine: Machine, measured: Measured) -> FloatArray | None:
    """Return wind and late load on the platform, base frame (n_rows, 3) [N]; None without."""
    forces = []
    if machine.drag_area_m2 != 0.0 and measured.wind_m_per_s is not None:
        wind = measured.wind_m_per_s
        speed = np.linalg.norm(wind, axis=1, keepdims=True)
        forces.append(0.5 * AIR_DENSITY_KG_PER_M3 * machine.drag_area_m2 * speed * wind)
    if machine.late_load_kg != 0.0 and measured.time_s is not None:
        down = -machine.robot.upright[2]
        weight_N = STANDARD_GRAVITY_M_PER_S2 * machine.late_load_kg * down
        is_late = measured.time_s >= machine.late_load_from_s
        forces.append(is_late[:, None] * weight_N)
    return np.asarray(sum(forces)) if forces else None


def straightened_m(machine: Machine, tension_N: FloatArray, span_m: FloatArray) -> FloatArray:
    r"""Return what bending stiffness takes off the lengths [m].

    A cable of chord c under tension T, w_⊥ = w X / c across it, sags with the slope
    w_⊥ (c - 2 s)/(2 T); clamped ends bring the slope to zero within δ = √(EI/T). The arc is longer
    than the chord by half the square of the slope, which two thin layers reduce by
    3 δ w_⊥² c² / (8 T²).
    """
    rigidity = machine.flexural_rigidity_N_m2
    if rigidity == 0.0:
        return np.zeros_like(tension_N)
    # Odd in the rigidity, so that its slope at zero can be taken from both sides.
    layer = np.sign(rigidity) * np.sqrt(abs(rigidity) / tension_N)
    load = machine.cable.weight_N_per_m * span_m  # w_⊥ c
    return np.asarray(load**2 * 3.0 * layer / (8.0 * tension_N**2))


_STILL = 1e-7
"""Of the noise: far below what the slopes of a fit would show."""
_ABOUT = (0.7, 2.8)
"""Residual over the distrust within which the latter stays. A new distrust, a power of two, is at
most a factor of two below the residual; √2 more on either side keep it from swinging."""


@dataclass(frozen=True, slots=True, eq=False)
class Guess:
    """What internal forces are taken with.

    Parameters
    ----------
    added : array (n_rows, 2 n_cables)
        What sensors and stiff ends add to lengths [m] and tensions [N].
    distrust : (float, float)
        By how much more than noise lengths and tensions are off. As long as the model is off,
        readings are trusted to no more than that: else cables would be let slack to make up for an
        exit point in the wrong place.
    """

    added: FloatArray
    distrust: tuple[float, float] = (1.0, 1.0)

    def after(
        self, measured: Measured, true: Readings, displayed: Readings, noise: Noise, *, judges: bool
    ) -> Guess:
        """Return the guess that an answer leads to; with ``judges``, also of the distrust."""
        added = np.nan_to_num(displayed.stacked - true.stacked)
        if not judges:
            return Guess(added, self.distrust)
        sigma = noise.of_channels(measured.length_m.shape[1])
        length, tension = np.hsplit(np.abs(measured.readings - displayed.stacked) / sigma, 2)
        distrust = (_distrust(length, self.distrust[0]), _distrust(tension, self.distrust[1]))
        return Guess(added, distrust)

    def is_near(self, previous: Guess, noise: Noise) -> bool:
        """Tell whether another guess would give the same, to a small share of the noise."""
        change = np.abs(self.added - previous.added)
        is_still = change <= _STILL * noise.of_channels(change.shape[1] // 2)
        return bool(is_still.all()) and self.distrust == previous.distrust


def _distrust(off: FloatArray, before: float) -> float:
    """Return how far readings are off in units of noise; as before where that is about right."""
    finite = off[~np.isnan(off)]
    size = MAD_TO_STD * float(np.median(finite)) if finite.size else 0.0
    if _ABOUT[0] <= size / before <= _ABOUT[1]:
        return before
    return float(2.0 ** np.floor(np.log2(max(size, 1.0))))


def balanced_readings(
    machine: Machine, measured: Measured, guess: Guess, noise: Noise
) -> tuple[Readings, Readings]:
    """Return true lengths and tensions, and those of cables with stiff ends."""
    length_m, tension_N = np.hsplit(measured.readings - guess.added, 2)
    statics = solve_internal(
        machine.robot,
        measured.poses,
        machine.cable,
        length_m,
        tension_N,
        (noise.length_m * guess.distrust[0], noise.tension_N * guess.distrust[1]),
        added_force_N(machine, measured),
    )
    length, tension = statics.length_m, statics.exit_tension_N
    span = statics.geometry().horizontal_distance_m
    straightened = length - straightened_m(machine, tension, span)
    return Readings(length, tension), Readings(straightened, tension)
