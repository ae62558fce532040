"""Analyses of which a test gives some results itself."""

from __future__ import annotations

from copy import copy
from typing import Any

from designer.analysis.analyse import Analysis, finished


def altered(analysis: Analysis, **results: Any) -> Analysis:
    """Return an analysis with these results.

    The others stay as they are, but for those that follow from these.
    """
    changed = copy(finished(analysis))
    for stage in ("cases", "governing", "ropes", "outside", "findings"):
        vars(changed).pop(stage, None)
    vars(changed).update(results)
    return changed
