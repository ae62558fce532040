"""Standard output and error as the commands use them: tables, progress, one-line notes."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager

from rich.console import Console
from rich.markup import escape
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn
from rich.table import Table
from rich.text import Text

from designer.io.process import end_at_closed_pipe, is_terminal


class _Console(Console):
    """Ends as other programs do where nobody reads on; rich would give a negative answer."""

    def on_broken_pipe(self) -> None:
        """Be told of a closed pipe."""
        end_at_closed_pipe()


# A pipe has no width: then tables are as wide as they need to be, not cut at 80 columns. Names may
# hold what rich takes for emoji, such as ":1:".
_out = _Console(highlight=False, emoji=False, width=None if is_terminal(sys.stdout) else 240)
_notes = _Console(stderr=True, highlight=False, emoji=False)
_TOLD_EVERY_S = 5.0
"""Time between lines of progress where output goes to a file."""


class ProgressBars:
    """Context manager that shows one bar a task on standard error.

    Where nobody reads on a screen, a line is written from time to time.
    """

    def __init__(self) -> None:
        self._began_s = self._told_s = time.monotonic()
        self._progress = Progress(
            TextColumn("{task.description:<10}", markup=False),
            BarColumn(),
            MofNCompleteColumn(),
            TimeRemainingColumn(),
            console=_notes,
            disable=not _notes.is_terminal,
        )

    def __enter__(self) -> ProgressBars:
        self._progress.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._progress.stop()

    @contextmanager
    def task(self, name: str, total: int) -> Iterator[Callable[[int], None]]:
        """Open a task of ``total`` steps; yields the function that advances it."""
        bar = self._progress.add_task(name, total=total)
        done, first = 0, (0.0, 0.0)

        def advance(steps: int) -> None:
            nonlocal done, first
            done += steps
            self._progress.advance(bar, steps)
            share = min(done / max(total, 1), 1.0)
            if first[1] == 0.0:  # what is compiled before the first step says nothing of the others
                first = time.monotonic(), share
            if not _notes.is_terminal:
                self._tell(name, share, *first)

        yield advance
        self._progress.update(bar, completed=total, total=total)

    def _tell(self, name: str, share: float, first_s: float, first_share: float) -> None:
        """Write how far a task is, unless that was told a moment ago."""
        now_s = time.monotonic()
        if now_s - self._told_s < _TOLD_EVERY_S or share == 0.0:
            return
        self._told_s = now_s
        text = f"{now_s - self._began_s:.0f} s: {name}, {share:.0%}"
        if share > first_share:
            left_s = (now_s - first_s) * (1.0 - share) / (share - first_share)
            text += f", {left_s:.0f} s left"
        _notes.print(text, markup=False, soft_wrap=True)


class Spinner:
    """Context manager that shows what is being tried; call it with a new text.

    Where nobody reads on a screen, a line is written from time to time.
    """

    def __init__(self, text: str) -> None:
        self._status = _notes.status(Text(text)) if _notes.is_terminal else None
        self._began_s = self._told_s = time.monotonic()

    def __enter__(self) -> Spinner:
        if self._status is not None:
            self._status.start()
        return self

    def __exit__(self, *_: object) -> None:
        if self._status is not None:
            self._status.stop()

    def __call__(self, text: str) -> None:
        """Show another text."""
        now_s = time.monotonic()
        if self._status is not None:
            self._status.update(Text(text))
        elif now_s - self._told_s >= _TOLD_EVERY_S:
            self._told_s = now_s
            _notes.print(f"{now_s - self._began_s:.0f} s: {text}", markup=False, soft_wrap=True)


def bare_table(*headings: str, title: str | None = None) -> Table:
    """Return an empty table whose headings and title are printed as they are, brackets and all."""
    shown = None if title is None else escape(title)
    return Table(
        *map(escape, headings), title=shown, title_justify="left", show_header=bool(headings)
    )


def show(shown: Table | str, *, markup: bool = True, soft_wrap: bool = False) -> None:
    """Print a table, or a line, which may have rich's markup, on standard output."""
    _out.print(shown, markup=markup, soft_wrap=soft_wrap)


def announce_compiling() -> None:
    """Say when the solver has to be compiled, so that the seconds of a first run are no surprise.

    Which parts of it a study needs shows only as it runs, so the note comes when one is compiled.
    """
    from designer.kernel.compiling import tell_of_compiling

    tell_of_compiling(
        lambda: _notes.print("Compiling what this needs of the solver: once, up to a minute …")
    )


def print_left_out(problems: Iterable[str]) -> None:
    """Name every plugin, grade or effect that was left out, one line each."""
    for problem in problems:
        _notes.print(problem, markup=False, soft_wrap=True)
