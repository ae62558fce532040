"""What is told of long work where nobody reads on a screen."""

from __future__ import annotations

import time

import pytest

from designer.cli import terminal


def test_the_time_left_is_reckoned_from_the_first_step_on(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """A minute of compiling before it would foretell nine more."""
    now_s = 0.0
    monkeypatch.setattr(terminal.time, "monotonic", lambda: now_s)
    bars = terminal.ProgressBars()
    with bars.task("proof", 100) as advance:
        now_s = 60.0
        advance(10)
        now_s = 70.0
        advance(20)
        advance(1)  # a moment later
    told = capsys.readouterr().err.splitlines()
    assert told == ["60 s: proof, 10%", "70 s: proof, 30%, 35 s left"]


def test_the_time_left_follows_the_later_steps(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Ten slow steps, then quick ones: the mean over all would foretell six times too much."""
    now_s = 0.0
    monkeypatch.setattr(terminal.time, "monotonic", lambda: now_s)
    bars = terminal.ProgressBars()
    with bars.task("groups", 400) as advance:
        for step in range(200):
            now_s += 10.0 if step < 10 else 0.5
            advance(1)
    told = capsys.readouterr().err.splitlines()
    left_s = int(told[-1].split(", ")[2].removesuffix(" s left"))
    assert 100 <= left_s <= 110


@pytest.mark.parametrize("shown", ["bars", "spinner"])
def test_work_that_says_nothing_is_told_to_go_on(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], shown: str
) -> None:
    monkeypatch.setattr(terminal, "_TOLD_EVERY_S", 0.02)
    if shown == "bars":
        with terminal.ProgressBars() as bars, bars.task("verification", 1):
            time.sleep(0.5)
    else:
        with terminal.ProgressBars("searching") as spinner:
            spinner("what is left")
            time.sleep(0.5)
    told = capsys.readouterr().err.splitlines()
    assert len(told) > 3
    assert told[-1].endswith("verification" if shown == "bars" else "what is left")
