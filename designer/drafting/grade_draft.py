"""A grade file made of a maker's table and what the table does not say."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from statistics import median
from typing import Any

from designer.documents.document import GRADE, document_of
from designer.documents.edits import scalar
from designer.drafting.maker_table import MakerRow, MakerTable
from designer.errors import Fault, InputError
from designer.grades.checks import flaws_over_diameter
from designer.grades.grade import (
    DIMENSIONS,
    Grade,
    Modulus,
    Reference,
    RelativeStiffness,
    Size,
    Units,
)
from designer.grades.listing import ton_remarks
from designer.grades.registry import grade_of
from designer.units import read_quantity

TEXTS = {
    "id": "unique name, such as acme-6x36",
    "manufacturer": "who makes the rope",
    "product": "the name it is sold under",
    "construction": "such as 6x36 or 12-strand braid",
    "core": "such as IWRC; of a fibre rope the fibre that bears",
    "finish": "such as galvanised",
    "material": "steel, stainless steel, HMPE, Vectran, PBO, aramid, polyester, nylon, …",
    "standard": "if stated",
    "wire_grade": "if stated, such as 1960 N/mm2",
    "trust": "A the maker's own table, B a seller's, C third hand",
    "source.publisher": "who published the table",
    "source.document": "name of the sheet, page or catalogue",
    "source.url": "its address, if it has one",
    "source.date": "its date or edition",
    "modulus.value": "on the circle of the nominal diameter, such as 62.7 GPa; or --like GRADE",
    "modulus.source": "where the modulus comes from",
    "modulus.uncertainty": "as a fraction, such as 0.1",
}
"""What may be said of a grade beside its table, by the fields of its file."""
OPTIONAL = ("material", "standard", "wire_grade", "source.url", "source.date")
COPIED = ("construction", "core", "finish", "material")
"""What is taken from a grade that the table's is said to be like, unless it is said as well."""
ELASTICITY = ("modulus.value", "modulus.source", "modulus.uncertainty")
_LEAST_BORROWED = 0.15
"""Uncertainty of a modulus that is another rope's, at least."""
_SIZE_FIELD = re.compile(r"sizes\[(\d+)\](?:\.(\w+))?")


@dataclass(frozen=True, slots=True)
class OffTheLaw:
    """A row beside the laws MBL = c d² and m = k d² of its table, in the units of the table.

    The laws go through the medians of all rows; ``name`` is the figure that is off.
    """

    row: MakerRow
    name: str
    figure: float
    by_law: float


@dataclass(frozen=True, slots=True)
class GradeDraft:
    """A grade on its way to a file."""

    table: MakerTable
    rows: tuple[MakerRow, ...]
    units: Mapping[str, str]  #: of each column of figures
    texts: Mapping[str, str]  #: fields of `TEXTS` that are known
    like: Grade | None = None  #: whose elasticity and other properties it borrows
    doubt: str = ""  #: why rows that are off the law may stay; empty for none

    @property
    def missing(self) -> tuple[str, ...]:
        """Fields that a grade needs and nobody gave."""
        needed = [name for name in TEXTS if name not in OPTIONAL]
        if self.like is not None and "modulus.value" not in self.texts:
            needed = [name for name in needed if name not in ELASTICITY]
        return tuple(name for name in needed if not self.texts.get(name))

    @property
    def copied(self) -> tuple[str, ...]:
        """Name and value of all that is the lender's."""
        if self.like is None:
            return ()
        texts = [(name, getattr(self.like, name)) for name in COPIED]
        parts = pairwise(self._elasticity_lines() if "modulus.value" not in self.texts else ())
        return (
            *(f"{name} {text}" for name, text in texts if text and self.texts.get(name) == text),
            *(f"{a[:-1]} {b.partition(': ')[2]}" for a, b in parts if not a.startswith(" ")),
        )

    def remarks(self) -> list[str]:
        """Return what is doubtful of the units of its figures."""
        return ton_remarks(self._grade_of_figures())

    def off_the_law(self) -> tuple[OffTheLaw, ...]:
        """Return the rows that stand off the law of d².

        Raises
        ------
        InputError
            If a whole column does, as one in another unit than it is said to be.
        """
        found = []
        for flaw in flaws_over_diameter(self._grade_of_figures()):
            if len(flaw.keys) < 3:
                raise InputError([Fault(self.table.name, None, "", flaw.problem, flaw.expected)])
            row, name = self.rows[int(flaw.keys[1])], str(flaw.keys[2])
            ratios = [float(r.figures[name]) / float(r.figures["diameter"]) ** 2 for r in self.rows]
            law = median(ratios) * float(row.figures["diameter"]) ** 2
            found.append(OffTheLaw(row, name, float(row.figures[name]), law))
        return tuple(found)

    def _grade_of_figures(self) -> Grade:
        """Return a grade of the table's figures, whatever else is known of it."""
        values = {
            figure: [
                read_quantity(f"{row.figures[figure]} {self.units[figure]}", DIMENSIONS[figure])
                for row in self.rows
            ]
            for figure in ("diameter", "minimum_breaking_load", "linear_mass")
        }
        sizes = tuple(
            Size(row.id, *figures)
            for row, *figures in zip(self.rows, *values.values(), strict=True)
        )
        material: Any = self.texts.get("material")
        return Grade(
            id="",
            manufacturer="",
            product="",
            construction=self.texts.get("construction", ""),
            core=self.texts.get("core", ""),
            finish="",
            trust="A",
            source=Reference("", ""),
            material=material,
            sizes=sizes,
            units=Units(**self.units),
        )

    def text(self) -> str:
        """Return the file; what is missing stands in it as a comment."""
        lines = [*self._field_lines(("id", "manufacturer", "product", "construction", "core"))]
        lines += self._field_lines(("finish", "material", "standard", "wire_grade", "trust"))
        lines.append("source:")
        for name in ("publisher", "document", "url", "date"):
            lines += self._field_lines((f"source.{name}",), indent="  ")
        if self.like is not None:
            copied = f"from grade {self.like.id}: {'; '.join(self.copied)}"
            lines.append(f"notes: [{_quoted(copied)}]")
        lines += self._elasticity_lines()
        units = ", ".join(f"{figure}: {scalar(unit)}" for figure, unit in self.units.items())
        off = {item.row.line for item in self.off_the_law()} if self.doubt else set()
        lines += [f"units: {{{units}}}", "sizes:"]
        for row in self.rows:
            doubt = f", doubt: {scalar(self.doubt)}" if row.line in off else ""
            figures = ", ".join(f"{figure}: {row.figures[figure]}" for figure in row.figures)
            lines.append(f"  - {{id: {_quoted(row.id)}, {figures}{doubt}}}")
        return "\n".join([*lines, ""])

    def _field_lines(self, names: Sequence[str], indent: str = "") -> list[str]:
        lines = []
        for name in names:
            text, last = self.texts.get(name), name.rpartition(".")[2]
            if text:
                lines.append(f"{indent}{last}: {_quoted(text)}")
            elif name in self.missing:
                lines.append(f"{indent}# {last}:  # fill in: {TEXTS[name]}")
        return lines

    def _elasticity_lines(self) -> list[str]:
        if self.like is not None and "modulus.value" not in self.texts:
            return [*_borrowed(self.like.elasticity, self.like), *_properties(self.like)]
        lines = ["modulus:", "  reference_area: nominal", "  basis: printed"]
        if "modulus.value" in self.texts:
            return [*lines, *self._field_lines(ELASTICITY, indent="  ")]
        lines += [f"  {name.partition('.')[2]}:  # fill in: {TEXTS[name]}" for name in ELASTICITY]
        return [f"# {line}" for line in lines]

    def grade(self) -> Grade:
        """Return the grade as its file is read, checked as every grade.

        Raises
        ------
        InputError
            With a fault for each thing that is wrong, at the line of the table where it is of a
            size.
        """
        text = self.text()
        document = document_of(text.encode(), self.table.name, GRADE)
        try:
            return grade_of(document, self.table.name)
        except InputError as error:
            raise InputError([self._at_its_line(fault) for fault in error.faults]) from None

    def _at_its_line(self, fault: Fault) -> Fault:
        """Return a fault of the grade file as one of the table, or of what was said beside it."""
        match = _SIZE_FIELD.fullmatch(fault.field)
        if match is None:
            return replace(fault, line=None)
        column = self.table.columns.get(match[2] or "")
        head = fault.field if column is None else column.head
        return replace(fault, line=self.rows[int(match[1])].line, field=head)


