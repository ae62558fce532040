"""The data: rows, outliers, what was left out, what was unknown from the start."""

from __future__ import annotations

import numpy as np

from designer.diagnosis.result import Diagnosis, Estimate
from designer.report import format as fmt
from designer.report.blocks import Box, Bullets, Column, Fact, Facts, Section, Table
from designer.report.diagnosis import words
from designer.report.diagnosis.quantity import quantities

_MOST_OUTLIERS = 30


def section(diagnosis: Diagnosis) -> Section:
    """Return what was measured, what stands off, and what these data cannot show."""
    notes, problems = diagnosis.measured.notes, diagnosis.study.known_effects.problems
    return Section.of(
        "data",
        "The data",
        Box.of("loose", _facts(diagnosis)),
        Bullets(notes) if notes else None,
        _unknown(diagnosis) if diagnosis.given else None,
        _outliers(diagnosis)
        if diagnosis.outliers
        else "No reading stands off by more than five times the spread of its kind.",
        Table.of(
            "Effects that these data cannot show.",
            ("Effect", "Reason"),
            *diagnosis.skipped,
            kind="narrow",
        )
        if diagnosis.skipped
        else None,
        *(("These plugins or effects could not be used:", Bullets(problems)) if problems else ()),
    )


def _facts(diagnosis: Diagnosis) -> Facts:
    measured, study = diagnosis.measured, diagnosis.study
    heldout = int(diagnosis.heldout.sum())
    kind = "poses at rest" if measured.settled else "samples of a slow motion"
    robot = diagnosis.machine.robot
    degrees = "a point mass" if robot.is_point_mass else "a platform that can turn"
    facts = []
    if study.measurements is not None:
        facts.append(Fact("File", study.measurements.file.name))
    facts += [
        Fact("Rows", fmt.count(measured.n_rows), kind),
        Fact("Poses", "measured" if measured.has_poses else "estimated from the readings"),
        Fact("Fitted", fmt.count(measured.n_rows - heldout)),
        Fact("Held out", fmt.count(heldout), "contiguous blocks that no fit has seen"),
        Fact("Robot", f"{robot.n_cables} cables", degrees),
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
    recorded = ", ".join((*sorted(measured.columns), *measured.covariates))
    facts.append(Fact("Recorded as well", recorded or "nothing"))
    return Facts(tuple(facts))


def _unknown(diagnosis: Diagnosis) -> Table:
    rows = (
        (setting.effect.key, p.label, words.estimate(value, p.unit))
        for setting in diagnosis.given
        for p in setting.effect.parameters
        for value in [Estimate(setting.values[p.name], float("nan"))]
    )
    return Table.of(
        "Unknown from the start: fitted with every model, and not counted as a finding.",
        ("Effect", "Parameter", Column("Value")),
        *rows,
        kind="narrow",
    )


def _outliers(diagnosis: Diagnosis) -> Table:
    outliers = sorted(diagnosis.outliers, key=lambda o: -abs(o.size))
    shown = outliers[:_MOST_OUTLIERS]
    more = len(outliers) - len(shown)
    rest = f" The {len(shown)} largest of {len(outliers)}." if more else ""
    return Table.of(
        "Outliers of the final model: kept in the data, given little weight by the fit, and left "
        f"out of the errors.{rest}",
        (Column("Row"), "Reading", Column("Off by", "times the noise")),
        *((fmt.count(o.row), o.channel, fmt.number(o.size, 3)) for o in shown),
        kind="narrow",
    )
