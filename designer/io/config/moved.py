"""A study's text for another folder: the relative paths in it as they are from there."""

from __future__ import annotations

import os
from functools import partial
from pathlib import Path

from designer.documents import edits
from designer.documents.document import Document
from designer.documents.modeline import with_schema_moved
from designer.documents.node import Key


def moved_to(folder: Path, text: str, document: Document, start: Path) -> str:
    """Return the text of a document, which lies in ``start``, as it is to lie in a folder."""
    if folder.resolve() == start.resolve():
        return text
    files = document.root.child("catalogues")
    count = len(files.content) if files is not None and isinstance(files.content, tuple) else 0
    places: list[tuple[Key, ...]] = [("catalogues", k) for k in range(count)]
    for keys in [*places, ("measurements", "file"), ("document", "logo")]:
        node = document.root.at(keys)
        name = None if node is None else node.data()
        if isinstance(name, str) and not Path(name).is_absolute():
            to = path_from(folder, start / name)
            text = edits.with_value(text, keys, edits.scalar(to))
    return with_schema_moved(text, start, partial(path_from, folder))


def path_from(folder: Path, path: Path) -> str:
    """Return a path as it is from a folder."""
    try:
        return Path(os.path.relpath(path.resolve(), folder.resolve())).as_posix()
    except ValueError:  # on another drive
        return path.resolve().as_posix()
