"""What was found: values and laws, rivals and how to tell them apart, what was withdrawn."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from designer.diagnosis.propose import Proposal
from designer.diagnosis.result import Diagnosis, Estimate, Finding
from designer.effects.effect import Parameter
from designer.report import format as fmt
from designer.report.diagnosis import words
from designer.report.diagnosis.sureness import withdrawal
from designer.report.parts import Column, Group, Row, Statement, Table

_TO_95 = 1.96


@dataclass(frozen=True, slots=True)
class FoundSection:
    """What was found.

    Parameters
    ----------
    parameters : Table or None
        Values with their intervals and what is plausible.
    laws : Table or None
        How each effect acts, and where the law comes from.
    rivals : tuple of Statement
        Effects that cannot be told apart.
    proposals : tuple of Table
        Poses that would tell rivals apart.
    withdrawn : tuple of Statement
        Effects that fitted, but do not hold.
    """

    parameters: Table | None
    laws: Table | None
    rivals: tuple[Statement, ...]
    proposals: tuple[Table, ...]
    withdrawn: tuple[Statement, ...]


def found_section(diagnosis: Diagnosis) -> FoundSection | None:
    """Return what was found; None where nothing was, and nothing withdrawn."""
    if not diagnosis.findings and not diagnosis.withdrawn:
        return None
    return FoundSection(
        parameters=_parameters(diagnosis),
        laws=_laws(diagnosis),
        rivals=tuple(_rivals(diagnosis)),
        proposals=tuple(_proposal(item) for item in diagnosis.proposals),
        withdrawn=tuple(Statement(w.effect, withdrawal(w)) for w in diagnosis.withdrawn),
    )


def _parameters(diagnosis: Diagnosis) -> Table | None:
    if not diagnosis.findings:
        return None
    groups = tuple(
        Group(
            tuple(_parameter(p, finding) for p in finding.effect.parameters),
            words.capital(words.plain_finding(finding)),
            finding.effect.key,
        )
        for finding in diagnosis.findings
    )
    columns = (
        Column("Parameter", is_number=False),
        Column("Value"),
        Column("95 %"),
        Column("Does nothing at"),
        Column("Plausible"),
    )
    caption = "Fitted values with one standard deviation, from the joint fit of all effects."
    return Table(caption, columns, groups)


def _parameter(parameter: Parameter, finding: Finding) -> Row:
    item = finding.parameters[parameter.name]
    is_believable = parameter.plausible[0] <= item.value <= parameter.plausible[1]
    return Row(
        (
            words.label(parameter.name),
            words.estimate(item, parameter.unit),
            words.interval(item, parameter.unit, _TO_95),
            words.estimate(Estimate(parameter.neutral, float("nan")), parameter.unit),
            words.plausible(parameter),
        ),
        "" if is_believable else "bad",
        "" if is_believable else "Outside what an engineer would believe: something else may act.",
    )


def _laws(diagnosis: Diagnosis) -> Table | None:
    if not diagnosis.findings:
        return None
    unique = {f.effect.id: f.effect for f in diagnosis.findings}
    return Table.of(
        "How each effect acts.",
        tuple(Column(title, is_number=False) for title in ("Effect", "Law", "Source")),
        *(Row((e.id, words.capital(e.law), words.capital(e.source))) for e in unique.values()),
    )


def _rivals(diagnosis: Diagnosis) -> Iterator[Statement]:
    for finding in diagnosis.findings:
        if finding.rivals:
            yield Statement(
                finding.effect.key,
                f"These data are explained as well with {fmt.listing(finding.rivals, 'or')} in its "
                "place. Only one of them need be true.",
                "doubt",
            )


def _proposal(proposal: Proposal) -> Table:
    pairs = zip(proposal.positions_m, proposal.separation, strict=True)
    rows = (
        Row((str(k), fmt.position(position), fmt.number(float(gap), 3)))
        for k, (position, gap) in enumerate(pairs, start=1)
    )
    return Table.of(
        f"Where to measure to tell {proposal.found} from {proposal.rival}: both are fitted to "
        "these data, and differ there by this much over all readings of one pose.",
        (Column("Pose"), Column("Position"), Column("Apart by", "times the noise")),
        *rows,
    )
