"""The reports on measured data: the diagnosis, and the check of a declared model."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path

from designer.analysis.provenance import Provenance
from designer.diagnosis import contexts
from designer.diagnosis.check import Check
from designer.diagnosis.contexts import Context, shared
from designer.diagnosis.result import Diagnosis
from designer.diagnosis.words import kinds
from designer.report import format as fmt
from designer.report.document import MOST_ROWS, Report, Section, control_of
from designer.report.render import write_pages
from designer.report.templates import Statement, plain_statement

SECTIONS: tuple[tuple[str, Callable[[Diagnosis], Context | None]], ...] = (
    ("answer", contexts.first_page),
    ("found", contexts.found),
    ("errors", contexts.errors),
    ("calibration", contexts.calibration),
    ("residual", contexts.residual),
    ("unexplained", contexts.unexplained),
    ("search", contexts.search),
    ("design", contexts.design),
    ("data", contexts.data),
    ("assumptions", contexts.assumptions),
)
"""Each section's id, as its template is called, and what gives the template its context."""


def diagnosis_report(diagnosis: Diagnosis, provenance: Provenance) -> Report:
    """Return the report on a diagnosis."""
    kinds = {"answer": "first-page", "assumptions": "keep"}
    common = {**shared(diagnosis), "provenance": provenance}
    given = [(key, context_of(diagnosis)) for key, context_of in SECTIONS]
    sections = (
        Section(key, kind=kinds.get(key, ""), context={**common, **context})
        for key, context in (*given, ("provenance", {}))
        if context is not None
    )
    return Report.of(
        "diagnosis",
        diagnosis.study.name,
        "Diagnosis of measured data",
        provenance.created,
        sections,
        version=provenance.version,
        control=control_of(diagnosis.study),
    )


def verdict(diagnosis: Diagnosis) -> Statement:
    """Return the answer: what was found, that there is nothing to find, or what is unexplained."""
    context = {**shared(diagnosis), **contexts.verdict(diagnosis)}
    return plain_statement("diagnosis/verdict.html.j2", context)


def write_diagnosis(diagnosis: Diagnosis, folder: Path, templates: Path | None = None) -> None:
    """Write ``diagnosis.html`` and ``diagnosis.pdf`` into an existing folder."""
    write_pages(diagnosis_report(diagnosis, Provenance.now()), folder, templates)


def check_report(check: Check, provenance: Provenance) -> Report:
    """Return the report on a check."""
    names = (
        ("answer", "left", "provenance") if check.structure.carriers else ("answer", "provenance")
    )
    context = {
        "check": check,
        "errors": list(_errors(check)),
        "kinds": kinds(check.noise),
        "provenance": provenance,
        "most_rows": MOST_ROWS,
    }
    sections = (Section(name, context=context) for name in names)
    return Report.of(
        "check",
        check.study.name,
        "Check of the declared model",
        provenance.created,
        sections,
        version=provenance.version,
    )


def write_check(check: Check, folder: Path, templates: Path | None = None) -> None:
    """Write ``check.html`` and ``check.pdf`` into an existing folder."""
    write_pages(check_report(check, Provenance.now()), folder, templates)


def _errors(check: Check) -> Iterator[tuple[str, ...]]:
    """Yield reading, model, root mean square error, its interval and median of the error."""
    length, tension = kinds(check.noise)
    for kind in (length, tension):
        for label, model in check.models:
            left = model.length_m if kind is length else model.tension_N
            if left is not None:
                rms, ends = kind.with_unit(left.rms.value), kind.interval(left.rms)
                yield kind.name, label, rms, ends, kind.with_unit(left.median)
    for label, model in check.models:
        if model.foretold is not None and model.foretold.n_solved:
            off = model.foretold.position_m
            rms, ends = length.with_unit(off.value), length.interval(off)
            yield "pose by the lengths alone", label, rms, ends, fmt.MISSING
