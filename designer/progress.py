"""How long tasks tell how far they are."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager
from contextvars import ContextVar
from typing import Protocol

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
