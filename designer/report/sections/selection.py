"""The choice of a rope: idealised beside real, the cost of the snap, all candidates."""

from __future__ import annotations

import math
from dataclasses import dataclass

from designer.analysis import Analysis
from designer.catalogue.grade import TRUST_MEANING, Grade, Reference
from designer.report import format as fmt
from designer.report.findings import Findings
from designer.report.parts import Column, Fact, Group, Picture, Row, Statement, Table
from designer.report.sections.comparison import Comparison, compare
from designer.selection.result import Candidate, GradeOutcome, SelectionResult


@dataclass(frozen=True, slots=True)
class SelectionSection:
    """The choice of a rope.

    Parameters
    ----------
    verdict : Statement
        What was chosen, or why nothing.
    sources : tuple of Fact
        What is known of the chosen grade, and where from; empty if none was chosen.
    comparison : Comparison or None
        The configured cable family beside the chosen rope; None if none was chosen.
    candidates : Table
        Every grade and size that was tried.
    notes : tuple of Statement
        Doubts about figures that the tables point to.
    alternatives : Table or None
        Grades outside the study's list that would hold; None where there are none to show.
    chart : Picture or None
        The candidates as a chart.
    """

    verdict: Statement
    sources: tuple[Fact, ...]
    comparison: Comparison | None
    candidates: Table
    notes: tuple[Statement, ...]
    alternatives: Table | None
    chart: Picture | None


def selection_section(
    analysis: Analysis, findings: Findings, chart: Picture | None
) -> SelectionSection | None:
    """Return the section on the choice; None if the study asks for none."""
    selection = analysis.selection
    if selection is None:
        return None
    chosen, outcome = selection.chosen, findings.chosen_outcome
    return SelectionSection(
        verdict=_statement(selection),
        sources=_sources(chosen.grade) if chosen else (),
        comparison=compare(analysis, outcome) if outcome else None,
        candidates=_candidates(selection),
        notes=_notes(selection),
        alternatives=_alternatives(selection),
        chart=chart,
    )


def product_name(grade: Grade) -> str:
    """Return maker and product in one line."""
    return f"{grade.product}, {grade.manufacturer}"


def _statement(selection: SelectionResult) -> Statement:
    chosen = selection.chosen
    if chosen is None:
        reason = selection.reason or "no reason is known"
        return Statement("No rope was found", f"{reason[0].upper()}{reason[1:]}.", "bad")
    held = sum(outcome.outcome == "fits" for outcome in selection.outcomes)
    text = (
        f"{chosen.size.id} of {chosen.grade.id} is the lightest of the sizes that hold every "
        f"pose: {fmt.plural(held, 'grade')} of {len(selection.outcomes)} can serve the workspace."
    )
    return Statement("A rope was found", text, "good")


def _sources(grade: Grade) -> tuple[Fact, ...]:
    modulus = grade.modulus
    area = {"nominal": "nominal circle", "metallic": "metallic area"}[modulus.reference_area]
    doubt = f"±\u00a0{fmt.trimmed(100 * modulus.uncertainty)}\u00a0%"
    return (
        Fact("Grade", grade.id),
        Fact("Product", grade.product),
        Fact("Maker", grade.manufacturer),
        Fact("Construction", f"{grade.construction}, core {grade.core}, {grade.finish}"),
        Fact("Standard", grade.standard or "not given"),
        _reference(grade.source),
        Fact("Trust", f"{grade.trust}: {TRUST_MEANING[grade.trust]}"),
        Fact(
            "Modulus",
            f"{fmt.pascals(modulus.value_Pa)} {doubt} on the {area}",
            f"{modulus.basis}: {modulus.source}",
        ),
        *(Fact("Note", note) for note in grade.notes),
    )


_HEAD = (
    Column("Size", is_number=False),
    Column("Diameter", "mm"),
    Column("Breaking load", "kN"),
    Column("Largest tension", "kN"),
    Column("Utilisation"),
    Column("Mass", "kg/m"),
    Column("All cables", "kg"),
    Column("Holds", is_number=False),
)


