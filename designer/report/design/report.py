"""The design report: its sections, one file each, in the order in which they are shown."""

from __future__ import annotations

from collections.abc import Callable

from designer.analysis.analyse import Analysis
from designer.report.control import control_of
from designer.report.design import (
    carries,
    checks,
    contexts,
    groups,
    load_cases,
    pose,
    selection,
    workspace,
)
from designer.report.design.contexts import Context, shared
from designer.report.design.first_page import first_page
from designer.report.design.source import Source, source_of
from designer.report.design.workshop import fabrication
from designer.report.document import Report, Section

SECTIONS: tuple[tuple[str, Callable[[Source], Context | None]], ...] = (
    ("answer", first_page),
    ("inputs", contexts.inputs),
    ("checks", checks.requirements),
    ("carries", carries.sensitivities),
    ("uncertainty", contexts.uncertainty),
    ("load-cases", load_cases.load_cases),
    ("workspace", workspace.workspace),
    ("selection", selection.selection),
    ("groups", groups.groups),
    ("stiffness", contexts.stiffness),
    ("clearance", contexts.clearance),
    ("workshop", fabrication),
    ("proof", contexts.proof),
    ("pose", pose.pose),
    ("family", workspace.family),
    ("verification", contexts.verification),
    ("left-out", contexts.left_out),
    ("assumptions", contexts.assumptions),
    ("nomenclature", contexts.nomenclature),
    ("provenance", contexts.provenance),
)
"""Each section's id, as its template is called, and what gives the template its context.

None instead of a context where the study gives nothing for the section.
"""


def section(source: Source, section_id: str) -> Section | None:
    """Return a section by its id; None where the study gives nothing for it."""
    context = dict(SECTIONS)[section_id](source)
    if context is None:
        return None
    kind = ""
    if section_id == "answer":
        kind = "first-page" if source.analysis.unmet else "first-page alone"
    return Section(section_id, kind=kind, context={**shared(source), **context})


def design_report(analysis: Analysis, *, draws: bool = True) -> Report:
    """Return the report on an analysis; with ``draws`` false, without figures."""
    return report_from(source_of(analysis, draws=draws))


def report_from(source: Source) -> Report:
    """Return the report from what its sections are made from."""
    analysis = source.analysis
    return Report.of(
        "report",
        analysis.study.name,
        "Cable design report",
        analysis.provenance.created,
        (section(source, section_id) for section_id, _ in SECTIONS),
        version=analysis.provenance.version,
        missing=source.missing,
        control=control_of(analysis.study, analysis.catalogue),
    )
