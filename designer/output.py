"""Writing results: whole or not at all."""

from __future__ import annotations

import shutil
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from designer.errors import OutputError


@contextmanager
def output_folder(folder: Path) -> Iterator[Path]:
    """Hand out a temporary folder; on success its files appear in ``folder``, else nothing does.

    Raises
    ------
    OutputError
        If ``folder`` is a file, or cannot be written.
    """
    if folder.exists() and not folder.is_dir():
        raise OutputError(f"{folder}: is a file (expected a folder to write the report into)")
    try:
        folder.parent.mkdir(parents=True, exist_ok=True)
        # Beside the target, so that the final move stays on one file system; inside it where it
        # exists, so that a folder which cannot be written shows before the work and not after.
        place = folder if folder.exists() else folder.parent
        building = Path(tempfile.mkdtemp(prefix=".designer-", dir=place))
    except OSError as error:
        raise OutputError(f"{folder}: cannot be written ({error.strerror})") from error
    try:
        yield building
        folder.mkdir(exist_ok=True)
        for file in building.iterdir():
            file.replace(folder / file.name)
    finally:
        shutil.rmtree(building, ignore_errors=True)


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
        with path.open("x", encoding="utf-8") as file:
            file.write(text)
    except FileExistsError as error:
        raise OutputError(f"{path}: exists already (expected a new file)") from error
    except OSError as error:
        raise OutputError(f"{path}: cannot be written ({error.strerror})") from error
