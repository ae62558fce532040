"""Our own grades, which come in by the same door as everybody else's."""

from __future__ import annotations

from functools import cache
from pathlib import Path

from designer.grades.files import read_grades
from designer.grades.grade import Grade
from designer.grades.standard_rope import standard_ropes
from designer.plugins import hookimpl
from designer.resources import data_folder


@hookimpl
def register_grades() -> list[Path | Grade]:
    """Return the grades that are shipped, and those computed by a standard."""
    return list(_grades())


@cache
def _grades() -> tuple[Path | Grade, ...]:
    """Read them once; the folder itself where a file is faulty, so that the fault is told."""
    files, faults = read_grades(data_folder("catalog"))
    shipped = (data_folder("catalog"),) if faults else tuple(file.grade for file in files)
    return (*shipped, *standard_ropes())
