"""What a step may change, and steps that can be undone and done again."""

from __future__ import annotations

from dataclasses import dataclass, field

from designer.arrays import FloatArray
from designer.errors import Fault
from designer.explore.question import Rope, RopePerCable
from designer.explore.reading import Reading


@dataclass(frozen=True, slots=True, eq=False)
class SessionState:
    """All that a step may change.

    Parameters
    ----------
    reading : Reading
        The text, and what it is.
    live : Reading
        The same, or, where the text is faulty, what was sound last; where nothing ever was, the
        text.
    place : array (6,)
        Where the platform is, and its rotation vector [m, rad].
    rope : Rope, RopePerCable or None
        The rope, or the ropes of groups, that are looked at.
    pin : object
        What the present state is compared with; None for nothing.
    """

    reading: Reading
    live: Reading
    place: FloatArray
    rope: Rope | RopePerCable | None = None
    pin: object = None


@dataclass(frozen=True, slots=True)
class Rejected:
    """An entry that was refused: what was typed, and why."""

    text: str
    faults: tuple[Fault, ...]


_MOST_STEPS = 1000
"""Some hours of edits; each holds a text and what was read of it."""


@dataclass(slots=True)
class HistoryStep:
    """The states before and after something that has a name; ``key`` of what may go on with it."""

    label: str
    before: SessionState
    after: SessionState
    key: object = None


@dataclass(slots=True)
class History:
    """The present state, and the steps that led to it."""

    state: SessionState
    done: list[HistoryStep] = field(default_factory=list)
    undone: list[HistoryStep] = field(default_factory=list)

    def take(self, label: str, state: SessionState, key: object) -> None:
        """Go on to another state; with the key of the last step as part of that step."""
        before, self.state = self.state, state
        last = self.done[-1] if self.done else None
        if key is not None and last is not None and last.key == key:
            last.after = state
        else:
            self.done.append(HistoryStep(label, before, state, key))
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
