"""The page of a check: what the declared model leaves of new data, nothing searched."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from designer.analysis.provenance import Provenance
from designer.diagnosis.check import Check
from designer.report import format as fmt
from designer.report.diagnosis.quantity import kinds
from designer.report.document import MOST_ROWS, Report, Section
from designer.report.render import write_pages


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
