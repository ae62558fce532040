"""A study's text for another folder: the relative paths in it as they are from there.

At its head a comment names the schema by which editors check it, without a network.
"""

from __future__ import annotations

import os
import re
from collections.abc import Callable
from functools import partial
from pathlib import Path

from designer.documents import edits
from designer.documents.document import Document, Key

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


def moved_to(folder: Path, text: str, document: Document, start: Path) -> str:
    """Return the text of a document, which lies in ``start``, as it is to lie in a folder."""
    if folder.resolve() == start.resolve():
        return text
    places: list[tuple[Key, ...]] = [("measurements", "file"), ("document", "logo"), *_TABLES]
    sessions = _items(document, ("measurements", "sessions"))
    of_sessions = [(*session, "file") for session in sessions]
    places += of_sessions
    for listed in (("catalogues",), ("measurements", "file"), *of_sessions):
        places += _items(document, listed)
    for keys in places:
        node = document.root.at(keys)
        name = None if node is None else node.data()
        if isinstance(name, str) and not Path(name).is_absolute():
            to = path_from(folder, start / name)
            text = edits.with_value(text, keys, edits.scalar(to))
    return with_schema_moved(text, start, partial(path_from, folder))


_TABLES = (
    ("selection", "prices"),
    ("workspace", "poses"),
    ("workspace", "path"),
    ("workspace", "path", "file"),
    ("workspace", "orientation", "table"),
)


def path_from(folder: Path, path: Path) -> str:
    """Return a path as it is from a folder."""
    try:
        return Path(os.path.relpath(path.resolve(), folder.resolve())).as_posix()
    except ValueError:  # on another drive
        return path.resolve().as_posix()


def _items(document: Document, listed: tuple[Key, ...]) -> list[tuple[Key, ...]]:
    """Return the places of a list's items; none where there is no list."""
    node = document.root.at(listed)
    count = len(node.content) if node is not None and isinstance(node.content, tuple) else 0
    return [(*listed, k) for k in range(count)]
