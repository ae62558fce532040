"""What the study asks for, as the file gives it and as it was understood."""

from __future__ import annotations

from itertools import zip_longest

from markupsafe import Markup

from designer.analysis.analyse import Analysis
from designer.report import format as fmt
from designer.report.blocks import Section, Table
from designer.report.design.source import Source
from designer.study import Entry


def section(source: Source) -> Section:
    """Return the fields that the file gives."""
    given = (e for e in source.analysis.study.source.entries if e.given != "default")
    see = Markup(
        "All other fields keep their default, see "
        '<a href="#defaults">Fields left at their default</a>.'
    )
    return Section.of(
        "inputs",
        "Inputs",
        _halves("Fields given in the configuration file.", [(e.field, _shown(e)) for e in given]),
        see if defaults_table(source.analysis) is not None else None,
    )


def defaults_table(analysis: Analysis) -> Table | None:
    """Return the fields left out, the first half on the left; None where there are none."""
    cells = [(e.field, e.value_SI) for e in _defaults(analysis) if e.value_SI != "none"]
    if not cells:
        return None
    return _halves("Fields that the configuration file leaves out.", cells)


def none_given(analysis: Analysis) -> str:
    """Return the fields that have no value, in a sentence."""
    names = [e.field for e in _defaults(analysis) if e.value_SI == "none"]
    return f"Not given, and not in the study: {fmt.listing(names)}." if names else ""


def _defaults(analysis: Analysis) -> list[Entry]:
    """Return the fields left out, but those that a drawing office writes on a document."""
    entries = analysis.study.source.entries
    return [e for e in entries if e.given == "default" and not e.field.startswith("document.")]


def _shown(entry: Entry) -> str:
    """Return a value as the file gives it, where that has its unit, else in SI units."""
    has_unit = entry.given[:1] not in "[{" and any(c.isalpha() for c in entry.given)
    return entry.given if has_unit else fmt.shorter(entry.value_SI)


def _halves(caption: str, cells: list[tuple[str, str]]) -> Table:
    """Return fields and values, the first half on the left."""
    half = (len(cells) + 1) // 2
    pairs = zip_longest(cells[:half], cells[half:], fillvalue=("", ""))
    return Table.of(
        caption,
        ("Field", "Value", "Field", "Value"),
        *((*left, *right) for left, right in pairs),
        kind="inputs halves long",
    )
