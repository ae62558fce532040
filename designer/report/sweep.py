"""A sweep as a document: what is best, what is traded for what, what each field does."""

from __future__ import annotations

from dataclasses import dataclass
from datetime import datetime
from itertools import combinations
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from designer.analysis.result_json import evaluates_answer
from designer.arrays import BoolArray, FloatArray
from designer.documents.csv_text import csv_text
from designer.io.output import write_whole
from designer.report import format as fmt
from designer.report.blocks import (
    Block,
    Column,
    Heads,
    Picture,
    Report,
    Section,
    Statement,
    Table,
    plain_report,
)
from designer.report.figures import sweep as figures
from designer.report.figures.sweep import Axis
from designer.report.render import write_pages

if TYPE_CHECKING:
    import xarray as xr

NOT_EVALUATED = (
    "Whether they hold as asked was not evaluated, since nothing that is kept depends on it: keep "
    "answer.verdict for that."
)
_MOST_POINTS = 40
_MOST_PAIRS = 3
_MOST_FIELDS = 5


@dataclass(frozen=True, slots=True)
class SweptPoints:
    """A store's points as the pages need them; a goal times its sign is better the less it is."""

    varied: tuple[Axis, ...]
    kept: tuple[Axis, ...]
    goals: tuple[Axis, ...]
    signs: tuple[float, ...]
    front: BoolArray
    holds: BoolArray

    @classmethod
    def of(cls, found: xr.Dataset) -> SweptPoints:
        """Return the points of a store, read whole."""

        def axes(role: str) -> dict[str, Axis]:
            arrays = found.filter_by_attrs(role=role).items()
            return {str(k): Axis.of(str(k), v.attrs.get("units", ""), v.values) for k, v in arrays}

        kept = axes("kept")
        numbers = {name: axis for name, axis in kept.items() if not axis.labels}
        numbers = {k: v for k, v in numbers.items() if np.isfinite(v.values).any()}
        holds = np.asarray(found["reason"].values == "")
        signs = {"minimise": 1.0, "maximise": -1.0}
        goals = {k: signs[found[k].goal] for k in numbers if "goal" in found[k].attrs}
        values = [sign * numbers[name].values for name, sign in goals.items()]
        front = pareto_front(np.column_stack(values), holds) if goals else np.zeros_like(holds)
        return cls(
            tuple(axes("varied").values()),
            tuple(numbers.values()),
            tuple(numbers[name] for name in goals),
            tuple(goals.values()),
            front,
            holds,
        )


def pareto_front(values: FloatArray, counts: BoolArray) -> BoolArray:
    """Return which points no other one beats in every column, less being better.

    Parameters
    ----------
    values : ndarray, shape (n_points, n_goals)
        NaN for a point that has none.
    counts : ndarray of bool, shape (n_points,)
        Points that are looked at.
    """
    left = np.flatnonzero(counts & np.isfinite(values).all(axis=1))
    left = left[np.lexsort(values[left].T[::-1])]
    front = np.zeros(len(values), bool)
    while len(left):
        best, rest = values[left[0]], values[left]
        front[left[(rest == best).all(axis=1)]] = True
        left = left[(rest < best).any(axis=1)]
    return front


def sweep_report(found: xr.Dataset, name: str, created: datetime) -> Report[None]:
    """Return the document on a store, of a sweep called ``name``."""
    points = SweptPoints.of(found)
    sections = [
        Section.of("answer", "What came out", *_overview(found, points)),
        _trade_offs(points),
        _influences(points),
        _reasons(found),
    ]
    return plain_report("sweep", name, "Sweep over a study", created, sections)


def write_sweep(found: xr.Dataset, name: str, folder: Path, templates: Path | None = None) -> None:
    """Write ``sweep.html``, ``sweep.pdf`` and ``sweep.csv`` into an existing folder."""
    write_pages(sweep_report(found, name, datetime.now().astimezone()), folder, templates)
    write_whole(folder / "sweep.csv", _table(found).encode())


def _table(found: xr.Dataset) -> str:
    """Return all points as CSV."""
    table = found.to_dataframe().reset_index()
    rows = table.itertuples(index=False)
    return csv_text([table.columns, *([None if x != x else x for x in row] for row in rows)])  # noqa: PLR0124


