"""The diagnosis report: its sections, in the order in which they are shown."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from designer.analysis.provenance import Provenance
from designer.diagnosis.result import Diagnosis
from designer.report.control import control_of
from designer.report.diagnosis import contexts
from designer.report.diagnosis.contexts import Context, shared
from designer.report.document import Report, Section
from designer.report.render import write_pages
from designer.report.templates import Statement, plain_statement

SECTIONS: tuple[tuple[str, Callable[[Diagnosis], Context | None]], ...] = (
    ("answer", contexts.first_page),
    ("found", contexts.found),
    ("errors", contexts.errors),
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
