"""The figures of a diagnosis: each is drawn when a template first asks for it, and once."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property

from designer.diagnosis.result import Diagnosis
from designer.diagnosis.structure import Carrier
from designer.report.document import Drawing, vector
from designer.report.figures.diagnosis import Layout, carriers_chart, errors_chart, rows_chart

_MOST = 4
"""Panels side by side that are still wide enough to be read."""
_MOST_ON_FIRST_PAGE = 3
"""The same, in the panel of the first page."""


class Drawings:
    """Figures by name; None where nothing is drawn."""

    def __init__(self, diagnosis: Diagnosis) -> None:
        self._diagnosis = diagnosis

    @cached_property
    def errors(self) -> Drawing | None:
        """The error at each stage."""
        return vector(errors_chart(self._diagnosis))

    @cached_property
    def rows(self) -> Drawing | None:
        """The residual of every reading over the rows."""
        return vector(rows_chart(self._diagnosis))

    @cached_property
    def strongest(self) -> Drawing | None:
        """The residual against what it goes with most, for the first page."""
        diagnosis = self._diagnosis
        structure = diagnosis.structure_after
        carriers = diagnosis.structure_before.carriers
        if diagnosis.is_unexplained:
            carriers = structure.present or structure.carriers
        layout: Layout = "overlaid" if diagnosis.findings else "after"
        return self._carriers(carriers[:_MOST_ON_FIRST_PAGE], "diagnosis-first", layout)

    @cached_property
    def carriers_before(self) -> Drawing | None:
        """The residual against what it went with before."""
        carriers = self._diagnosis.structure_before.carriers[:_MOST]
        layout: Layout = "stacked" if self._diagnosis.findings else "after"
        return self._carriers(carriers, "diagnosis-carriers", layout)

    @cached_property
    def carriers_after(self) -> Drawing | None:
        """What is left; None without findings, as that is the whole residual."""
        if not self._diagnosis.findings:
            return None
        carriers = self._diagnosis.structure_after.carriers[:_MOST]
        return self._carriers(carriers, "diagnosis-left", "after")

    def _carriers(self, carriers: Sequence[Carrier], key: str, layout: Layout) -> Drawing | None:
        names = [carrier.name for carrier in carriers]
        return vector(carriers_chart(self._diagnosis, names, key, layout)) if names else None
