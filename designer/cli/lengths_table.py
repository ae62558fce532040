"""What `designer lengths` prints: what each winch has to pay out, and which poses are not held."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from designer.cli.tables import bad, figure
from designer.cli.terminal import bare_table, show

if TYPE_CHECKING:
    from collections.abc import Iterator

    from designer.analysis.lengths import Lengths
    from designer.arrays import BoolArray

_MOST_ROWS = 12
"""Rows that are named one by one."""


def print_lengths(lengths: Lengths, path: Path) -> None:
    """Print a table of the cables, and the rows that are not held or lie outside the region."""
    statics = lengths.statics
    is_solved = statics.is_solved
    if is_solved.any():
        length_m, stroke_m = statics.length_m[is_solved], lengths.stroke_m
        turns = np.broadcast_to(stroke_m / lengths.cable.turn_m, stroke_m.shape)
        used = 100.0 * lengths.utilisation[is_solved].max(axis=0)
        columns = (length_m.min(axis=0), length_m.max(axis=0), stroke_m, turns, used)
        table = bare_table(
            "cable", "shortest [m]", "longest [m]", "stroke [m]", "drum turns", "used [%]",
            title=f"{len(is_solved)} poses with {lengths.cable.name}",
        )  # fmt: skip
        for cable, row in enumerate(zip(*columns, strict=True), start=1):
            texts = (figure(x, places) for x, places in zip(row, (4, 4, 4, 1, 1), strict=True))
            table.add_row(str(cable), *texts)
        show(table)
        if np.isfinite(turns).any():
            show("Drum turns: in one layer on the drum that the rope's grade suggests.")
    for line in _remarks(lengths):
        show(bad(line), soft_wrap=True)
    show(f"{path} written", markup=False)


def _remarks(lengths: Lengths) -> Iterator[str]:
    is_solved = lengths.statics.is_solved
    beyond = is_solved & ~lengths.holds
    yield from _rows(~is_solved, "not held, see the verdict")
    if beyond.any():
        used = f"{lengths.utilisation[beyond].max():.1%}"
        yield from _rows(beyond, f"beyond the allowable tension, up to {used} of it")
    yield from _rows(lengths.outside, "outside the region that the study asks for")


def _rows(which: BoolArray, what: str) -> Iterator[str]:
    rows = np.flatnonzero(which) + 1
    if len(rows):
        named = ", ".join(map(str, rows[:_MOST_ROWS])) + " …" * (len(rows) > _MOST_ROWS)
        yield f"{len(rows)} of {len(which)} poses {what}: row {named}"
