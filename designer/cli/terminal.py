"""Standard output and error as the commands use them: tables, progress, one-line notes."""

from __future__ import annotations

import math
import sys
import threading
import time
from collections.abc import Iterable, Iterator
from contextlib import ExitStack, contextmanager
from functools import partial

from rich.console import Console, ConsoleOptions, RenderableType
from rich.markup import escape
from rich.progress import (
    BarColumn,
    MofNCompleteColumn,
    Progress,
    SpinnerColumn,
    TaskID,
    TextColumn,
    TimeElapsedColumn,
    TimeRemainingColumn,
)
from rich.segment import Segment
from rich.spinner import Spinner
from rich.table import Table
from rich.text import Text

from designer.errors import visible
from designer.io.process import end_at_closed_pipe, is_terminal
from designer.progress import Advance, interrupted_by, steps_shown_by


class _Console(Console):
    """Ends as other programs do where nobody reads on; rich would give a negative answer."""

    def on_broken_pipe(self) -> None:
        """Be told of a closed pipe."""
        end_at_closed_pipe()

    def render(
        self, renderable: RenderableType, options: ConsoleOptions | None = None
    ) -> Iterator[Segment]:
        """Yield what to print: names in a file, such as of columns, command no terminal."""
        for segment in super().render(renderable, options):
            yield segment if segment.control else segment._replace(text=visible(segment.text))


# A pipe has no width: then tables are as wide as they need to be, not cut at 80 columns. Names may
# hold what rich takes for emoji, such as ":1:".
_out = _Console(highlight=False, emoji=False, width=None if is_terminal(sys.stdout) else 240)
_notes = _Console(stderr=True, highlight=False, emoji=False)
_TOLD_EVERY_S = 5.0
"""Time between lines of progress where output goes to a file."""
_SHOWN_EVERY_S = 0.5
_BATCHES_A_STEP = 30
"""As many batches of poses a first step is taken to have."""
_MOST_SEEN = 1000
"""Steps whose time is kept."""


class _Teller:
    """Writes a line from time to time, also while nothing is heard of the work, in a thread."""

    def __init__(self, text: str) -> None:
        self._began_s = self._told_s = time.monotonic()
        self._text = text
        self._ends = threading.Event()
        self._thread = threading.Thread(target=self._run, daemon=True)

    def begin(self) -> None:
        self._thread.start()

    def end(self) -> None:
        self._ends.set()

    def __call__(self, text: str) -> None:
        """Take in a new text, and write it unless something was written a moment ago."""
        self._text = text
        now_s = time.monotonic()
        if text and now_s - self._told_s >= _TOLD_EVERY_S:
            self._told_s = now_s
            _notes.print(f"{now_s - self._began_s:.0f} s: {text}", markup=False, soft_wrap=True)

    def _run(self) -> None:
        while not self._ends.wait(_TOLD_EVERY_S / 4.0):
            self(self._text)


class ProgressBars(Progress):
    """Context manager that shows a bar for each task, and what is being done, on standard error.

    It is called with the latter, a line at a time. Where nobody reads on a screen, a line is
    written from time to time.
    """

    def __init__(self, text: str = "") -> None:
        self._line = Spinner("dots", Text(text))
        self._teller = None if _notes.is_terminal else _Teller(text)
        self._stages: list[_Stage] = []
        self._watch = ExitStack()
        super().__init__(
            SpinnerColumn(),
            TextColumn("{task.description:<10}", markup=False),
            BarColumn(),
            MofNCompleteColumn(),
            TimeElapsedColumn(),
            TimeRemainingColumn(),
            console=_notes,
            disable=not _notes.is_terminal,
        )

    def start(self) -> None:
        """Begin to show."""
        super().start()
        self._watch.enter_context(interrupted_by(self._count_batch))
        self._watch.enter_context(steps_shown_by(partial(self.task, stays=False)))
        if self._teller is not None:
            self._teller.begin()

    def stop(self) -> None:
        """Leave the bars where they are, and nothing else."""
        self._watch.close()
        self._line.text = Text("")
        super().stop()
        if self._teller is not None:
            self._teller.end()

    def get_renderables(self) -> Iterator[RenderableType]:
        """Yield the bars, and below them what is being done."""
        if self.tasks:
            yield from super().get_renderables()
        if self._line.text:
            yield self._line

    def __call__(self, text: str) -> None:
        """Tell what is being done."""
        self._line.text = Text(text)
        if self._teller is not None:
            self._teller(text)

    @contextmanager
    def task(self, name: str, total: int, *, stays: bool = True) -> Iterator[Advance]:
        """Open a task of ``total`` steps; yields the function that advances it.

        Its bar ``stays`` where it is when it ends.
        """
        stage = _Stage(self, self.add_task(name, total=total), name, total)
        self._stages.append(stage)
        try:
            yield stage.advance
        finally:
            self._stages.remove(stage)
        if stays:
            self.update(stage.bar, completed=total, total=total)
        else:
            self.remove_task(stage.bar)
        self.report(self._stages[-1].words if self._stages else "")

    def report(self, words: str) -> None:
        """Write how far a task is, where nobody reads on a screen."""
        if self._teller is not None:
            self._teller(words)

    def _count_batch(self) -> None:
        if self._stages:
            self._stages[-1].batch()


