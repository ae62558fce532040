"""Which answers that are shown are of an older state of the study, and since when."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING

from PySide6.QtCore import QObject, QTimer, Signal

if TYPE_CHECKING:
    from designer.explore.question import Question

_OLD_MS = 200
"""A shorter time of an older state is no matter: answers come many times a second."""


class Ages(QObject):
    """Ages of what is shown, by its name: the kind of an answer, or ``map``."""

    changed = Signal()
    """Something has become old."""

    def __init__(self) -> None:
        super().__init__()
        self.outdated: frozenset[str] = frozenset()
        """What is of an older state, and has been for a while; the same until ``changed``."""
        self._states: dict[str, object] = {}
        self._old_since_s: dict[str, float] = {}
        self._timer = QTimer(self, singleShot=True)
        self._timer.timeout.connect(self._tell)

    @property
    def is_waiting(self) -> bool:
        """Whether something may become old by itself."""
        return self._timer.isActive()

    def renew(self, aspect: str, question: Question, present: Question | None) -> None:
        """Take in that the answer to a question is shown."""
        self._states[aspect] = _state_of(aspect, question)
        self._freshen(aspect)
        if present is not None:
            self._compare(aspect, present, time.monotonic())

    def follow(self, present: Question) -> None:
        """Compare all that is shown with the present state."""
        now_s = time.monotonic()  # one change makes all of them old at once
        for aspect in self._states:
            self._compare(aspect, present, now_s)

    def _compare(self, aspect: str, present: Question, now_s: float) -> None:
        if self._states[aspect] == _state_of(aspect, present):
            self._freshen(aspect)
        elif aspect not in self._old_since_s:
            self._old_since_s[aspect] = now_s
            if not self._timer.isActive():  # else a slider that goes on moving would put it off
                self._timer.start(_OLD_MS)

    def _freshen(self, aspect: str) -> None:
        self._old_since_s.pop(aspect, None)
        self.outdated -= {aspect}

    def _tell(self) -> None:
        """Say what is old by now, and wait for the rest: a timer may come a little early."""
        before_s = time.monotonic() - _OLD_MS * 1e-3
        since = self._old_since_s.items()
        self.outdated = frozenset(aspect for aspect, since_s in since if since_s <= before_s)
        if len(self.outdated) < len(since):
            self._timer.start(_OLD_MS // 10)
        self.changed.emit()

    def forget(self) -> None:
        """Take in that nothing is shown any more."""
        self._timer.stop()
        self.outdated = frozenset()
        self._states.clear()
        self._old_since_s.clear()


def _state_of(aspect: str, question: Question) -> object:
    """Return what an answer depends on of the state of the window."""
    if aspect == "here":
        return question.text, question.rope, question.place.tobytes()
    if aspect in ("map", "worst"):
        return question.text, question.rope
    return question.text
