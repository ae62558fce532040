"""The design report: its sections, one file each, in the order in which they are shown."""

from __future__ import annotations

from collections.abc import Callable, Iterable

from designer.analysis.analyse import Analysis
from designer.report.design import carries, contexts, pose, selection, workspace
from designer.report.design.contexts import Context, shared
from designer.report.design.drawings import Drawings
from designer.report.design.first_page import first_page
from designer.report.document import Report, Section, control_of

SECTIONS: tuple[tuple[str, Callable[[Analysis], Context | None]], ...] = (
    ("answer", first_page),
    ("inputs", contexts.inputs),
    ("checks", contexts.requirements),
    ("carries", carries.sensitivities),
    ("uncertainty", contexts.uncertainty),
    ("load-cases", contexts.load_cases),
    ("workspace", workspace.workspace),
    ("selection", selection.selection),
    ("groups", contexts.groups),
    ("stiffness", contexts.stiffness),
    ("modes", contexts.modes),
    ("clearance", contexts.clearance),
    ("workshop", contexts.fabrication),
    ("path", contexts.path),
    ("reactions", contexts.reactions),
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


def section(drawings: Drawings, section_id: str) -> Section | None:
    """Return a section by its id; None where the study gives nothing for it."""
    context = dict(SECTIONS)[section_id](drawings.analysis)
    if context is None:
        return None
    kind = ""
    if section_id == "answer":
        kind = "first-page" if drawings.analysis.unmet else "first-page alone"
    return Section(section_id, kind=kind, context={**shared(drawings), **context})


_QUICK = "Page 1 alone: no charts, no proof between the samples, no PDF. Not for the record."


def design_report(analysis: Analysis, *, draws: bool = True, quick: bool = False) -> Report:
    """Return the report on an analysis; with ``draws`` false, without figures.

    A ``quick`` one has the first page alone, and says so.
    """
    from designer.report.figures.opengl import why_no_scenes

    if quick:
        return report_from(Drawings(analysis, missing=_QUICK), ("answer",))
    return report_from(Drawings(analysis, draws, why_no_scenes() if draws else ""))


def report_from(drawings: Drawings, sections: Iterable[str] = dict(SECTIONS)) -> Report:
    """Return the report from its figures, and from what they show."""
    analysis = drawings.analysis
    return Report.of(
        "report",
        analysis.study.name,
        "Cable design report",
        analysis.provenance.created,
        (section(drawings, section_id) for section_id in sections),
        version=analysis.provenance.version,
        missing=drawings.missing,
        control=control_of(analysis.study, analysis.catalogue),
    )
