"""Runs a stranger's code so that nothing it does can break the rest."""

from __future__ import annotations

import ctypes
import io
import os
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager, redirect_stdout, suppress
from typing import TypeVar

from designer.errors import described, one_line

Value = TypeVar("Value")

LONGEST_WAIT_S = 30.0
"""How long a plugin may take to be imported, or to answer a hook [s]."""


def attempt(
    action: Callable[[], Value], label: str, failure: str, problems: list[str]
) -> Value | None:
    """Return what a stranger's code gives; None where it fails.

    ``problems`` gets a line for a failure, which says whose it is and what it did (``label``
    ``failure``, such as "cannot be loaded"), and one for what was written to standard output.
    """
    answers: list[tuple[Value | None, BaseException | None]] = []

    def run() -> None:
        try:
            answers.append((action(), None))
        except BaseException as error:  # it may raise anything, and ask Python to exit
            answers.append((None, error))

    caught = io.StringIO()
    with _descriptor_to_stderr(), redirect_stdout(caught):
        # In a thread of its own: nothing can end one that hangs, but it can be left behind, and as
        # a daemon it does not keep the program alive.
        thread = threading.Thread(target=run, name=label, daemon=True)
        thread.start()
        thread.join(LONGEST_WAIT_S)
        late = TimeoutError(f"no answer within {LONGEST_WAIT_S:g} s")
        value, error = answers[0] if answers else (None, late)
    if error is not None:
        problems.append(f"{label} {failure}: {described(error)}: left out")
    printed = "" if caught.closed else caught.getvalue()
    if printed:
        problems.append(f"{label} wrote to standard output: {one_line(printed)!r}")
    return value


@contextmanager
def _descriptor_to_stderr() -> Iterator[None]:
    """Send what is written below Python, such as by a child process, to standard error."""
    saved = None
    with suppress(OSError, ValueError):  # started without a standard output or error
        _flush()
        saved = os.dup(1)
        os.dup2(2, 1)
    try:
        yield
    finally:
        if saved is not None:
            with suppress(OSError, ValueError):
                _flush()
            os.dup2(saved, 1)
            os.close(saved)


def _flush() -> None:
    """Empty Python's buffer of standard output and that of the C library, which has its own."""
    if sys.stdout is not None:
        sys.stdout.flush()
    if os.name == "posix":
        ctypes.CDLL(None).fflush(None)
