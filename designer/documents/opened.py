"""The one place that opens files of the user's: regular ones alone.

A pipe that nobody writes into, or a terminal, would be waited for without end, and a device such as
/dev/zero never ends.
"""

from __future__ import annotations

import errno
import os
import stat
from pathlib import Path
from typing import BinaryIO

from designer.errors import InputError

LARGEST_FILE_BYTES = 1_000_000
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


def other_kind(mode: int) -> str:
    """Return what is no regular file, such as ``a pipe``; empty for what is one."""
    return _KINDS.get(stat.S_IFMT(mode), "of another kind")


def _require_regular(mode: int) -> None:
    if kind := other_kind(mode):  # the number makes it an IsADirectoryError, where it is
        number = errno.EISDIR if stat.S_ISDIR(mode) else errno.EINVAL
        raise OSError(number, f"it is {kind}, not a file")
