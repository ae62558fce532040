"""The diagnosis report: `DiagnosisContext` is the template's whole world."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from designer.analysis.analyse import Provenance
from designer.diagnosis.result import Diagnosis
from designer.report.design.context import Heading
from designer.report.diagnosis.appendix import (
    created,
    internal_forces,
    provenance_facts,
)
from designer.report.diagnosis.data import DataSection, data_section
from designer.report.diagnosis.drawings import DiagnosisPictures, draw
from designer.report.diagnosis.errors import ErrorsSection, errors_section
from designer.report.diagnosis.first_page import FirstPage, first_page
from designer.report.diagnosis.found import FoundSection, found_section
from designer.report.diagnosis.residual import ResidualSection, residual_section
from designer.report.diagnosis.search import SearchSection, search_section
from designer.report.diagnosis.unexplained import UnexplainedSection, unexplained_section
from designer.report.parts import Fact
from designer.report.render import DIAGNOSIS, write_pages


@dataclass(frozen=True, slots=True)
class DiagnosisContext:
    """Everything that the template of a diagnosis shows; every number is formatted already.

    Parameters
    ----------
    title : str
        Name of the study.
    generator : str
        This program and its version.
    created, created_iso : str
        Date and time of the diagnosis, to read and as ISO 8601.
    headings : tuple of Heading
        The sections that this report has, in order; ids are ``answer``, ``found``, ``errors``,
        ``residual``, ``unexplained``, ``search``, ``design``, ``data``, ``assumptions`` and
        ``provenance``.
    first_page : FirstPage
        What was wrong, how sure, the error before and after, and the cable.
    found : FoundSection or None
        Values, rivals, what was withdrawn.
    errors : ErrorsSection
        Errors from stage to stage.
    residual : ResidualSection
        The residual before and after.
    unexplained : UnexplainedSection or None
        What no effect explains.
    search : SearchSection
        The search, round by round.
    data : DataSection
        What was measured.
    internal_forces : str
        Where they are taken from, on a robot whose cables outnumber its degrees of freedom or fall
        short of them; else empty.
    provenance : tuple of Fact
        Where the numbers come from.
    """

    title: str
    generator: str
    created: str
    created_iso: str
    headings: tuple[Heading, ...]
    first_page: FirstPage
    found: FoundSection | None
    errors: ErrorsSection
    residual: ResidualSection
    unexplained: UnexplainedSection | None
    search: SearchSection
    data: DataSection
    internal_forces: str
    provenance: tuple[Fact, ...]

    def heading(self, section_id: str) -> Heading:
        """Return the heading of a section that this report has."""
        return next(heading for heading in self.headings if heading.id == section_id)


def build_diagnosis_context(
    diagnosis: Diagnosis, pictures: DiagnosisPictures, provenance: Provenance
) -> DiagnosisContext:
    """Return what the report shows of a diagnosis.

    Parameters
    ----------
    diagnosis : Diagnosis
        All results.
    pictures : DiagnosisPictures
        Figures drawn from them.
    provenance : Provenance
        Program, libraries, time.
    """
    return DiagnosisContext(
        title=diagnosis.study.name,
        generator=f"cdpr-designer {provenance.version}",
        created=created(provenance),
        created_iso=provenance.created.isoformat(timespec="seconds"),
        headings=_headings(diagnosis),
        first_page=first_page(diagnosis, pictures.strongest),
        found=found_section(diagnosis),
        errors=errors_section(diagnosis, pictures.errors),
        residual=residual_section(diagnosis, pictures.carriers, pictures.rows),
        unexplained=unexplained_section(diagnosis, pictures.left),
        search=search_section(diagnosis),
        data=data_section(diagnosis),
        internal_forces=internal_forces(diagnosis),
        provenance=provenance_facts(diagnosis, provenance),
    )


def write_diagnosis(diagnosis: Diagnosis, folder: Path) -> None:
    """Write ``diagnosis.html`` and ``diagnosis.pdf`` into an existing folder."""
    context = build_diagnosis_context(diagnosis, draw(diagnosis), Provenance.now())
    write_pages(context, DIAGNOSIS, folder)


def _headings(diagnosis: Diagnosis) -> tuple[Heading, ...]:
    has_found = bool(diagnosis.findings or diagnosis.withdrawn)
    present = {
        "answer": ("What was wrong", True),
        "found": ("What was found" if diagnosis.findings else "What was withdrawn", has_found),
        "errors": ("Errors before and after", True),
        "residual": ("The residual", True),
        "unexplained": ("What is unexplained", diagnosis.is_unexplained),
        "search": ("The search", True),
        "design": ("What it means for the design", True),
        "data": ("The data", True),
        "assumptions": ("Assumptions and limits", True),
        "provenance": ("Provenance", True),
    }
    shown = [(name, title) for name, (title, is_shown) in present.items() if is_shown]
    return tuple(Heading(name, k, title) for k, (name, title) in enumerate(shown, start=1))
