"""What carries the result, for scripts: part of ``result.json``."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import asdict
from typing import Any

from designer.analysis.carries import Carries
from designer.analysis.group_slopes import GroupSlopes
from designer.analysis.sensitivities import Sensitivity
from designer.arrays import FloatArray

Json = dict[str, Any]


def carries_dict(carries: Carries | None, groups: Sequence[GroupSlopes]) -> Json:
    """Return sensitivities, reserves, sizes and first failures; empty where none is chosen.

    Of ``groups`` there are sensitivities alone, each with the name of its group.
    """
    if carries is None:
        of_groups = (
            _sensitivities(group.each, group.exit_points_per_m, "adjoint", group.group.name)
            for group in groups
        )
        rows = [row for rows in of_groups for row in rows]
        return {"sensitivities": rows, "reserve": None, "sizes_beside": [], "first_failures": []}
    slopes = carries.sensitivities
    return {
        "sensitivities": _sensitivities(slopes.each, slopes.exit_points_per_m, slopes.method),
        "reserve": {
            "payload_factor": math.nan if carries.payload is None else carries.payload.value,
            "region_margin_m": math.nan if carries.region is None else carries.region.value,
            "payload": carries.payload,
            "region": carries.region,
        },
        "sizes_beside": carries.sizes,
        "first_failures": carries.failures,
    }


def _sensitivities(
    inputs: Sequence[Sensitivity],
    exit_points_per_m: FloatArray,
    method: str,
    group: str | None = None,
) -> list[Json]:
    rows: list[Json] = [asdict(sensitivity) for sensitivity in inputs]
    for cable, slopes in enumerate(exit_points_per_m, start=1):
        rows += [
            {
                "input": f"exit_point_{cable}_{axis}",
                "value": None,
                "unit": "m",
                "derivative": slope,
                "elasticity": None,
            }
            for axis, slope in zip("xyz", slopes.tolist(), strict=True)
        ]
    return [row | {"method": method, "group": group} for row in rows]
