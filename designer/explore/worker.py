"""One thread that answers while a window lives, and processes for work of minutes.

Newest request first, and nothing is lost. The kernels release the interpreter lock, so a window
stays quick beside the thread. Between two batches of poses it looks up: what is more urgent than
its work is answered there and then, and work that nobody wants any more is given up. Work of
minutes is done in another process that is ended where nobody wants it any more.
"""

from __future__ import annotations

import atexit
import os
import threading
from collections.abc import Callable
from contextlib import suppress
from itertools import count
from multiprocessing import Pipe
from multiprocessing.connection import Connection
from multiprocessing.context import SpawnProcess
from pathlib import Path
from pickle import UnpicklingError
from typing import Any, get_args

import numpy as np

from designer.effects.load import load_effects
from designer.errors import InputError
from designer.explore.answers import (
    map_answer,
    pose_answer,
    quick_ropes,
    requirements_alone,
    worst_answer,
)
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
from designer.explore.session import Context
from designer.io.process import SPAWN, end_with_parent, settle_in
from designer.plugins import find_plugins, require_ring
from designer.progress import interrupted_by

Deliver = Callable[[Message], None]
_URGENCY: tuple[Quick, ...] = get_args(Quick)
"""The most urgent first; they are answered in the middle of work of the later ones."""
_UNINTERRUPTED = ("pose", "coarse")
"""Done before one could give them up; a newer one waits for its turn, or none would ever be done
while a slider moves."""


class _Abandoned(BaseException):
    """Nobody wants the answer any more; no ``except Exception`` on the way may keep it."""


class Worker:
    """Answers requests in threads and processes of its own.

    ``deliver`` is called with each `Message` in the worker's threads; shall be quick and not raise.
    """

    def __init__(self, deliver: Deliver) -> None:
        self._deliver = deliver
        self._numbers = count(1)
        self._changed = threading.Condition()
        self._waiting: dict[Kind, Request] = {}
        self._dropped: list[Request] = []
        self._running: list[Request] = []
        self._abandoned: set[int] = set()
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
                if is_old and running.kind not in _UNINTERRUPTED:
                    self._abandoned.add(running.number)
            self._changed.notify()
        return request.number

    def cancel(self, kind: Kind) -> None:
        """Give up what waits or runs of a kind, if anything does."""
        if kind in self._helpers:
            self._helpers[kind].cancel()
            return
        with self._changed:
            self._drop(kind)
            self._abandoned |= {running.number for running in self._running if running.kind == kind}
            self._changed.notify()

    def close(self, timeout_s: float = 2.0) -> None:
        with self._changed:
            self._closing = True
            for kind in list(self._waiting):
                self._drop(kind)
            self._abandoned |= {running.number for running in self._running}
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
            if request.number in self._abandoned:
                raise _Abandoned
            with interrupted_by(lambda: None):
                self._serve(urgency)

        try:
            with interrupted_by(between):
                return Message(request, "done", self._answer(request))
        except _Abandoned:
            return Message(request, "cancelled")
        except Exception as error:
            return Message(request, "failed", text=failure_text(error))
        finally:
            with self._changed:
                self._running.remove(request)
                self._abandoned.discard(request.number)

    def _answer(self, request: Request) -> Any:
        question, options = request.question, request.options

        def report(task: str, steps: int, total: int) -> None:
            self._tell(Message(request, "progress", None, task, steps, total))

        if request.kind == "residuals":
            require_ring("diagnose")
            from designer.explore.measurements import residuals

            return residuals(question)
        answers: dict[Kind, Callable[[], Any]] = {
            "pose": lambda: pose_answer(question, **options),
            "coarse": lambda: map_answer(question, fine=False, **options),
            "fine": lambda: map_answer(question, fine=True, **options),
            "ropes": lambda: quick_ropes(question),
            "requirements": lambda: requirements_alone(question),
            "worst": lambda: worst_answer(question, ThrottledReporter(report)),
        }
        return answers[request.kind]()


# Work of minutes

_GRACE_S = 3.0  #: How long a process may take to clear away what it has half-written
_NO_REQUEST: Any = object()  #: In place of a request: nothing is wanted
_PATIENCE_S = 1.0  #: How long whoever closes waits for that; it goes on by itself


