"""Errors from stage to stage, over all cables and cable by cable."""

from __future__ import annotations

from designer.diagnosis.errors_of import Interval
from designer.diagnosis.result import Diagnosis
from designer.report import format as fmt
from designer.report.blocks import Column, Group, Picture, Row, Section, Table
from designer.report.diagnosis.quantity import Quantity, quantities
from designer.report.pictures import chart


def section(diagnosis: Diagnosis) -> Section:
    """Return the errors at each stage."""
    kinds = [quantity for quantity, _, _ in quantities(diagnosis)]
    numbers = ("Fitted rows", "Held-out rows", "95 %", "In units of noise")
    stages = Table.grouped(
        "Root mean square error at each stage, outliers left out; intervals by block bootstrap.",
        ("Model", *map(Column, numbers)),
        (_group(diagnosis, quantity) for quantity in kinds),
    )
    return Section.of(
        "errors",
        "Errors before and after",
        _chart(diagnosis),
        stages,
        _foretold(diagnosis),
        *(_cables(diagnosis, quantity) for quantity in kinds),
    )


def _chart(diagnosis: Diagnosis) -> Picture:
    from designer.report.figures.diagnosis import errors_chart

    return chart(
        "Error on held-out rows at each stage, with 95 % intervals. At the dashed line the "
        "model is as good as the readings.",
        "A row for each stage, a panel for each kind of reading",
        errors_chart(diagnosis),
    )


def _group(diagnosis: Diagnosis, quantity: Quantity) -> Group:
    rows = tuple(
        Row(
            (
                stage.label,
                quantity.shown(error.rms),
                quantity.shown(error.heldout.value),
                quantity.interval(error.heldout),
                quantity.in_noise(error.heldout.value),
            )
        )
        for stage in diagnosis.stages
        if (error := quantity.error_of(stage)) is not None
    )
    noise = f"noise {quantity.with_unit(quantity.noise)}"
    return Group(rows, f"Error of {quantity.name} [{quantity.unit}]", noise)


def _cables(diagnosis: Diagnosis, quantity: Quantity) -> Table:
    rows = (
        (stage.label, *(quantity.shown(float(value)) for value in error.heldout_of_cable))
        for stage in diagnosis.stages
        if (error := quantity.error_of(stage)) is not None
    )
    n_cables = diagnosis.machine.robot.n_cables
    prefix = "Cable " if n_cables < 5 else ""
    return Table.of(
        f"Error of {quantity.name} on held-out rows, cable by cable [{quantity.unit}].",
        ("Model", *(Column(f"{prefix}{k}") for k in range(1, n_cables + 1))),
        *rows,
    )


def _foretold(diagnosis: Diagnosis) -> Table | None:
    """Return the error of what the lengths alone foretell; None where that is not known."""
    before, after = diagnosis.foretold_before, diagnosis.foretold_after
    if before is None or after is None:
        return None
    rows = (
        ("Position of the platform [mm]", 1e3, before.position_m, after.position_m),
        ("Its orientation [mrad]", 1e3, before.turn_rad, after.turn_rad),
        ("Tensions at the winches [N]", 1.0, before.tension_N, after.tension_N),
    )
    lost = max(one.n_rows - one.n_solved for one in (before, after))
    unsolved = f" Without {lost} rows in which no balance was found." if lost else ""
    return Table.of(
        "Pose and tensions by forward statics from the measured lengths alone: root mean square "
        f"error on held-out rows, with its 95 % interval.{unsolved}",
        ("What the lengths foretell", Column("Before"), Column("After")),
        *(
            (name, _with_interval(was, scale), _with_interval(now, scale))
            for name, scale, was, now in rows
            if was is not None and now is not None
        ),
    )


def _with_interval(found: Interval, scale: float) -> str:
    ends = (found.value, found.low, found.high)
    value, low, high = (fmt.number(scale * x, 3) for x in ends)
    return f"{value} ({low} to {high})"
