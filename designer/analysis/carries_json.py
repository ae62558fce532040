"""What carries the result, for scripts: part of ``result.json``."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import asdict
from typing import Any

import numpy as np

from designer.analysis.carries import Carries
from designer.analysis.sensitivities import Sensitivities, Sensitivity

Json = dict[str, Any]


def carries_dict(carries: Carries | None, groups: Sequence[Sensitivities]) -> Json:
    """Return sensitivities, reserves, sizes and first failures; empty where none is chosen.

    Of ``groups`` there are sensitivities alone, each with the name of its group.
    """
    if carries is None:
        rows = [*_sensitivities(groups)]
        return {"sensitivities": rows, "reserve": None, "sizes_beside": [], "first_failures": []}
    return {
        "sensitivities": [*_sensitivities([carries.sensitivities])],
        "reserve": {
            "payload_factor": math.nan if carries.payload is None else carries.payload.value,
            "region_margin_m": math.nan if carries.region is None else carries.region.value,
            "payload": carries.payload,
            "region": carries.region,
        },
        "sizes_beside": carries.sizes,
        "first_failures": carries.failures,
    }


def _sensitivities(of_ropes: Iterable[Sensitivities]) -> Iterator[Json]:
    for of_rope in of_ropes:
        rows: list[Json] = [asdict(sensitivity) for sensitivity in of_rope.each]
        for (cable, axis), slope in np.ndenumerate(of_rope.exit_points_per_m):
            name = f"exit_point_{cable + 1}_{'xyz'[axis]}"
            rows.append(asdict(Sensitivity(name, math.nan, "m", float(slope), math.nan)))
        group = of_rope.group and of_rope.group.name
        yield from (row | {"method": of_rope.method, "group": group} for row in rows)