def _overview(found: xr.Dataset, points: SweptPoints) -> tuple[Block | None, ...]:
    n, holds = len(points.holds), int(points.holds.sum())
    fields = fmt.listing(axis.title for axis in points.varied)
    text = f"{fmt.count(n)} {'study' if n == 1 else 'studies'} over {fields}."
    if not evaluates_answer(str(name) for name in found.filter_by_attrs(role="kept")):
        text += f" {NOT_EVALUATED}"
        head = Statement(f"{fmt.share(holds, n)} of the studies are solved", text)
    elif holds == n:
        head = Statement("Every study has an answer", text, "good")
    else:
        head = Statement(f"{fmt.share(holds, n)} of the studies have an answer", text, "doubt")
    best = [_best(points, *each) for each in zip(points.goals, points.signs, strict=True)]
    rows = [row for row in best if row is not None]
    if not rows:
        return (head,)
    heads: Heads = ("Best by", Column("Value"), *(Column(axis.title) for axis in points.varied))
    return (head, Table.of("The best point by each goal.", heads, *rows))


def _best(points: SweptPoints, goal: Axis, sign: float) -> tuple[str, ...] | None:
    """Return the row of the best by one goal, of equals one that no other beats in the rest.

    None where no study that holds has this goal.
    """
    held = np.flatnonzero(points.holds & np.isfinite(goal.values))
    if not len(held):
        return None
    at = held[np.lexsort((~points.front[held], sign * goal.values[held]))[0]]
    return (goal.title, _shown(goal, at), *(_shown(axis, at) for axis in points.varied))


def _shown(axis: Axis, at: int) -> str:
    value = axis.values[at]
    return axis.labels[int(value)] if axis.labels else fmt.trimmed(float(value), 5)


def _trade_offs(points: SweptPoints) -> Section | None:
    front = np.flatnonzero(points.front)
    if len(points.goals) < 2 or not len(front):
        return None
    pairs = list(combinations(points.goals, 2))[:_MOST_PAIRS]
    front = front[np.argsort(points.goals[0].values[front])]
    shown = front[np.unique(np.linspace(0, len(front) - 1, _MOST_POINTS).astype(int))]
    caption = "Pareto-optimal points: none is better by one goal without being worse by another."
    if len(shown) < len(front):
        caption += f" {len(shown)} of {len(front)}, evenly picked; sweep.csv has all points."
    heads = tuple(Column(axis.title) for axis in (*points.varied, *points.goals))
    rows = (tuple(_shown(a, k) for a in (*points.varied, *points.goals)) for k in shown)
    return Section.of(
        "trade-offs",
        "What is traded for what",
        Picture(
            "Goals against each other. Dark: Pareto-optimal points; pale: all others.",
            "",
            svg=figures.trade_offs(pairs, points.front),
        ),
        Table.of(caption, heads, *rows, kind="long"),
    )


def _influences(points: SweptPoints) -> Section | None:
    if not points.kept:
        return None
    kept, varied = points.kept[:_MOST_FIELDS], points.varied[:_MOST_FIELDS]
    colour = (points.goals or points.kept)[0]
    lines = figures.parallel((*points.varied, *points.kept), colour, points.front)
    return Section.of(
        "fields",
        "What each field does",
        Picture(
            "Each result over each field; dark: Pareto-optimal points.",
            "",
            svg=figures.influences(varied, kept, points.front),
        ),
        Picture(
            f"A line for each study over all quantities, coloured by {colour.title}; "
            "Pareto-optimal ones thick.",
            "",
            svg=lines,
        )
        if lines
        else "No study has all of the results that are kept.",
    )


def _reasons(found: xr.Dataset) -> Section | None:
    reasons, counts = np.unique([why for why in found["reason"].values if why], return_counts=True)
    if not len(reasons):
        return None
    order = np.argsort(-counts)[:_MOST_POINTS]
    rows = ((fmt.count(int(counts[k])), str(reasons[k])) for k in order)
    table = Table.of("Studies without an answer, by reason.", (Column("Studies"), "Reason"), *rows)
    return Section.of("reasons", "What has no answer", table)
