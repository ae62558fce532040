"""How long tasks report how far they are, how long they may still take, and when they end."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import AbstractContextManager, contextmanager
from contextvars import ContextVar
from typing import Protocol, TypeVar

Advance = Callable[[int], None]
"""Called with the number of steps done since the last call."""


class Reporter(Protocol):
    """Shows progress: a context for each long task, which hands out a function to advance it."""

    def task(self, name: str, total: int) -> AbstractContextManager[Advance]:
        """Open a task of ``total`` steps."""


class Silent:
    """A reporter that shows nothing."""

    @contextmanager
    def task(self, name: str, total: int) -> Iterator[Advance]:
        """Open a task that nobody watches."""
        yield lambda _: None


SILENT = Silent()


_between: ContextVar[Callable[[], None] | None] = ContextVar("between", default=None)


@contextmanager
def interrupted_by(between: Callable[[], None]) -> Iterator[None]:
    """Have something called between the batches of poses that this thread solves meanwhile.

    It may do other work there, or raise to give up what was begun.
    """
    token = _between.set(between)
    try:
        yield
    finally:
        _between.reset(token)


def checkpoint() -> None:
    """Let go between two batches of poses; see `interrupted_by`."""
    between = _between.get()
    if between is not None:
        between()


Item = TypeVar("Item")
OpenTask = Callable[[str, int], AbstractContextManager[Advance]]
_open_task: ContextVar[OpenTask] = ContextVar("open_task", default=SILENT.task)


@contextmanager
def steps_shown_by(open_task: OpenTask) -> Iterator[None]:
    """Show the loops that this thread runs through `steps` meanwhile."""
    token = _open_task.set(open_task)
    try:
        yield
    finally:
        _open_task.reset(token)


def steps(name: str, items: Iterable[Item]) -> Iterator[Item]:
    """Yield each item, deep inside of a task, and show how far that is; see `steps_shown_by`."""
    items = [*items]
    with _open_task.get()(name, len(items)) as advance:
        for item in items:
            yield item
            advance(1)


class Named(Protocol):
    """What is tried one after the other."""

    @property
    def key(self) -> str:
        """What to call it."""


One = TypeVar("One", bound=Named)


class Pace:
    """Tells what is being tried and how long that will take; leaves out what comes too late.

    Parameters
    ----------
    tell : callable
        Told in one line what is being done.
    time_s : float
        What the search may take [s].
    clock : callable
        Tells the time [s].
    """

    def __init__(
        self,
        tell: Callable[[str], None] = lambda _: None,
        time_s: float = math.inf,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        self._tell, self._clock = tell, clock
        self._end_s = clock() + time_s
        self._left_out: list[str] = []

    def __call__(self, text: str) -> None:
        """Tell what is being done."""
        self._tell(text)

    @property
    def is_over(self) -> bool:
        """Whether the time is spent."""
        return self._clock() >= self._end_s

    @property
    def left_out(self) -> tuple[str, ...]:
        """What was not tried for lack of time, in words."""
        return tuple(self._left_out)

    def leave_out(self, text: str) -> None:
        """Note what is not tried, for lack of time."""
        self._left_out.append(text)

    def each(self, part: str, steps: Sequence[One]) -> Iterator[One]:
        """Yield the steps of a part of the search, telling of each; leave out those too late."""
        start_s = self._clock()
        for count, step in enumerate(steps):
            if self.is_over:
                names = ", ".join(named.key for named in steps[count:])
                self.leave_out(f"{part}: {names if count else 'all'}")
                return
            remaining = self._left(start_s, count, len(steps))
            self._tell(f"{part}, {count + 1} of {len(steps)}: {step.key}{remaining}")
            yield step

    def _left(self, start_s: float, count: int, total: int) -> str:
        """Say how long the rest of a part will take, and the search at most."""
        now_s = self._clock()
        most_s = self._end_s - now_s
        limit = f"{in_words(most_s)} at most" if math.isfinite(most_s) else ""
        rest = f"about {in_words((now_s - start_s) * (total - count) / count)}" if count else ""
        parts = ", ".join(filter(None, (rest, limit)))
        return f" ({parts})" if parts else ""


def in_words(time_s: float) -> str:
    """Return a time as one reads it: 8 s, 3 min 20 s, 1 h 5 min."""
    seconds = round(time_s)
    if seconds < 60:
        return f"{seconds} s"
    if seconds < 3600:
        return f"{seconds // 60} min {seconds % 60} s" if seconds % 60 else f"{seconds // 60} min"
    return f"{seconds // 3600} h {seconds % 3600 // 60} min"
