"""The pages of a sweep."""

from __future__ import annotations

from datetime import datetime
from pathlib import Path

import numpy as np
from sweep_cases import SWEEP, written
from test_sweep_run import swept

from designer.report.blocks import Picture, Statement
from designer.report.sweep import pareto_front, sweep_report
from designer.sweep.store import read_store


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


def test_numbers_and_texts_have_their_place(tmp_path: Path) -> None:
    sweep = SWEEP.replace("[4, 12, 5]", "[4, 12, 5 m]") + "maximise: [pose.limit_ratio]\n"
    sweep = sweep.replace("pose.sagging.status]", "pose.sagging.status, pose.limit_ratio]")
    swept(written(tmp_path, sweep), tmp_path / "out.zarr")
    page = sweep_report(read_store(tmp_path / "out.zarr"), "masses", datetime.now().astimezone())
    assert [section.id for section in page.sections] == ["answer", "fields", "reasons"]
    head = page.section("answer").blocks[0]
    assert isinstance(head, Statement)
    assert head.title == "66.7\N{NO-BREAK SPACE}% of the studies have an answer"
    picture = page.section("fields").blocks[0]
    assert isinstance(picture, Picture)
    assert "5 m" in picture.svg
    assert "robot.platform.mass" in picture.svg.replace("\n", "")
