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
Long = Literal["select", "diagnose", "export"]
Kind = Quick | Long
_TOLD_EVERY_S = 0.1


@dataclass(frozen=True, slots=True, eq=False)
class Request:
    """A question of a kind; numbers grow."""

    number: int
    kind: Kind
    question: Question
    options: Mapping[str, Any] = field(default_factory=dict)


@dataclass(frozen=True, slots=True, eq=False)
class Delivery:
    """What becomes of a request; each comes to exactly one end: done, failed or cancelled."""

    request: Request

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


@dataclass(frozen=True, slots=True, eq=False)
class Done(Delivery):
    """The answer; None where the study has not what is asked for, such as a workspace."""

    answer: Any


@dataclass(frozen=True, slots=True, eq=False)
class Failed(Delivery):
    """What went wrong, for the user as it stands."""

    text: str


@dataclass(frozen=True, slots=True, eq=False)
class Cancelled(Delivery):
    """It was taken back, or a newer one took its place."""


@dataclass(frozen=True, slots=True, eq=False)
class Progress(Delivery):
    """What is being done, and how far it is; ``total`` is 0 where that is not known."""

    task: str
    done: int
    total: int


class Told:
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
        self._tell_now_and_then(text, 0, 0)

    @contextmanager
    def task(self, name: str, total: int) -> Iterator[Advance]:
        """Open a task of ``total`` steps."""
        done, self._last_s = 0, -math.inf

        def advance(steps: int) -> None:
            nonlocal done
            done += steps
            self._tell_now_and_then(name, done, total)

        self._tell_now_and_then(name, 0, total)
        yield advance

    def _tell_now_and_then(self, name: str, done: int, total: int) -> None:
        now_s = time.monotonic()
        if now_s - self._last_s >= _TOLD_EVERY_S:
            self._last_s = now_s
            self._tell(name, done, total)


def failure_text(error: BaseException) -> str:
    """Return an error as a user is told of it: our own as they stand, others by their kind."""
    if isinstance(error, DesignerError):
        return str(error)
    return f"unexpected {described(error)}"
