"""What the study asks for, as the file gives it and as it was understood."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import zip_longest

from designer.analysis.analyse import Analysis
from designer.report import format as fmt
from designer.report.parts import Column, Row, Table
from designer.study import Entry


@dataclass(frozen=True, slots=True)
class InputsSection:
    """All inputs.

    Parameters
    ----------
    given : Table
        Fields that the file gives.
    defaults : Table or None
        Fields that it leaves out, in two columns for the appendix; None if there are none.
    """

    given: Table
    defaults: Table | None


def inputs_section(analysis: Analysis) -> InputsSection:
    """Return the inputs of the study."""
    entries = analysis.study.source.entries
    given = [e for e in entries if e.given != "default"]
    defaults = [e for e in entries if e.given == "default"]
    field, written, meaning = (
        Column(title, is_number=False) for title in ("Field", "As given", "In SI units")
    )
    return InputsSection(
        given=Table.of(
            "Fields given in the configuration file.",
            (field, written, meaning),
            *(Row((e.field, e.given, fmt.shorter(e.value_SI))) for e in given),
        ),
        defaults=_defaults(defaults) if defaults else None,
    )


def _defaults(entries: Sequence[Entry]) -> Table:
    """Return the entries in two columns, the first half on the left."""
    field, value = Column("Field", is_number=False), Column("Value used", is_number=False)
    cells = [(e.field, e.value_SI) for e in entries]
    half = (len(cells) + 1) // 2
    pairs = zip_longest(cells[:half], cells[half:], fillvalue=("", ""))
    return Table.of(
        "Fields that the configuration file leaves out, in SI units.",
        (field, value, field, value),
        *(Row((*left, *right)) for left, right in pairs),
    )
