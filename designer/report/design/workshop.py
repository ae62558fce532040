"""What the workshop needs: lengths to order, drums and sheaves, end fittings."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from designer.analysis.analyse import Analysis
from designer.grades.grade import Grade, Size
from designer.selection.efficiency import Allowance

DEAD_TURNS = 3
"""Turns that stay on the drum; crane standards ask for two at least."""


@dataclass(frozen=True, slots=True)
class FabricatedCable:
    """One cable: what it is of, and its longest and shortest unstrained length [m]."""

    number: int
    grade: Grade
    size: Size
    longest_m: float
    shortest_m: float

    @property
    def turns(self) -> float:
        """Turns of the suggested drum from the shortest to the longest length."""
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
        turn_m = self.grade.drum_turn_m(self.size)
        dead_m = 0.0 if math.isnan(turn_m) else DEAD_TURNS * turn_m
        return math.ceil(10.0 * (self.longest_m + dead_m)) / 10.0


def fabrication(analysis: Analysis) -> Mapping[str, object] | None:
    """Lengths of each cable, and what its rope asks of drums; None without a product."""
    cables = list(_cables(analysis))
    if not cables:
        return None
    assert analysis.study.selection is not None
    ropes: dict[tuple[str, str], list[FabricatedCable]] = {}
    for cable in cables:
        ropes.setdefault((cable.grade.id, cable.size.id), []).append(cable)
    return {
        "cables": cables,
        "ropes": [*ropes.values()],
        "allowance": Allowance.of(analysis.study.selection),
        "dead_turns": DEAD_TURNS,
    }


def _cables(analysis: Analysis) -> Iterator[FabricatedCable]:
    if analysis.qualities is None or not analysis.assignment.is_found:
        return
    verification = analysis.assignment.verification
    lengths = zip(verification.longest_m.tolist(), verification.shortest_m.tolist(), strict=True)
    ropes = zip(analysis.assignment.by_cable, lengths, strict=True)
    for number, (rope, (longest_m, shortest_m)) in enumerate(ropes, start=1):
        yield FabricatedCable(number, rope.grade, rope.size, longest_m, shortest_m)
