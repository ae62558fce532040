"""What carries the result, for scripts: part of ``result.json``."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import asdict
from typing import Any

from designer.analysis.carries import Carries
from designer.analysis.group_slopes import GroupSlopes
from designer.analysis.reserve import Reserve
from designer.analysis.sensitivities import Sensitivity
from designer.arrays import FloatArray
from designer.documents.plain import finite

Json = dict[str, Any]


def carries_dict(found: Carries | None, groups: Sequence[GroupSlopes]) -> Json:
    """Return sensitivities, reserves, sizes and first failures; empty where none is chosen.

    Of ``groups`` there are sensitivities alone, each with the name of its group.
    """
    plain: Json
    if found is None:
        of_groups = (
            _sensitivities(one.each, one.exit_points_per_m, "adjoint", one.group.name)
            for one in groups
        )
        plain = finite({"sensitivities": [row for rows in of_groups for row in rows]})
        return {**plain, "reserve": None, "sizes_beside": [], "first_failures": []}
    slopes = found.sensitivities
    plain = finite(
        {
            "sensitivities": _sensitivities(slopes.each, slopes.exit_points_per_m, slopes.method),
            "reserve": {
                "payload_factor": math.nan if found.payload is None else found.payload.value,
                "region_margin_m": math.nan if found.region is None else found.region.value,
                "payload": _reserve(found.payload),
                "region": _reserve(found.region),
            },
            "sizes_beside": [
                {
                    "grade": one.candidate.grade.id,
                    "size_id": one.candidate.size.id,
                    "load_case": one.load_case,
                    "max_tension_N": one.max_tension_N,
                    "utilisation": one.utilisation,
                    "safety_factor": one.safety_factor,
                    "total_mass_kg": one.candidate.total_mass_kg,
                }
                for one in found.sizes
            ],
            "first_failures": [
                {
                    "direction": one.direction,
                    "name": one.name,
                    "distance_m": one.distance_m,
                    "pose": one.position_m,
                    "why": one.why,
                    "looked_m": one.reach_m,
                }
                for one in found.failures
            ],
        }
    )
    return plain


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


def _reserve(one: Reserve | None) -> Json | None:
    if one is None:
        return None
    return {
        "value": one.value,
        "utilisation": one.utilisation,
        "load_case": one.load_case,
        "pose": one.place[:3],
        "held": one.is_held,
    }
