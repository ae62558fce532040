"""What the shell and the system do to a command: closed pipes, signals, poor terminals."""

from __future__ import annotations

import errno
import multiprocessing
import multiprocessing.connection
import os
import signal
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from types import FrameType
from typing import NoReturn, TextIO

from designer.errors import OutputError, one_line

NO_ROOM = (errno.ENOSPC, errno.EFBIG, getattr(errno, "EDQUOT", None))  # Windows has no quota
"""What the system says where a file cannot grow: the disk is full, or a limit is reached."""
SPAWN = multiprocessing.get_context("spawn")
"""Makes the processes that work for this one: none shares its threads, which a fork would."""
CLOSED_PIPE = 128 + 13
"""Exit status of a program whose reader went away, as the shell gives it after a SIGPIPE."""


written: dict[Path, None] = {}
"""Files and folders that this run has put in place, in order; an interruption reports them."""


def settle_in() -> None:
    """Make the streams take every letter, and a request to end leave nothing half-written."""
    written.clear()
    for stream in (sys.stdout, sys.stderr):
        reconfigure = getattr(stream, "reconfigure", None)
        if reconfigure is not None:
            reconfigure(errors="replace")  # a '?' is better than no answer
    for number in (signal.SIGTERM, signal.SIGINT):
        with suppress(ValueError):  # only the main thread of a program may do this
            if signal.getsignal(number) is not signal.SIG_IGN:  # as in a background job
                signal.signal(number, _end)


def interruption() -> str:
    """Return the line that tells of an interruption what was written before it."""
    names = ", ".join(str(path) for path in written if path.exists())
    return one_line(f"Interrupted; {f'written: {names}' if names else 'nothing was written'}.")


def is_terminal(stream: TextIO | None) -> bool:
    """Return whether somebody reads this on a screen; a program may have no such stream at all."""
    return stream is not None and stream.isatty()


@contextmanager
def readable_output() -> Iterator[None]:
    """End quietly where nobody reads on, and in one line where the output cannot be written.

    Neither of them is an answer, so neither has the exit status of one. What is left in the
    buffers is written here: Python's own last attempt would end with a status of its own.
    """
    try:
        try:
            yield
        finally:
            for stream in _streams():
                stream.flush()
    except SystemExit as end:  # what rich makes of a closed pipe has the status of an answer
        if isinstance(end.__context__, BrokenPipeError):
            end_at_closed_pipe()
        raise
    except OSError as error:
        if isinstance(error, BrokenPipeError):
            end_at_closed_pipe()
        if error.errno in NO_ROOM:
            silence_broken_output()
            raise OutputError(f"standard output: cannot be written ({error.strerror})") from error
        raise


def end_at_closed_pipe() -> NoReturn:
    """End as a program does whose reader went away."""
    silence_broken_output()
    raise SystemExit(CLOSED_PIPE)


def silence_broken_output() -> None:
    """Lead each stream that takes nothing any more to nowhere, so that its buffer does no harm."""
    for stream in _streams():
        try:
            stream.flush()
        except OSError:
            with suppress(OSError, ValueError, AttributeError):
                nowhere = os.open(os.devnull, os.O_WRONLY)
                os.dup2(nowhere, stream.fileno())
                os.close(nowhere)


def _streams() -> list[TextIO]:
    """Return those of the two streams that the program was started with and has not closed."""
    return [
        stream for stream in (sys.stdout, sys.stderr) if stream is not None and not stream.closed
    ]


class Undo:
    """What is to be done at the end, the last first; each step does no harm when done twice."""

    def __init__(self) -> None:
        self._steps: list[Callable[[], object]] = []

    def add(self, step: Callable[[], object]) -> None:
        """Add a step, before that which it undoes: a request to end may come in between."""
        self._steps.append(step)

    def forget(self) -> None:
        """Drop all steps: what they would undo is to stay."""
        self._steps.clear()

    def run(self) -> None:
        """Do all steps; one that is broken off by a request to end is done again by that."""
        while self._steps:
            self._steps[-1]()
            self._steps.pop()


_undo_at_end: list[Undo] = []


@contextmanager
def undone_at_end() -> Iterator[Undo]:
    """Hand out steps that are done where the block ends, or where the program is asked to end."""
    undo = Undo()
    _undo_at_end.append(undo)
    try:
        yield undo
    finally:
        undo.run()
        _undo_at_end.remove(undo)


@contextmanager
def ends_gently() -> Iterator[Callable[[], bool]]:
    """Hand out what tells whether Ctrl-C was pressed in the block; a second time it ends all."""
    is_requested = False

    def ask(*_: object) -> None:
        nonlocal is_requested
        is_requested = True
        signal.signal(signal.SIGINT, before)

    before = signal.getsignal(signal.SIGINT)
    is_ours = before is _end  # in the background, or without a command line, it is left alone
    if is_ours:
        signal.signal(signal.SIGINT, ask)
    try:
        yield lambda: is_requested
    finally:
        if is_ours:
            signal.signal(signal.SIGINT, before)


@contextmanager
def children_are_deaf() -> Iterator[None]:
    """Keep Ctrl-C, which a terminal sends to all, from the processes that are started in the block.

    They would each end with a traceback of their own; who started them ends them.
    """
    if not hasattr(signal, "pthread_sigmask"):  # Windows
        yield
        return
    before = signal.pthread_sigmask(signal.SIG_BLOCK, [signal.SIGINT])
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def end_with_parent() -> None:
    """Let this process end where the one that started it does, in whatever way that ended."""
    parent = multiprocessing.parent_process()
    if parent is None:
        return

    def watch() -> None:
        multiprocessing.connection.wait([parent.sentinel])
        os._exit(1)

    threading.Thread(target=watch, daemon=True).start()


def _end(number: int, _: FrameType | None) -> NoReturn:
    """Undo what is half-done, and leave without a look back.

    An exception from here could come up anywhere, such as inside a library that is half-loaded,
    which may then crash; so may libraries where Python takes them down. So neither is done.
    """
    for signal_number in (signal.SIGTERM, signal.SIGINT):
        signal.signal(signal_number, signal.SIG_IGN)
    for undo in reversed(_undo_at_end):
        undo.run()
    with suppress(OSError):
        # A progress bar hides the cursor, and the terminal has written ^C.
        show_cursor = b"\x1b[?25h\n" if is_terminal(sys.stderr) else b""
        os.write(2, show_cursor + f"{interruption()}\n".encode(errors="replace"))
    os._exit(128 + number)
