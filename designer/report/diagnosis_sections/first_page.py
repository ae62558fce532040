"""The first page: what was wrong, how sure that is, the error before and after, the cable."""

from __future__ import annotations

from dataclasses import dataclass

from designer.diagnosis.result import Diagnosis, Finding
from designer.report import format as fmt
from designer.report.diagnosis_sections import words
from designer.report.diagnosis_sections.design import DesignSection, design_section
from designer.report.diagnosis_sections.quantity import quantities
from designer.report.diagnosis_sections.sureness import sureness
from designer.report.parts import Column, Picture, Row, Statement, Table


@dataclass(frozen=True, slots=True)
class FirstPage:
    """The first page.

    Parameters
    ----------
    verdict : Statement
        The answer in one or two sentences.
    findings : tuple of Statement
        Each effect in plain words with its values.
    sureness : tuple of Statement
        How sure this is, and what speaks against it.
    errors : Table
        Error on held-out rows before and after.
    picture : Picture or None
        The residual against what it goes with most.
    design : DesignSection
        What it means for the cable.
    """

    verdict: Statement
    findings: tuple[Statement, ...]
    sureness: tuple[Statement, ...]
    errors: Table
    picture: Picture | None
    design: DesignSection


def first_page(diagnosis: Diagnosis, picture: Picture | None) -> FirstPage:
    """Return the first page."""
    return FirstPage(
        verdict=verdict(diagnosis),
        findings=tuple(_finding(finding) for finding in diagnosis.findings),
        sureness=sureness(diagnosis),
        errors=_errors(diagnosis),
        picture=picture,
        design=design_section(diagnosis),
    )


def verdict(diagnosis: Diagnosis) -> Statement:
    """Return the answer: what was found, that there is nothing to find, or what is unexplained."""
    found = [words.plain_finding(finding) for finding in diagnosis.findings]
    left = _left(diagnosis)
    if found:
        text = f"{words.capital(fmt.listing(found))}. {_drop(diagnosis)}"
        if left:
            return Statement("Found in part", f"{text} {left}", "doubt")
        doubtful = any(f.rivals or f.warnings for f in diagnosis.findings)
        return Statement("Found", text, "doubt" if doubtful else "good")
    if left:
        return Statement("Unexplained", f"{left} No known effect accounts for it.", "bad")
    return Statement(
        "Nothing to find",
        "The data agree with the model. What is left of the readings goes with nothing that was "
        f"recorded. {_drop(diagnosis)}",
        "good",
    )


def _left(diagnosis: Diagnosis) -> str:
    if not diagnosis.is_unexplained:
        return ""
    carrier = diagnosis.structure_after.carriers[0]
    return (
        f"A residual {'is left that' if diagnosis.findings else ''} goes with {carrier.name}, "
        f"which accounts for {fmt.percent(carrier.fraction_of_variance, 2)} of the variance of "
        "the readings that follow it most."
    ).replace("residual  goes", "residual goes")


def _drop(diagnosis: Diagnosis) -> str:
    parts = []
    for quantity, before, after in quantities(diagnosis):
        last = quantity.with_unit(after.heldout.value)
        first = quantity.shown(before.heldout.value)
        noise = f"{quantity.in_noise(after.heldout.value)} times the noise"
        change = f"from {first} to {last}" if diagnosis.findings else last
        verb = "falls " if diagnosis.findings else "is "
        parts.append(f"{quantity.name} error {verb}{change}, {noise}")
    if not parts:
        return ""
    return f"On rows that no fit has seen, the {fmt.listing(parts)}."


def _finding(finding: Finding) -> Statement:
    title = words.capital(words.plain_finding(finding))
    text = f"{words.capital(words.values(finding.effect, finding.parameters))}."
    if finding.rivals:
        text += f" Or, as far as these data tell: {fmt.listing(finding.rivals, 'or')}."
    return Statement(title, text, "doubt" if finding.rivals or finding.warnings else "")


def _errors(diagnosis: Diagnosis) -> Table:
    rows = []
    for quantity, before, after in quantities(diagnosis):
        rows.append(
            Row(
                (
                    f"{words.capital(quantity.name)}\u00a0[{quantity.unit}]",
                    quantity.shown(before.heldout.value),
                    f"{quantity.shown(before.heldout.low)} to {quantity.shown(before.heldout.high)}",
                    quantity.shown(after.heldout.value),
                    f"{quantity.shown(after.heldout.low)} to {quantity.shown(after.heldout.high)}",
                    quantity.shown(quantity.noise),
                    f"{quantity.in_noise(before.heldout.value)} → "
                    f"{quantity.in_noise(after.heldout.value)}",
                )
            )
        )
    columns = (
        Column("Reading", is_number=False),
        Column("Before"),
        Column("95 %"),
        Column("After"),
        Column("95 %"),
        Column("Noise"),
        Column("In units of noise"),
    )
    return Table.of(
        "Root mean square error on held-out rows, before and after, with 95 % intervals.",
        columns,
        *rows,
    )
