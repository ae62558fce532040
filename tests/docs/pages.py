"""Reads the pages of the docs: their blocks of code, in order."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).parents[2]
DOCS = ROOT / "docs"
_BLOCK = re.compile(
    r"^```(\{code-block\} )?([\w+]+)\n(?::caption: (\S+)\n)?\n?(.*?)^```$", re.M | re.S
)


@dataclass(frozen=True)
class Block:
    """A block of code: its language, the file that it is (empty for none), its text, its line."""

    language: str
    file: str
    text: str
    line: int


def pages() -> list[Path]:
    return sorted(path for path in DOCS.rglob("*.md") if "build_helpers" not in path.parts)


def blocks(page: Path) -> Iterator[Block]:
    text = page.read_text(encoding="utf-8")
    for found in _BLOCK.finditer(text):
        line = text.count("\n", 0, found.start()) + 1
        yield Block(found[2], found[3] or "", found[4], line)
