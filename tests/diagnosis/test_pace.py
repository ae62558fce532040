"""How a search tells how far it is, and what it does where its time is spent."""

from __future__ import annotations

import io
from dataclasses import dataclass, replace

import pytest
from report_parts import diagnosis_page
from rich.console import Console
from twins.dataset import make, size_for
from twins.robots import YARD3

from designer.cli import terminal
from designer.diagnosis.case import Case, case_of
from designer.diagnosis.diagnose import diagnose
from designer.io.config import read_study
from designer.measured.read import read_measured
from designer.progress import Pace, in_words


@dataclass
class Clock:
    """A clock that moves when it is told to."""

    now_s: float = 0.0

    def __call__(self) -> float:
        return self.now_s


@dataclass
class Step:
    key: str


STEPS = [Step("a"), Step("b"), Step("c"), Step("d")]


def test_time_left_follows_from_the_steps_done() -> None:
    told: list[str] = []
    clock = Clock()
    for _ in Pace(told.append, 600.0, clock).each("round 1", STEPS):
        clock.now_s += 30.0
    assert told[0] == "round 1, 1 of 4: a (10 min at most)"
    assert told[2] == "round 1, 3 of 4: c (about 1 min, 9 min at most)"


def test_what_comes_too_late_is_named() -> None:
    clock = Clock()
    pace = Pace(time_s=50.0, clock=clock)
    tried = []
    for step in pace.each("round 1", STEPS):
        tried.append(step.key)
        clock.now_s += 30.0
    assert tried == ["a", "b"]
    assert list(pace.each("round 2", STEPS)) == []
    assert pace.left_out == ("round 1: c, d", "round 2: all")


@pytest.mark.parametrize(
    ("time_s", "text"),
    [(8.4, "8 s"), (120.0, "2 min"), (200.0, "3 min 20 s"), (3900.0, "1 h 5 min")],
)
def test_times_in_words(time_s: float, text: str) -> None:
    assert in_words(time_s) == text


def case_with(time_s: float, folder) -> Case:
    effect = {"platform_mass": YARD3.draw("platform_mass", size_for(YARD3, "platform_mass", 10.0))}
    make(YARD3, effect).write(folder)
    study = read_study(folder / "config.yaml")
    measurements = replace(study.measurements, search_time_s=time_s)
    return case_of(replace(study, measurements=measurements), measurements, read_measured(study))


@pytest.mark.slow
def test_a_search_without_time_says_what_it_did_not_try(tmp_path) -> None:
    found = diagnose(case_with(0.0, tmp_path))
    assert found.findings == ()
    assert found.not_tried[0] == "round 1: all"
    assert found.to_dict()["search"]["is_complete"] is False
    assert "round 1: all" in diagnosis_page(found).sureness[0].text
    # What is left of the data is tested all the same.
    assert found.is_unexplained


@pytest.mark.slow
def test_time_may_end_between_two_rounds(tmp_path, monkeypatch) -> None:
    """What was found in the rounds before stays, and no claim is made on its rivals."""
    clock = Clock()
    began = Pace.each

    def each(self, part, steps):
        clock.now_s += 1000.0 * (part == "round 2")
        return began(self, part, steps)

    monkeypatch.setattr(Pace, "each", each)
    monkeypatch.setattr(Pace.__init__, "__defaults__", (lambda _: None, 0.0, clock))
    found = diagnose(case_with(600.0, tmp_path))
    assert [finding.effect.key for finding in found.findings] == ["platform_mass"]
    assert found.not_tried == ("round 2: all", "rivals of platform_mass: all")
    assert "Rivals: none in the list" not in {
        statement.title for statement in diagnosis_page(found).sureness
    }


@pytest.mark.slow
def test_what_is_not_tested_on_unseen_rows_is_no_finding(tmp_path, monkeypatch) -> None:
    clock = Clock()
    began = Pace.each

    def each(self, part, steps):
        yield from began(self, part, steps)
        clock.now_s += 1000.0

    monkeypatch.setattr(Pace, "each", each)
    monkeypatch.setattr(Pace.__init__, "__defaults__", (lambda _: None, 0.0, clock))
    found = diagnose(case_with(600.0, tmp_path))
    assert found.findings == ()
    assert found.not_tried == ("platform_mass and below on rows not seen",)
    assert not found.steps[0].is_complete


def test_lines_of_progress_where_nobody_looks(monkeypatch) -> None:
    clock, written = Clock(), io.StringIO()
    monkeypatch.setattr(terminal, "_notes", Console(file=written, force_terminal=False))
    monkeypatch.setattr(terminal.time, "monotonic", clock)
    with terminal.ProgressBars("searching") as spinner:
        for step in range(12):
            clock.now_s = float(step)
            spinner(f"step {step}")
    assert written.getvalue() == "5 s: step 5\n10 s: step 10\n"


def test_bars_are_lines_with_the_time_left_where_nobody_looks(monkeypatch) -> None:
    clock, written = Clock(), io.StringIO()
    monkeypatch.setattr(terminal, "_notes", Console(file=written, force_terminal=False))
    monkeypatch.setattr(terminal.time, "monotonic", clock)
    with terminal.ProgressBars() as bars:
        for name in ("workspace", "drawing"):
            with bars.task(name, 8) as advance:
                for _ in range(8):
                    clock.now_s += 1.5
                    advance(1)
    assert written.getvalue().splitlines() == [
        "6 s: workspace, 50%, 6 s left",
        "12 s: workspace, 100%, 0 s left",
        "18 s: drawing, 50%, 6 s left",
        "24 s: drawing, 100%, 0 s left",
    ]
