"""Writing results: whole or not at all."""

from __future__ import annotations

import errno
import os
import secrets
import shutil
import time
from collections.abc import Callable, Collection, Container, Iterator
from contextlib import contextmanager, suppress
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from designer.documents.opened import other_kind
from designer.errors import OutputError
from designer.io.process import NO_ROOM, Undo, undone_at_end, written

if TYPE_CHECKING:
    from filelock import BaseFileLock

_HIDDEN = ".designer-"
_NEW, _OLD, _LOCK = "new", "old", "lock"
"""In the hidden folder: what is being made, what it replaces, and what tells that a run lives."""
_TO_LOCK_S = 60.0
"""A hidden folder of this age that has no lock is of a run which was killed before, or just after.
"""


@contextmanager
def output_folder(folder: Path, outdated: Collection[str] = ()) -> Iterator[Path]:
    """Hand out a temporary folder; on success its files appear in ``folder``, else nothing does.

    Parameters
    ----------
    folder : Path
        May exist; files of other names stay in it.
    outdated : collection of str
        Names of files that an earlier run may have left there: gone where this one has none.

    Raises
    ------
    OutputError
        If ``folder`` is a file, cannot be written, or has something else where a file is to go.
    """
    with undone_at_end() as undo:
        with explained(folder):
            building = _begin(folder, undo)
            for name in outdated:
                _target(folder / name)
        with explained(folder, only=(*NO_ROOM, errno.ENAMETOOLONG)):
            yield building
        with explained(folder), undone_at_end() as back:
            aside = _move(building, folder, outdated, back)
            written[folder] = None
            back.forget()
            # In one step: from here on a run that is killed has nothing to give back.
            aside.replace(aside.with_name("outdated"))


@contextmanager
def explained(folder: Path, only: Container[int | None] | None = None) -> Iterator[None]:
    """Turn the system's refusal to write, or only some kinds of it, into a line for the user."""
    try:
        yield
    except OSError as error:
        if only is not None and error.errno not in only:
            raise
        file = next(filter(os.path.isfile, folder.parents), None)  # pathlib's fails at a long name
        reason = f"{file} is a file" if file else error.strerror
        if isinstance(error, FileExistsError) and folder.is_symlink():
            reason = "it is a link that leads nowhere"
        raise OutputError(f"{folder}: cannot be written ({reason})") from error


def _begin(folder: Path, undo: Undo) -> Path:
    """Return a new folder to build in; what is made for it goes again at the end."""
    from filelock import FileLock

    if folder.exists() and not folder.is_dir():
        raise OutputError(f"{folder}: is a file (expected a folder to write into)")
    for missing in reversed(
        [parent for parent in (folder, *folder.parents) if not parent.exists()]
    ):
        undo.add(partial(_attempt, missing.rmdir))  # somebody may have put something in
    folder.mkdir(parents=True, exist_ok=True)
    clear_left_overs(folder)
    # Inside it, so that a folder which cannot be written shows before the work and not after, and
    # the final move stays on one file system.
    hidden = folder / f"{_HIDDEN}{secrets.token_hex(4)}"
    lock = FileLock(hidden / _LOCK)
    undo.add(partial(_remove_hidden, hidden, lock))
    hidden.mkdir(mode=0o700)
    with suppress(NotImplementedError):  # a file system without locks
        lock.acquire()
    building = hidden / _NEW
    building.mkdir()
    return building


def _remove_hidden(hidden: Path, lock: BaseFileLock) -> None:
    for part in hidden.glob("*"):  # the lock last: without it nobody knows what the rest is
        if part.name != _LOCK:
            shutil.rmtree(part, ignore_errors=True)
    lock.release()  # Windows removes no file that is open
    shutil.rmtree(hidden, ignore_errors=True)


