"""Errors from stage to stage, over all cables and cable by cable."""

from __future__ import annotations

from dataclasses import dataclass

from designer.diagnosis.result import Diagnosis
from designer.report.diagnosis_sections.quantity import Quantity, quantities
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
    """

    picture: Picture
    stages: Table
    cables: tuple[Table, ...]


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
    return ErrorsSection(picture, stages, tuple(_cables(diagnosis, q) for q in kinds))


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
