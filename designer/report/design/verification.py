"""The governing poses, solved a second time."""

from __future__ import annotations

from designer.analysis.verification import SecondAnswer
from designer.report import format as fmt
from designer.report.blocks import Column, Row, Section, Statement, Table
from designer.report.design.source import Source


def section(source: Source) -> Section | None:
    """Return ours beside what other methods find; None where nothing was solved."""
    found = source.analysis.verification
    if not found:
        return None
    return Section.of(
        "verification",
        "Solved a second time",
        verification_statement(found),
        Table.of(
            "Governing poses by other methods than the solver's.",
            ("What", "Other method", Column("Here", "mm"), Column("There", "mm"),
             Column("Difference", "mm")),
            *map(_row, found),
        ),
        "The optimisers start from straight cables and solve the equations of the cables for the "
        "thinnest one; they know no pulleys, and where several equilibria hold a pose they may end "
        "at a thicker one, which refutes nothing. The quadrature integrates the equilibrium of "
        "the cable's elements with the lengths and forces found here: a cable that ended "
        "elsewhere than at its attachment would show a wrong answer.",
    )  # fmt: skip


def verification_statement(found: tuple[SecondAnswer, ...]) -> Statement:
    """Return whether the other methods agree."""
    against = [one for one in found if not one.agrees]
    if not against:
        return Statement(
            "Other methods find nothing thinner, and cables end where they should", "", "good"
        )
    text = "; ".join(f"{one.quantity}, by {one.method}" for one in against)
    return Statement("Another method disagrees", f"{fmt.capital(text)}.", "bad")


def _row(one: SecondAnswer) -> Row:
    compared = (one.remark, "") if one.remark else map(_millimetres, (one.theirs, one.difference))
    cells = (fmt.capital(one.quantity), one.method, _millimetres(one.ours), *compared)
    return Row(cells, tone="" if one.agrees else "bad")


def _millimetres(value_m: float) -> str:
    value = 1e3 * value_m
    return fmt.trimmed(value, 5) if value == 0.0 or value > 1e-3 else fmt.power_of_ten(value)
