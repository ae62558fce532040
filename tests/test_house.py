"""The order of the rooms: nothing imports from a room that stands above it."""

from __future__ import annotations

import ast
from pathlib import Path

import designer

ROOMS = [
    "__init__", "errors", "arrays", "spelling", "units", "resources", "progress", "model",
    "physics", "kernel", "statics", "sizing", "plugins", "effects", "study", "documents",
    "grades", "measured", "workspace", "proof", "selection", "diagnosis", "analysis", "io",
    "foreign", "reference", "report", "api", "sweep", "optimum", "explore", "cli", "__main__",
]  # fmt: skip
"""From the bottom up."""

FOLDER = Path(designer.__file__).parent
FILES = sorted(FOLDER.rglob("*.py"))


def room_of(file: Path) -> str:
    return file.relative_to(FOLDER).parts[0].removesuffix(".py")


def imported_rooms(file: Path) -> set[str]:
    """Rooms that a file imports from at run time, wherever in the file."""
    tree = ast.parse(file.read_text(encoding="utf-8"))
    only_types = {
        id(inner)
        for node in ast.walk(tree)
        if isinstance(node, ast.If) and ast.unparse(node.test) == "TYPE_CHECKING"
        for inner in ast.walk(node)
    }
    found = set()
    for node in ast.walk(tree):
        if isinstance(node, ast.ImportFrom) and node.module and id(node) not in only_types:
            parts = node.module.split(".")
            if parts[0] == "designer":
                found |= {parts[1]} if len(parts) > 1 else {alias.name for alias in node.names}
    return found


def test_every_room_has_its_place() -> None:
    assert sorted({room_of(file) for file in FILES}) == sorted(ROOMS)


def test_nothing_imports_from_above() -> None:
    assert len(FILES) > 100
    upward = [
        f"{file.relative_to(FOLDER)} imports {room}"
        for file in FILES
        for room in imported_rooms(file) & set(ROOMS)
        if ROOMS.index(room) > ROOMS.index(room_of(file))
    ]
    assert upward == []
