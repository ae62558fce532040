"""What load cells read beside the tension at the winch: gain, zero, place, friction."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from designer.effects.effect import (
    Effect,
    Parameter,
    Readings,
    Size,
    Values,
    per_cable,
    sized_by,
    weight_N,
)
from designer.effects.winches import direction_of
from designer.model.measurements import Measured
from designer.model.robot import Machine
from designer.physics import pulley
from designer.statics.geometry import level_geometry
from designer.units import FORCE, NUMBER

# A wrong gain, of one or of all by what they share (a unit, an amplifier), or a wrong zero.

_ZERO_SIZE = sized_by(weight_N, 0.01, bounds=(-10.0, 10.0), plausible=(-1.0, 1.0))
_GAIN = Size(0.02, bounds=(0.02, 50.0), plausible=(0.7, 1.4))


def _scale_cable(readings: Readings, values: Values, measured: Measured, *, cable: int) -> Readings:
    tension = np.array(readings.tension_N)
    tension[:, cable - 1] *= values["gain"]
    return replace(readings, tension_N=tension)


def _shift_zeros(readings: Readings, values: Values, measured: Measured) -> Readings:
    offsets = per_cable(values, "offset_{cable}_N", readings.tension_N.shape[1])
    return replace(readings, tension_N=readings.tension_N + offsets)


TENSION_GAIN = Effect(
    id="tension_gain",
    summary="the load cell of cable {cable} has a wrong gain",
    law="measured tension is gain times the force",
    source="definition",
    parameters=(Parameter("gain", NUMBER, _GAIN, neutral=1.0, above=0.0),),
    on_readings=_scale_cable,
    needs=frozenset({"tension"}),
    takes_cable=True,
)
TENSION_SCALE = replace(
    TENSION_GAIN,
    id="tension_scale",
    summary="the load cells have one wrong gain in common",
    law="measured tensions are gain times the forces",
    on_readings=lambda readings, values, measured: replace(
        readings, tension_N=readings.tension_N * values["gain"]
    ),
    takes_cable=False,
)
TENSION_BIAS = replace(
    TENSION_SCALE,
    id="tension_bias",
    summary="the load cells have a wrong zero",
    law="measured tension plus an offset for each cable",
    parameters=(Parameter("offset_{cable}_N", FORCE, _ZERO_SIZE, is_optional=True),),
    on_readings=_shift_zeros,
    between_sessions=True,
)


# Load cells at the platform, where the cable's own weight is not in the tension.

_PLATFORM_SHARE = Size(0.1, bounds=(-20.0, 20.0), plausible=(0.7, 1.3))


def _read_at_platform(
    readings: Readings, values: Values, measured: Measured, *, machine: Machine
) -> Readings:
    """Return tensions less the weight below the winch.

    Along a hanging cable T dT = V dV, so that w times the drop from where it leaves its pulley is
    the change of T + T²/(2 EA).
    """
    level = level_geometry(machine.robot, measured.poses)
    stiffness_N, radius_m = machine.cables.axial_stiffness_N, machine.robot.pulley_radius_m
    slope = pulley.straight_slope_rad(level.horizontal_distance_m, level.drop_m, radius_m)
    drop_m = level.drop_m + radius_m * np.cos(slope)
    winch_N = readings.tension_N
    stretched = winch_N + winch_N**2 / (2.0 * stiffness_N) - machine.cables.weight_N_per_m * drop_m
    inside = np.maximum(1.0 + 2.0 * stretched / stiffness_N, 0.0)
    platform_N = stiffness_N * (np.sqrt(inside) - 1.0)
    return replace(readings, tension_N=winch_N + values["share"] * (platform_N - winch_N))


CELL_AT_PLATFORM = Effect(
    id="cell_at_platform",
    summary="the load cells are at the platform",
    law="measured tension is on the way from that at the winch (share 0) to that at the platform "
    "(share 1)",
    source="elastic catenary: Irvine, Cable Structures, 1981",
    parameters=(Parameter("share", NUMBER, _PLATFORM_SHARE),),
    on_readings=_read_at_platform,
    cause="setting_up",
    needs=frozenset({"tension"}),
    takes_machine=True,
)


# Friction between winch and platform.

_FRICTION = Size(5e-3, bounds=(0.0, 1.0), plausible=(0.0, 0.3))


def _rub_pulleys(readings: Readings, values: Values, measured: Measured) -> Readings:
    # The direction is that of the predicted lengths, since measured ones may be missing.
    change = np.diff(readings.length_m, axis=0, prepend=readings.length_m[:1])
    ratio = np.exp(-values["coefficient"] * np.sign(change))
    return replace(readings, tension_N=readings.tension_N * ratio)


PULLEY_FRICTION = Effect(
    id="pulley_friction",
    summary="friction: the winch feels less while paying out and more while hauling in",
    law="winch-side tension is T exp(-μ s), s = +1 paying out, -1 hauling in",
    source="Euler-Eytelwein",
    parameters=(Parameter("coefficient", NUMBER, _FRICTION),),
    on_readings=_rub_pulleys,
    needs=frozenset({"tension"}),
    follows_rows=True,
)


# Friction that does not grow with the load: in gears, bearings or load cells.


def _read_with_hysteresis(readings: Readings, values: Values, measured: Measured) -> Readings:
    widths_N = per_cable(values, "width_{cable}_N", readings.tension_N.shape[1])
    less_N = 0.5 * widths_N * direction_of(readings.length_m)
    return replace(readings, tension_N=readings.tension_N - less_N)


_WIDTH_SIZE = sized_by(weight_N, 0.01, bounds=(-1.0, 1.0), plausible=(-0.5, 0.5))

TENSION_HYSTERESIS = Effect(
    id="tension_hysteresis",
    summary="tensions read less while paying out and more while hauling in, whatever the load",
    law="measured tension is less by half the width while paying out, and more while hauling in",
    source="Coulomb friction",
    parameters=(Parameter("width_{cable}_N", FORCE, _WIDTH_SIZE, is_optional=True),),
    on_readings=_read_with_hysteresis,
    needs=frozenset({"tension", "reversals"}),
    follows_rows=True,
)
