"""The open study as the window lives with it: steps go to the session, questions to the worker.

Whoever shows something listens to its signals, and nobody needs the window for that. It computes
nothing. While something moves, the pose and a coarse map are asked for; when it rests, the whole
map and the candidates.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Iterable
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from PySide6.QtCore import QObject, Qt, QTimer, Signal

from designer.arrays import FloatArray
from designer.errors import Fault

if TYPE_CHECKING:
    from designer.explore.answers import Differences, Pin
    from designer.explore.question import Kind, Long, Message, Question, Rope, RopePerCable
    from designer.explore.session import Session
    from designer.explore.worker import Worker
    from designer.study import Study

_OLD_MS = 200  #: A shorter time of an older state is no matter: answers come many times a second


class Ages(QObject):
    """Ages of what is shown, by its name: the kind of an answer, or ``map``."""

    changed = Signal()  #: Something has become old

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
        return self._timer.isActive()

    def renew(self, aspect: str, question: Question, present: Question | None) -> None:
        """Take in that the answer to a question is shown."""
        self._states[aspect] = _state_of(aspect, question)
        self._old_since_s.pop(aspect, None)
        self.outdated -= {aspect}
        if present is not None:
            self._compare([aspect], present)

    def follow(self, present: Question) -> None:
        """Compare all that is shown with the present state."""
        self._compare(self._states, present)

    def _compare(self, aspects: Iterable[str], present: Question) -> None:
        now_s = time.monotonic()  # one change makes all of them old at once
        for aspect in aspects:
            if self._states[aspect] == _state_of(aspect, present):
                self._old_since_s.pop(aspect, None)
                self.outdated -= {aspect}
            elif aspect not in self._old_since_s:
                self._old_since_s[aspect] = now_s
                if not self._timer.isActive():  # else a slider that goes on moving would put it off
                    self._timer.start(_OLD_MS)

    def _tell(self) -> None:
        """Say what is old by now, and wait for the rest: a timer may come a little early."""
        before_s = time.monotonic() - _OLD_MS * 1e-3
        since = self._old_since_s.items()
        self.outdated = frozenset(aspect for aspect, since_s in since if since_s <= before_s)
        if len(self.outdated) < len(since):
            self._timer.start(_OLD_MS // 10)
        self.changed.emit()

    def forget(self) -> None:
        self._timer.stop()
        self.outdated = frozenset()
        self._states.clear()
        self._old_since_s.clear()


def _state_of(aspect: str, question: Question) -> object:
    if aspect == "pose":
        return question.text, question.rope, question.place.tobytes()
    if aspect in ("map", "worst"):
        return question.text, question.rope
    return question.text


_REST_MS = 250  #: A pause of the hand that is longer than those of a drag
_SHOWN_AS: dict[Kind, tuple[str, ...]] = {
    "coarse": ("map",),
    "fine": ("map",),
    "select": ("select", "ropes"),
    "requirements": ("select",),
}
"""What an answer is shown as, where that is not its kind."""
LONG: tuple[Long, ...] = ("select", "diagnose", "export", "optimise", "sweep")
"""What takes long: with progress, and cancelled by hand."""
NAMES: dict[str, str] = {
    "pose": "the pose",
    "coarse": "the map",
    "fine": "the map",
    "worst": "the worst pose",
    "ropes": "the candidates",
    "select": "the full selection",
    "requirements": "the requirements",
    "residuals": "the residuals",
    "diagnose": "the diagnosis",
    "export": "the export",
    "optimise": "the optimisation",
    "sweep": "the sweep",
}
"""As a user reads of them."""


class LiveSession(QObject):
    """A session and what is known of its present state, for all parts of the window."""

    opened = Signal()
    """Another study is open, or none; all that was known of the last one is forgotten."""
    changed = Signal()  #: Text, refused entries, rope or pinned state may be different
    moved = Signal()  #: The platform may be elsewhere, or the study another
    answered = Signal(str, object)  #: The kind of a question, and its answer
    begun = Signal(str)  #: Long work of a kind was begun
    progressed = Signal(str, str, int, int)
    """Of long work: kind, task, steps done, and all steps (0 if not known)."""
    busy_changed = Signal()  #: Something was begun or has ended, or has become old
    quantity_changed = Signal(str)  #: The map is coloured by another quantity
    flushing = Signal()
    """The text is about to be saved or left: what was typed last is to be handed on."""
    taken_over = Signal()  #: The study is another, and the state before it is pinned as A
    message = Signal(str)  #: Something that a user shall read, and find again
    _forgotten = Signal()
    _delivered = Signal(object)

    def __init__(self) -> None:
        super().__init__()
        self._delivered.connect(self._take, Qt.ConnectionType.QueuedConnection)
        self.session: Session | None = None
        self.question: Question | None = None
        self.answers: dict[str, Any] = {}
        self.slice_share = 0.5
        self.quantity = "utilisation"
        self._against: Question | None = None
        self._compares_map = self._had_ropes = False
        self._pending: dict[Kind, int] = {}
        self._newest: dict[Kind, int] = {}
        self._last = self._since = 0
        self._rest = QTimer(self, singleShot=True, interval=_REST_MS)
        self._rest.timeout.connect(self._ask_all)
        self._ages = Ages()
        self._ages.changed.connect(self.busy_changed)

    @cached_property
    def _worker(self) -> Worker:
        from designer.explore.worker import Worker

        return Worker(self._delivered.emit)

    # What there is

    @property
    def study(self) -> Study | None:
        """The study; the last sound one where the text is faulty, None where there never was."""
        return None if self.session is None else self.session.study

    @property
    def rope(self) -> Rope | RopePerCable | None:
        """The rope, or ropes, that are looked at; None for the family."""
        return None if self.session is None else self.session.state.rope

    @property
    def pinned(self) -> Pin | None:
        """The state that the present one is compared with; None for nothing."""
        if self.session is None:
            return None
        from designer.explore.answers import Pin

        pin = self.session.state.pin
        return pin if isinstance(pin, Pin) else None

    @property
    def busy(self) -> frozenset[Kind]:
        return frozenset(self._pending)

    @property
    def is_at_rest(self) -> bool:
        """Whether everything that was asked has been answered, and nothing will be asked."""
        return not (self._pending or self._rest.isActive() or self._ages.is_waiting)

    @property
    def outdated(self) -> frozenset[str]:
        """What is shown of an older state of the study, and has been for a while."""
        return self._ages.outdated

    def listen(self, show: Callable[[Any], object], *kinds: Kind) -> None:
        """Have the answers to some kinds of questions shown; None where all is forgotten."""
        self._forgotten.connect(lambda: show(None))
        self.answered.connect(lambda kind, answer: show(answer) if kind in kinds else None)

    def differences(self) -> Differences | None:
        """Return what is different from the pinned state; None where nothing is pinned."""
        from designer.explore.answers import compare

        pin, present = self.pinned, self._present()
        return None if pin is None or present is None else compare(pin, present)

    def _present(self) -> Pin | None:
        from designer.explore.answers import Pin

        question = None if self.session is None else self.session.question()
        if self.session is None or question is None:
            return None
        answers = (self.answers.get(kind) for kind in ("pose", "worst", "ropes"))
        return Pin(question, self.session.fields(), *answers)

    # Which study

    def open(self, session: Session | None) -> None:
        """Go on with another study, or with none."""
        self.forget()
        self.session, self.answers = session, {}
        self._against, self._compares_map, self._had_ropes = None, False, False
        self._forgotten.emit()
        self._follow()
        self.opened.emit()

    def forget(self) -> None:
        self.question = None
        self._rest.stop()
        self._ages.forget()
        for kind in tuple(self._pending):
            self._worker.cancel(kind)
        self._pending.clear()
        self._since = self._last
        self.busy_changed.emit()

    def close(self) -> None:
        self._rest.stop()
        self._ages.forget()
        self._delivered.disconnect(self._take)
        self._since = sys.maxsize
        if "_worker" in self.__dict__:
            self._worker.close()

    # Steps of the session

    def do(self, step: Callable[[Session], object], *, moving: bool = False) -> None:
        """Have the session take a step, which may be on its way, and follow it."""
        if self.session is not None:
            step(self.session)
            self._follow(moving=moving)

    def put_all_back(self) -> None:
        if self.session is not None and self.session.is_modified:
            self.session.settle()
            self.do(lambda session: session.set_text(session.saved_text))

    def write(self, text: str) -> None:
        if self.session is not None and text != self.session.text:
            self.do(lambda session: session.set_text(text, continuous=True))

    def drop_rejected(self, path: str) -> None:
        if self.session is not None:
            self.session.rejected.pop(path, None)
            self.changed.emit()

    def choose(self, rope: Rope | RopePerCable | None) -> None:
        """Look at a rope, or ropes; at the family for None."""
        self.do(lambda session: session.choose(rope))
        if rope is not None:
            self.colour_by("utilisation")

    # The platform

    def move(self, place: FloatArray, moving: bool = False) -> None:
        """Take the platform to a position (3,) or a place (6,) [m, rad], or on the way there."""
        if self.session is not None and self.study is not None:
            self.session.move(place, continuous=moving)
            if not moving:
                self.session.settle()
            self._follow_place(moving=moving)

    def move_exit_point(self, number: int, position_m: FloatArray, moving: bool) -> None:
        """Take an exit point, counted from 0, to (3,) [m], or on the way there."""
        faults: list[Fault] = []
        self.do(lambda s: faults.extend(s.move_exit_point(number, position_m)), moving=moving)
        if not moving:
            self.do(lambda session: session.settle())
            self._tell(faults)

    def shift(self, offset_m: FloatArray) -> None:
        """Move the platform by (3,) [m]; several shifts are one step to undo."""
        if self.session is not None:
            offset = np.concatenate([offset_m, np.zeros(3)])
            self.session.move(self.session.state.place + offset, continuous=True)
            self._follow_place(moving=True)

    def turn(self, rotation_rad: FloatArray) -> None:
        """Turn the platform by a rotation vector (3,) [rad]; several turns are one step to undo."""
        if self.session is not None:
            self.session.turn(rotation_rad)
            self._follow_place(moving=True)

    def to_worst(self) -> None:
        place = getattr(self.answers.get("worst"), "place", None)
        if place is not None:
            self.move(place)

    def to_pose(self) -> None:
        if self.study is not None and self.study.pose is not None:
            self.move(self.study.pose.place)

    def keep_pose(self) -> None:
        faults: list[Fault] = []
        self.do(lambda session: faults.extend(session.keep_pose()))
        self._tell(faults)

    def _tell(self, faults: Iterable[Fault]) -> None:
        for fault in faults:
            self.message.emit(str(fault))

    # Comparing

    def pin(self) -> None:
        self.do(lambda session: session.set_pin(self._present()))

    def release(self) -> None:
        self.do(lambda session: session.set_pin(None))

    def take_over(self, text: str) -> None:
        """Go on with another text of the study, the present state pinned."""
        self.pin()
        self.write(text)
        self.taken_over.emit()

    def compare_in_map(self, is_compared: bool) -> None:
        self._compares_map = is_compared
        self._see_pinned()

    def _see_pinned(self) -> None:
        pin = self.pinned if self._compares_map else None
        against = None if pin is None else pin.question
        if against is not self._against:
            self._against = against
            self._ask_map("fine")

    # Questions

    def colour_by(self, quantity: str) -> None:
        if quantity == self.quantity:
            return
        self.quantity = quantity
        self.quantity_changed.emit(quantity)
        chart = self.answers.get("map")
        if chart is not None and chart.grids and quantity not in chart.values:
            self._ask_map("fine")

    def move_slice(self, share: float, moving: bool) -> None:
        """Ask for the map with its slice at another share of the height."""
        self.slice_share = share
        self._ask_map("coarse" if moving else "fine")

    def begin_long(self, kind: Long, **options: Any) -> None:
        if self.question is not None:
            self.begun.emit(kind)
            self._ask(kind, self.question, **options)

    def cancel(self, kind: Kind) -> None:
        self._worker.cancel(kind)

    def _follow(self, *, moving: bool = False) -> None:
        """Have the session shown as it is now, and ask for what follows from it."""
        if self.rope is None and self.quantity == "utilisation" and self.study is not None:
            self.colour_by("diameter")  # of the thinnest cable the utilisation is 100 % everywhere
        self.changed.emit()
        self._follow_place(moving=moving)
        self._see_pinned()

    def _follow_place(self, *, moving: bool) -> None:
        """The same where only the platform may be elsewhere; what may be different is asked for."""
        self.moved.emit()
        if self.session is None:
            return
        before, self.question = self.question, self.session.question()
        question = self.question
        if question is None:
            return
        self._ages.follow(question)
        if before is not None and before.text != question.text and "select" in self._pending:
            self._worker.cancel("select")
            self._newest["select"] = self._pending.pop("select")
            self._tell_failed("select", "given up, since the study has changed")
        self._ask("pose", question)
        # A map is the same wherever the platform is.
        if before is None or (before.text, before.rope) != (question.text, question.rope):
            if moving:
                self._ask("coarse", question)
            self._rest.start(_REST_MS if moving else 0)
        elif not moving:
            self._ask("pose", question, settled=True)

    def _ask_map(self, kind: Kind) -> None:
        if self.question is not None:
            self._ask(kind, self.question)

    def _ask_all(self) -> None:
        if self.question is not None:
            kinds: tuple[Kind, ...] = ("fine", "ropes", "worst")
            for kind in kinds:
                self._ask(kind, self.question)
            self._ask("pose", self.question, settled=True)
            if self.question.study.selection is None:
                self._ask("requirements", self.question)
            if self.question.study.measurements is not None:
                self._ask("residuals", self.question)

    def _ask(self, kind: Kind, question: Question, **options: Any) -> None:
        if kind in ("coarse", "fine"):
            always = {"unserved", "sag", "diameter"} if kind == "fine" else set()
            options["quantities"] = frozenset({self.quantity, *always})
            options["slice_share"] = self.slice_share
            options["against"] = self._against
        self._last = self._pending[kind] = self._worker.ask(kind, question, **options)
        self.busy_changed.emit()

    # Answers

    def _take(self, message: Message) -> None:
        """In the window's thread: hand on what is newer than what was handed on of its kind.

        While something moves, answers come to questions that are not the last ones any more.
        """
        kind, number = message.kind, message.number
        if number <= max(self._since, self._newest.get(kind, 0)):
            return
        if not message.is_end:
            self.progressed.emit(kind, message.text, message.steps, message.total)
            return
        if self._pending.get(kind) == number:
            del self._pending[kind]
        if message.status == "done":
            self._newest[kind] = number
            self.answers[kind] = message.answer
            for aspect in _SHOWN_AS.get(kind, (kind,)):
                self.answers[aspect] = message.answer
                self._ages.renew(aspect, message.question, self.question)
                if aspect == "ropes":
                    self._show_best_rope()
            self.answered.emit(kind, message.answer)
        elif message.status == "failed":
            self._tell_failed(kind, message.text)
        self.busy_changed.emit()

    def _show_best_rope(self) -> None:
        """Look at the best of the first candidates, where nobody has chosen another rope."""
        ropes, is_first, self._had_ropes = self.answers["ropes"], not self._had_ropes, True
        best = None if ropes is None else ropes.best
        if is_first and self.rope is None and best is not None:
            self.do(lambda session: session.begin_with(best))
            if self.quantity == "diameter":  # nobody chose it
                self.colour_by("utilisation")

    def _tell_failed(self, kind: Kind, text: str) -> None:
        self.message.emit(f"{NAMES[kind]}: {text}")
