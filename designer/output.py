"""Writing results: whole or not at all."""

from __future__ import annotations

import errno
import shutil
import tempfile
from collections.abc import Container, Iterable, Iterator
from contextlib import ExitStack, contextmanager, suppress
from pathlib import Path

from designer.errors import OutputError

_FULL = (errno.ENOSPC, getattr(errno, "EDQUOT", None))  # Windows knows no quota by this name


@contextmanager
def output_folder(folder: Path, outdated: Iterable[str] = ()) -> Iterator[Path]:
    """Hand out a temporary folder; on success its files appear in ``folder``, else nothing does.

    Parameters
    ----------
    folder : Path
        May exist; files of other names stay in it.
    outdated : iterable of str
        Names of files that an earlier run may have left there: gone where this one has none.

    Raises
    ------
    OutputError
        If ``folder`` is a file, cannot be written, or has a folder where a file is to go.
    """
    with ExitStack() as undo:
        with _explained(folder):
            building = _begin(folder, undo)
        with _explained(folder, only=_FULL):
            yield building
        with _explained(folder):
            _move(building, folder, outdated, undo)
        undo.pop_all()
    shutil.rmtree(building, ignore_errors=True)


@contextmanager
def _explained(folder: Path, only: Container[int | None] | None = None) -> Iterator[None]:
    """Turn the system's refusal to write, or only some kinds of it, into a line for the user."""
    try:
        yield
    except OSError as error:
        if only is not None and error.errno not in only:
            raise
        raise OutputError(_not_writable(folder, error)) from error


def _begin(folder: Path, undo: ExitStack) -> Path:
    """Return a new folder to build in; what is made for it goes again on failure."""
    if folder.exists() and not folder.is_dir():
        raise OutputError(f"{folder}: is a file (expected a folder to write into)")
    for missing in reversed([one for one in (folder, *folder.parents) if not one.exists()]):
        undo.callback(_remove_empty, missing)
    folder.mkdir(parents=True, exist_ok=True)
    # Inside it, so that a folder which cannot be written shows before the work and not after, and
    # the final move stays on one file system.
    building = Path(tempfile.mkdtemp(prefix=".designer-", dir=folder))
    undo.callback(shutil.rmtree, building, ignore_errors=True)
    return building


def _move(building: Path, folder: Path, outdated: Iterable[str], undo: ExitStack) -> None:
    """Put all new files in place, or none: old ones wait aside until the last is there."""
    new = list(building.iterdir())
    in_the_way = [file.name for file in new if file.is_file() and (folder / file.name).is_dir()]
    if in_the_way:
        place = folder / in_the_way[0]
        raise OutputError(f"{place}: is a folder (expected a file, or nothing)")
    aside = Path(tempfile.mkdtemp(dir=building))
    for name in {*(file.name for file in new), *outdated}:
        if (folder / name).is_file():
            _move_one(folder / name, aside / name, undo)
    for file in new:
        _move_one(file, folder / file.name, undo)


def _move_one(source: Path, target: Path, undo: ExitStack) -> None:
    undo.callback(_put_back, target, source)  # first: an interrupt may come in between
    source.replace(target)


def _put_back(source: Path, target: Path) -> None:
    with suppress(OSError):  # was not moved yet
        source.replace(target)


def _remove_empty(folder: Path) -> None:
    with suppress(OSError):  # somebody has put something in
        folder.rmdir()


def _not_writable(path: Path, error: OSError) -> str:
    file = next((one for one in path.parents if _is_file(one)), None)
    reason = f"{file} is a file" if file else error.strerror
    if isinstance(error, FileExistsError) and path.is_symlink():
        reason = "it is a link that leads nowhere"
    return f"{path}: cannot be written ({reason})"


def _is_file(path: Path) -> bool:
    try:
        return path.is_file()
    except OSError:  # such as a name longer than the file system takes
        return False


def file_names(folder: Path) -> list[str]:
    """Return the names of the files in a folder, sorted."""
    return sorted(file.name for file in folder.iterdir() if file.is_file())


def write_whole(path: Path, content: bytes) -> None:
    """Write a file under another name in its folder, then rename it."""
    unfinished = path.with_name(f".{path.name}.part")
    try:
        unfinished.write_bytes(content)
        unfinished.replace(path)
    finally:
        unfinished.unlink(missing_ok=True)


def write_new_file(path: Path, text: str) -> None:
    """Write a file that must not exist yet.

    Raises
    ------
    OutputError
        If it exists, or cannot be written.
    """
    try:
        with ExitStack() as undo, path.open("x", encoding="utf-8") as file:
            undo.callback(path.unlink)
            file.write(text)
            file.flush()
            undo.pop_all()
    except FileExistsError as error:
        raise OutputError(f"{path}: exists already (expected a new file)") from error
    except OSError as error:
        raise OutputError(_not_writable(path, error)) from error
