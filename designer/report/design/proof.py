"""What is proved of the chosen rope: in all poses, or in which share of them."""

from __future__ import annotations

from designer.analysis.analyse import Analysis
from designer.proof.prove import Proof
from designer.report import format as fmt
from designer.report.blocks import Statement
from designer.report.phrases import rounded_down, rounded_up


def proof_statement(proof: Proof) -> Statement:
    """Return what is proved, in a sentence or two."""
    where = f" in the load case that governs, {proof.load_case}" if proof.load_case else ""
    largest = f"The largest found is {fmt.utilisation(proof.found)}."
    if proof.status == "off":
        return Statement("Found, not proved", f"{fmt.capital(proof.reason)}. {largest}")
    if proof.status == "proved":
        bound = fmt.utilisation(rounded_up(proof.bound))
        text = f"Each has an equilibrium without tensions beyond that{where}. {largest}"
        return Statement(f"Proved for all poses: at most {bound}", text, "good")
    share = fmt.percent(rounded_down(proof.fraction))
    text = (
        f"In the time given it is proved for {share} of the volume{where} that the rope holds. "
        f"{largest}"
    )
    return Statement(f"Found, not proved: {share} of the volume", text, "doubt")


def chosen_proof(analysis: Analysis) -> Proof | None:
    """Return the proof of the chosen rope; none where groups of cables have ropes of their own."""
    return None if analysis.selection is None else analysis.selection.proof
