"""The log that the tests spoil."""

from __future__ import annotations

from pathlib import Path

import pytest
from measured_log import Log, body_log


@pytest.fixture
def log(tmp_path: Path) -> Log:
    """Return the log of a point mass on three cables."""
    return Log(tmp_path)


@pytest.fixture
def body(tmp_path: Path) -> Log:
    """Return the log of a body on four cables, lengths only, without an orientation."""
    return body_log(tmp_path)
