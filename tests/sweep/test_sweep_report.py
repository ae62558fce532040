"""The pages of a sweep."""

from __future__ import annotations

from collections.abc import Sequence
from datetime import datetime
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from report_parts import pictures, statements, tables
from sweep_cases import SWEEP, written
from test_sweep_run import swept

from designer.report.document import Report
from designer.sweeps.report import NOT_EVALUATED, pareto_front, sweep_report
from designer.sweeps.run import read_store


def page_of(
    a: Sequence[float], b: Sequence[float], goals: tuple[str, str], reason: str = ""
) -> Report:
    """Return the page on points 0, 1, 2 … with two results."""
    kept = {
        name: ("point", np.array(values, float), {"role": "kept", "goal": goal})
        for name, values, goal in zip("ab", (a, b), goals, strict=True)
    }
    varied = {"x": ("point", np.arange(float(len(a))), {"role": "varied"})}
    reasons = {"reason": ("point", np.array([reason] * len(a), dtype=object))}
    found = xr.Dataset({**varied, **kept, **reasons})
    return sweep_report(found, "few", datetime.now().astimezone())


def best_of(page: Report) -> list[tuple[str, ...]]:
    best = [table for table in tables(page) if table.caption.startswith("The best point")]
    return [row.cells for table in best for group in table.groups for row in group.rows]


def test_the_best_of_a_goal_that_is_maximised_is_its_largest() -> None:
    page = page_of([1, 2, 3], [10, 20, 30], ("minimise", "maximise"))  # all are on the front
    assert best_of(page) == [("a", "1", "0"), ("b", "30", "2")]


def test_results_that_no_point_has_together_and_points_that_all_fail() -> None:
    nan = np.nan
    page = page_of([5, 4, nan, nan], [nan, nan, 7, 6], ("minimise", "minimise"))
    assert best_of(page) == [("a", "4", "1"), ("b", "6", "3")]
    page = page_of([5, 4], [1, 2], ("minimise", "minimise"), "no rope holds as asked")
    assert best_of(page) == []


def test_the_front_is_what_nothing_beats() -> None:
    rng = np.random.default_rng(4)
    values = rng.integers(0, 12, (300, 3)).astype(float)
    values[rng.random(300) < 0.1] = np.nan
    counts = rng.random(300) < 0.9
    beaten = [
        any((v <= one).all() and (v < one).any() for v in values[counts] if not np.isnan(v).any())
        for one in values
    ]
    expected = counts & ~np.isnan(values).any(axis=1) & ~np.array(beaten)
    assert 1 < expected.sum() < 100
    assert pareto_front(values, counts).tolist() == expected.tolist()


@pytest.mark.slow
def test_numbers_and_texts_have_their_place(tmp_path: Path) -> None:
    sweep = SWEEP.replace("[4, 12, 5]", "[4, 12, 5 m]") + "maximise: [pose.limit_ratio]\n"
    sweep = sweep.replace("pose.sagging.status]", "pose.sagging.status, pose.limit_ratio]")
    swept(written(tmp_path, sweep), tmp_path / "out.zarr")
    page = sweep_report(read_store(tmp_path / "out.zarr"), "masses", datetime.now().astimezone())
    assert [section.id for section in page.sections] == ["answer", "fields", "reasons"]
    head = statements(page)["66.7\N{NO-BREAK SPACE}% of the studies are solved"]
    assert NOT_EVALUATED in head.text
    picture = pictures(page)[0]
    assert "5 m" in picture.svg
    assert "robot.platform.mass" in picture.svg.replace("\n", "")
