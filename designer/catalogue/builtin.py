"""Our own grades, which come in by the same door as everybody else's."""

from __future__ import annotations

from pathlib import Path

from designer.catalogue.hookspecs import hookimpl
from designer.resources import data_folder


@hookimpl
def register_grades() -> list[Path]:
    """Return the folder of the grades that are shipped."""
    return [data_folder("catalog")]
