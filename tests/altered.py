"""Analyses of which a test gives some results itself."""

from __future__ import annotations

from copy import copy
from typing import Any

from designer.analysis.analyse import Analysis


def altered(analysis: Analysis, **results: Any) -> Analysis:
    """Return an analysis with these results.

    The others stay where they are computed already, but for those that follow from these.
    """
    changed = copy(analysis)
    for stage in ("cases", "governing", "ropes", "outside", "findings"):
        vars(changed).pop(stage, None)
    vars(changed).update(results)
    return changed
