"""The order of the rooms, and what keeps them readable."""

from __future__ import annotations

import ast
import re
from collections import Counter
from collections.abc import Iterator
from functools import cache
from pathlib import Path

import pytest

import designer
from designer.model.region import PointList, Prism, Rectangle, Region
from designer.plugins import RINGS

ROOMS = [
    "__init__", "errors", "arrays", "spelling", "checked", "units", "resources", "progress",
    "model", "physics", "kernel", "statics", "sizing", "plugins", "effects", "study", "documents",
    "grades", "workspace", "proof", "selection", "analysis", "io",
    "report", "api", "cli",
    *(room for ring in RINGS for room in ring.rooms), "__main__",
]  # fmt: skip
"""From the bottom up; rings are above all that a report needs."""
USED_RINGS = {"window": {"exchange", "batch", "diagnosis"}}
"""Rings that a ring may import from; those of none are not named."""

FOLDER = Path(designer.__file__).parent
FILES = sorted(FOLDER.rglob("*.py"))


@cache
def trees() -> dict[Path, ast.Module]:
    return {file: ast.parse(file.read_text(encoding="utf-8")) for file in FILES}


def room_of(file: Path) -> str:
    return file.relative_to(FOLDER).parts[0].removesuffix(".py")


def imported_rooms(file: Path) -> set[str]:
    """Rooms that a file imports from at run time, wherever in the file."""
    tree = trees()[file]
    only_types = {
        id(inner)
        for node in ast.walk(tree)
        if isinstance(node, ast.If) and getattr(node.test, "id", None) == "TYPE_CHECKING"
        for inner in ast.walk(node)
    }
    names = []
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            names += [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom) and id(node) not in only_types:
            names += [f"{node.module}.{alias.name}" for alias in node.names]
    parts = (name.split(".") for name in names)
    return {room for package, room, *_ in (p for p in parts if len(p) > 1) if package == "designer"}


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


def test_the_core_imports_no_ring() -> None:
    ring_of = {room: ring.name for ring in RINGS for room in ring.rooms}
    assert set(ring_of) < set(ROOMS)
    assert ROOMS.index("cli") < min(map(ROOMS.index, ring_of))
    inward = [
        f"{file.relative_to(FOLDER)} imports {room}"
        for file in FILES
        for ring in [ring_of.get(room_of(file), "the core")]
        for room in imported_rooms(file) & set(ring_of)
        if ring_of[room] not in {ring, *USED_RINGS.get(ring, ())}
    ]
    assert inward == []


MAP = FOLDER.parent / "CONTRIBUTING.md"


@pytest.mark.skipif(not MAP.exists(), reason="an installed copy has no map")
def test_contributing_maps_every_room() -> None:
    text = MAP.read_text(encoding="utf-8")
    core, rings = (
        text.partition(f"\n| {head}")[2].partition("\n\n")[0]
        for head in ("room of the core", "ring |")
    )
    firsts = (line.split(" | ")[0] for line in core.splitlines()[2:])
    named = {name for first in firsts for name in re.findall(r"`(\w+)/?`", first)}
    ring_rooms = {room for ring in RINGS for room in ring.rooms}
    assert named == set(ROOMS) - ring_rooms - {"__init__", "__main__"}
    rows = [
        f"| {ring.name} | {', '.join(f'`{room}/`' for room in ring.rooms)} | "
        f"{', '.join(f'`{command}`' for command in ring.commands)} |"
        for ring in RINGS
    ]
    assert [row for row in rows if f"\n{row}" not in rings] == []


PRONOUNS = frozenset(
    """
    one found most some each met there those own way known told asked other others kept left few
    these what done given thing first here worse near same both none nothing where whole tried
    turned this that taken wanted shown held
    """.split()  # noqa: SIM905
)
"""Words that say nothing of what a variable holds."""
SHARE_OF_PRONOUNS = 0.02
"""Of all variables; 'left' beside 'right' and 'first' beside 'second' say enough."""


def variables_of(tree: ast.Module) -> Iterator[str]:
    for node in ast.walk(tree):
        if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store):
            yield node.id
        elif isinstance(node, ast.arg):
            yield node.arg


def test_variables_are_named_for_what_they_hold() -> None:
    names = [name.lstrip("_") for tree in trees().values() for name in variables_of(tree)]
    pronouns = Counter(name for name in names if name in PRONOUNS)
    assert len(names) > 10_000
    assert pronouns.total() <= SHARE_OF_PRONOUNS * len(names), pronouns.most_common(10)


def test_no_room_asks_a_region_what_it_is() -> None:
    kinds = {cls.__name__ for cls in (Region, Prism, Rectangle, PointList)}
    asked = [
        f"{file.relative_to(FOLDER)}:{node.lineno}"
        for file, tree in trees().items()
        for node in ast.walk(tree)
        if isinstance(node, ast.Call)
        and ast.unparse(node.func) == "isinstance"
        and kinds & {name.id for name in ast.walk(node.args[1]) if isinstance(name, ast.Name)}
    ]
    assert asked == []
