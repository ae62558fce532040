"""Steps that can be undone and done again."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Generic, TypeVar

State = TypeVar("State")
_MOST_STEPS = 1000


@dataclass(slots=True)
class Step(Generic[State]):
    """The states before and after something that has a name; ``key`` of what may go on with it."""

    label: str
    before: State
    after: State
    key: object = None


@dataclass(slots=True)
class History(Generic[State]):
    """The present state, and the steps that led to it."""

    state: State
    done: list[Step[State]] = field(default_factory=list)
    undone: list[Step[State]] = field(default_factory=list)

    def take(self, label: str, state: State, key: object) -> None:
        """Go on to another state; with the key of the last step as part of that step."""
        before, self.state = self.state, state
        last = self.done[-1] if self.done else None
        if key is not None and last is not None and last.key == key:
            last.after = state
        else:
            self.done.append(Step(label, before, state, key))
            del self.done[:-_MOST_STEPS]
        self.undone.clear()

    def settle(self) -> None:
        """Let nothing go on with the last step."""
        if self.done:
            self.done[-1].key = None

    def undo(self) -> None:
        """Take the last step back, if there is one."""
        if self.done:
            step = self.done.pop()
            self.undone.append(step)
            self.state, step.key = step.before, None
            self.settle()

    def redo(self) -> None:
        """Take the step again that was taken back last, if there is one."""
        if self.undone:
            step = self.undone.pop()
            self.settle()
            self.done.append(step)
            self.state = step.after
