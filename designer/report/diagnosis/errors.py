"""Errors from stage to stage, over all cables and cable by cable."""

from __future__ import annotations

from dataclasses import dataclass

from designer.diagnosis.errors_of import Interval
from designer.diagnosis.foretell import Foretold
from designer.diagnosis.result import Diagnosis
from designer.report import format as fmt
from designer.report.diagnosis.quantity import Quantity, quantities
from designer.report.parts import Column, Group, Picture, Row, Table


@dataclass(frozen=True, slots=True)
class ErrorsSection:
    """Errors before and after.

    Parameters
    ----------
    picture : Picture
        Held-out error at each stage with its interval.
    stages : Table
        The same in numbers, with the error over fitted rows.
    cables : tuple of Table
        Held-out error of each cable at each stage, a table for each kind of reading.
    foretold : Table or None
        Error of the pose and tensions that the lengths alone foretell, before and after.
    """

    picture: Picture
    stages: Table
    cables: tuple[Table, ...]
    foretold: Table | None


def errors_section(diagnosis: Diagnosis, picture: Picture) -> ErrorsSection:
    """Return the errors at each stage."""
    kinds = [quantity for quantity, _, _ in quantities(diagnosis)]
    columns = (
        Column("Model", is_number=False),
        Column("Fitted rows"),
        Column("Held-out rows"),
        Column("95 %"),
        Column("In units of noise"),
    )
    stages = Table(
        "Root mean square error at each stage, outliers left out; intervals by block bootstrap.",
        columns,
        tuple(_group(diagnosis, quantity) for quantity in kinds),
    )
    cables = tuple(_cables(diagnosis, quantity) for quantity in kinds)
    return ErrorsSection(picture, stages, cables, _foretold(diagnosis))


def _group(diagnosis: Diagnosis, quantity: Quantity) -> Group:
    rows = []
    for stage in diagnosis.stages:
        error = quantity.error_of(stage)
        if error is None:
            continue
        held = error.heldout
        rows.append(
            Row(
                (
                    stage.label,
                    quantity.shown(error.rms),
                    quantity.shown(held.value),
                    f"{quantity.shown(held.low)} to {quantity.shown(held.high)}",
                    quantity.in_noise(held.value),
                )
            )
        )
    noise = f"noise {quantity.with_unit(quantity.noise)}"
    return Group(tuple(rows), f"Error of {quantity.name} [{quantity.unit}]", noise)


def _cables(diagnosis: Diagnosis, quantity: Quantity) -> Table:
    rows = []
    for stage in diagnosis.stages:
        error = quantity.error_of(stage)
        if error is not None:
            values = (quantity.shown(float(value)) for value in error.heldout_of_cable)
            rows.append(Row((stage.label, *values)))
    n_cables = diagnosis.machine.robot.n_cables
    return Table.of(
        f"Error of {quantity.name} on held-out rows, cable by cable [{quantity.unit}].",
        (
            Column("Model", is_number=False),
            *(Column(f"{'Cable ' if n_cables < 5 else ''}{k}") for k in range(1, n_cables + 1)),
        ),
        *rows,
    )


def _foretold(diagnosis: Diagnosis) -> Table | None:
    before, after = diagnosis.foretold_before, diagnosis.foretold_after
    if before is None or after is None:
        return None
    rows = (
        _foretold_row("Position of the platform", "mm", 1e3, before.position_m, after.position_m),
        _foretold_row("Its orientation", "mrad", 1e3, before.turn_rad, after.turn_rad),
        _foretold_row("Tensions at the winches", "N", 1.0, before.tension_N, after.tension_N),
    )
    return Table.of(
        "Pose and tensions by forward statics from the measured lengths alone: root mean square "
        f"error on held-out rows, with its 95 % interval.{_unsolved(before, after)}",
        (Column("What the lengths foretell", is_number=False), Column("Before"), Column("After")),
        *(row for row in rows if row is not None),
    )


def _foretold_row(
    name: str, unit: str, scale: float, before: Interval | None, after: Interval | None
) -> Row | None:
    if before is None or after is None:
        return None

    def shown(interval: Interval) -> str:
        value, low, high = (
            fmt.number(scale * x, 3) for x in (interval.value, interval.low, interval.high)
        )
        return f"{value} ({low} to {high})"

    return Row((f"{name} [{unit}]", shown(before), shown(after)))


def _unsolved(before: Foretold, after: Foretold) -> str:
    lost = max(before.n_rows - before.n_solved, after.n_rows - after.n_solved)
    return f" Without {lost} rows in which no balance was found." if lost else ""
