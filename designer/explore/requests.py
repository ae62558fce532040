"""What is asked of a worker, and what comes back."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Literal

from designer.explore.question import Question

Quick = Literal["here", "coarse", "fine", "ropes", "residuals", "worst"]
Long = Literal["select", "diagnose", "export"]
Kind = Quick | Long


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


def failure_text(error: BaseException) -> str:
    """Return an error as a user is told of it: our own as they stand, others by their kind."""
    from designer.errors import DesignerError

    if isinstance(error, DesignerError):
        return str(error)
    told = " ".join(str(error).split())
    return f"unexpected {type(error).__name__}" + (f": {told}" if told else "")
