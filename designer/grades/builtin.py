"""Our own grades, which come in by the same door as everybody else's."""

from __future__ import annotations

import os
import pickle
from contextlib import suppress
from functools import cache
from hashlib import sha256
from itertools import chain
from pathlib import Path
from typing import TYPE_CHECKING

from designer.plugins import hookimpl
from designer.resources import data_folder

if TYPE_CHECKING:
    from designer.grades.grade import Grade


@hookimpl
def register_grades() -> list[Path | Grade]:
    """Return the grades that are shipped, and those computed by a standard."""
    return list(_grades())


@cache
def _grades() -> tuple[Path | Grade, ...]:
    """Read them once; the folder itself where a file is faulty, so that the fault is told."""
    from designer.grades.registry import read_grades
    from designer.grades.standard_rope import standard_ropes

    folder = data_folder("catalog")
    file = _cache_file(folder)
    grades = _read_cache(file)
    if grades is None:
        files, faults = read_grades(folder)
        if faults:
            return (folder, *standard_ropes())
        grades = tuple(grade_file.grade for grade_file in files)
        _write_cache(file, grades)
    return (*grades, *standard_ropes())


def _cache_file(folder: Path) -> Path:
    """Return where grades are cached as they were read, since to check them takes a second.

    Its name is a digest of the grade files and of all that reads them.
    """
    from platformdirs import user_cache_path

    package = Path(__file__).parents[1]
    readers = (package.glob(f"{room}*.py") for room in ("", "grades/", "documents/"))
    digest = sha256()
    for source in sorted(chain(folder.rglob("*.yaml"), *readers)):
        digest.update(source.name.encode() + source.read_bytes())
    cache_folder = user_cache_path("cdpr-designer", appauthor=False)
    return cache_folder / f"grades-{digest.hexdigest()[:32]}"


def _read_cache(file: Path) -> tuple[Grade, ...] | None:
    """Return what is cached; None where nothing is, or it is damaged."""
    with suppress(OSError):
        digest, data = file.read_bytes()[:32], file.read_bytes()[32:]
        if sha256(data).digest() == digest:
            grades: tuple[Grade, ...] = pickle.loads(data)
            return grades
    return None


def _write_cache(file: Path, grades: tuple[Grade, ...]) -> None:
    """Write the grades, if the disk takes them; the file appears whole."""
    data = pickle.dumps(grades)
    trial = file.with_suffix(f".{os.getpid()}")
    with suppress(OSError):
        file.parent.mkdir(parents=True, exist_ok=True)
        trial.write_bytes(sha256(data).digest() + data)
        trial.replace(file)
