"""Between session and worker: asks anew whatever has changed, and hands the answers on.

It computes nothing. While something moves, the pose and a coarse map are asked for; when it rests,
the whole map and the candidates.
"""

from __future__ import annotations

import sys
import time
from typing import Any, get_args

from PySide6.QtCore import QObject, Qt, QTimer, Signal

from designer.explore.question import Question
from designer.explore.requests import Delivery, Done, Failed, Kind, Long, Progress
from designer.explore.worker import Worker

_REST_MS = 250
_OLD_MS = 200
"""A shorter time of an older state is no matter: answers come many times a second."""
_SHOWN_AS: dict[Kind, tuple[str, ...]] = {
    "coarse": ("map",),
    "fine": ("map",),
    "select": ("select", "ropes"),
}
"""What an answer is shown as, where that is not its kind."""
LONG: tuple[Long, ...] = get_args(Long)
"""What takes long: with progress, and cancelled by hand."""
NAMES: dict[str, str] = {
    "here": "the pose",
    "coarse": "the map",
    "fine": "the map",
    "worst": "the worst pose",
    "ropes": "the candidates",
    "select": "the full selection",
    "residuals": "the residuals",
    "diagnose": "the diagnosis",
    "export": "the export",
}
"""As a user is told of them."""


class Live(QObject):
    """Questions to the worker, answers from it."""

    answered = Signal(str, object)
    """The kind of a question, and its answer."""
    failed = Signal(str, str)
    """The kind of a question, and why there is no answer."""
    progressed = Signal(str, str, int, int)
    """Of long work: kind, task, steps done, and all steps (0 if not known)."""
    busy_changed = Signal()
    """Something was begun or has ended."""
    _delivered = Signal(object)

    def __init__(self) -> None:
        super().__init__()
        self._delivered.connect(self._take, Qt.ConnectionType.QueuedConnection)
        self._worker = Worker(self._delivered.emit)
        self.question: Question | None = None
        self.slice_share = 0.5
        self.quantity = "utilisation"
        self.against: Question | None = None
        self._pending: dict[Kind, int] = {}
        self._newest: dict[Kind, int] = {}
        self._states: dict[str, object] = {}
        self._old_since_s: dict[str, float] = {}
        self._last = self._since = 0
        self._rest = QTimer(self, singleShot=True, interval=_REST_MS)
        self._rest.timeout.connect(self._ask_whole)
        self._aging = QTimer(self, singleShot=True, interval=_OLD_MS)
        self._aging.timeout.connect(self.busy_changed)

    @property
    def busy(self) -> frozenset[Kind]:
        """Kinds of questions that have no answer yet."""
        return frozenset(self._pending)

    @property
    def is_at_rest(self) -> bool:
        """Whether everything that was asked has been answered, and nothing will be asked."""
        timers = self._rest, self._aging
        return not self._pending and not any(timer.isActive() for timer in timers)

    @property
    def outdated(self) -> frozenset[str]:
        """What is shown of an older state of the study, and has been for a while."""
        now_s = time.monotonic() + 0.01  # timers are no more exact
        since = self._old_since_s.items()
        return frozenset(shown for shown, since_s in since if now_s - since_s >= _OLD_MS * 1e-3)

    def ask_about(self, question: Question | None, *, moving: bool) -> None:
        """Ask for all that may be different now."""
        before, self.question = self.question, question
        if question is None:
            return
        for shown in self._states:
            self._see_age(shown)
        if before is not None and before.text != question.text and "select" in self._pending:
            self._worker.cancel("select")
            self._newest["select"] = self._pending.pop("select")
            self.failed.emit("select", "given up, since the study has changed")
        self._ask("here", question)
        # A map is the same wherever the platform is.
        if before is None or (before.text, before.rope) != (question.text, question.rope):
            if moving:
                self._ask("coarse", question)
            self._rest.start(_REST_MS if moving else 0)
        elif not moving:
            self._ask("here", question, settled=True)

    def ask_map(self) -> None:
        """Ask for the whole map again, with what is wanted now."""
        if self.question is not None:
            self._ask("fine", self.question)

    def ask_slice(self, share: float, *, moving: bool) -> None:
        """Ask for the map with its slice at another height."""
        self.slice_share = share
        if self.question is not None:
            self._ask("coarse" if moving else "fine", self.question)

    def ask_long(self, kind: Kind, **options: Any) -> None:
        """Begin long work on the present question."""
        if self.question is not None:
            self._ask(kind, self.question, **options)

    def cancel(self, kind: Kind) -> None:
        """End long work."""
        self._worker.cancel(kind)

    def forget(self) -> None:
        """Drop all that was asked: another study is open."""
        self.question = None
        self._rest.stop()
        self._aging.stop()
        for kind in tuple(self._pending):
            self._worker.cancel(kind)
        self._pending.clear()
        self._states.clear()
        self._old_since_s.clear()
        self._since = self._last
        self.busy_changed.emit()

    def close(self) -> None:
        """End all work; returns at once."""
        self._rest.stop()
        self._aging.stop()
        self._delivered.disconnect(self._take)
        self._since = sys.maxsize
        self._worker.close()

    def _ask_whole(self) -> None:
        if self.question is not None:
            whole: tuple[Kind, ...] = ("fine", "ropes", "worst")
            for kind in whole:
                self._ask(kind, self.question)
            self._ask("here", self.question, settled=True)
            if self.question.study.measurements is not None:
                self._ask("residuals", self.question)

    def _ask(self, kind: Kind, question: Question, **options: Any) -> None:
        if kind in ("coarse", "fine"):
            whole = {"unserved", "sag", "diameter"} if kind == "fine" else set()
            options["quantities"] = frozenset({self.quantity, *whole})
            options["slice_share"] = self.slice_share
            options["against"] = self.against
        self._last = self._pending[kind] = self._worker.ask(kind, question, **options)
        self.busy_changed.emit()

    def _see_age(self, shown: str) -> None:
        """Note since when what is shown is of an older state than the present one."""
        assert self.question is not None
        if self._states[shown] == _state_of(shown, self.question):
            self._old_since_s.pop(shown, None)
        elif shown not in self._old_since_s:
            self._old_since_s[shown] = time.monotonic()
            self._aging.start()

    def _take(self, delivery: Delivery) -> None:
        """In the window's thread: hand on what is newer than what was handed on of its kind.

        While something moves, answers come to questions that are not the last ones any more.
        """
        kind, number = delivery.kind, delivery.number
        if number <= max(self._since, self._newest.get(kind, 0)):
            return
        if isinstance(delivery, Progress):
            self.progressed.emit(kind, delivery.task, delivery.done, delivery.total)
            return
        if self._pending.get(kind) == number:
            del self._pending[kind]
        if isinstance(delivery, Done):
            self._newest[kind] = number
            for shown in _SHOWN_AS.get(kind, (kind,)):
                self._states[shown] = _state_of(shown, delivery.question)
                self._old_since_s.pop(shown, None)
                if self.question is not None:
                    self._see_age(shown)
            self.answered.emit(kind, delivery.answer)
        elif isinstance(delivery, Failed):
            self.failed.emit(kind, delivery.text)
        self.busy_changed.emit()


def _state_of(shown: str, question: Question) -> object:
    """Return what an answer depends on of the state of the window."""
    if shown == "here":
        return question.text, question.rope, question.place.tobytes()
    if shown in ("map", "worst"):
        return question.text, question.rope
    return question.text
