"""What is told of long work where nobody reads on a screen."""

from __future__ import annotations

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
