"""Windows to drive; nothing of Qt is imported before a test asks for one."""

from __future__ import annotations

from collections.abc import Iterator
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import pytest

if find_spec("PySide6") is None:  # they say so in test_window_command.py, which needs none of it
    collect_ignore_glob = ["test_window_[!c]*.py"]


@pytest.fixture(scope="session")
def qapp() -> Any:
    """The application as the command makes it."""
    from designer.explore.desktop.app import application

    return application()


@pytest.fixture
def empty(qtbot: Any, tmp_path: Path) -> Iterator[Any]:
    """A window of its own that shows the start page."""
    from window_driver import Driver

    driver = Driver(qtbot, tmp_path)
    yield driver
    driver.close()


@pytest.fixture(scope="module")
def shared(qapp: Any, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Any]:
    """A window that the tests of a module share, since the first frame takes a second."""
    from pytestqt.qtbot import QtBot  # type: ignore[import-untyped]
    from window_driver import Driver

    class Request:
        node = None

    driver = Driver(QtBot(Request()), tmp_path_factory.mktemp("settings"))
    yield driver
    driver.close()


@pytest.fixture
def yard(shared: Any, qtbot: Any, tmp_path: Path) -> Any:
    """The shared window on a copy of the yard crane with few samples, as if just opened."""
    from window_driver import small_yard

    shared.bot = qtbot
    shared.reset()
    shared.open(small_yard(tmp_path))
    return shared
