"""The design report: its sections in the order in which they are shown."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from types import FunctionType

from markupsafe import Markup

from designer.analysis.analyse import Analysis
from designer.plugins import Plugins, attempt, command_name, find_plugins, registered
from designer.report.design import sections
from designer.report.design.drawings import Drawings
from designer.report.design.first_page import first_page
from designer.report.design.sections import Context, shared
from designer.report.document import Report, Section, control_of
from designer.report.templates import filters_of

SECTIONS: tuple[tuple[str, Callable[[Analysis], Context | None]], ...] = (
    ("answer", first_page),
    ("inputs", sections.inputs),
    ("checks", sections.requirements),
    ("carries", sections.sensitivities),
    ("uncertainty", sections.uncertainty),
    ("load-cases", sections.load_cases),
    ("workspace", sections.workspace),
    ("selection", sections.selection),
    ("groups", sections.groups),
    ("stiffness", sections.stiffness),
    ("modes", sections.modes),
    ("clearance", sections.clearance),
    ("workshop", sections.fabrication),
    ("path", sections.path),
    ("reactions", sections.reactions),
    ("proof", sections.proof),
    ("pose", sections.pose),
    ("family", sections.family),
    ("verification", sections.verification),
    ("left-out", sections.left_out),
    ("assumptions", sections.assumptions),
    ("nomenclature", sections.nomenclature),
    ("provenance", sections.provenance),
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


def report_from(drawings: Drawings, section_ids: Sequence[str] = tuple(dict(SECTIONS))) -> Report:
    """Return the report from its figures, and from what they show."""
    analysis = drawings.analysis
    shown = [section(drawings, section_id) for section_id in section_ids]
    plugins = find_plugins(analysis.catalogue.with_plugins)
    filters, problems = filters_of(plugins)
    if "left-out" in section_ids:  # the first section that is about the report itself
        extra, more = plugin_sections(analysis, plugins)
        problems += more
        last = [*section_ids].index("left-out")
        shown[last:last] = extra
    return Report.of(
        "report",
        analysis.study.name,
        "Cable design report",
        analysis.provenance.created,
        shown,
        version=analysis.provenance.version,
        missing=drawings.missing,
        control=control_of(analysis.study, analysis.catalogue),
        problems=problems,
        filters=filters,
    )


def plugin_sections(analysis: Analysis, plugins: Plugins) -> tuple[list[Section], list[str]]:
    """Return the sections of plugins, and a line for each that is left out."""
    functions, problems = registered(
        plugins, "register_report_sections", FunctionType, command_name, dict(SECTIONS)
    )
    sections = []
    for section_id, (function, label) in functions.items():
        filled = partial(_plugin_section, section_id, function, analysis)
        section = attempt(filled, label, f"fails in the section {section_id}", problems)
        sections += [] if section is None else [section]
    return sections, problems


def _plugin_section(section_id: str, function: FunctionType, analysis: Analysis) -> Section | None:
    if (answer := function(analysis)) is None:
        return None
    title, body = answer
    html = body if isinstance(body, Markup) else Markup("<p>{}</p>").format(body)
    return Section(section_id, title=str(title), body=html)