class Helper:
    """One process for one kind of work, and the thread that waits for it; both start when needed.

    ``deliver`` is called with each `Message`, in the thread.
    """

    def __init__(self, kind: Kind, deliver: Callable[[Message], None]) -> None:
        self._kind, self._deliver = kind, deliver
        self._changed = threading.Condition()
        self._waiting: list[Request] = []
        self._running: Request | None = None
        self._process: SpawnProcess | None = None
        self._connection: Connection | None = None
        self._thread: threading.Thread | None = None
        self._closing = False
        # No daemon, since a sweep has processes of its own; so it is ended where nobody closes it.
        atexit.register(self._end)

    def ask(self, request: Request) -> None:
        """Do this instead of what waits or runs."""
        with self._changed:
            self._end_running()
            self._waiting.append(request)
            if self._thread is None:
                name = f"designer-{self._kind}"
                self._thread = threading.Thread(target=self._work, name=name, daemon=True)
                self._thread.start()
            self._changed.notify()

    def cancel(self) -> None:
        """Give up what waits or runs, if anything does."""
        with self._changed:
            self._end_running()
            self._waiting.append(_NO_REQUEST)
            self._changed.notify()

    def close(self) -> None:
        with self._changed:
            self._closing = True
            process, thread = self._process, self._thread
            if process is not None:
                process.terminate()
            self._waiting.append(_NO_REQUEST)
            self._changed.notify()
        if thread is not None:
            thread.join(_PATIENCE_S)

    def _end_running(self) -> None:
        if self._running is not None and self._process is not None:
            self._process.terminate()

    def _work(self) -> None:
        while True:
            with self._changed:
                while not self._waiting:
                    self._changed.wait()
                *dropped, request = self._waiting
                self._waiting.clear()
                ends = self._closing
                dropped += [request] if ends else []
                self._running = None if ends or request is _NO_REQUEST else request
            for unanswered in dropped:
                if unanswered is not _NO_REQUEST:
                    self._deliver(Message(unanswered, "cancelled"))
            if ends:
                self._end()
                return
            if request is not _NO_REQUEST:
                self._deliver(self._end_of(request))

    def _end_of(self, request: Request) -> Message:
        """Have the process do it; where that ends without a word, it was cancelled or it broke."""
        try:
            end = self._exchange(request)
        except (OSError, EOFError, UnpicklingError):
            end = None
        except Exception as error:
            end = Message(request, "failed", text=failure_text(error))
        with self._changed:
            self._running = None
            replaced = bool(self._waiting) or self._closing
        status = self._end() if replaced or end is None else None
        if end is not None:
            return end
        if replaced:
            return Message(request, "cancelled")
        failure = f"the process that did this ended unexpectedly, status {status}"
        return Message(request, "failed", text=failure)

    def _exchange(self, request: Request) -> Message:
        with self._changed:
            if self._closing or self._waiting:
                raise EOFError  # given up before it began
            if self._process is None or self._connection is None or not self._process.is_alive():
                self._connection, child_end = Pipe()
                process = SPAWN.Process(target=work, args=(child_end,))
                process.start()
                child_end.close()
                self._process = process
            connection, question = self._connection, request.question
        connection.send(
            {
                "kind": request.kind,
                "text": question.text,
                "path": str(question.path),
                "place": question.place.tolist(),
                "rope": question.rope,
                "with_plugins": question.plugins.with_others,
                "options": dict(request.options),
            }
        )
        while True:
            message = Message(request, **connection.recv())
            if message.is_end:
                return message
            self._deliver(message)

    def _end(self) -> int | None:
        """End the process, by force where it does not; return its status."""
        process, self._process = self._process, None
        if process is None:
            return None
        process.terminate()
        process.join(_GRACE_S)
        if process.exitcode is None:
            process.kill()
            process.join()
        return process.exitcode


# In the process


def work(connection: Connection) -> None:
    """Do task after task, until nobody listens, and send what a `Message` has but its request."""
    end_with_parent()
    settle_in()
    if hasattr(os, "nice"):
        os.nice(5)  # the window comes first

    def report(task: str, steps: int, total: int) -> None:
        connection.send({"status": "progress", "text": task, "steps": steps, "total": total})

    reporter = ThrottledReporter(report)
    with suppress(EOFError, OSError):  # nobody listens any more
        while True:
            task = connection.recv()
            try:
                connection.send({"status": "done", "answer": _answer(task, reporter)})
            except Exception as error:
                connection.send({"status": "failed", "text": failure_text(error)})


def _answer(task: dict[str, Any], reporter: ThrottledReporter) -> Any:
    from designer.explore.answers import full_ropes
    from designer.explore.export import export, optimised_study, sweep_study

    answers: dict[Long, Callable[..., Any]] = {
        "select": full_ropes,
        "export": export,
        "optimise": optimised_study,
        "sweep": sweep_study,
    }
    if task["kind"] == "diagnose":
        require_ring("diagnose")
        from designer.explore.measurements import diagnosis_answer

        answers["diagnose"] = diagnosis_answer
    plugins = find_plugins(task["with_plugins"])
    path = Path(task["path"])
    reading = Context(path, load_effects(plugins), plugins).read(task["text"])
    if reading.study is None:
        raise InputError(reading.faults)
    place, rope, text = np.array(task["place"]), task["rope"], task["text"]
    question = Question(reading.study, place, rope, text, path, plugins)
    return answers[task["kind"]](question, reporter, **task["options"])