def clear_left_overs(folder: Path) -> None:
    """Remove what runs left in a folder that were killed; what they had put aside comes back.

    A run that lives holds the lock in its hidden folder, which ends with the process.
    """
    from filelock import FileLock, Timeout

    for hidden in folder.glob(f"{_HIDDEN}*"):
        lock = FileLock(hidden / _LOCK)
        if not (hidden / _LOCK).exists() and time.time() - hidden.stat().st_mtime < _TO_LOCK_S:
            continue  # a run may be about to lock it
        with suppress(Timeout, NotImplementedError, OSError), lock.acquire(timeout=0):
            for file in (hidden / _OLD).glob("*"):
                file.replace(os.path.realpath(folder / file.name))
            _remove_hidden(hidden, lock)


def _move(building: Path, folder: Path, outdated: Collection[str], back: Undo) -> Path:
    """Put all new files in place, or none; old ones wait in the folder that is returned."""
    new = list(building.iterdir())
    targets = {name: folder / name for name in (*(file.name for file in new), *outdated)}
    targets |= {file.name: _target(folder / file.name) for file in new if file.is_file()}
    aside = building.with_name(_OLD)
    aside.mkdir()
    for name, target in targets.items():
        if target.is_file():
            _move_one(target, aside / name, back)
    for file in new:
        _move_one(file, targets[file.name], back)
    return aside


def _move_one(source: Path, target: Path, back: Undo) -> None:
    back.add(partial(_attempt, target.replace, source))  # which may not be moved yet
    source.replace(target)


def _attempt(action: Callable[..., object], *values: Path) -> None:
    with suppress(OSError):
        action(*values)


def file_names(folder: Path) -> list[str]:
    """Return the names of the files in a folder, sorted."""
    return sorted(file.name for file in folder.iterdir() if file.is_file())


def write_whole(path: Path, content: bytes) -> None:
    """Write a file under another name in its folder, then rename it; a link stays one."""
    target = _target(path)
    unfinished = _unfinished(target)
    try:
        unfinished.write_bytes(content)
        unfinished.replace(target)
    finally:
        unfinished.unlink(missing_ok=True)


def _target(path: Path) -> Path:
    """Return which file is written at a path, through links; what is none would be lost."""
    with suppress(FileNotFoundError):
        if kind := other_kind(path.stat().st_mode):
            raise OutputError(f"{path}: is {kind} (expected a file, or nothing)")
    return Path(os.path.realpath(path))


def require_file(path: Path) -> None:
    """Refuse a path before the work that `write_file` would refuse after it."""
    with explained(path):
        unfinished = _unfinished(_target(path))
        unfinished.touch()
        unfinished.unlink()


def cache_path(*names: str) -> Path:
    """Return where a file is for other runs: in the user's folder for such."""
    from platformdirs import user_cache_path

    return user_cache_path("cdpr-designer", appauthor=False).joinpath(*names)


def write_cache(path: Path, content: bytes) -> None:
    """Write a file for other runs, if the disk takes it."""
    with suppress(OSError, OutputError):
        path.parent.mkdir(parents=True, exist_ok=True)
        write_whole(path, content)


def write_file(path: Path, text: str) -> None:
    """Write a file, whole or not at all, over what it was.

    Raises
    ------
    OutputError
        If it cannot be written.
    """
    with explained(path):
        write_whole(path, text.encode())
        written[path] = None


def write_new_file(path: Path, text: str) -> None:
    """Write a file that must not exist yet.

    Raises
    ------
    OutputError
        If it exists, or cannot be written.
    """
    unfinished = _unfinished(path)
    try:
        with explained(path), undone_at_end() as undo:
            undo.add(partial(unfinished.unlink, missing_ok=True))
            unfinished.write_bytes(text.encode())
            try:
                path.hardlink_to(unfinished)
            except (OSError, NotImplementedError):  # a file system without links
                if os.path.lexists(path):
                    raise FileExistsError(errno.EEXIST, "exists already") from None
                unfinished.replace(path)
            written[path] = None
    except OutputError as error:
        if isinstance(error.__cause__, FileExistsError):
            line = f"{path}: exists already (expected a new file)"
            raise OutputError(line) from error.__cause__
        raise


def _unfinished(path: Path) -> Path:
    """Return where a file is written first; what a kill leaves there, the next run overwrites."""
    return path.parent / f".{os.fsdecode(os.fsencode(path.name)[:240])}.part"
