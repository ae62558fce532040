"""The process that does the work of minutes: tasks come in, progress and answers go out."""

from __future__ import annotations

import os
from collections.abc import Callable
from contextlib import suppress
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any

import numpy as np

from designer.effects.load import load_effects
from designer.errors import InputError
from designer.explore.question import Question
from designer.explore.reading import Context
from designer.explore.requests import Long, ThrottledReporter, failure_text
from designer.io.process import end_with_parent, settle_in
from designer.plugins.find import find_plugins


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
    from designer.explore.export import export
    from designer.explore.measurements import diagnosis_answer
    from designer.explore.plans import optimised_study, sweep_study
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
