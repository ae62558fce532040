"""Sensitivities, reserves, sizes beside the chosen one, the way out: numbers for the template."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping

import numpy as np

from designer.analysis.analyse import Analysis
from designer.analysis.carries import Carries
from designer.analysis.sensitivities import Sensitivities
from designer.model.verdict import Verdict
from designer.report import format as fmt

_NAMES = {
    "payload": "Payload",
    "breaking_load": "Breaking load",
    "efficiency": "End fittings, bending and sheaves keep",
    "modulus": "Stiffness EA",
    "linear_mass": "Mass of the rope",
}
_OF_ALL_GROUPS = ("payload", "breaking_load", "efficiency")
STEP_M = 0.01
"""By how much places are moved: a centimetre, as a surveyor may be off by."""
_PART = 0.01
"""By which part other inputs grow: one per cent."""
_MOST_MOVES = 3
"""As many exit points as a reader compares; result.json has all."""

Change = tuple[str, float]
"""An input, and what it changes of the utilisation."""


def sensitivities(analysis: Analysis) -> Mapping[str, object] | None:
    """What carries the result; None where no rope is chosen."""
    carries, groups = analysis.carries, analysis.group_slopes
    if carries is not None:
        return _of_one_rope(carries)
    return _of_groups(groups) if groups else None


def _of_one_rope(carries: Carries) -> Mapping[str, object]:
    slopes, utilisation = carries.sensitivities, carries.governing.utilisation
    platform = carries.governing.loaded.bare[0].platform
    values = {
        "payload": fmt.kilograms(platform.mass_kg),
        "breaking_load": fmt.newtons(slopes.of("breaking_load").value),
        "efficiency": fmt.percent(slopes.of("efficiency").value),
        "modulus": fmt.newtons(slopes.of("modulus").value),
        "linear_mass": fmt.kilograms_per_metre(slopes.of("linear_mass").value),
    }
    return {
        "carries": carries,
        "platform": platform,
        "inputs": [
            (name, values[key], _PART * utilisation * slopes.of(key).elasticity)
            for key, name in _NAMES.items()
        ],
        "moves": [(name, STEP_M * slope) for name, slope in slopes_of_moves(carries)],
        "step_m": STEP_M,
        "nearest_why": "" if carries.nearest is None else _reason(carries.nearest.why),
        "failure_heads": [(one.name.replace("-", "−"), "m") for one in carries.failures],
    }


def slopes_of_moves(carries: Carries) -> list[Change]:
    """Return what moves outward, and the exit points that matter most, with their slopes [1/m]."""
    moves = [("Sides of the region outward", carries.sensitivities.of("region").derivative)]
    slopes = carries.sensitivities.exit_points_per_m
    order = np.argsort(-np.abs(np.nan_to_num(slopes)).ravel(), kind="stable")
    for at in order[:_MOST_MOVES].tolist():
        cable, axis = divmod(at, 3)
        moves.append((f"Exit point {cable + 1} along {'xyz'[axis]}", float(slopes[cable, axis])))
    return [(name, slope) for name, slope in moves if math.isfinite(slope)]


def shares_of_inputs(carries: Carries) -> list[Change]:
    """Return the elasticity of each input over that of the strength, where it is known."""
    slopes = carries.sensitivities
    utilisation = -slopes.of("efficiency").derivative * slopes.of("efficiency").value
    each = [(name, slopes.of(key).elasticity) for key, name in _NAMES.items()]
    return [(name, utilisation * value) for name, value in each if math.isfinite(value)]


def _reason(name: str) -> str:
    if name == "overloaded":
        return "its utilisation is beyond 100\u00a0%"
    verdict = next((verdict for verdict in Verdict if verdict.label == name), None)
    return name if verdict is None else verdict.clause


def _of_groups(groups: tuple[Sensitivities, ...]) -> Mapping[str, object]:
    names = [group.group.name for group in groups if group.group]
    inputs = [(key, name) for key, name in _NAMES.items() if key in _OF_ALL_GROUPS]
    inputs += [(f"modulus_{name}", f"Stiffness EA of {name}") for name in names]
    inputs += [(f"linear_mass_{name}", f"Mass of the rope of {name}") for name in names]
    return {
        "carries": None,
        "groups": groups,
        "group_heads": [(name, "") for name in names],
        "inputs": [
            (title, [_PART * group.utilisation * group.of(key).elasticity for group in groups])
            for key, title in inputs
        ],
        "moves": [
            (title, [STEP_M * slope for slope in slopes]) for title, slopes in _group_moves(groups)
        ],
        "step_m": STEP_M,
    }


def _group_moves(groups: tuple[Sensitivities, ...]) -> Iterator[tuple[str, list[float]]]:
    """Yield what moves outward, and the exit points that matter most, with the slopes [1/m]."""
    region = [group.of("region").derivative for group in groups]
    if any(region):
        yield "Sides of the region outward", region
    each = np.stack([group.exit_points_per_m for group in groups])
    largest = np.nan_to_num(np.abs(each)).max(axis=0)
    for at in np.argsort(-largest, axis=None, kind="stable")[:_MOST_MOVES].tolist():
        cable, axis = divmod(at, 3)
        yield f"Exit point {cable + 1} along {'xyz'[axis]}", each[:, cable, axis].tolist()