def _reference(source: Reference) -> Fact:
    """Return where a table was read, with a link if its address is one of the web."""
    parts = (source.publisher, source.document, source.date)
    text = ", ".join(part for part in parts if part)
    url = source.url or ""
    is_web = url.startswith(("https://", "http://"))
    return Fact("Table read from", text, note=url, link=url if is_web else "")


def _candidates(selection: SelectionResult) -> Table:
    caption = (
        "Every grade that the study allows, lightest first, and the sizes tried. The mass of all "
        "cables counts each at the longest length that it needs."
    )
    return _table_of(caption, selection.outcomes, selection.chosen)


@dataclass(frozen=True, slots=True)
class Decimals:
    """Digits after the point in the columns of forces [kN] and of total masses [kg]."""

    force: int
    mass: int


def _table_of(caption: str, outcomes: tuple[GradeOutcome, ...], chosen: Candidate | None) -> Table:
    tried = [candidate for outcome in outcomes for candidate in outcome.candidates]
    decimals = Decimals(
        force=fmt.decimals(c.size.minimum_breaking_load_N / 1e3 for c in tried),
        mass=fmt.decimals(c.total_mass_kg for c in tried),
    )
    ordered = sorted(outcomes, key=_rank)
    return Table(caption, _HEAD, tuple(_grade_group(o, chosen, decimals) for o in ordered))


def _rank(outcome: GradeOutcome) -> tuple[int, float]:
    if outcome.best is not None:
        return 0, outcome.best.total_mass_kg
    if outcome.outcome == "too_thin":
        return 1, outcome.continuous_diameter_m / outcome.grade.thickest.diameter_m
    return 2, 0.0


def _grade_group(outcome: GradeOutcome, chosen: Candidate | None, decimals: Decimals) -> Group:
    grade = outcome.grade
    is_chosen = chosen is not None and outcome.best is chosen
    return Group(
        rows=tuple(_row(c, decimals, is_chosen and c is chosen) for c in outcome.candidates),
        title=grade.id,
        remark=f"{grade.construction} {grade.core}, trust {grade.trust}: {outcome.sentence}",
        tone="good" if is_chosen else "" if outcome.outcome == "fits" else "muted",
    )


def _row(candidate: Candidate, decimals: Decimals, is_chosen: bool) -> Row:
    size, found = candidate.size, candidate.verification
    can_hold = math.isfinite(found.max_tension_N)
    cells = (
        size.id,
        fmt.fixed(1e3 * size.diameter_m, 1),
        fmt.fixed(size.minimum_breaking_load_N / 1e3, decimals.force),
        fmt.fixed(found.max_tension_N / 1e3, decimals.force) if can_hold else fmt.MISSING,
        fmt.utilisation(found.utilisation),
        fmt.fixed(size.linear_density_kg_per_m, 3),
        fmt.fixed(candidate.total_mass_kg, decimals.mass) if can_hold else fmt.MISSING,
        "chosen" if is_chosen else "yes" if candidate.verified else "no",
    )
    note = f"Doubtful figures: {size.doubt}" if size.doubt else ""
    return Row(cells, "good" if is_chosen else "" if candidate.verified else "muted", note)


def _notes(selection: SelectionResult) -> tuple[Statement, ...]:
    seen = {outcome.grade.trust for outcome in selection.outcomes}
    return tuple(
        Statement(f"Trust {letter}", f"{meaning[0].upper()}{meaning[1:]}.")
        for letter, meaning in TRUST_MEANING.items()
        if letter in seen
    )


def _alternatives(selection: SelectionResult) -> Table | None:
    if not selection.alternatives:
        return None
    caption = "Grades that the study does not allow, but that would hold the whole workspace."
    return _table_of(caption, selection.alternatives, None)
