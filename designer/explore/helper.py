"""Work of minutes in a process of its own: the window never waits, and to cancel takes no time.

A process, and not a thread: much of that work is Python, which would hold the interpreter lock;
drawing a report would share OpenGL with the window; and what a library computes cannot be told to
stop. It stays for the next such work, since starting takes a second or two.
"""

from __future__ import annotations

import atexit
import os
import threading
from collections.abc import Callable
from contextlib import suppress
from multiprocessing import Pipe
from multiprocessing.connection import Connection
from multiprocessing.context import SpawnProcess
from pathlib import Path
from pickle import UnpicklingError
from typing import Any

import numpy as np

from designer.effects.load import load_effects
from designer.errors import InputError
from designer.explore.question import (
    Kind,
    Long,
    Message,
    Question,
    Request,
    ThrottledReporter,
    failure_text,
)
from designer.explore.reading import Context
from designer.io.process import SPAWN, end_with_parent, settle_in
from designer.plugins import find_plugins

_GRACE_S = 3.0
"""How long a process may take to clear away what it has half-written."""
_PATIENCE_S = 1.0
"""How long whoever closes waits for that; it goes on by itself."""


class Helper:
    """One process for one kind of work, and the thread that waits for it; both start when needed.

    Parameters
    ----------
    kind : str
        The kind of work.
    deliver : callable
        Called with each `Message`, in the thread.
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
            self._waiting.append(_NOTHING)
            self._changed.notify()

    def close(self) -> None:
        """Give up everything and end the process."""
        with self._changed:
            self._closing = True
            process, thread = self._process, self._thread
            if process is not None:
                process.terminate()
            self._waiting.append(_NOTHING)
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
                self._running = None if ends or request is _NOTHING else request
            for unanswered in dropped:
                if unanswered is not _NOTHING:
                    self._deliver(Message(unanswered, "cancelled"))
            if ends:
                self._end()
                return
            if request is not _NOTHING:
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
        connection = self._started()
        question = request.question
        task = {
            "kind": request.kind,
            "text": question.text,
            "path": str(question.path),
            "place": question.place.tolist(),
            "rope": question.rope,
            "with_plugins": question.plugins.with_others,
            "options": dict(request.options),
        }
        connection.send(task)
        while True:
            message = Message(request, **connection.recv())
            if message.is_end:
                return message
            self._deliver(message)

    def _started(self) -> Connection:
        with self._changed:
            if self._closing or self._waiting:
                raise EOFError  # given up before it began
            if self._process is None or self._connection is None or not self._process.is_alive():
                self._connection, theirs = Pipe()
                process = SPAWN.Process(target=work, args=(theirs,))
                process.start()
                theirs.close()
                self._process = process
            return self._connection

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


_NOTHING: Any = object()
"""In place of a request: nothing is wanted."""


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
    from designer.explore.export import export, optimised_study, sweep_study
    from designer.explore.measurements import diagnosis_answer
    from designer.explore.ropes import full_ropes

    answers: dict[Long, Callable[..., Any]] = {
        "select": full_ropes,
        "diagnose": diagnosis_answer,
        "export": export,
        "optimise": optimised_study,
        "sweep": sweep_study,
    }
    return answers[task["kind"]](_question(task), reporter, **task["options"])


def _question(task: dict[str, Any]) -> Question:
    plugins = find_plugins(task["with_plugins"])
    path = Path(task["path"])
    reading = Context(path, load_effects(plugins), plugins).read(task["text"])
    if reading.study is None:
        raise InputError(reading.faults)
    place = np.array(task["place"])
    return Question(reading.study, place, task["rope"], task["text"], path, plugins)
