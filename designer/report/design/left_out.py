"""Grades that were not considered, and what could not be loaded."""

from __future__ import annotations

from collections.abc import Iterator

from designer.analysis.analyse import Analysis
from designer.report import format as fmt
from designer.report.blocks import MOST_ROWS, Bullets, Section
from designer.report.design.source import Source
from designer.study import Selection


def section(source: Source) -> Section | None:
    """Return the grades that were not considered; None without a selection."""
    analysis, selection = source.analysis, source.analysis.study.selection
    if selection is None:
        return None
    kinds = [*_not_allowed(analysis, selection), *_by_name_only(analysis, selection)]
    problems = analysis.left_out
    loaded = "Every plugin, grade file and effect could be loaded."
    if problems:
        loaded = "These could not be loaded:"
    return Section.of(
        "left-out",
        "Grades left out",
        " ".join((*(kinds or ["Every grade of the catalogue was considered."]), loaded)),
        Bullets(problems) if problems else None,
    )


def _not_allowed(analysis: Analysis, selection: Selection) -> Iterator[str]:
    """Yield how many grades the study does not allow, and which if they are few."""
    allowed = selection.grades
    if allowed is None:
        return
    grades = analysis.catalogue.grades
    names = sorted(g.id for g in grades if g.id not in allowed and not g.why_only_by_name)
    if 0 < len(names) <= MOST_ROWS:
        yield f"The study does not allow these grades of the catalogue: {fmt.listing(names)}."
    elif names:
        yield (
            f"The catalogue has {fmt.plural(len(names), 'more grade')}, which the study does not "
            "allow in selection.grades. The command designer catalog list shows all."
        )


def _by_name_only(analysis: Analysis, selection: Selection) -> Iterator[str]:
    """Yield kinds of grades that a study must name, each with why."""
    kinds: dict[str, list[str]] = {}
    for grade in analysis.catalogue.grades:
        if grade.why_only_by_name and grade.id not in (selection.grades or ()):
            kinds.setdefault(grade.why_only_by_name, []).append(grade.id)
    for why, names in kinds.items():
        yield f"{fmt.plural(len(names), 'grade')} such as {names[0]}: {why}."
