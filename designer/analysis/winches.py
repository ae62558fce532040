"""What the drums of the winches take up of the ropes that are chosen."""

from __future__ import annotations

from typing import TYPE_CHECKING

from designer.selection.spooling import Spooled, spooled_on

if TYPE_CHECKING:
    from designer.analysis.analyse import Analysis


def spooled_of(analysis: Analysis) -> tuple[Spooled, ...]:
    """Return what becomes of each rope on its drum; nothing without ropes, or without a drum."""
    drum, assignment = analysis.built.robot.winches.drum, analysis.assignment
    if drum is None or not assignment.is_found:
        return ()
    lengths = assignment.verification.longest_m, assignment.verification.shortest_m
    return spooled_on(drum, *lengths, [rope.size.diameter_m for rope in assignment.by_cable])
