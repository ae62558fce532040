"""The data: rows, outliers, what was left out, what was unknown from the start."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from designer.diagnosis.result import Diagnosis, Estimate
from designer.report import format as fmt
from designer.report.diagnosis import words
from designer.report.diagnosis.quantity import quantities
from designer.report.parts import Column, Fact, Row, Table

_MOST_OUTLIERS = 30


@dataclass(frozen=True, slots=True)
class DataSection:
    """The data.

    Parameters
    ----------
    facts : tuple of Fact
        File, rows, noise, cable on the machine.
    notes : tuple of str
        What the reader of the file has to say.
    unknown : Table or None
        What was unknown from the start, with its values.
    outliers : Table or None
        Readings that were given little weight.
    skipped : Table or None
        Effects that this data cannot show, and why.
    left_out : tuple of str
        Plugins and effects that could not be used, and why.
    """

    facts: tuple[Fact, ...]
    notes: tuple[str, ...]
    unknown: Table | None
    outliers: Table | None
    skipped: Table | None
    left_out: tuple[str, ...]


def data_section(diagnosis: Diagnosis) -> DataSection:
    """Return what the data are."""
    return DataSection(
        facts=tuple(_facts(diagnosis)),
        notes=diagnosis.measured.notes,
        unknown=_unknown(diagnosis),
        outliers=_outliers(diagnosis),
        skipped=_skipped(diagnosis),
        left_out=diagnosis.study.known_effects.problems,
    )


def _facts(diagnosis: Diagnosis) -> list[Fact]:
    measured, study = diagnosis.measured, diagnosis.study
    heldout = int(diagnosis.heldout.sum())
    kind = "poses at rest" if measured.settled else "samples of a slow motion"
    facts = []
    if study.measurements is not None:
        facts.append(Fact("File", study.measurements.file.name))
    facts += [
        Fact("Rows", fmt.count(measured.n_rows), kind),
        Fact("Fitted", fmt.count(measured.n_rows - heldout)),
        Fact("Held out", fmt.count(heldout), "contiguous blocks that no fit has seen"),
        Fact("Robot", f"{diagnosis.machine.robot.n_cables} cables", _degrees(diagnosis)),
    ]
    left = diagnosis.imbalance
    if left is not None and not np.isnan(left).all():
        shown = f"{fmt.percent(float(np.nanmedian(left)), 2)} of the platform's weight"
        most = f"median; {fmt.percent(float(np.nanmax(left)), 2)} at most, as it sways"
        facts.append(Fact("Out of balance", shown, most))
    for quantity, _, _ in quantities(diagnosis):
        noise = quantity.with_unit(quantity.noise)
        facts.append(Fact(f"Noise of a {quantity.name}", noise, diagnosis.noise.source))
    cable = diagnosis.machine.cable
    mass = fmt.kilograms_per_metre(cable.linear_density_kg_per_m)
    facts.append(Fact("Cable on the machine", mass, f"EA {fmt.newtons(cable.axial_stiffness_N)}"))
    facts.append(Fact("Recorded as well", ", ".join(_recorded(diagnosis)) or "nothing"))
    return facts


def _degrees(diagnosis: Diagnosis) -> str:
    return "a point mass" if diagnosis.machine.robot.is_point_mass else "a platform that can turn"


def _recorded(diagnosis: Diagnosis) -> list[str]:
    measured = diagnosis.measured
    return [*sorted(measured.columns), *measured.covariates]


def _unknown(diagnosis: Diagnosis) -> Table | None:
    if not diagnosis.given:
        return None
    rows = [
        Row(
            (
                setting.effect.key,
                words.label(p.name),
                words.estimate(Estimate(setting.values[p.name], float("nan")), p.unit),
            )
        )
        for setting in diagnosis.given
        for p in setting.effect.parameters
    ]
    return Table.of(
        "Unknown from the start: fitted with every model, and not counted as a finding.",
        (Column("Effect", is_number=False), Column("Parameter", is_number=False), Column("Value")),
        *rows,
    )


def _outliers(diagnosis: Diagnosis) -> Table | None:
    outliers = sorted(diagnosis.outliers, key=lambda o: -abs(o.size))
    if not outliers:
        return None
    shown = outliers[:_MOST_OUTLIERS]
    more = len(outliers) - len(shown)
    rest = f" The {len(shown)} largest of {len(outliers)}." if more else ""
    return Table.of(
        "Outliers of the final model: kept in the data, given little weight by the fit, and left "
        f"out of the errors.{rest}",
        (Column("Row"), Column("Reading", is_number=False), Column("Off by", "times the noise")),
        *(Row((fmt.count(o.row), o.channel, fmt.number(o.size, 3))) for o in shown),
    )


def _skipped(diagnosis: Diagnosis) -> Table | None:
    if not diagnosis.skipped:
        return None
    return Table.of(
        "Effects that these data cannot show.",
        (Column("Effect", is_number=False), Column("Reason", is_number=False)),
        *(Row(item) for item in diagnosis.skipped),
    )
