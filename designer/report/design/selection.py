"""The choice of a rope: idealised beside real, the cost of the snap, all candidates."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from designer.analysis.analyse import Analysis
from designer.analysis.findings import Findings
from designer.grades.grade import TRUST_MEANING, Grade, Reference
from designer.report import format as fmt
from designer.report.design.candidates import (
    alternatives_table,
    best_table,
    fallen_table,
    front_sentence,
    main_dominators,
    pareto_table,
    thin_table,
)
from designer.report.design.comparison import Comparison, compare
from designer.report.parts import Column, Fact, Picture, Row, Statement, Table
from designer.report.pictures import Pictures
from designer.selection.objectives import MEANINGS
from designer.selection.result import SelectionResult
from designer.selection.usable import UsableSize


@dataclass(frozen=True, slots=True)
class UsablePart:
    """Where each size of one grade may go.

    Parameters
    ----------
    table : Table
        Share and volume of each size.
    chart : Picture or None
        The same as a curve.
    scene : Picture or None
        Where some of the sizes serve, in space.
    """

    table: Table
    chart: Picture | None
    scene: Picture | None


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
    tried : str
        What was solved and what it was compared by.
    front : str
        How many sizes no other beats, in a sentence; empty where none holds.
    pareto : Table or None
        These sizes; None where none holds.
    pareto_chart : Picture or None
        The same among all that hold.
    best : Table or None
        The best size of each grade; None where none holds.
    chart : Picture or None
        Sizes and need of each grade.
    fallen : Table
        Why the others fell out.
    dominators : str
        Who beats most of the others, and what was searched; may be empty.
    thin : Table or None
        Grades of which no size holds; None where there are none.
    usable : UsablePart or None
        What each size of the chosen grade serves; None where nothing was solved.
    notes : tuple of Statement
        Doubts about figures that the tables point to.
    alternatives : Table or None
        Grades outside the study's list that would hold; None where there are none to show.
    """

    verdict: Statement
    sources: tuple[Fact, ...]
    comparison: Comparison | None
    tried: str
    front: str
    pareto: Table | None
    pareto_chart: Picture | None
    best: Table | None
    chart: Picture | None
    fallen: Table
    dominators: str
    thin: Table | None
    usable: UsablePart | None
    notes: tuple[Statement, ...]
    alternatives: Table | None


def selection_section(
    analysis: Analysis, findings: Findings, pictures: Pictures
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
        tried=_tried(selection),
        front=front_sentence(selection),
        pareto=pareto_table(selection) if selection.front else None,
        pareto_chart=pictures.pareto,
        best=best_table(selection) if selection.front else None,
        chart=pictures.candidates,
        fallen=fallen_table(selection),
        dominators=main_dominators(selection),
        thin=thin_table(selection.outcomes),
        usable=_usable(selection, pictures),
        notes=_notes(selection),
        alternatives=alternatives_table(selection),
    )


def product_name(grade: Grade) -> str:
    """Return product and maker in one line."""
    return f"{grade.product}, maker {grade.manufacturer}"


def _statement(selection: SelectionResult) -> Statement:
    chosen = selection.chosen
    if chosen is None:
        reason = selection.reason or "no reason is known"
        return Statement("No rope was found", f"{reason[0].upper()}{reason[1:]}.", "bad")
    held = sum(outcome.outcome == "fits" for outcome in selection.outcomes)
    first = MEANINGS[selection.objectives[0]]
    most = "largest" if first.more_is_better else "least"
    text = (
        f"{chosen.size.id} of {chosen.grade.id} has the {most} {first.word} of the sizes that hold "
        f"every pose: {fmt.plural(held, 'grade')} of {len(selection.outcomes)} can serve the "
        "workspace."
    )
    return Statement("A rope was found", text, "good")


