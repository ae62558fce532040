"""Runs a stranger's code so that nothing it does can break the rest."""

from __future__ import annotations

import ctypes
import io
import os
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager, redirect_stdout, suppress
from typing import Generic, TypeVar

Value = TypeVar("Value")

LONGEST_WAIT_S = 30.0
"""How long a plugin may take to be imported, or to answer a hook [s]."""


def one_line(text: object) -> str:
    """Return a text on one line, without control characters, cut short."""
    try:
        words = " ".join(str(text).split())
    except Exception:  # a stranger's exception may fail at telling what it is
        words = "an error without a readable message"
    shown = "".join(letter if letter.isprintable() else "?" for letter in words)
    return shown if len(shown) <= 300 else shown[:300] + "…"


def attempt(
    action: Callable[[], Value], label: str, failure: str, problems: list[str]
) -> Value | None:
    """Return what a stranger's code gives; None, and a line in ``problems``, where it fails.

    Parameters
    ----------
    action : callable
        The stranger's code.
    label : str
        Whose it is.
    failure : str
        What to say that it did, such as ``cannot be loaded``.
    problems : list of str
        Gets a line for a failure, and one for what was written to standard output.
    """
    caught = io.StringIO()
    with _descriptor_to_stderr(), redirect_stdout(caught):
        answer = _Answer(action)
        answer.wait(label)
    error, value = answer.error, answer.value
    if error is not None:
        value = None  # one that came after all, too late
        problems.append(f"{label} {failure}: {_told(error)}: left out")
    printed = "" if caught.closed else caught.getvalue()
    if printed:
        problems.append(f"{label} wrote to standard output: {one_line(printed)!r}")
    return value


def _told(error: BaseException) -> str:
    words = one_line(error)
    return f"{type(error).__name__}: {words}" if words else type(error).__name__


class _Answer(Generic[Value]):
    """What an action gave, or why it gave nothing."""

    def __init__(self, action: Callable[[], Value]) -> None:
        self._action = action
        self.value: Value | None = None
        self.error: BaseException | None = None

    def wait(self, label: str) -> None:
        """Run the action in a thread of its own: one that hangs can be left behind.

        Nothing can end a thread from outside; as a daemon it does not keep the program alive.
        """
        thread = threading.Thread(target=self._run, name=label, daemon=True)
        thread.start()
        thread.join(LONGEST_WAIT_S)
        if thread.is_alive():
            self.error = TimeoutError(f"no answer within {LONGEST_WAIT_S:g} s")

    def _run(self) -> None:
        try:
            self.value = self._action()
        except BaseException as error:  # it may raise anything, and ask Python to exit
            self.error = error


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