class _Stage:
    """How far a task is, also within a step, by the batches of poses that are solved in it.

    How many a step takes is not known before. After n of them, with the mean m of the steps before
    and x = log(1 + n / m), x / (1 + x) of it counts: never all, and never for long the same.
    """

    def __init__(self, bars: ProgressBars, bar: TaskID, name: str, total: int) -> None:
        self.bar, self.words = bar, f"{name}, 0%"
        self._bars, self._name, self._total, self._pace = bars, name, max(total, 1), _Pace()
        self._n_done = self._n_batches = self._n_batches_before = 0
        self._shown_s = self._ends_s = -math.inf
        bars.report(self.words)

    def advance(self, steps: int) -> None:
        self._n_done += steps
        self._n_batches_before += self._n_batches
        self._n_batches = 0
        share = min(self._n_done / self._total, 1.0)
        left_s = self._pace.left_s(share)
        self._ends_s = -math.inf if left_s is None else time.monotonic() + left_s
        self._show(self._n_done, f"{share:.0%}")

    def batch(self) -> None:
        self._n_batches += 1
        if time.monotonic() - self._shown_s < _SHOWN_EVERY_S or self._n_done >= self._total:
            return
        mean = self._n_batches_before / self._n_done if self._n_done else _BATCHES_A_STEP
        x = math.log1p(self._n_batches / max(mean, 1.0))
        n_done = self._n_done + x / (1.0 + x)
        self._show(n_done, f"{n_done / self._total:.1%}")

    def _show(self, n_done: float, share: str) -> None:
        self._shown_s = time.monotonic()
        left_s = self._ends_s - self._shown_s
        remaining = f", {left_s:.0f} s left" if left_s >= 0.0 else ""
        self.words = f"{self._name}, {share}{remaining}"
        self._bars.update(self.bar, completed=n_done)
        self._bars.report(self.words)


class _Pace:
    """How long a task may still take, by the later half of the time since its first step.

    What is compiled before that step says nothing of the others, and early steps less than late
    ones: what was tried first may have taken longest.
    """

    def __init__(self) -> None:
        self._seen: list[tuple[float, float]] = []

    def left_s(self, share: float) -> float | None:
        """Return the time left at a share that is done; None where nothing tells it yet."""
        now_s = time.monotonic()
        self._seen.append((now_s, share))
        if len(self._seen) > _MOST_SEEN:
            del self._seen[1:-1:2]
        middle_s = 0.5 * (self._seen[0][0] + now_s)
        earlier = [sample for sample in self._seen if sample[0] <= middle_s]
        then_s, then = earlier[-1]
        return (now_s - then_s) * (1.0 - share) / (share - then) if share > then else None


def bare_table(*headings: str, title: str | None = None) -> Table:
    """Return an empty table whose headings and title are printed as they are, brackets and all."""
    heading = None if title is None else escape(title)
    return Table(
        *map(escape, headings), title=heading, title_justify="left", show_header=bool(headings)
    )


def show(content: Table | str, *, markup: bool = True, soft_wrap: bool = False) -> None:
    """Print a table, or a line, which may have rich's markup, on standard output."""
    _out.print(content, markup=markup, soft_wrap=soft_wrap)


def announce_compiling(*, proves: bool = False) -> None:
    """Say when the solver has to be compiled, so that the seconds of a first run are no surprise.

    Which parts of it a study needs shows only as it runs, so the note comes when one is compiled.
    Where a proof follows, another process begins with what that needs.
    """
    from designer.kernel.compiling import tell_of_compiling

    def tell() -> None:
        _notes.print("Compiling what this needs of the solver: once, a minute or two …")
        if proves:
            from designer.proof.ahead import compile_apart

            compile_apart()

    tell_of_compiling(
        tell,
        lambda file: _notes.print(
            f"{file} cannot be read: compiled again", markup=False, soft_wrap=True
        ),
    )


def print_left_out(problems: Iterable[str]) -> None:
    """Name every plugin, grade or effect that was left out, one line each."""
    for problem in problems:
        _notes.print(problem, markup=False, soft_wrap=True)
