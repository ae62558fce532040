"""What the commands of the catalogue print: the list of grades, and one of them."""

from __future__ import annotations

from collections.abc import Sequence

from rich.markup import escape
from rich.table import Column, Table

from designer.cli.terminal import bare_table, show
from designer.grades.grade import TYPICAL_LOAD_FRACTION, Grade
from designer.grades.listing import GradeRow, facts, size_rows


def print_grades(rows: Sequence[GradeRow]) -> None:
    """Print the list of grades, those of one publisher together."""
    table = bare_table(
        "grade", "construction", "material", "sizes", "d [mm]", "MBL [kN]", "trust", "from"
    )
    for publisher in sorted({row.publisher for row in rows}, key=str.casefold):
        table.add_section()
        table.add_row(f"[bold]{escape(publisher)}[/]")
        for row in rows:
            if row.publisher == publisher:
                table.add_row(*_grade_cells(row))
    show(table)
    show(
        "trust: A maker's or standard's table, B seller's transcript, C third hand; (n?) doubtful "
        "sizes; for document and address: designer catalog show GRADE"
    )


def _grade_cells(row: GradeRow) -> tuple[str, ...]:
    return (
        f"  {escape(row.id)}",
        escape(_known(row.construction, row.core)),
        escape(_known(row.material, row.finish.removeprefix("stainless, "))),
        f"{row.n_sizes}" + (f" ({row.n_doubtful}?)" if row.n_doubtful else ""),
        _range(row.diameter_m, 1e3),
        _range(row.minimum_breaking_load_N, 1e-3),
        escape(row.trust),
        escape(row.origin),
    )


def _known(*texts: str) -> str:
    """Join what a source states; catalogue files say "not stated" where it does not."""
    return ", ".join(text for text in texts if text not in ("", "not stated")) or "not stated"


def print_grade(grade: Grade) -> None:
    """Print all that is known of one grade."""
    known = bare_table(title=grade.id)
    for name, text in facts(grade):
        known.add_row(name, escape(text))
    show(known)
    names = ("size", "d [mm]", "MBL [kN]", "mass [kg/m]", "A [mm²]", "EA [MN]", "price", "doubt")
    prices = f"price [{grade.currency}/m]"
    sizes = bare_table(*(prices if name == "price" else name for name in names))
    for row in size_rows(grade):
        area_m2 = row.metallic_area_m2
        sizes.add_row(
            escape(row.id),
            f"{1e3 * row.diameter_m:.4g}",
            f"{row.minimum_breaking_load_N / 1e3:.4g}",
            f"{row.linear_density_kg_per_m:.4g}",
            "" if area_m2 is None else f"{1e6 * area_m2:.4g}",
            f"{row.axial_stiffness_N / 1e6:.4g}",
            "" if row.price_per_m is None else f"{row.price_per_m:.4g}",
            escape(row.doubt),
        )
    for column in _empty_columns(sizes):
        sizes.columns.remove(column)
    show(sizes)
    if grade.stiffness is not None and len(grade.stiffness.load_fraction) > 1:
        show(f"EA at {TYPICAL_LOAD_FRACTION:g} of the breaking load")


def _empty_columns(table: Table) -> list[Column]:
    return [column for column in table.columns if not any(column.cells)]


def _range(ends: tuple[float, float], scale: float) -> str:
    first, last = f"{scale * ends[0]:.4g}", f"{scale * ends[1]:.4g}"
    return first if first == last else f"{first}–{last}"
