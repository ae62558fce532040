"""What is told of long work where nobody reads on a screen."""

from __future__ import annotations

import io
import time

import numpy as np
import pytest

from designer.cli import commands, terminal
from designer.errors import Fault, InputError, OutputError, described
from designer.progress import checkpoint


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
    assert told[-1].endswith("verification, 0%" if shown == "bars" else "what is left")


def test_share_grows_within_a_step(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """A step of a minute: its batches of poses move the share, which stays below the step's end."""
    now_s = 0.0
    monkeypatch.setattr(terminal.time, "monotonic", lambda: now_s)
    with terminal.ProgressBars() as bars, bars.task("stages", 2), bars.task("search", 4) as advance:
        for _ in range(2):
            for _ in range(60):
                now_s += 1.0
                checkpoint()
            advance(1)
    reported = capsys.readouterr().err.splitlines()
    times = [int(line.split(" s: ")[0]) for line in reported]
    assert np.diff([0, *times]).max() <= 5
    shares = [float(line.split("search, ")[1].split("%")[0]) for line in reported]
    assert all(np.diff(shares[:-1]) > 0.0)
    assert all(share <= 25 for share, time_s in zip(shares, times, strict=True) if time_s < 60)
    checkpoint()  # nothing is shown any more


HOSTILE = "\x1b]0;a\x07\x1b[31m\x9b5m\u202e\r\udc80b"
SHOWN = "?]0;a??[31m?5m?"


@pytest.mark.parametrize(
    "told",
    [
        str(Fault(HOSTILE, 3, HOSTILE, HOSTILE, HOSTILE)),
        str(InputError.at(HOSTILE, "is wrong")),
        described(ValueError(HOSTILE)),
    ],
)
def test_a_message_commands_no_terminal(told: str) -> None:
    assert told.isprintable()
    assert SHOWN in told


def test_the_last_handler_commands_no_terminal(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def refuse() -> None:
        raise OutputError(f"{HOSTILE}: cannot be written\nand more")

    monkeypatch.setattr(commands, "app", refuse)
    with pytest.raises(SystemExit):
        commands.main()
    told = capsys.readouterr().err.splitlines()
    assert [line.isprintable() for line in told] == [True, True]
    assert told[0].startswith(SHOWN)


@pytest.mark.parametrize("is_terminal", [True, False])
def test_tables_and_notes_command_no_terminal(
    monkeypatch: pytest.MonkeyPatch, is_terminal: bool
) -> None:
    console = terminal._Console(
        file=io.StringIO(), force_terminal=is_terminal, color_system=None, width=200
    )
    for name in ("_out", "_notes"):
        monkeypatch.setattr(terminal, name, console)
    table = terminal.bare_table(HOSTILE, title=HOSTILE)
    table.add_row(HOSTILE)
    terminal.show(table)
    terminal.show(HOSTILE, markup=False)
    terminal.print_left_out([HOSTILE, "10\u202fkN\u00a0"])
    told = console.file.getvalue()
    assert all(
        line.replace("\u202f", "").replace("\u00a0", "").isprintable() for line in told.splitlines()
    )
    assert told.count("0;a?") == 5
    assert "10\u202fkN\u00a0" in told


def test_progress_still_moves_the_cursor(monkeypatch: pytest.MonkeyPatch) -> None:
    console = terminal._Console(file=io.StringIO(), force_terminal=True, width=80)
    monkeypatch.setattr(terminal, "_notes", console)
    with terminal.ProgressBars() as bars, bars.task(HOSTILE, 2) as advance:
        bars(HOSTILE)
        advance(1)
    told = console.file.getvalue()
    assert "\x1b[?25l" in told
    assert "\x1b]0;a" not in told
