"""What `CONTRIBUTING.md` tells to do for a new thing is all that it takes."""

from __future__ import annotations

from designer.model.verdict import Verdict
from designer.report.figures.charts_shares import parts
from designer.workspace.result import Census


def test_every_verdict_has_its_part_of_the_bar() -> None:
    met = Census(len(Verdict), {verdict.label: 1 for verdict in Verdict}, 0, 0)
    found = parts(met)
    assert sum(part.count for part in found) == met.samples
    assert {part.label for part in found} >= {v.reason for v in Verdict} - {Verdict.SOLVED.reason}
    assert len({(part.colour, part.hatch) for part in found}) == len(found)


def test_every_verdict_but_solved_says_what_to_do() -> None:
    for verdict in set(Verdict) - {Verdict.SOLVED}:
        assert verdict.advice.startswith("Move the configured pose")
