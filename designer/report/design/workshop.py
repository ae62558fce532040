"""What the workshop needs: lengths to order, drums and sheaves, end fittings."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

from designer.analysis.analyse import Analysis
from designer.grades.grade import Grade, Size
from designer.report import format as fmt
from designer.report.blocks import Column, Heads, Section, Table
from designer.report.design.source import Source
from designer.selection.efficiency import Allowance

_DEAD_TURNS = 3
"""Turns that stay on the drum; crane standards ask for two at least."""


@dataclass(frozen=True, slots=True)
class _Line:
    """One cable: what it is of, and its longest and shortest unstrained length [m]."""

    cable: int
    grade: Grade
    size: Size
    longest_m: float
    shortest_m: float

    @property
    def turns(self) -> float:
        """Turns of the suggested drum from the shortest to the longest length."""
        return (self.longest_m - self.shortest_m) / self.grade.drum_turn_m(self.size)

    @property
    def order_m(self) -> float:
        """The longest length with the dead turns, rounded up to a decimetre."""
        turn_m = self.grade.drum_turn_m(self.size)
        dead_m = 0.0 if math.isnan(turn_m) else _DEAD_TURNS * turn_m
        return math.ceil(10.0 * (self.longest_m + dead_m)) / 10.0


def section(source: Source) -> Section | None:
    """Return lengths of each cable, and what its rope asks of drums; None without a product."""
    lines = list(_lines(source.analysis))
    if not lines:
        return None
    return Section.of(
        "workshop",
        "For the workshop",
        f"To order is the longest unstrained length with {_DEAD_TURNS} dead turns on the suggested "
        "drum, where the rope's table suggests one. What lies between drum and exit point and what "
        "the end fittings take comes on top. Turns are in one layer, about the rope's centre.",
        _lengths(lines),
        _ropes(source.analysis, lines),
    )


def _lines(analysis: Analysis) -> Iterator[_Line]:
    met = analysis.assignment.verification
    lengths = zip(met.longest_m.tolist(), met.shortest_m.tolist(), strict=True)
    ropes = zip(analysis.assignment.by_cable, lengths, strict=True)
    for cable, (rope, (longest_m, shortest_m)) in enumerate(ropes, start=1):
        yield _Line(cable, rope.grade, rope.size, longest_m, shortest_m)


def _lengths(lines: list[_Line]) -> Table:
    rows = (
        (
            str(one.cable),
            one.size.id,
            fmt.fixed(one.shortest_m, 2),
            fmt.fixed(one.longest_m, 2),
            fmt.fixed(one.longest_m - one.shortest_m, 2),
            fmt.fixed(one.turns, 1),
            fmt.fixed(one.order_m, 1),
        )
        for one in lines
    )
    heads: Heads = (
        "Cable",
        "Size",
        *(Column(name, "m") for name in ("Shortest", "Longest", "Stroke")),
        Column("Drum turns"),
        Column("To order", "m"),
    )
    return Table.of("Unstrained lengths from the exit points.", heads, *rows)


def _ropes(analysis: Analysis, lines: list[_Line]) -> Table:
    assert analysis.study.selection is not None
    allowance = Allowance.of(analysis.study.selection)
    counts: dict[tuple[str, str], list[_Line]] = {}
    for one in lines:
        counts.setdefault((one.grade.id, one.size.id), []).append(one)
    rows = []
    for alike in counts.values():
        grade, size = alike[0].grade, alike[0].size
        given = grade.sheave_ratio
        ratios = (given.suggested, given.minimum) if given else (math.nan, math.nan)
        drums = (fmt.fixed(1e3 * ratio * size.diameter_m, 0) for ratio in ratios)
        rows.append(
            (
                f"{grade.id}, {size.id}",
                fmt.fixed(sum(one.order_m for one in alike), 1),
                str(2 * len(alike)),
                fmt.percent(allowance.termination_efficiency),
                fmt.newtons(size.minimum_breaking_load_N),
                *drums,
            )
        )
    return Table.of(
        "Ropes, end fittings and drums. An end fitting shall keep the stated share of the breaking "
        "load; diameters of drums and sheaves are those of the rope's table.",
        (
            "Rope",
            Column("To order", "m"),
            Column("Ends"),
            Column("Ends keep"),
            Column("Breaking load"),
            Column("Drum, suggested", "mm"),
            Column("at least", "mm"),
        ),
        *rows,
    )
