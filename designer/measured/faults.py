"""Many faults of one kind, told in a few lines."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from itertools import islice

from designer.errors import Fault
from designer.measured.cells import MOST_ALIKE


def first_few(faults: Iterable[Fault], total: int, file: str, kind: str) -> list[Fault]:
    """Return the first of ``total`` faults, and one that counts the others."""
    told = list(islice(faults, MOST_ALIKE))
    if total > len(told):
        told.append(Fault(file, None, "", f"and {total - len(told)} more {kind}"))
    return told


def row_list(rows: Sequence[int]) -> str:
    """Return row numbers in words, neighbours together: ``row 3``, ``rows 1 to 4, 9``."""
    spans: list[list[int]] = []
    for row in rows:
        if spans and row == spans[-1][1] + 1:
            spans[-1][1] = row
        else:
            spans.append([row, row])
    shown = [f"{a}" if a == b else f"{a} to {b}" for a, b in spans[:MOST_ALIKE]]
    more = ["…"] * (len(spans) > MOST_ALIKE)
    return f"row{'s' * (len(rows) != 1)} {', '.join(shown + more)}"
