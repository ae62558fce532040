"""What the shell and the system do to a command: closed pipes, signals, poor terminals."""

from __future__ import annotations

import errno
import os
import signal
import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from types import FrameType
from typing import NoReturn, TextIO

from designer.errors import OutputError

CLOSED_PIPE = 128 + 13
"""Exit status of a program whose reader went away, as the shell gives it after a SIGPIPE."""


def settle_in() -> None:
    """Make the streams take every letter, and a request to end leave nothing half-written."""
    for stream in (sys.stdout, sys.stderr):
        reconfigure = getattr(stream, "reconfigure", None)
        if reconfigure is not None and not (stream.encoding or "").lower().startswith("utf"):
            reconfigure(errors="replace")  # a '?' is better than no answer
    with suppress(ValueError):  # only the main thread of a program may do this
        signal.signal(signal.SIGTERM, _end)


def is_terminal(stream: TextIO | None) -> bool:
    """Return whether somebody reads this on a screen; a program may have no such stream at all."""
    return stream is not None and stream.isatty()


@contextmanager
def readable_output() -> Iterator[None]:
    """End quietly where nobody reads on, and in one line where the output cannot be written.

    Neither of them is an answer, so neither has the exit status of one.
    """
    try:
        yield
    except OSError as error:
        if isinstance(error, BrokenPipeError):
            end_at_closed_pipe()
        if error.errno == errno.ENOSPC:
            silence_output()
            raise OutputError(f"standard output: cannot be written ({error.strerror})") from error
        raise


def end_at_closed_pipe() -> NoReturn:
    """End as a program does whose reader went away."""
    silence_output()
    raise SystemExit(CLOSED_PIPE)


def silence_output() -> None:
    """Lead standard output to nowhere, so that what is left in its buffer does no harm."""
    with suppress(OSError, ValueError, AttributeError):
        nowhere = os.open(os.devnull, os.O_WRONLY)
        os.dup2(nowhere, sys.stdout.fileno())
        os.close(nowhere)


def _end(number: int, _: FrameType | None) -> NoReturn:
    raise SystemExit(128 + number)
