"""What the sensors would show in the measured poses, with given effects in the model."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from designer.arrays import FloatArray
from designer.effects.effect import Readings, Setting, as_built
from designer.machine import Machine
from designer.measured_data import Measured
from designer.robot import Poses
from designer.statics.inverse import solve_sagging
from designer.statics.nearest import solve_nearest

AIR_DENSITY_KG_PER_M3 = 1.225
"""Dry air at 15 °C and sea level, ISO 2533 [kg/m³]."""


class Predictor:
    """Predicts readings of one data set; remembers the last few machines it solved.

    Effects on readings leave the machine alone, so that their slopes cost no statics.

    Parameters
    ----------
    machine : Machine
        As declared.
    measured : Measured
        The data; only poses and surroundings are used.
    fixed : sequence of Setting
        Effects on readings that are declared: they act before all others.
    """

    def __init__(self, machine: Machine, measured: Measured, fixed: Sequence[Setting] = ()) -> None:
        self._machine = machine
        self._measured = measured
        self._fixed = tuple(fixed)
        self._known: dict[tuple[object, ...], Readings] = {}

    def __call__(self, settings: Sequence[Setting]) -> Readings:
        """Return what the sensors would show with these effects, applied in their order."""
        readings = self._physical([s for s in settings if s.effect.on_machine is not None])
        for setting in (*self._fixed, *settings):
            if setting.effect.on_readings is not None:
                readings = setting.effect.on_readings(readings, setting.values, self._measured)
        return readings

    def _physical(self, settings: Sequence[Setting]) -> Readings:
        key = tuple((s.effect.key, *s.values.values()) for s in settings)
        if key not in self._known:
            if len(self._known) > 64:
                self._known.clear()
            machine = as_built(self._machine, settings)
            self._known[key] = readings_of(machine, self._measured.poses, self._measured)
        return self._known[key]


def readings_of(machine: Machine, poses: Poses, measured: Measured | None = None) -> Readings:
    """Return unstrained lengths and winch-side tensions of a machine in poses (n_rows,).

    Robots with as many cables as degrees of freedom are solved exactly. For others the tensions
    nearest to balance are taken, see `designer.statics.nearest`.
    """
    force = None if measured is None else _wind_force_N(machine, measured)
    if machine.robot.is_square:
        statics = solve_sagging(machine.robot, poses, machine.cable, force)
        length, tension = statics.length_m, statics.exit_tension_N
        span = statics.geometry().horizontal_distance_m
    else:
        length, tension, span = solve_nearest(machine.robot, poses, machine.cable, force)
    return Readings(length - _straightened_m(machine, tension, span), tension)


def _wind_force_N(machine: Machine, measured: Measured) -> FloatArray | None:
    if machine.drag_area_m2 == 0.0 or measured.wind_m_per_s is None:
        return None
    wind = measured.wind_m_per_s
    speed = np.linalg.norm(wind, axis=1, keepdims=True)
    return np.asarray(0.5 * AIR_DENSITY_KG_PER_M3 * machine.drag_area_m2 * speed * wind)


def _straightened_m(machine: Machine, tension_N: FloatArray, span_m: FloatArray) -> FloatArray:
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
