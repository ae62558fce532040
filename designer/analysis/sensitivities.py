"""What the utilisation at the governing pose answers to, by the slopes of the solved state.

The governing pose is the worst of its region, so it may be held: what it gains by moving is of
second order (the envelope theorem). Only where it lies on a side of the region does it move, with
that side. On kept lengths, after the loss of a cable or a change of temperature, when the platform
rests elsewhere, slopes are differences of solved states.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from designer.arrays import FloatArray
from designer.model.load_case import Loaded
from designer.selection.cases import CaseResult
from designer.statics.geometry import load_wrench_N
from designer.statics.slopes import Slopes, utilisation_slopes

_STEP = 1e-4
_ALIKE = 1e-6


@dataclass(frozen=True, slots=True)
class Sensitivity:
    """How the utilisation answers to one input.

    Parameters
    ----------
    input : str
        Its name in result files.
    value : float
        What it is now [unit].
    unit : str
        SI; empty for a factor.
    derivative : float
        Slope of the utilisation in it [1/unit]; NaN where there is none.
    elasticity : float
        Relative change over relative change; NaN also for an input without a scale of its own.
    """

    input: str
    value: float
    unit: str
    derivative: float
    elasticity: float


@dataclass(frozen=True, slots=True, eq=False)
class Sensitivities:
    """What the utilisation answers to.

    Parameters
    ----------
    each : tuple of Sensitivity
        Payload (a factor on weight and loads of the platform, with its inertia), breaking load,
        efficiency, modulus, mass of the rope, and region (metres by which its sides move outward).
    exit_points_per_m : array (n_cables, 3)
        Slope in each exit point, base frame [1/m]; NaN where there is none.
    method : str
        ``adjoint`` or ``differences``.
    why_not : str
        Why there are no slopes, or not all, for the reader of a report; empty where there are.
    """

    each: tuple[Sensitivity, ...]
    exit_points_per_m: FloatArray
    method: str
    why_not: str = ""

    def of(self, name: str) -> Sensitivity:
        """Return one of them by its name."""
        return next(slope for slope in self.each if slope.input == name)


def sensitivities(case: CaseResult, efficiency: float, breaking_load_N: float) -> Sensitivities:
    """Return the slopes at the worst pose of a load case, of a rope with these figures."""
    if case.loaded.keeps_lengths:
        return _by_differences(case, efficiency, breaking_load_N)
    statics = case.statics
    solved = statics is not None and bool(statics.is_solved[0])
    ties: tuple[Slopes, ...] = ()
    if statics is not None and solved:
        ties = utilisation_slopes(statics, case.loaded.cable.allowable_tension_N)
    n_cables = case.loaded.robot.n_cables
    if not ties:
        unknown = dict.fromkeys(("payload", "modulus", "linear_mass", "region"), math.nan)
        why = (
            "The internal forces that are best here are at a corner at which several choices are "
            "as good, so that the utilisation has no slope."
        )
        inputs = _named(case, efficiency, breaking_load_N, unknown)
        return Sensitivities(inputs, np.full((n_cables, 3), np.nan), "adjoint", why)
    rows = [_adjoint(case, slopes) for slopes in ties]
    slopes_of = {name: _agreed([row[name] for row in rows]) for name in rows[0]}
    exits = np.stack([slopes.exit_points_per_m for slopes in ties])
    alike = np.ptp(exits, axis=0) <= _ALIKE * np.abs(exits).max()
    why = ""
    if len(ties) > 1:
        cables = " and ".join(str(slopes.cable) for slopes in ties)
        why = f"Cables {cables} are used alike: where only one of them gains, there is no slope."
    inputs = _named(case, efficiency, breaking_load_N, slopes_of)
    return Sensitivities(inputs, np.where(alike, exits[0], np.nan), "adjoint", why)


def _adjoint(case: CaseResult, slopes: Slopes) -> dict[str, float]:
    """Return slopes in the logarithms of payload, modulus and mass, and in the region [1/m]."""
    loaded = case.loaded
    heavier = load_wrench_N(with_payload(loaded, 2.0).robot, case.pose)[0]
    more = heavier - load_wrench_N(loaded.robot, case.pose)[0]
    load = _cable_load(with_density(loaded, 2.0)) - _cable_load(loaded)
    side = case.workspace.region.outward(case.pose.position_m[0])
    return {
        "payload": float(slopes.load @ more),
        "modulus": float(slopes.stiffness.sum()),
        "linear_mass": float(slopes.cable_load_m_per_N.sum(axis=0) @ load),
        "region": float(slopes.position_per_m @ side),
    }


def _by_differences(case: CaseResult, efficiency: float, breaking_load_N: float) -> Sensitivities:
    loaded, place = case.loaded, case.verification.worst_place
    side = np.zeros_like(place)
    side[:3] = case.workspace.region.outward(place[:3])

    def slope(changed: Callable[[float], Loaded]) -> float:
        ends = [case.tension_N(changed(sign * _STEP)) for sign in (1.0, -1.0)]
        return (ends[0] - ends[1]) / (2.0 * _STEP * loaded.cable.allowable_tension_N)

    def shifted(by: float) -> float:
        verification = replace(case.verification, worst_place=place + by * side)
        return (
            replace(case, verification=verification).tension_N(loaded)
            / loaded.cable.allowable_tension_N
        )

    slopes = {
        "payload": slope(lambda by: with_payload(loaded, 1.0 + by)),
        "modulus": slope(lambda by: with_stiffness(loaded, 1.0 + by)),
        "linear_mass": slope(lambda by: with_density(loaded, 1.0 + by)),
        "region": (shifted(_STEP) - shifted(-_STEP)) / (2.0 * _STEP) if side.any() else 0.0,
    }
    exits = np.full((loaded.robot.n_cables, 3), np.nan)
    for cable, axis in np.ndindex(exits.shape):
        exits[cable, axis] = slope(partial(with_exit_moved, loaded, cable, axis))
    finite = np.isfinite([*slopes.values(), *exits.ravel()]).all()
    why = "" if finite else "Near this pose the platform finds no rest on the kept lengths."
    inputs = _named(case, efficiency, breaking_load_N, slopes)
    return Sensitivities(inputs, np.where(np.isfinite(exits), exits, np.nan), "differences", why)


def _named(
    case: CaseResult, efficiency: float, breaking_load_N: float, slopes: dict[str, float]
) -> tuple[Sensitivity, ...]:
    used, cable = case.utilisation, case.loaded.bare[1]

    def relative(name: str, value: float, unit: str, slope: float) -> Sensitivity:
        return Sensitivity(name, value, unit, slope / value, slope / used)

    return (
        relative("payload", 1.0, "", slopes["payload"]),
        relative("breaking_load", breaking_load_N, "N", -used),
        relative("efficiency", efficiency, "", -used),
        relative("modulus", cable.axial_stiffness_N, "N", slopes["modulus"]),
        relative("linear_mass", cable.linear_density_kg_per_m, "kg/m", slopes["linear_mass"]),
        Sensitivity("region", 0.0, "m", slopes["region"], math.nan),
    )


def _agreed(values: list[float]) -> float:
    """Return the slope that all ties have; NaN where they differ."""
    alike = max(values) - min(values) <= _ALIKE * max(map(abs, values), default=0.0)
    return values[0] if alike else math.nan


def _cable_load(loaded: Loaded) -> FloatArray:
    """Return the load per unstrained length of a cable (3,), base frame [N/m]."""
    return np.asarray(-loaded.cable.weight_N_per_m * loaded.robot.upright[2])


def with_payload(loaded: Loaded, factor: float) -> Loaded:
    """Return the same with weight, inertia and loads of the platform so many times as large.

    Wind on the platform stays.
    """
    scaled = payload_scaled(loaded, factor)
    return scaled.on(*scaled.bare)


def payload_scaled(loaded: Loaded, factor: float) -> Loaded:
    """Return its load case with that, and what it is put on, to be put on."""
    (robot, cable), case = loaded.bare, loaded.case
    body = robot.platform
    wrench = body.wrench_N if case.wrench_N is None else case.wrench_N
    robot = replace(robot, platform=replace(body, mass_kg=factor * case.mass_on(body)))
    case = replace(case, mass_kg=None, wrench_N=factor * wrench)
    return replace(loaded, case=case, bare=(robot, cable))


def with_density(loaded: Loaded, factor: float) -> Loaded:
    """Return the same with a rope so many times as heavy."""
    robot, cable = loaded.bare
    heavier = replace(cable, linear_density_kg_per_m=factor * cable.linear_density_kg_per_m)
    return loaded.on(robot, heavier)


def with_stiffness(loaded: Loaded, factor: float) -> Loaded:
    """Return the same with a rope so many times as stiff."""
    robot, cable = loaded.bare
    stiffer = replace(cable, axial_stiffness_N=factor * cable.axial_stiffness_N)
    return loaded.on(robot, stiffer)


def with_exit_moved(loaded: Loaded, cable: int, axis: int, by_m: float) -> Loaded:
    """Return the same with one exit point moved along an axis, both from 0 [m]."""
    robot, line = loaded.bare
    exits = np.array(robot.exit_points_m)
    exits[cable, axis] += by_m
    moved = replace(robot, exit_points_m=exits)
    return loaded.on(moved, line)
