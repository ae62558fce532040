"""The comment at the head of a study by which editors find its schema, without a network."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path

SCHEMA_FILE = "cdpr-designer.schema.json"
"""What `designer init` calls the schema, beside the study."""

_MODELINE = re.compile(r"^(# yaml-language-server: \$schema=)(\S+)$", re.MULTILINE)


def with_modeline(text: str) -> str:
    """Return a study with the comment before it; the path is relative to the study."""
    return f"# yaml-language-server: $schema={SCHEMA_FILE}\n{text}"


def with_schema_moved(text: str, start: Path, moved: Callable[[Path], str]) -> str:
    """Return a study whose comment, if it has one, names the same schema from another folder.

    ``start`` is the folder that the study was in; ``moved`` gives a path as it is from the other.
    """

    def renamed(match: re.Match[str]) -> str:
        head, name = match.groups()
        is_relative = "://" not in name and not Path(name).is_absolute()
        return head + (moved(start / name) if is_relative else name)

    return _MODELINE.sub(renamed, text)
