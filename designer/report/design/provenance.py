"""Where the numbers come from."""

from __future__ import annotations

from designer.analysis.provenance import Provenance
from designer.report.blocks import Fact
from designer.report.paper import why_no_pdf
from designer.report.phrases import shown_time
from designer.study import Study


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
