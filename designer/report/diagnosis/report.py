"""The diagnosis report: its sections, in the order in which they are shown."""

from __future__ import annotations

from pathlib import Path

from designer.analysis.provenance import Provenance
from designer.diagnosis.result import Diagnosis
from designer.report import format as fmt
from designer.report.blocks import Box, Fact, Facts, Report, Section
from designer.report.control import control_of
from designer.report.design.provenance import facts_of
from designer.report.diagnosis import (
    assumptions,
    data,
    design,
    errors,
    found,
    residual,
    search,
    unexplained,
)
from designer.report.diagnosis.first_page import FirstPage, first_page
from designer.report.render import write_pages

SECTIONS = (
    found.section,
    errors.section,
    residual.section,
    unexplained.section,
    search.section,
    design.section,
    data.section,
    assumptions.section,
)
"""Each takes a `Diagnosis` and returns a section; None where there is nothing to say in it."""


def diagnosis_report(diagnosis: Diagnosis, provenance: Provenance) -> Report[FirstPage]:
    """Return the report on a diagnosis."""
    sections = (
        Section("answer", "What was wrong", kind="first-page"),
        *(make(diagnosis) for make in SECTIONS),
        _provenance(diagnosis, provenance),
    )
    about = "Diagnosis of measured data", diagnosis.study, provenance
    control = control_of(diagnosis.study)
    return Report.of("diagnosis", *about, first_page(diagnosis), sections, control=control)


def write_diagnosis(diagnosis: Diagnosis, folder: Path, templates: Path | None = None) -> None:
    """Write ``diagnosis.html`` and ``diagnosis.pdf`` into an existing folder."""
    write_pages(diagnosis_report(diagnosis, Provenance.now()), folder, templates)


def _provenance(diagnosis: Diagnosis, provenance: Provenance) -> Section:
    measurements, steps = diagnosis.study.measurements, diagnosis.steps
    measured: tuple[Fact, ...] = ()
    if measurements is not None:
        measured = (
            Fact("Measured data", measurements.file.name),
            Fact("SHA-256 of the data", diagnosis.measured.sha256),
        )
    facts = (
        *facts_of(provenance, diagnosis.study, *measured),
        Fact("Candidates", fmt.count(len(steps[0].trials) if steps else 0)),
        Fact("Everything in numbers", "diagnosis.json", "beside this report"),
    )
    return Section.of("provenance", "Provenance", Box.of("loose", Facts(facts)))
