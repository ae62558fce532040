"""The choice of a rope: idealised beside real, the cost of the snap, all candidates."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

from designer.analysis import Analysis
from designer.cable import Material
from designer.catalogue.grade import TRUST_MEANING, Grade
from designer.report import format as fmt
from designer.report.findings import Findings
from designer.report.parts import Column, Fact, Group, Picture, Row, Statement, Table
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
    comparison : Table or None
        The configured cable family beside the chosen rope; None if none was chosen.
    why_different : tuple of str
        Sentences that explain that table.
    snap : tuple of Fact
        What the step from the continuous optimum to a size costs.
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
    comparison: Table | None
    why_different: tuple[str, ...]
    snap: tuple[Fact, ...]
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
    has_choice = chosen is not None and outcome is not None
    return SelectionSection(
        verdict=_statement(selection),
        sources=_sources(chosen.grade) if chosen else (),
        comparison=_comparison(analysis, chosen, outcome) if has_choice else None,
        why_different=_why_different(analysis, outcome) if outcome else (),
        snap=_snap(chosen, outcome) if has_choice else (),
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
    return (
        Fact("Grade", grade.id),
        Fact("Product", grade.product),
        Fact("Maker", grade.manufacturer),
        Fact("Construction", f"{grade.construction}, core {grade.core}, {grade.finish}"),
        Fact("Standard", grade.standard or "not given"),
        Fact("Table read from", str(grade.source)),
        Fact("Trust", f"{grade.trust}: {TRUST_MEANING[grade.trust]}"),
        Fact(
            "Modulus",
            f"{fmt.pascals(modulus.value_Pa)} on the {area}, ± {fmt.percent(modulus.uncertainty)}",
            f"{modulus.basis}: {modulus.source}",
        ),
        *(Fact("Note", note) for note in grade.notes),
    )


def _comparison(
    analysis: Analysis, chosen: Candidate | None, outcome: GradeOutcome | None
) -> Table:
    assert chosen is not None
    assert outcome is not None
    workspace = analysis.workspace
    sagging = workspace.sagging if workspace else None
    needed_m = sagging.diameter_m if sagging else math.nan
    actual = _material_of(chosen)
    columns = (
        Column("Figure", is_number=False),
        Column("Configured cable"),
        Column(f"{chosen.grade.id}, continuous"),
        Column(f"{chosen.size.id}, as sold"),
    )
    three = (analysis.study.material, outcome.family, actual)
    diameters = (needed_m, outcome.continuous_diameter_m, chosen.size.diameter_m)
    masses = [m.cable(d).linear_density_kg_per_m for m, d in zip(three, diameters, strict=True)]
    tensions = (
        sagging.max_tension_N if sagging else math.nan,
        outcome.family.cable(outcome.continuous_diameter_m).allowable_tension_N,
        chosen.verification.max_tension_N,
    )
    rows = (
        _line("Density", (fmt.kilograms_per_cubic_metre(m.density_kg_per_m3) for m in three)),
        _line("Modulus of elasticity", (fmt.pascals(m.youngs_modulus_Pa) for m in three)),
        _line("Allowable stress", (fmt.pascals(m.allowable_stress_Pa) for m in three)),
        _line("Length that its weight could use up", (_strength(m) for m in three)),
        _line("Diameter", (fmt.millimetres(d) for d in diameters)),
        _line("Mass per length", (fmt.kilograms_per_metre(m) for m in masses)),
        _line("Largest tension", (fmt.newtons(t) for t in tensions)),
    )
    caption = (
        "The configured cable family beside the chosen rope. Density, modulus and stress refer "
        "to the full circle of the nominal diameter; the safety factor is in the stress."
    )
    return Table.of(caption, columns, *rows)


def _line(name: str, cells: Iterator[str]) -> Row:
    return Row((name, *cells))


def _strength(material: Material) -> str:
    return f"{fmt.count(round(material.strength_length_m))}\u00a0m"


def _material_of(candidate: Candidate) -> Material:
    area_m2 = candidate.size.nominal_area_m2
    return Material(
        density_kg_per_m3=candidate.size.density_kg_per_m3,
        youngs_modulus_Pa=candidate.cable.axial_stiffness_N / area_m2,
        allowable_stress_Pa=candidate.cable.allowable_tension_N / area_m2,
    )


def _why_different(analysis: Analysis, outcome: GradeOutcome) -> tuple[str, ...]:
    assert analysis.study.selection is not None
    ideal, real = analysis.study.material, outcome.family
    stress = real.allowable_stress_Pa / ideal.allowable_stress_Pa
    density = real.density_kg_per_m3 / ideal.density_kg_per_m3
    sentences = [
        "The configured family is an assumption about a cable. The chosen grade is what its "
        "table says, so the two need different diameters.",
        f"On the same circle the rope carries {fmt.factor(stress)} times the allowable stress "
        f"and weighs {fmt.factor(density)} times as much. Its strength over weight, which is "
        f"what sag feels, is {fmt.factor(stress / density)} times that of the configured family.",
        f"The rope's allowable stress is its breaking load over the nominal circle, divided by "
        f"the safety factor of {fmt.number(analysis.study.selection.safety_factor, 3)}.",
    ]
    return tuple(sentences)


def _snap(chosen: Candidate | None, outcome: GradeOutcome | None) -> tuple[Fact, ...]:
    assert chosen is not None
    assert outcome is not None
    optimum_m = outcome.continuous_diameter_m
    lightest = outcome.family.cable(optimum_m).linear_density_kg_per_m
    thicker = chosen.size.diameter_m / optimum_m - 1.0
    heavier = chosen.size.linear_density_kg_per_m / lightest - 1.0
    return (
        Fact(
            "Diameter",
            f"{fmt.millimetres(optimum_m)} → {fmt.millimetres(chosen.size.diameter_m)}",
            fmt.signed_percent(thicker),
        ),
        Fact(
            "Mass per length",
            f"{fmt.kilograms_per_metre(lightest)} → "
            f"{fmt.kilograms_per_metre(chosen.size.linear_density_kg_per_m)}",
            fmt.signed_percent(heavier),
        ),
        Fact(
            "Utilisation",
            f"{fmt.utilisation(1.0)} → {fmt.utilisation(chosen.verification.utilisation)}",
            "of the allowable tension at the worst pose",
        ),
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


def _candidates(selection: SelectionResult) -> Table:
    ordered = sorted(selection.outcomes, key=_rank)
    return Table(
        "Every grade that the study allows, lightest first, and the sizes tried. The mass of all "
        "cables counts each at the longest length that it needs.",
        _HEAD,
        tuple(_grade_group(outcome, selection.chosen) for outcome in ordered),
    )


def _rank(outcome: GradeOutcome) -> tuple[int, float]:
    if outcome.best is not None:
        return 0, outcome.best.total_mass_kg
    if outcome.outcome == "too_thin":
        return 1, outcome.continuous_diameter_m / outcome.grade.thickest.diameter_m
    return 2, 0.0


def _grade_group(outcome: GradeOutcome, chosen: Candidate | None) -> Group:
    grade = outcome.grade
    is_chosen = chosen is not None and outcome.best is chosen
    return Group(
        rows=tuple(_candidate_row(c, is_chosen and c is chosen) for c in outcome.candidates),
        title=grade.id,
        remark=f"{grade.construction} {grade.core}, trust {grade.trust}: {outcome.sentence}",
        tone="good" if is_chosen else "" if outcome.outcome == "fits" else "muted",
    )


def _candidate_row(candidate: Candidate, is_chosen: bool) -> Row:
    size, found = candidate.size, candidate.verification
    can_hold = math.isfinite(found.max_tension_N)
    cells = (
        size.id,
        fmt.fixed(1e3 * size.diameter_m, 1),
        fmt.number(size.minimum_breaking_load_N / 1e3),
        fmt.number(found.max_tension_N / 1e3) if can_hold else fmt.MISSING,
        fmt.utilisation(found.utilisation),
        fmt.number(size.linear_density_kg_per_m),
        fmt.number(candidate.total_mass_kg) if can_hold else fmt.MISSING,
        "chosen" if is_chosen else "yes" if candidate.verified else "no",
    )
    note = f"Doubtful figures: {size.doubt}" if size.doubt else ""
    return Row(cells, "good" if is_chosen else "" if candidate.verified else "muted", note)


def _notes(selection: SelectionResult) -> tuple[Statement, ...]:
    seen = {outcome.grade.trust for outcome in selection.outcomes}
    return tuple(
        Statement(f"Trust {letter}", f"{meaning}.")
        for letter, meaning in TRUST_MEANING.items()
        if letter in seen
    )


def _alternatives(selection: SelectionResult) -> Table | None:
    if not selection.alternatives:
        return None
    ordered = sorted(selection.alternatives, key=_rank)
    return Table(
        "Grades that the study does not allow, but that would hold the whole workspace.",
        _HEAD,
        tuple(_grade_group(outcome, None) for outcome in ordered),
    )
