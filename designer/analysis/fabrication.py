"""What the workshop has to know of each cable: its rope, its lengths, its drum."""

from __future__ import annotations

import math
from dataclasses import dataclass

from designer.analysis.analyse import Analysis
from designer.grades.grade import Grade, Size
from designer.model.winches import DEAD_TURNS, Drum
from designer.selection.spooling import Spooled, spooled_on


@dataclass(frozen=True, slots=True)
class FabricatedCable:
    """One cable: what it is of, and its longest and shortest unstrained length [m]."""

    number: int
    grade: Grade
    size: Size
    longest_m: float
    shortest_m: float
    drum: Drum | None  # That of the study, and the rope on it
    spooled: Spooled | None

    @property
    def turns(self) -> float:
        """Turns of the study's drum, or the suggested one, from the shortest to the longest."""
        if self.spooled is not None:
            return self.spooled.turns
        return self.stroke_m / self.grade.drum_turn_m(self.size)

    @property
    def stroke_m(self) -> float:
        """How far the cable runs."""
        return self.longest_m - self.shortest_m

    @property
    def suggested_drum_m(self) -> float:
        """Diameter of drums and sheaves that the rope's table suggests; NaN without one."""
        ratio = self.grade.sheave_ratio
        return math.nan if ratio is None else ratio.suggested * self.size.diameter_m

    @property
    def least_drum_m(self) -> float:
        """The least diameter that the rope's table allows; NaN without one."""
        ratio = self.grade.sheave_ratio
        return math.nan if ratio is None else ratio.minimum * self.size.diameter_m

    @property
    def order_m(self) -> float:
        """The longest length with the dead turns, rounded up to a decimetre."""
        turn_m, dead_turns = self.grade.drum_turn_m(self.size), DEAD_TURNS
        if self.drum is not None:
            turn_m, dead_turns = self.drum.turn_m(self.size.diameter_m), self.drum.dead_turns
        dead_m = 0.0 if math.isnan(turn_m) else dead_turns * turn_m
        return math.ceil(10.0 * (self.longest_m + dead_m)) / 10.0


def spooled_of(analysis: Analysis) -> tuple[Spooled, ...]:
    """Return what becomes of each rope on its drum; nothing without ropes, or without a drum."""
    drum, assignment = analysis.built.robot.winches.drum, analysis.assignment
    if drum is None or not assignment.is_found:
        return ()
    lengths = assignment.verification.longest_m, assignment.verification.shortest_m
    return spooled_on(drum, *lengths, [rope.size.diameter_m for rope in assignment.by_cable])


def fabricated_cables(analysis: Analysis) -> list[FabricatedCable]:
    """Return each cable of the design; none where no ropes were found or asked for."""
    if analysis.qualities is None or not analysis.assignment.is_found:
        return []
    verification = analysis.assignment.verification
    lengths = zip(verification.longest_m.tolist(), verification.shortest_m.tolist(), strict=True)
    ropes = zip(analysis.assignment.by_cable, lengths, strict=True)
    drum, on_drum = analysis.built.robot.winches.drum, spooled_of(analysis)
    return [
        FabricatedCable(
            k + 1, rope.grade, rope.size, *ends_m, drum, on_drum[k] if on_drum else None
        )
        for k, (rope, ends_m) in enumerate(ropes)
    ]
