"""The design report: its sections, one file each, in the order in which they are shown."""

from __future__ import annotations

from designer.analysis.analyse import Analysis
from designer.progress import SILENT, Reporter
from designer.report.blocks import Report, Section
from designer.report.control import control_of
from designer.report.design import (
    assumptions,
    carries,
    checks,
    clearance,
    groups,
    inputs,
    left_out,
    load_cases,
    pose,
    proof,
    provenance,
    selection,
    stiffness,
    uncertainty,
    verification,
    workshop,
    workspace,
)
from designer.report.design.first_page import FirstPage, first_page
from designer.report.design.source import Source, source_of

SECTIONS = (
    inputs.section,
    checks.section,
    carries.section,
    uncertainty.section,
    load_cases.section,
    workspace.section,
    selection.section,
    groups.section,
    stiffness.section,
    clearance.section,
    workshop.section,
    proof.section,
    pose.section,
    workspace.family,
    verification.section,
    left_out.section,
    assumptions.section,
    assumptions.nomenclature,
    provenance.section,
)
"""Each takes a `Source` and returns a section; None where the study gives nothing for it."""


def design_report(
    analysis: Analysis, *, draws: bool = True, reporter: Reporter = SILENT
) -> Report[FirstPage]:
    """Return the report on an analysis; with ``draws`` false, without figures."""
    return report_from(source_of(analysis, draws=draws), reporter)


def report_from(source: Source, reporter: Reporter = SILENT) -> Report[FirstPage]:
    """Return the report from what its sections are made from."""
    with reporter.task("drawing", len(SECTIONS) + 1) as advance:
        analysis, page = source.analysis, first_page(source)
        kind = f"first-page{'' if page.reasons else ' alone'}"
        sections: list[Section | None] = [Section("answer", "The answer", kind=kind)]
        for make in SECTIONS:
            advance(1)
            sections.append(make(source))
    about = "Cable design report", analysis.study, analysis.provenance
    control = control_of(analysis.study, analysis.catalogue)
    return Report.of("report", *about, page, sections, source.missing, control)
