"""What is asked of a worker, and what comes back."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import Any, Literal

from designer.errors import DesignerError, described
from designer.explore.question import Question
from designer.progress import Advance

Quick = Literal["here", "coarse", "fine", "ropes", "residuals", "worst"]
Long = Literal["select", "diagnose", "export", "optimise", "sweep"]
Kind = Quick | Long
Status = Literal["progress", "done", "failed", "cancelled"]
_REPORT_EVERY_S = 0.1
"""As often as an eye follows; a message costs a thread or a process some time."""


@dataclass(frozen=True, slots=True, eq=False)
class Request:
    """A question of a kind; numbers grow."""

    number: int
    kind: Kind
    question: Question
    options: Mapping[str, Any] = field(default_factory=dict)


@dataclass(frozen=True, slots=True, eq=False)
class Message:
    """What becomes of a request: progress, and exactly one end.

    Parameters
    ----------
    request : Request
        What was asked.
    status : str
        ``progress``; or the end: ``done``, ``failed``, or ``cancelled``, taken back or replaced by
        a newer one.
    answer : Any
        Of a request that is done; None where the study has not what is asked for, such as a
        workspace.
    text : str
        What went wrong, for the user as it stands; of progress what is being done.
    steps, total : int
        Of progress: how many steps are done, and of how many; a total of 0 is not known.
    """

    request: Request
    status: Status
    answer: Any = None
    text: str = ""
    steps: int = 0
    total: int = 0

    @property
    def number(self) -> int:
        """Of the request."""
        return self.request.number

    @property
    def kind(self) -> Kind:
        """Of the request."""
        return self.request.kind

    @property
    def question(self) -> Question:
        """Of the request."""
        return self.request.question

    @property
    def is_end(self) -> bool:
        """Whether no other message follows."""
        return self.status != "progress"


class ThrottledReporter:
    """A reporter, and a spinner, that tell how far something is, a few times a second at most.

    Parameters
    ----------
    tell : callable
        Called with what is being done, how many steps are done, and of how many; 0 of 0 where that
        is not known.
    """

    def __init__(self, tell: Callable[[str, int, int], None]) -> None:
        self._tell, self._last_s = tell, -math.inf

    def __call__(self, text: str) -> None:
        """Tell what is being done."""
        self._report(text, 0, 0)

    @contextmanager
    def task(self, name: str, total: int) -> Iterator[Advance]:
        """Open a task of ``total`` steps."""
        finished, self._last_s = 0, -math.inf

        def advance(steps: int) -> None:
            nonlocal finished
            finished += steps
            self._report(name, finished, total)

        self._report(name, 0, total)
        yield advance

    def _report(self, name: str, steps: int, total: int) -> None:
        now_s = time.monotonic()
        if now_s - self._last_s >= _REPORT_EVERY_S:
            self._last_s = now_s
            self._tell(name, steps, total)


def failure_text(error: BaseException) -> str:
    """Return an error as a user is told of it: our own as they stand, others by their kind."""
    if isinstance(error, DesignerError):
        return str(error)
    return f"unexpected {described(error)}"