def _sources(grade: Grade) -> tuple[Fact, ...]:
    elasticity = grade.elasticity
    doubt = f"±\u00a0{fmt.trimmed(100 * elasticity.uncertainty)}\u00a0%"
    return (
        Fact("Grade", grade.id),
        Fact("Product", grade.product),
        Fact("Maker", grade.manufacturer),
        Fact("Construction", f"{grade.construction}, core {grade.core}, {grade.finish}"),
        Fact("Standard", grade.standard or "not given"),
        _reference(grade.source),
        Fact("Trust", f"{grade.trust}: {TRUST_MEANING[grade.trust]}"),
        Fact(
            "Modulus" if grade.modulus else "Stiffness",
            f"{elasticity.figure}, {doubt}",
            f"{elasticity.basis}: {elasticity.source}",
        ),
        *_limits(grade),
        *(Fact("Computed", f"{c.figure.replace('_', ' ')}: {c.how}") for c in grade.computed),
        *([Fact("Notes", " ".join(map(_sentence, grade.notes)))] if grade.notes else []),
    )


def _sentence(note: str) -> str:
    return note if note.endswith(".") else f"{note}."


def _limits(grade: Grade) -> Iterator[Fact]:
    limits = grade.limits
    if limits is not None and limits.temperature_C is not None:
        lowest, highest = limits.temperature_C
        yield Fact("Temperature", f"{lowest:g} to {highest:g} °C", limits.source)
    if limits is not None and limits.creep is not None:
        yield Fact("Creep", limits.creep, limits.source)


def _reference(source: Reference) -> Fact:
    """Return where a table was read, with a link if its address is one of the web."""
    parts = (source.publisher, source.document, source.date)
    text = ", ".join(part for part in parts if part)
    url = source.url or ""
    is_web = url.startswith(("https://", "http://"))
    return Fact("Table read from", text, note=url, link=url if is_web else "")


def _notes(selection: SelectionResult) -> tuple[Statement, ...]:
    seen = {outcome.grade.trust for outcome in selection.outcomes}
    return tuple(
        Statement(f"Trust {letter}", f"{meaning[0].upper()}{meaning[1:]}.")
        for letter, meaning in TRUST_MEANING.items()
        if letter in seen
    )


def _tried(selection: SelectionResult) -> str:
    """Return what was solved, in a sentence."""
    candidates = selection.candidates
    if not candidates:
        return "No size was solved."
    held = sum(c.verification.holds for c in candidates)
    return (
        f"{fmt.plural(len(candidates), 'size')} of {fmt.plural(len(selection.outcomes), 'grade')} "
        f"were solved in every sample, each with its own mass, stiffness and breaking load; "
        f"{fmt.count(held)} of them hold. They were compared by "
        f"{fmt.listing(MEANINGS[o].title for o in selection.objectives)}; the first decides."
    )


def _usable(selection: SelectionResult, pictures: Pictures) -> UsablePart | None:
    usable = selection.usable
    if usable is None or not usable.sizes:
        return None
    has_volume = usable.sizes[0].volume_m3 is not None
    columns = [
        Column("Size", is_number=False),
        Column("Diameter", "mm"),
        Column("Serves", "of the region" if has_volume else "of the points"),
    ]
    if has_volume:
        columns.append(Column("Volume", "m³"))
    first = usable.first_for_good
    shown = len(usable.sizes) if first is None else first + 1
    caption = (
        f"How much of the workspace each size of {usable.grade.id} serves with its own figures, "
        "by the samples."
    )
    if not usable.is_nested:
        caption += " The sizes are not nested: some serve less than a thinner one."
    if shown < len(usable.sizes):
        caption += " All thicker ones serve all of it."
    return UsablePart(
        table=Table.of(caption, tuple(columns), *map(_usable_row, usable.sizes[:shown])),
        chart=pictures.usable_chart,
        scene=pictures.usable_scene,
    )


def _usable_row(one: UsableSize) -> Row:
    cells = [one.size.id, fmt.fixed(1e3 * one.size.diameter_m, 1), _part(one.fraction)]
    if one.volume_m3 is not None:
        cells.append(fmt.number(one.volume_m3))
    note = ""
    if one.lost_fraction > 0.0:
        note = f"Does not serve {_part(one.lost_fraction)} of it that a thinner size serves."
    return Row(tuple(cells), "" if one.fraction > 0.0 else "muted", note)


def _part(fraction: float) -> str:
    """Return a share; never ``100 %`` for what is not all."""
    nearly_all = fraction < 1.0 and round(fraction, 3) == 1.0
    return f"over\u00a0{fmt.percent(0.999)}" if nearly_all else fmt.percent(fraction)
