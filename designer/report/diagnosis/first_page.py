"""The first page: what was wrong, how sure that is, the error before and after, the cable."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from designer.diagnosis.errors_of import Error
from designer.diagnosis.result import Diagnosis, DiagnosisVerdict, Finding
from designer.report import format as fmt
from designer.report.blocks import Column, Picture, Statement, Table
from designer.report.diagnosis import words
from designer.report.diagnosis.carriers import strongest
from designer.report.diagnosis.design import on_first_page
from designer.report.diagnosis.quantity import Quantity, quantities
from designer.report.diagnosis.sureness import sureness
from designer.spelling import in_runs

_ABOUT_AS_FAR = 0.9
_MOST_STATEMENTS = 7


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
    design : tuple of str
        What it means for the cable, in paragraphs.
    """

    verdict: Statement
    findings: tuple[Statement, ...]
    sureness: tuple[Statement, ...]
    errors: Table
    picture: Picture | None
    design: tuple[str, ...]

    @property
    def is_full(self) -> bool:
        """Whether the statements leave the picture no room on one sheet; it comes again later."""
        return len(self.findings) + len(self.sureness) > _MOST_STATEMENTS


def first_page(diagnosis: Diagnosis) -> FirstPage:
    """Return the first page."""
    return FirstPage(
        verdict=verdict(diagnosis),
        findings=tuple(_finding(group) for group in words.grouped(diagnosis.findings)),
        sureness=tuple(sureness(diagnosis)),
        errors=_errors(diagnosis),
        picture=strongest(diagnosis),
        design=on_first_page(diagnosis),
    )


def verdict(diagnosis: Diagnosis) -> Statement:
    """Return the answer: what was found, that there is nothing to find, or what is unexplained."""
    found = [words.plain_group(group) for group in words.grouped(diagnosis.findings)]
    against, answer = _against(diagnosis), diagnosis.verdict
    if found:
        text = f"{fmt.capital(fmt.listing(found))}. {_drop(diagnosis)}{_foretold(diagnosis)}"
        if answer is DiagnosisVerdict.IN_PART:
            return Statement("Found in part", f"{text} {against}", "doubt")
        doubtful = any(f.rivals or f.warnings for f in diagnosis.findings)
        return Statement("Found", text, "doubt" if doubtful else "good")
    if answer is DiagnosisVerdict.UNEXPLAINED:
        return Statement("Unexplained", f"{against} No known effect accounts for it.", "bad")
    if answer is DiagnosisVerdict.IMPLAUSIBLE:
        return Statement("Not plausible", f"{against} {_drop(diagnosis)}", "bad")
    if answer is DiagnosisVerdict.SCATTER:
        more = "It goes with nothing that was recorded: poses may be measured worse than declared."
        title = "Scatter larger than the sensors explain"
        return Statement(title, f"{against} {more} {_drop(diagnosis)}", "bad")
    return Statement(
        "Nothing to find",
        "The data agree with the model. What is left of the readings goes with nothing that was "
        f"recorded. {_drop(diagnosis)}",
        "doubt" if diagnosis.structure_after.lasting.share else "good",
    )


def _left(diagnosis: Diagnosis) -> str:
    structure = diagnosis.structure_after
    if not structure.is_present:
        return ""
    what = "What is left" if diagnosis.findings else "The residual"
    if structure.events:
        return f"{what} goes with {fmt.listing(e.text for e in structure.events)}."
    carrier, place = structure.present[0], diagnosis.left_in
    where = f" ({place.reading}, rows {fmt.listing(in_runs(place.rows))})" if place else ""
    return (
        f"{what} goes with {words.covariate(carrier.name)}, which accounts for "
        f"{fmt.percent(carrier.fraction_of_variance, 2)} of the variance where it shows most"
        f"{where}."
    )


def _against(diagnosis: Diagnosis) -> str:
    """Say what speaks against the model as it is now; empty where nothing does."""
    text = _left(diagnosis)
    if diagnosis.is_scattered:
        kind, times = max(diagnosis.scatter.items(), key=lambda item: item[1])
        text += (
            f" The {kind}s scatter by {fmt.number(times, 2)} times their declared noise, more than "
            "their sensors explain."
        )
    if diagnosis.doubts:
        text += (
            f" What was unknown came out where it cannot be: {fmt.listing(diagnosis.doubts)}. "
            "Check units, scales and numbers of cables in the config."
        )
    return text.strip()


def _drop(diagnosis: Diagnosis) -> str:
    """Say how far the error on held-out rows falls or rises, or what it is without findings."""
    parts: list[str] = []
    for quantity, before, after in quantities(diagnosis):
        last = quantity.with_unit(after.heldout.value)
        first = quantity.with_unit(before.heldout.value)
        verb = "falls" if after.heldout.value < before.heldout.value else "rises"
        change = f"stays {last}" if first == last else f"{verb} from {first} to {last}"
        change = change if diagnosis.findings else f"is {last}"
        noise = f"{quantity.in_noise(after.heldout.value)} times the noise"
        parts.append(f"of {quantity.name} {change} ({noise})")
    return f"On rows that no fit has seen, the error {fmt.listing(parts, 'and that')}."


def _foretold(diagnosis: Diagnosis) -> str:
    before, after = diagnosis.foretold_before, diagnosis.foretold_after
    if before is None or after is None:
        return ""
    if after.position_m.value > _ABOUT_AS_FAR * before.position_m.value:
        return ""  # nothing that concerns lengths was found
    first, last = (fmt.millimetres(one.position_m.value) for one in (before, after))
    return f" By the lengths alone the platform would be {first} off; now it is {last}."


def _finding(group: Sequence[Finding]) -> Statement:
    title = fmt.capital(words.plain_group(group))
    if len(group) == 1:
        text = f"{words.values(group[0].effect, group[0].parameters)}."
    else:
        text = "; ".join(_of_one_cable(finding) for finding in group) + "."
    rivals = dict.fromkeys(rival for finding in group for rival in finding.rivals)
    if rivals:
        text += f" Or, as far as these data tell: {fmt.listing(rivals, 'or')}."
    is_doubtful = rivals or any(finding.warnings for finding in group)
    return Statement(title, text, "doubt" if is_doubtful else "")


def _of_one_cable(finding: Finding) -> str:
    """Return the values of one cable among several: of a point that moved, by how much."""
    is_point = finding.effect.id == "anchor_offset"
    values = (
        fmt.millimetres(words.moved_m(finding))
        if is_point
        else words.values(finding.effect, finding.parameters)
    )
    return f"cable {finding.effect.cable}: {values}"


def _errors(diagnosis: Diagnosis) -> Table:
    has_change = bool(diagnosis.findings)
    stages = ("Before", "95 %", "After", "95 %") if has_change else ("Error", "95 %")
    rows = (
        tuple(_cells(quantity, (before, after) if has_change else (after,)))
        for quantity, before, after in quantities(diagnosis)
    )
    when = ", before and after," if has_change else ""
    return Table.of(
        f"Root mean square error on held-out rows{when} with 95 % intervals.",
        ("Reading", *map(Column, (*stages, "Noise", "In units of noise"))),
        *rows,
        kind="small",
    )


def _cells(quantity: Quantity, errors: Sequence[Error]) -> Iterator[str]:
    yield f"{fmt.capital(quantity.name)}\u00a0[{quantity.unit}]"
    for error in errors:
        yield quantity.shown(error.heldout.value)
        yield quantity.interval(error.heldout)
    yield quantity.shown(quantity.noise)
    yield " → ".join(quantity.in_noise(error.heldout.value) for error in errors)
