"""The one place that opens files of the user's: regular ones alone.

A pipe that nobody writes into, or a terminal, would be waited for without end, and a device such as
/dev/zero never ends. What unpacks without end is read `apart`.
"""

from __future__ import annotations

import errno
import json
import os
import stat
import subprocess
import sys
from collections.abc import Callable
from contextlib import suppress
from importlib import import_module
from pathlib import Path
from typing import Any, BinaryIO

from designer.errors import InputError

LARGEST_FILE_BYTES = 1_000_000
_MAX_MEMORY_BYTES = 2 << 30
_START = (
    "import json, sys; sys.path[:] = json.loads(sys.argv[1]); "
    "from designer.documents.opened import answer; answer(*json.loads(sys.argv[2]))"
)
_KINDS = {
    stat.S_IFREG: "",
    stat.S_IFDIR: "a folder",
    stat.S_IFIFO: "a pipe",
    stat.S_IFCHR: "a device",
    stat.S_IFBLK: "a device",
    stat.S_IFSOCK: "a socket",
}


def open_input(path: Path) -> BinaryIO:
    """Open a regular file to read it.

    Raises
    ------
    OSError
        If it cannot be opened, or is no regular file.
    ValueError
        If its name cannot be one.
    """
    _require_regular(path.stat().st_mode)  # to open some devices does something already
    # What was exchanged for a pipe since then is not waited for.
    flags = os.O_RDONLY | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_BINARY", 0)
    file = os.fdopen(os.open(path, flags), "rb")
    try:
        _require_regular(os.fstat(file.fileno()).st_mode)
    except OSError:
        file.close()
        raise
    return file


def read_input(path: Path) -> bytes:
    """Return what a regular file holds; raises as `open_input` does."""
    with open_input(path) as file:
        return file.read()


def reason(error: Exception) -> str:
    """Return in a few words why `open_input` could not open a file."""
    return str(getattr(error, "strerror", None) or "its name is not valid").lower()


def read_bytes(path: Path, name: str, kind: str = "a YAML file") -> bytes:
    """Return what a file holds that the user calls ``name``, and that should be such a file.

    Raises
    ------
    InputError
        If it cannot be read, or is larger than `LARGEST_FILE_BYTES`.
    """
    problem, raw = "the file is too large", b""
    try:
        size = path.stat().st_size
        if size > LARGEST_FILE_BYTES and path.is_file():
            problem = f"the file has {size / 1e6:.3g} MB"
        else:
            with open_input(path) as file:
                raw = file.read(LARGEST_FILE_BYTES + 1)
            if len(raw) <= LARGEST_FILE_BYTES:
                return raw
    except FileNotFoundError:
        problem = "there is no such file"
    except IsADirectoryError:
        problem = "this is a folder"
    except (OSError, ValueError) as error:
        problem = f"the file cannot be read: {reason(error)}"
    expected = f"{kind} of at most {LARGEST_FILE_BYTES / 1e6:g} MB"
    raise InputError.at(name, problem, expected)


def apart(read: Callable[..., Any], content: bytes, longest_s: int, *options: object) -> Any:
    """Return what a function makes of a file; None where it fails, or takes too much.

    The function is one of a module, is given the file and ``options``, and returns what JSON can
    hold. Another process calls it, with 2 GB of memory and ``longest_s`` of its processor.
    """
    task = json.dumps((read.__module__, read.__name__, longest_s, *options))
    frugal = {**os.environ, "OPENBLAS_NUM_THREADS": "1"}  # each thread takes of the memory
    with suppress(subprocess.SubprocessError):
        process = subprocess.run(
            [sys.executable, "-P", "-c", _START, json.dumps(sys.path), task],
            input=content, capture_output=True, env=frugal, timeout=4 * longest_s, check=True,
        )  # fmt: skip
        return json.loads(process.stdout.splitlines()[-1])
    return None


def answer(module: str, function: str, longest_s: int, *options: object) -> None:
    """Answer `apart`, in its process."""
    read = getattr(import_module(module), function)
    with suppress(ImportError, ValueError, OSError):  # Windows has no limits, macOS not all
        import resource

        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
        resource.setrlimit(resource.RLIMIT_CPU, (longest_s, longest_s))
        resource.setrlimit(resource.RLIMIT_AS, (_MAX_MEMORY_BYTES, _MAX_MEMORY_BYTES))
    print(json.dumps(read(sys.stdin.buffer.read(), *options)))


def other_kind(mode: int) -> str:
    """Return what is no regular file, such as ``a pipe``; empty for what is one."""
    return _KINDS.get(stat.S_IFMT(mode), "of another kind")


def _require_regular(mode: int) -> None:
    if kind := other_kind(mode):  # the number makes it an IsADirectoryError, where it is
        number = errno.EISDIR if stat.S_ISDIR(mode) else errno.EINVAL
        raise OSError(number, f"it is {kind}, not a file")
