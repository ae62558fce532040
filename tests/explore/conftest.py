"""Sessions on shipped studies, and a worker whose answers are waited for."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from queue import Empty, SimpleQueue
from typing import Any

import pytest

from designer.explore.question import Message, Question
from designer.explore.session import Session
from designer.explore.worker import Worker
from designer.plugins import Plugins, find_plugins
from designer.resources import example_file

LONGEST_WAIT_S = 120.0
Open = Callable[[str], Session]


@pytest.fixture(scope="session")
def no_plugins() -> Plugins:
    """Ours alone."""
    return find_plugins(with_plugins=False)


@pytest.fixture
def example(no_plugins: Plugins) -> Open:
    """Opens a shipped study."""
    return lambda name: Session.open(example_file(name), no_plugins)


@pytest.fixture
def yard(example: Open) -> Session:
    """A small crane on three cables."""
    return example("yard")


class Asker:
    """Asks a worker, and waits for what becomes of it."""

    def __init__(self) -> None:
        self.got: SimpleQueue[Message] = SimpleQueue()
        self.worker = Worker(self.got.put)
        self.seen: list[Message] = []

    def ask(self, kind: Any, question: Question | None, **options: Any) -> int:
        """Ask, and do not wait."""
        assert question is not None
        return self.worker.ask(kind, question, **options)

    def next(self) -> Message:
        """Wait for the next delivery."""
        try:
            self.seen.append(self.got.get(timeout=LONGEST_WAIT_S))
        except Empty:
            pytest.fail(f"nothing came after {self.seen}")
        return self.seen[-1]

    def end_of(self, number: int) -> Message:
        """Wait for the end of a request."""
        while True:
            for one in self.seen:
                if one.number == number and one.is_end:
                    return one
            self.next()


@pytest.fixture
def asker() -> Iterator[Asker]:
    """A worker, closed at the end."""
    one = Asker()
    yield one
    one.worker.close()
