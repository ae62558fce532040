"""What the study asks for, as the file gives it and as it was understood."""

from __future__ import annotations

from dataclasses import dataclass

from designer.analysis import Analysis
from designer.report.parts import Column, Row, Table


@dataclass(frozen=True, slots=True)
class InputsSection:
    """All inputs.

    Parameters
    ----------
    given : Table
        Fields that the file gives.
    defaults : Table or None
        Fields that it leaves out; None if there are none.
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
            *(Row((e.field, e.given, e.value_SI)) for e in given),
        ),
        defaults=Table.of(
            "Fields left out, with the value used.",
            (field, meaning),
            *(Row((e.field, e.value_SI)) for e in defaults),
        )
        if defaults
        else None,
    )
