"""What is proved of the chosen rope: in all poses, or in which share of them."""

from __future__ import annotations

import math
from collections.abc import Iterator

from designer.analysis.analyse import Analysis
from designer.report import format as fmt
from designer.report.blocks import Section, Statement
from designer.report.design.source import Source
from designer.selection.proven import CaseProof


def section(source: Source) -> Section | None:
    """Return what was proved, and how; None where nothing was to be."""
    case = _case(source.analysis)
    if case is None or case.proof.status == "off":
        return None
    return Section.of(
        "proof",
        "Proof",
        proof_statement(case),
        f"The region is divided into boxes of poses, {fmt.count(case.proof.boxes)} of them. In "
        "each, all pulls and poses are enclosed by intervals that are rounded outward; where an "
        "equilibrium is then certain to exist, its "
        "tensions are bounded by their enclosure (test of Krawczyk). Boxes whose bound is not "
        "within 0.1\u00a0% of the largest utilisation found are halved. Proved is that an "
        "equilibrium without larger tensions exists in each pose, for the figures of robot and "
        "rope as they are given; not that it is stable, or the only one.",
    )


def proofs(analysis: Analysis) -> Iterator[Statement]:
    """Yield what page 1 says of it."""
    case, part = _case(analysis), analysis.servable
    if case is not None:
        yield proof_statement(case)
    if part is not None and part.impossible > 0.0:
        least, most = fmt.percent(_down(part.impossible)), fmt.percent(_up(1.0 - part.possible))
        text = (
            f"In {least} of the volume at least, and {most} at most, no cables of any section, "
            "straight or sagging, can hold the platform. Both are proved."
        )
        yield Statement("Part that no rope can serve", text, "bad")


def proof_statement(case: CaseProof) -> Statement:
    """Return what is proved, in a sentence or two."""
    found = case.proof
    where = f" in the load case that governs, {case.load_case}" if case.load_case else ""
    largest = f"The largest found is {fmt.utilisation(found.found)}."
    if found.status == "off":
        return Statement("Found, not proved", f"{fmt.capital(found.reason)}. {largest}")
    if found.status == "proved":
        bound = fmt.utilisation(_up(found.bound))
        text = f"Each has an equilibrium without tensions beyond that{where}. {largest}"
        return Statement(f"Proved for all poses: at most {bound}", text, "good")
    share = fmt.percent(_down(found.fraction))
    text = (
        f"In the time given it is proved for {share} of the volume{where} that the rope holds. "
        f"{largest}"
    )
    return Statement(f"Found, not proved: {share} of the volume", text, "doubt")


def _up(share: float) -> float:
    """Return a share rounded up as it is shown, so that what is proved is not overstated."""
    return math.ceil(1000.0 * share) / 1000.0


def _down(share: float) -> float:
    return math.floor(1000.0 * share) / 1000.0


def _case(analysis: Analysis) -> CaseProof | None:
    """Return the proof of the chosen rope; none where groups of cables have ropes of their own."""
    return None if analysis.selection is None else analysis.selection.proof
