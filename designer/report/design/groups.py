"""Products for groups of cables: what the template of the section gets."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

from designer.report import format as fmt

if TYPE_CHECKING:
    from designer.report.design.source import Source

_MOST_PROPOSALS = 12
"""As many as a page has room for; result.json has all."""


def groups(source: Source) -> Mapping[str, object] | None:
    """What each group gets; None if the study has no groups."""
    choice = source.analysis.groups
    if choice is None:
        return None
    return {
        "choice": choice,
        "decimals_kN": fmt.decimals(p.cable.allowable_tension_N / 1e3 for p in choice.chosen.ropes),
        "most_proposals": _MOST_PROPOSALS,
    }
