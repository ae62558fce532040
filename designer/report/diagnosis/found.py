"""What was found: values and laws, rivals and how to tell them apart, what was withdrawn."""

from __future__ import annotations

from designer.diagnosis.propose import Proposal
from designer.diagnosis.result import Diagnosis, Estimate, Finding
from designer.effects.effect import Parameter
from designer.report import format as fmt
from designer.report.blocks import (
    Block,
    Column,
    Group,
    Heads,
    Row,
    Section,
    Statement,
    Subheading,
    Table,
)
from designer.report.diagnosis import words
from designer.report.diagnosis.sureness import withdrawal

_TO_95 = 1.96


def section(diagnosis: Diagnosis) -> Section | None:
    """Return what was found; None where nothing was, and nothing withdrawn."""
    found, withdrawn = diagnosis.findings, diagnosis.withdrawn
    if not found and not withdrawn:
        return None
    tables = (_parameters(diagnosis), _laws(diagnosis)) if found else ()
    heading = Subheading("withdrawn", "Withdrawn") if found and withdrawn else None
    note = (
        "These effects fit the data better than nothing, but do not hold as what they are. They "
        "stand in for something else, and were taken back."
    )
    return Section.of(
        "found",
        "What was found" if found else "What was withdrawn",
        *tables,
        *_rivals(diagnosis),
        heading,
        note if withdrawn else None,
        *(Statement(gone.effect, withdrawal(gone)) for gone in withdrawn),
    )


def _parameters(diagnosis: Diagnosis) -> Table:
    groups = (
        Group(
            tuple(_parameter(p, finding) for p in finding.effect.parameters),
            fmt.capital(words.plain_finding(finding)),
            finding.effect.key,
        )
        for finding in diagnosis.findings
    )
    numbers = map(Column, ("Value", "95 %", "Does nothing at", "Plausible"))
    columns: Heads = ("Parameter", *numbers)
    caption = "Fitted values with one standard deviation, from the joint fit of all effects."
    return Table.grouped(caption, columns, groups, "long")


def _parameter(parameter: Parameter, finding: Finding) -> Row:
    item = finding.parameters[parameter.name]
    is_believable = parameter.plausible[0] <= item.value <= parameter.plausible[1]
    return Row(
        (
            parameter.label,
            words.estimate(item, parameter.unit),
            words.interval(item, parameter.unit, _TO_95),
            words.estimate(Estimate(parameter.neutral, float("nan")), parameter.unit),
            words.plausible(parameter),
        ),
        "" if is_believable else "bad",
        "" if is_believable else "Outside what an engineer would believe: something else may act.",
    )


def _laws(diagnosis: Diagnosis) -> Table:
    unique = {f.effect.id: f.effect for f in diagnosis.findings}
    return Table.of(
        "How each effect acts.",
        ("Effect", "Law", "Source"),
        *((e.id, fmt.capital(e.law), fmt.capital(e.source)) for e in unique.values()),
    )


def _rivals(diagnosis: Diagnosis) -> tuple[Block, ...]:
    """Return effects that cannot be told apart, and poses that would tell them."""
    statements = [
        Statement(
            finding.effect.key,
            f"These data are explained as well with {fmt.listing(finding.rivals, 'or')} in its "
            "place. Only one of them need be true.",
            "doubt",
        )
        for finding in diagnosis.findings
        if finding.rivals
    ]
    if not statements:
        return ()
    heading = Subheading("rivals", "Rivals, and how to tell them apart")
    return heading, *statements, *map(_proposal, diagnosis.proposals)


def _proposal(proposal: Proposal) -> Table:
    pairs = zip(proposal.positions_m, proposal.separation, strict=True)
    rows = (
        (str(k), fmt.position(position), fmt.number(float(gap), 3))
        for k, (position, gap) in enumerate(pairs, start=1)
    )
    return Table.of(
        f"Where to measure to tell {proposal.found} from {proposal.rival}: both are fitted to "
        "these data, and differ there by this much over all readings of one pose.",
        (Column("Pose"), Column("Position"), Column("Apart by", "times the noise")),
        *rows,
        kind="narrow",
    )
