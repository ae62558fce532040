"""The configured pose alone: massless, the loop, the optimum, every cable, for the template."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from typing import SupportsFloat

import numpy as np

from designer.analysis.analyse import Analysis
from designer.analysis.pose import PoseAnalysis
from designer.model.verdict import Verdict
from designer.report import format as fmt
from designer.report.design.first_page import outside_pose
from designer.sizing.loop import Iterate, LoopSizing

Context = Mapping[str, object]

_MOST_ITERATIONS = 8
"""As many as stand beside a figure; of more, the first and the last."""
_LAST_ITERATIONS = 3
_FAR = 100.0
"""Tension over that of the start from where on a diverging iteration has no figures."""


def pose(analysis: Analysis) -> Context | None:
    """What is known of the configured pose; None if the study has none."""
    found = analysis.pose
    if found is None:
        return None
    statics = found.sizing.statics
    return {
        "pose": found,
        "verdict": Verdict(int(statics.verdict)),
        "pose_outside": outside_pose(analysis),
        "rotation_vector_deg": _rotation_vector_deg(found),
        "balance_residual": float(np.max(np.abs(statics.equilibrium_residual_N())))
        if statics.is_solved
        else math.nan,
        "ways": [*_ways(found)],
        "iterations": iterations(found.loop) if found.loop.iterates else None,
        "weight_effect": weight_effect(found),
        "cables": _cables(found) if statics.is_solved else None,
    }


def weight_effect(found: PoseAnalysis) -> float | None:
    """Return by what share sag changes the largest tension; None where it is not known."""
    start = float(found.massless.largest_tension_N)
    if not found.sizing.statics.is_solved or not math.isfinite(start):
        return None
    return float(found.sizing.statics.largest_tension_N) / start - 1.0


def _rotation_vector_deg(found: PoseAnalysis) -> list[float] | None:
    from scipy.spatial.transform import Rotation

    statics = found.sizing.statics
    if statics.robot.is_point_mass:
        return None
    turn = np.degrees(Rotation.from_matrix(statics.poses.rotation).as_rotvec())
    return [float(component) for component in turn]


def _ways(found: PoseAnalysis) -> Iterator[Context]:
    """Yield the diameter and the tension by each way of sizing."""
    massless, sizing, loop = found.massless, found.sizing, found.loop
    if np.isfinite(massless.largest_tension_N):
        yield _way("massless", sizing.massless_diameter_m, massless.largest_tension_N)
    if loop.iterates:
        last = loop.iterates[-1]
        ends = (math.nan, math.nan) if loop.has_diverged else (last.diameter_m, last.max_tension_N)
        yield _way("loop", *ends)
    if sizing.statics.is_solved:
        yield _way("optimum", sizing.diameter_m, sizing.statics.largest_tension_N)


def _way(name: str, diameter_m: SupportsFloat, tension_N: SupportsFloat) -> Context:
    return {"name": name, "diameter_m": float(diameter_m), "tension_N": float(tension_N)}


def iterations(loop: LoopSizing) -> Context:
    """Return the iterations of the loop; of a long one, the first and the last."""
    numbered = list(enumerate(loop.iterates))
    if len(numbered) > _MOST_ITERATIONS:
        first = numbered[: _MOST_ITERATIONS - _LAST_ITERATIONS]
        numbered = [*first, *numbered[-_LAST_ITERATIONS:]]
    typical = loop.iterates[0 if loop.has_diverged else -1]
    unit, scale = fmt.force_unit(typical.max_tension_N)
    shown: list[tuple[int, Iterate | None, bool]] = []
    for number, iterate in numbered:
        if shown and number > shown[-1][0] + 1:
            shown.append((number - 1, None, False))
        far = iterate.max_tension_N > _FAR * typical.max_tension_N
        shown.append((number, iterate, loop.has_diverged and far))
    return {
        "unit": unit,
        "scale": scale,
        "force_decimals": fmt.decimals([typical.max_tension_N / scale], 5),
        "diameter_decimals": fmt.decimals([1e3 * typical.diameter_m], 4),
        "shown": shown,
    }


def _cables(found: PoseAnalysis) -> Context:
    statics = found.sizing.statics
    largest_N = float(statics.largest_tension_N)
    unit, scale = fmt.force_unit(largest_N)
    lengths_m = zip(statics.geometry().chord_m, statics.length_m, strict=True)
    forces_N = zip(
        statics.force_x_N,
        statics.force_z_N,
        statics.platform_tension_N,
        statics.exit_tension_N,
        found.massless.tension_N,
        strict=True,
    )
    rows = [
        {
            "lengths_m": [float(length) for length in lengths],
            "forces": [float(force) / scale for force in forces],
            "is_most_loaded": max(forces[2:4]) >= largest_N * (1.0 - 1e-9),  # rounding
        }
        for lengths, forces in zip(lengths_m, forces_N, strict=True)
    ]
    return {
        "unit": unit,
        "length_decimals": fmt.decimals([float(statics.length_m.max())], 5),
        "force_decimals": fmt.decimals([largest_N / scale], 4),
        "rows": rows,
    }
