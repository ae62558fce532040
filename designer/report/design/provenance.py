"""Where the numbers come from, and what the study left at its default."""

from __future__ import annotations

from designer.analysis.analyse import Analysis, Provenance
from designer.report import format as fmt
from designer.report.blocks import Box, Column, Fact, Facts, Section, Subheading, Table, shown_time
from designer.report.design.inputs import defaults_table, none_given
from designer.report.design.source import Source
from designer.report.paper import why_no_pdf
from designer.study import Study


def section(source: Source) -> Section:
    """Return program, libraries, config, time, settings, sources of grades, defaults."""
    analysis = source.analysis
    catalogues = (
        (one.name, one.source, fmt.count(one.n_grades), one.sha256)
        for one in analysis.catalogue.sources
    )
    defaults = defaults_table(analysis)
    return Section.of(
        "provenance",
        "Provenance",
        Box.of("loose", _facts(analysis)),
        Table.of(
            "Sources of grades.",
            ("Name", "Where from", Column("Grades"), "SHA-256 of the grades"),
            *catalogues,
        ),
        Subheading("defaults", "Fields left at their default") if defaults else None,
        defaults,
        none_given(analysis) if defaults else None,
    )


def facts_of(provenance: Provenance, study: Study, *data: Fact) -> tuple[Fact, ...]:
    """Return program, libraries, config and time, as both kinds of report show them."""
    libraries = ", ".join(f"{name} {version}" for name, version in provenance.libraries)
    return (
        Fact("Program", f"cdpr-designer {provenance.version}", f"with {libraries}"),
        Fact("Configuration", study.source.path.name),
        Fact("SHA-256 of the configuration", study.source.sha256),
        *data,
        *([Fact("PDF", "left out", why_no_pdf())] if why_no_pdf() else []),
        Fact("Computed", shown_time(provenance.created), f"on {provenance.system}"),
    )


def _facts(analysis: Analysis) -> Facts:
    from designer.kernel.answer import TOLERANCE

    study = analysis.study
    tolerance = fmt.power_of_ten(TOLERANCE)
    facts = [
        *facts_of(analysis.provenance, study),
        Fact("Solver tolerance", tolerance, "relative residual of a solved pose"),
    ]
    files = ["every candidate in candidates.csv"] if analysis.selection is not None else []
    if analysis.sweep_file is not None:
        files.append(f"every sample in {analysis.sweep_file.name}")
    if files:
        facts.append(Fact("Beside this report", fmt.listing(files)))
    return Facts(tuple(facts))
