"""Least sheave over rope diameter by the class of a rope, where a study has a duty class.

The table is of the lowest class of crane; that of higher ones was not available. A rope whose
table does not tell how its strands are laid is taken for one of the rest, on the safe side.
"""

from __future__ import annotations

import re

from designer.grades.grade import Grade

SOURCE = "Japanese crane ordinance, table hor1-10-6-2-2, sheaves, lowest class"
_STRANDS = re.compile(r"(\d+)\s*[x×]\s*(\d+)(M?)", re.IGNORECASE)
_PARALLEL = re.compile(r"\b(seale|warrington|filler|ws)\b", re.IGNORECASE)
_PARALLEL_WIRES = (25, 26, 29, 31, 36, 41)
_MOST_IN_A_LAYER = 9


def least_sheave_ratio(grade: Grade) -> tuple[float, str] | None:
    """Return D/d and the class of a rope by that table; None for one that is not of steel."""
    if grade.material_class not in ("steel", "stainless steel"):
        return None
    found = _STRANDS.match(grade.construction)
    if found is None:
        return 25.0, "lay not stated"
    strands, wires = int(found[1]), int(found[2])
    is_parallel = bool(_PARALLEL.search(grade.construction)) or wires in _PARALLEL_WIRES
    is_stainless = grade.material_class == "stainless steel"
    # The first that applies.
    classes = (
        (
            strands in (6, 8) and is_parallel and not is_stainless,
            16.0,
            "6 or 8 strands in parallel lay",
        ),
        (strands in (6, 8) and is_parallel, 20.0, "stainless, parallel lay"),
        (strands in (3, 4), 20.0, "three or four strands"),
        (strands > _MOST_IN_A_LAYER, 20.0, "multi-strand"),
        (bool(found[3]) or (strands, wires) == (7, 19), 20.0, "cross lay"),
        (True, 25.0, "neither parallel nor cross lay by its table"),
    )
    return next((ratio, name) for applies, ratio, name in classes if applies)
