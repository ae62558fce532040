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


def carries_dict(found: Carries | None, groups: Sequence[GroupSlopes]) -> Json:
    """Return sensitivities, reserves, sizes and first failures; empty where none is chosen.

    Of ``groups`` there are sensitivities alone, each with the name of its group.
    """
    if found is None:
        of_groups = (
            _sensitivities(one.each, one.exit_points_per_m, "adjoint", one.group.name)
            for one in groups
        )
        rows = [row for rows in of_groups for row in rows]
        return {"sensitivities": rows, "reserve": None, "sizes_beside": [], "first_failures": []}
    slopes = found.sensitivities
    return {
        "sensitivities": _sensitivities(slopes.each, slopes.exit_points_per_m, slopes.method),
        "reserve": {
            "payload_factor": math.nan if found.payload is None else found.payload.value,
            "region_margin_m": math.nan if found.region is None else found.region.value,
            "payload": found.payload,
            "region": found.region,
        },
        "sizes_beside": found.sizes,
        "first_failures": found.failures,
    }


def _sensitivities(
    each: Sequence[Sensitivity],
    exit_points_per_m: FloatArray,
    method: str,
    group: str | None = None,
) -> list[Json]:
    rows: list[Json] = [asdict(one) for one in each]
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
