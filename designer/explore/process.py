"""The process that does the work of minutes: tasks come in, progress and answers go out."""

from __future__ import annotations

import os
import pickle
import sys
import threading
from pathlib import Path
from queue import SimpleQueue
from typing import Any, BinaryIO

import numpy as np

from designer.effects.load import load_effects
from designer.errors import InputError
from designer.explore.question import Question
from designer.explore.reading import Context
from designer.explore.requests import ThrottledReporter, failure_text
from designer.io.process import settle_in
from designer.plugins.find import find_plugins


def main() -> None:
    """Do task after task, until nobody listens."""
    settle_in()
    if hasattr(os, "nice"):
        os.nice(5)  # the window comes first
    # What libraries and plugins print goes to standard error; answers alone go out.
    out = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)
    tasks: SimpleQueue[dict[str, Any]] = SimpleQueue()
    threading.Thread(target=_listen, args=(sys.stdin.buffer, tasks), daemon=True).start()

    def report(task: str, steps: int, total: int) -> None:
        _send(out, status="progress", text=task, steps=steps, total=total)

    reporter = ThrottledReporter(report)
    while True:
        task = tasks.get()
        try:
            _send(out, status="done", answer=_answer(task, reporter))
        except Exception as error:
            _send(out, status="failed", text=failure_text(error))


def _listen(stream: BinaryIO, tasks: SimpleQueue[dict[str, Any]]) -> None:
    """Take in tasks; where nobody is left to send any, the process has no more business."""
    while True:
        try:
            tasks.put(pickle.load(stream))
        except (EOFError, OSError, pickle.UnpicklingError):
            os._exit(0)


def _send(out: BinaryIO, **message: Any) -> None:
    """Send the fields of a `Message` without its request, which the window has."""
    out.write(pickle.dumps(message))  # whole, or not at all
    out.flush()


def _answer(task: dict[str, Any], reporter: ThrottledReporter) -> Any:
    from designer.explore.export import export
    from designer.explore.measurements import diagnosis_answer
    from designer.explore.ropes import full_ropes

    question = _question(task)
    if task["kind"] == "select":
        return full_ropes(question, reporter)
    if task["kind"] == "diagnose":
        return diagnosis_answer(question, reporter)
    return export(question, reporter, **task["options"])


def _question(task: dict[str, Any]) -> Question:
    plugins = find_plugins(task["with_plugins"])
    path = Path(task["path"])
    reading = Context(path, load_effects(plugins), plugins).read(task["text"])
    if reading.study is None:
        raise InputError(reading.faults)
    place = np.array(task["place"])
    return Question(reading.study, place, task["rope"], task["text"], path, plugins)


if __name__ == "__main__":
    main()
