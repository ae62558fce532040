"""What ``designer diagnose --check`` prints."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from rich.markup import escape

from designer.cli.terminal import bare_table, show

if TYPE_CHECKING:
    from designer.diagnosis.check import Check, Left


def print_check(check: Check, folder: Path, written: Sequence[str]) -> None:
    """Print what is left without and with the declared effects, and what to make of it."""
    models = [("without effects", check.without)]
    if check.fitted is not None:
        unknown = ", ".join(dict.fromkeys(s.effect.id for s in check.fitted.settings))
        models.append((f"without, {unknown} fitted to these rows", check.fitted))
    models.append(("with the effects, nothing fitted", check.declared))
    table = bare_table("error", "model", "rms", "95 %", "median", title=check.study.name)
    for name, unit, scale in (("length", "mm", 1e3), ("tension", "N", 1.0)):
        for label, model in models:
            left = model.length_m if name == "length" else model.tension_N
            if left is not None:
                table.add_row(f"{name} [{unit}]".replace("[", r"\["), label, *_cells(left, scale))
    for label, model in models:
        if model.foretold is not None and model.foretold.n_solved:
            place = model.foretold.position_m
            value, low, high = (f"{1e3 * x:.4g}" for x in (place.value, place.low, place.high))
            table.add_row(r"pose by lengths \[mm]", label, value, f"{low} to {high}", "")
    show(table)
    for line in _remarks(check):
        show(escape(line))
    show(escape(f"{folder}: {', '.join(written)}"))


def _cells(left: Left, scale: float) -> tuple[str, str, str]:
    value, low, high, median = (
        f"{scale * x:.4g}" for x in (left.rms.value, left.rms.low, left.rms.high, left.median)
    )
    return value, f"{low} to {high}", median


def _remarks(check: Check) -> Iterator[str]:
    yield f"{check.n_compared} of {check.measured.n_rows} rows compared, outliers and all."
    if not check.study.effects:
        yield "The config declares no effects."
    elif not check.helps:
        yield "The declared effects do not help on these data."
    for key, reason in check.idle:
        yield f"{key} is declared and does not act here: {reason}."
    if check.declared.n_not_held:
        yield f"With the effects the robot cannot hold {check.declared.n_not_held} rows."
    carriers = check.structure.carriers
    if check.structure.is_present:
        share = f"{carriers[0].fraction_of_variance:.0%} of its variance"
        yield f"What is left goes with {carriers[0].name}, {share}."
    elif carriers:
        yield "What is left goes with nothing that was recorded."
    if check.outliers:
        yield f"{len(check.outliers)} readings stand off by more than five times the spread."