def _quoted(text: str) -> str:
    """Return a text as YAML reads it back, never as a number or a date."""
    plain = " ".join(text.split())
    return "'" + plain.replace("'", "''") + "'"


def _borrowed(elasticity: Modulus | RelativeStiffness, lender: Grade) -> list[str]:
    """Return the lines of a modulus or stiffness that is another grade's."""
    uncertainty = max(_LEAST_BORROWED, elasticity.uncertainty)
    origin = [
        "  basis: borrowed",
        f"  source: {_quoted(f'grade {lender.id}: {elasticity.source}')}",
        f"  uncertainty: {uncertainty:g}",
    ]
    if isinstance(elasticity, Modulus):
        value = f"  value: {elasticity.value_Pa / 1e9:.6g} GPa"
        return ["modulus:", value, f"  reference_area: {elasticity.reference_area}", *origin]
    loads, ratios = elasticity.load_fraction, elasticity.ea_over_breaking_load
    if len(ratios) == 1:
        figures = [f"  ea_over_breaking_load: {ratios[0]:g}"]
        figures += [f"  at_load_fraction: {load:g}" for load in loads]
    else:
        pairs = ", ".join(f"[{a:g}, {b:g}]" for a, b in zip(loads, ratios, strict=True))
        figures = [f"  by_load_fraction: [{pairs}]"]
    return ["stiffness:", *figures, *origin]


def _properties(lender: Grade) -> list[str]:
    """Return the lines of what else is borrowed: area factor, expansion, D/d."""
    lines = []
    factor, expansion, ratio = lender.area_factor, lender.thermal_expansion, lender.sheave_ratio
    if factor is not None:
        lines += ["area_factor:", f"  value: {factor.value:g}", *_lent(lender, factor.source)]
    if expansion is not None:
        value = f"  value: {expansion.coefficient_per_K:g} /K"
        lines += ["thermal_expansion:", value, *_lent(lender, expansion.source)]
    if ratio is not None:
        lines += ["sheave_ratio:", f"  suggested: {ratio.suggested:g}"]
        lines += [f"  minimum: {ratio.minimum:g}"]
        lines += [f"  source: {_quoted(f'borrowed from grade {lender.id}: {ratio.source}')}"]
    return lines


def _lent(lender: Grade, source: str) -> list[str]:
    return ["  basis: borrowed", f"  source: {_quoted(f'grade {lender.id}: {source}')}"]


def refused(off: Sequence[OffTheLaw], table: MakerTable) -> InputError:
    """Return the error of rows that are off the law and that nobody vouches for."""
    faults = []
    for item in off:
        by_law, figure = item.by_law, item.figure
        problem = f"{figure:g} is {figure / by_law - 1.0:+.0%} off the law of d²"
        expected = f"about {by_law:.4g} as its neighbours have; or --doubt WHY to keep it as it is"
        faults.append(table.fault(item.row.line, table.columns[item.name].head, problem, expected))
    return InputError(faults)
