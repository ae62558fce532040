"""The candidates as tables: whom none beats, the best of each grade, why the others fell out."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable, Iterable, Sequence

from designer.report import format as fmt
from designer.report.blocks import MOST_ROWS, Column, Group, Row, Table, Tone
from designer.report.figures.charts_selection import rank
from designer.selection.candidate import Candidate, Standing
from designer.selection.objectives import MEANINGS
from designer.selection.result import GradeOutcome, SelectionResult
from designer.study import Objective

_MOST_NAMES = 3
_Cell = Callable[[Candidate], str]
_Columns = list[tuple[Column | str, _Cell]]


def pareto_table(selection: SelectionResult) -> Table:
    """Return the candidates that no other beats in everything, the chosen one first."""
    names = fmt.listing(MEANINGS[objective].title for objective in selection.objectives)
    caption = (
        f"Sizes that hold everywhere and that no other size beats in {names} at once. The "
        "allowable tension is the breaking load times the efficiency over the safety factor."
    )
    shown = selection.front[:MOST_ROWS]
    if any(len({found.case.name for found in c.cases}) > 1 for c in shown):
        caption += " Tension and utilisation are of the load case that asks most of each size."
    if len(shown) < len(selection.front):
        caption += f" {_more(len(selection.front) - len(shown), 'size')}"
    columns, cells = zip(*_columns(selection, shown), strict=True)
    groups = (
        Group(
            rows=(_row(c, cells),),
            title=c.grade.id,
            remark=f"{c.grade.construction} {c.grade.core}, trust {c.grade.trust}: {c.reason}",
            tone="good" if c.standing == "chosen" else "",
        )
        for c in shown
    )
    return Table.grouped(caption, columns, groups, "candidates long")


def front_sentence(selection: SelectionResult) -> str:
    """Return how many sizes no other beats, and which where it is one; empty where none holds."""
    names = fmt.listing(MEANINGS[objective].title for objective in selection.objectives)
    if not selection.front:
        return ""
    if len(selection.front) > 1:
        return (
            f"{fmt.plural(len(selection.front), 'size')} are left that no other size beats in "
            f"{names} at once: who wants less of one has to take more of another."
        )
    if not any(c.standing == "dominated" for c in selection.candidates):
        return f"Only {selection.front[0].name} holds, so there is nothing to weigh it against."
    return (
        f"One size alone is left: {selection.front[0].name} beats every other size that holds and "
        f"of which all is known, by {names}. So nothing is to be weighed here."
    )


def best_table(selection: SelectionResult) -> Table | None:
    """Return the best size of each grade that holds, the best first; None where none holds."""
    title = MEANINGS[selection.objectives[0]].title
    caption = f"The best size of each grade that holds everywhere, by {title}."
    return _table_of_best(selection, selection.outcomes, caption, are_allowed=True)


def alternatives_table(selection: SelectionResult) -> Table | None:
    """Return the grades that the study does not allow, but that would hold; None without any."""
    caption = "Grades that the study does not allow, but that would hold the whole workspace."
    return _table_of_best(selection, selection.alternatives, caption, are_allowed=False)


def _more(amount: int, noun: str) -> str:
    """Say where the rest of a table is."""
    verb = "is" if amount == 1 else "are"
    return f"{fmt.plural(amount, f'more {noun}')} {verb} in candidates.csv."


def _table_of_best(
    selection: SelectionResult,
    outcomes: Sequence[GradeOutcome],
    caption: str,
    *,
    are_allowed: bool,
) -> Table | None:
    """Return the best size of each grade that holds, the chosen one and then the best first."""
    first = selection.objectives[0]
    best = [o.best for o in outcomes if o.best is not None]
    best.sort(key=lambda c: (c.standing != "chosen", c.figures.burden(first)))
    if not best:
        return None
    more = len(best) - MOST_ROWS
    if more > 0:
        rest = f"{fmt.plural(more, 'more grade')} would hold as well."
        caption += f" {_more(more, 'grade') if are_allowed else rest}"
    head: _Columns = [
        ("Grade", lambda c: c.grade.id),
        ("Material", lambda c: c.grade.material or "not stated"),
    ]
    columns, cells = zip(*head, *_columns(selection, best[:MOST_ROWS], full=False), strict=True)
    rows = (_row(c, cells, marks=are_allowed) for c in best[:MOST_ROWS])
    return Table.of(caption, columns, *rows, kind="candidates best long")


def _row(one: Candidate, cells: Iterable[_Cell], *, marks: bool = True) -> Row:
    tone: Tone = "good" if marks and one.standing == "chosen" else ""
    return Row(tuple(cell(one) for cell in cells), tone, fmt.doubtful(one.size.doubt))


def thin_table(outcomes: Sequence[GradeOutcome]) -> Table | None:
    """Return the grades of which no size holds; None where there are none."""
    failing = [o for o in rank(outcomes) if o.best is None]
    if not failing:
        return None
    rows = []
    for outcome in failing[:MOST_ROWS]:
        needed_m, thickest = outcome.continuous_diameter_m, outcome.grade.thickest
        why = "its own weight is too much"
        if math.isfinite(needed_m):
            why = "largest size sold is insufficient"
        rows.append((outcome.grade.id, thickest.id, _known(1e3 * needed_m, 1), why))
    columns = ("Grade", "Largest size", Column("Needed", "mm"), "Why not")
    caption = "Grades of which no size holds, the nearest first."
    if len(failing) > MOST_ROWS:
        caption += f" {_more(len(failing) - MOST_ROWS, 'grade')}"
    return Table.of(caption, columns, *rows, kind="long")


def fallen_table(selection: SelectionResult) -> Table:
    """Return why sizes fell out, with how many and for example which."""
    rows = []
    for standing, meaning in _MEANINGS.items():
        fallen = [c for c in selection.candidates if c.standing == standing]
        if fallen:
            grades = {c.grade.id for c in fallen}
            example = min(fallen, key=lambda c: c.verification.utilisation)
            named = fmt.printed(f"{example.name}: {example.reason}")
            rows.append((meaning, fmt.count(len(fallen)), fmt.count(len(grades)), named))
    for reason in dict.fromkeys(one.reason for one in selection.not_tried):
        left = [one for one in selection.not_tried if one.reason == reason]
        sizes = sum(1 if one.size else len(one.grade.sizes) for one in left)
        names = [*dict.fromkeys(one.grade.id for one in left)]
        rows.append((f"not solved: {reason}", fmt.count(sizes), fmt.count(len(names)), names[0]))
    columns = ("Why", Column("Sizes"), Column("Grades"), "For example")
    caption = "Why the other sizes fell out. candidates.csv has the reason of each."
    return Table.of(caption, columns, *rows)


def main_dominators(selection: SelectionResult) -> str:
    """Return who beats most of the dominated sizes, in a sentence; empty where none is."""
    dominated = [c for c in selection.candidates if c.standing == "dominated"]
    if not dominated:
        return ""
    beaten = Counter(c.reason.split(";")[0].removeprefix("dominated by ") for c in dominated)
    searched = sum(c.verification.is_refined for c in selection.candidates)
    if len(beaten) > 1:
        parts = [f"{name} beats {fmt.count(n)}" for name, n in beaten.most_common(_MOST_NAMES)]
        who = f"Of the {fmt.plural(len(dominated), 'dominated size')}, {fmt.listing(parts)}."
    else:
        all_of_them = f"all {fmt.count(len(dominated))} dominated sizes"
        what = all_of_them if len(dominated) > 1 else "the one dominated size"
        who = f"{next(iter(beaten))} beats {what}."
    return (
        f"{who} {fmt.plural(searched, 'size')} were searched between the samples: those that no "
        "other beats, the best of each grade, and those above 90\u00a0% of their allowable "
        "tension. For the others the samples are enough, since a search can only find more tension."
    )


_MEANINGS: dict[Standing, str] = {
    "dominated": "holds, but another one is as good in everything and better in something",
    "too_thin": "goes beyond its allowable tension",
    "not_held": "no equilibrium was found somewhere",
    "not_comparable": "holds, but what decides is not known of it",
}


def _columns(
    selection: SelectionResult, shown: Sequence[Candidate], *, full: bool = True
) -> _Columns:
    smallest_N = min((c.verification.max_tension_N for c in shown), default=0.0)
    unit, newtons = fmt.force_unit(smallest_N)
    tension = fmt.decimals([smallest_N / newtons], 4)
    force = fmt.decimals(c.cable.allowable_tension_N / newtons for c in shown)
    mass = fmt.decimals(c.total_mass_kg for c in shown)

    def forces(title: str, value_N: Callable[[Candidate], float], places: int) -> _Columns:
        return [(Column(title, unit), lambda c: fmt.fixed(value_N(c) / newtons, places))]

    own: dict[Objective, tuple[Column | str, _Cell]] = {
        "drum_diameter": (Column("Drum", "m"), lambda c: _known(c.figures.drum_diameter_m, 2)),
        "cost": (Column("Price", selection.currency or ""), lambda c: _known(c.figures.cost, 0)),
        "stiffness": (
            Column("Stiffness", "kN/m"),
            lambda c: _known(c.figures.stiffness_N_per_m / 1e3, 2),
        ),
    }
    strength = [
        *forces("Breaking load", lambda c: c.size.minimum_breaking_load_N, force),
        (Column("Efficiency"), lambda c: fmt.trimmed(c.efficiency, 3)),
        *forces("Allowable", lambda c: c.cable.allowable_tension_N, force),
    ]
    return [
        ("Size", lambda c: c.size.id.replace(" ", "\u00a0")),
        (Column("Diameter", "mm"), lambda c: fmt.fixed(1e3 * c.size.diameter_m, 1)),
        *(strength if full else ()),
        *forces("Largest tension", lambda c: c.verification.max_tension_N, tension),
        (Column("Used"), lambda c: fmt.utilisation(c.verification.utilisation)),
        (Column("All cables", "kg"), lambda c: fmt.fixed(c.total_mass_kg, mass)),
        *(own[objective] for objective in selection.objectives if objective in own),
    ]


def _known(value: float, decimals: int) -> str:
    return fmt.fixed(value, decimals) if math.isfinite(value) else fmt.MISSING
