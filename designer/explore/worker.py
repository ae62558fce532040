"""One thread that answers while a window lives: newest request first, and nothing is lost.

The kernels release the interpreter lock, so a window stays quick beside it. Between two batches of
poses the thread looks up: what is more urgent than its work is answered there and then, and work
that nobody wants any more is given up. Work of minutes goes to processes, see
`designer.explore.helper`.
"""

from __future__ import annotations

import threading
from collections.abc import Callable
from itertools import count
from typing import Any, get_args

from designer.explore.here import here
from designer.explore.map import map_answer, worst_answer
from designer.explore.measurements import residuals
from designer.explore.question import (
    Kind,
    Long,
    Message,
    Question,
    Quick,
    Request,
    ThrottledReporter,
    failure_text,
)
from designer.explore.ropes import asked_alone, quick_ropes
from designer.progress import interrupted_by

Deliver = Callable[[Message], None]
_URGENCY: tuple[Quick, ...] = get_args(Quick)
"""The most urgent first; they are answered in the middle of work of the later ones."""
_SHORT = ("here", "coarse")
"""Done before one could give them up; a newer one waits for its turn, or none would ever be done
while a slider moves."""


class _GivenUp(BaseException):
    """Nobody wants the answer any more; no ``except Exception`` on the way may keep it."""


class Worker:
    """Answers requests in threads and processes of its own.

    Parameters
    ----------
    deliver : callable
        Called with each `Message`, in the worker's threads; shall be quick and not raise.
    """

    def __init__(self, deliver: Deliver) -> None:
        from designer.explore.helper import Helper

        self._deliver = deliver
        self._numbers = count(1)
        self._changed = threading.Condition()
        self._waiting: dict[Kind, Request] = {}
        self._dropped: list[Request] = []
        self._running: list[Request] = []
        self._given_up: set[int] = set()
        self._closing = False
        self._helpers = {kind: Helper(kind, self._tell) for kind in get_args(Long)}
        self._thread = threading.Thread(target=self._work, name="designer-answers", daemon=True)
        self._thread.start()

    def ask(self, kind: Kind, question: Question, **options: Any) -> int:
        """Ask; return the number of the request, which its deliveries bear.

        It takes the place of one of its kind that waits. Longer work of its kind that runs, or that
        runs for another study, is given up.
        """
        request = Request(next(self._numbers), kind, question, options)
        if kind in self._helpers:
            self._helpers[kind].ask(request)
            return request.number
        with self._changed:
            self._drop(kind)
            self._waiting[kind] = request
            for running in self._running:
                is_old = running.kind == kind or running.question.study is not question.study
                if is_old and running.kind not in _SHORT:
                    self._given_up.add(running.number)
            self._changed.notify()
        return request.number

    def cancel(self, kind: Kind) -> None:
        """Give up what waits or runs of a kind, if anything does."""
        if kind in self._helpers:
            self._helpers[kind].cancel()
            return
        with self._changed:
            self._drop(kind)
            self._given_up |= {running.number for running in self._running if running.kind == kind}
            self._changed.notify()

    def close(self, timeout_s: float = 2.0) -> None:
        """Give up everything, end the processes, and wait a little for the thread to end."""
        with self._changed:
            self._closing = True
            for kind in list(self._waiting):
                self._drop(kind)
            self._given_up |= {running.number for running in self._running}
            self._changed.notify()
        for helper in self._helpers.values():
            helper.close()
        self._thread.join(timeout_s)

    def _drop(self, kind: Kind) -> None:
        dropped = self._waiting.pop(kind, None)
        if dropped is not None:
            self._dropped.append(dropped)

    def _tell(self, message: Message) -> None:
        """Deliver; whoever listens may be gone by the end."""
        try:
            self._deliver(message)
        except Exception:
            if not self._closing:
                raise

    def _work(self) -> None:
        while True:
            with self._changed:
                while not (self._waiting or self._dropped or self._closing):
                    self._changed.wait()
                if self._closing and not self._dropped:
                    return
            self._serve(len(_URGENCY))

    def _serve(self, below: int) -> None:
        """Answer all that is more urgent than this."""
        while True:
            with self._changed:
                dropped, self._dropped = self._dropped, []
                kinds = [kind for kind in _URGENCY[:below] if kind in self._waiting]
                request = self._waiting.pop(kinds[0]) if kinds else None
                if request is not None:
                    self._running.append(request)
            for unanswered in dropped:
                self._tell(Message(unanswered, "cancelled"))
            if request is None:
                return
            self._tell(self._answered(request))

    def _answered(self, request: Request) -> Message:
        urgency = _URGENCY.index(request.kind)

        def between() -> None:
            if request.number in self._given_up:
                raise _GivenUp
            with interrupted_by(lambda: None):
                self._serve(urgency)

        try:
            with interrupted_by(between):
                return Message(request, "done", self._answer(request))
        except _GivenUp:
            return Message(request, "cancelled")
        except Exception as error:
            return Message(request, "failed", text=failure_text(error))
        finally:
            with self._changed:
                self._running.remove(request)
                self._given_up.discard(request.number)

    def _answer(self, request: Request) -> Any:
        question, options = request.question, request.options

        def report(task: str, steps: int, total: int) -> None:
            self._tell(Message(request, "progress", None, task, steps, total))

        answers: dict[Kind, Callable[[], Any]] = {
            "here": lambda: here(question, **options),
            "coarse": lambda: map_answer(question, fine=False, **options),
            "fine": lambda: map_answer(question, fine=True, **options),
            "ropes": lambda: quick_ropes(question),
            "residuals": lambda: residuals(question),
            "requirements": lambda: asked_alone(question),
            "worst": lambda: worst_answer(question, ThrottledReporter(report)),
        }
        return answers[request.kind]()
