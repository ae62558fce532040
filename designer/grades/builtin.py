"""Our own grades, which come in by the same door as everybody else's."""

from __future__ import annotations

from pathlib import Path

from designer.grades.grade import Grade
from designer.grades.standard_rope import standard_ropes
from designer.plugins import hookimpl
from designer.resources import data_folder


@hookimpl
def register_grades() -> list[Path | Grade]:
    """Return the folder of the grades that are shipped, and those computed by a standard."""
    return [data_folder("catalog"), *standard_ropes()]
