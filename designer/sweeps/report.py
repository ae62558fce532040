"""A sweep as a document: what is best, what is traded for what, what each field does."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from datetime import datetime
from itertools import combinations
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from designer.analysis.result_json import evaluates_answer
from designer.arrays import BoolArray, FloatArray
from designer.documents.plain import csv_text
from designer.io.output import write_whole
from designer.report.document import Report, Section, vector
from designer.report.render import write_pages
from designer.sweeps import figures
from designer.sweeps.figures import Axis

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
    def of(cls, dataset: xr.Dataset) -> SweptPoints:
        """Return the points of a store, read whole."""

        def axes(role: str) -> dict[str, Axis]:
            arrays = dataset.filter_by_attrs(role=role).items()
            return {str(k): Axis.of(str(k), unit_of(v.attrs), v.values) for k, v in arrays}

        kept = axes("kept")
        numbers = {name: axis for name, axis in kept.items() if not axis.labels}
        numbers = {k: v for k, v in numbers.items() if np.isfinite(v.values).any()}
        holds = np.asarray(dataset["reason"].values == "")
        signs = {"minimise": 1.0, "maximise": -1.0}
        goals = {k: signs[dataset[k].goal] for k in numbers if "goal" in dataset[k].attrs}
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


def unit_of(attributes: Mapping[str, str]) -> str:
    """Return the unit of a variable of a store, and whether it is an estimate."""
    estimated = "estimated" if "estimate" in attributes else ""
    return ", ".join(filter(None, (attributes.get("units", ""), estimated)))


def pareto_front(values: FloatArray, counts: BoolArray) -> BoolArray:
    """Return which points no other one beats in every column, less being better.

    Parameters
    ----------
    values : ndarray, shape (n_points, n_goals)
        NaN for a point that has none.
    counts : ndarray of bool, shape (n_points,)
        Points that are looked at.
    """
    candidates = np.flatnonzero(counts & np.isfinite(values).all(axis=1))
    candidates = candidates[np.lexsort(values[candidates].T[::-1])]
    front = np.zeros(len(values), bool)
    while len(candidates):
        best, rest = values[candidates[0]], values[candidates]
        front[candidates[(rest == best).all(axis=1)]] = True
        candidates = candidates[(rest < best).any(axis=1)]
    return front


def sweep_report(dataset: xr.Dataset, name: str, created: datetime) -> Report:
    """Return the document on a store, of a sweep called ``name``."""
    points = SweptPoints.of(dataset)
    reasons = Counter(sorted(reason for reason in dataset["reason"].values if reason))
    contexts = {
        "answer": _overview(dataset, points),
        "trade-offs": _trade_offs(points),
        "fields": _influences(points),
        "reasons": {"reasons": reasons.most_common(_MOST_POINTS)} if reasons else None,
    }
    sections = (Section(key, context=value) for key, value in contexts.items() if value)
    return Report.of("sweep", name, "Sweep over a study", created, sections)


def write_sweep(
    dataset: xr.Dataset, name: str, folder: Path, templates: Path | None = None
) -> None:
    """Write ``sweep.html``, ``sweep.pdf`` and ``sweep.csv`` into an existing folder."""
    write_pages(sweep_report(dataset, name, datetime.now().astimezone()), folder, templates)
    write_whole(folder / "sweep.csv", _table(dataset).encode())


def _table(dataset: xr.Dataset) -> str:
    """Return all points as CSV."""
    table = dataset.to_dataframe().reset_index()
    rows = table.itertuples(index=False)
    return csv_text([table.columns, *([None if x != x else x for x in row] for row in rows)])  # noqa: PLR0124


def _overview(dataset: xr.Dataset, points: SweptPoints) -> Mapping[str, object]:
    kept = (str(name) for name in dataset.filter_by_attrs(role="kept"))
    return {
        "studies": len(points.holds),
        "holding": int(points.holds.sum()),
        "fields": [axis.title for axis in points.varied],
        "not_evaluated": "" if evaluates_answer(kept) else NOT_EVALUATED,
        "field_heads": _heads(points.varied),
        "best": [
            [goal.title, goal.text(at), *(axis.text(at) for axis in points.varied)]
            for goal, sign in zip(points.goals, points.signs, strict=True)
            for at in _best(points, goal, sign)
        ],
    }


def _heads(axes: Sequence[Axis]) -> list[tuple[str, str]]:
    return [(axis.title, "") for axis in axes]


def _best(points: SweptPoints, goal: Axis, sign: float) -> list[int]:
    """Return the best point by one goal, of equals one that no other beats in the rest.

    Empty where no study that holds has this goal.
    """
    held = np.flatnonzero(points.holds & np.isfinite(goal.values))
    order = np.lexsort((~points.front[held], sign * goal.values[held]))
    return [int(held[at]) for at in order[:1]]


def _trade_offs(points: SweptPoints) -> Mapping[str, object] | None:
    front = np.flatnonzero(points.front)
    if len(points.goals) < 2 or not len(front):
        return None
    pairs = list(combinations(points.goals, 2))[:_MOST_PAIRS]
    front = front[np.argsort(points.goals[0].values[front])]
    rows = front[np.unique(np.linspace(0, len(front) - 1, _MOST_POINTS).astype(int))]
    axes = (*points.varied, *points.goals)
    return {
        "chart": vector(figures.trade_offs(pairs, points.front)),
        "front": len(front),
        "heads": _heads(axes),
        "rows": [[axis.text(at) for axis in axes] for at in rows],
    }


def _influences(points: SweptPoints) -> Mapping[str, object] | None:
    if not points.kept:
        return None
    kept, varied = points.kept[:_MOST_FIELDS], points.varied[:_MOST_FIELDS]
    colour = (points.goals or points.kept)[0]
    lines = figures.parallel((*points.varied, *points.kept), colour, points.front)
    return {
        "influences": vector(figures.influences(varied, kept, points.front)),
        "parallel": vector(lines or None),
        "colour": colour.title,
    }
