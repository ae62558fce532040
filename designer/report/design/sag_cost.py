"""What ignoring sag would have cost."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from designer.analysis.analyse import Analysis
from designer.analysis.findings import Findings, MasslessChoice
from designer.report import format as fmt
from designer.report.parts import Column, Row, Table


@dataclass(frozen=True, slots=True)
class SagCost:
    """With and without sag.

    Parameters
    ----------
    table : Table
        Diameter and tension in the configured family, and the factor between the two.
    consequence : str
        What a design without sag would have bought, and how it would fare; may be empty.
    """

    table: Table
    consequence: str


def sag_cost(analysis: Analysis, findings: Findings) -> SagCost | None:
    """Compare with and without sag at the worst pose, or at the configured pose."""
    pairs = _workspace_pairs(analysis) or _pose_pairs(analysis)
    if pairs is None:
        return None
    (diameter_m, massless_diameter_m), (tension_N, massless_tension_N), place = pairs
    columns = (
        Column("", is_number=False),
        Column("Without sag"),
        Column("With sag"),
        Column("Factor"),
    )
    rows = (
        Row(
            (
                "Diameter",
                fmt.millimetres(massless_diameter_m),
                fmt.millimetres(diameter_m),
                fmt.factor(diameter_m / massless_diameter_m),
            )
        ),
        Row(
            (
                "Tension",
                *fmt.newtons_alike(massless_tension_N, tension_N),
                fmt.factor(tension_N / massless_tension_N),
            )
        ),
    )
    caption = f"Configured cable family, {place}."
    choice = findings.massless_choice
    return SagCost(
        Table.of(caption, columns, *rows), _consequence(analysis, choice) if choice else ""
    )


Pairs = tuple[tuple[float, float], tuple[float, float], str]


def _workspace_pairs(analysis: Analysis) -> Pairs | None:
    workspace = analysis.workspace
    if workspace is None or workspace.sagging is None or workspace.massless is None:
        return None
    sagging, massless = workspace.sagging, workspace.massless
    return (
        (sagging.diameter_m, massless.diameter_m),
        (sagging.max_tension_N, massless.max_tension_N),
        "each at its own worst pose",
    )


def _pose_pairs(analysis: Analysis) -> Pairs | None:
    pose = analysis.pose
    if pose is None or not pose.sizing.statics.is_solved:
        return None
    massless_N = float(pose.massless.largest_tension_N)
    if not np.isfinite(massless_N):
        return None
    return (
        (float(pose.sizing.diameter_m), float(pose.sizing.massless_diameter_m)),
        (float(pose.sizing.statics.largest_tension_N), massless_N),
        "at the configured pose",
    )


def _consequence(analysis: Analysis, choice: MasslessChoice) -> str:
    assert analysis.selection is not None
    assert analysis.selection.chosen is not None
    assert analysis.study.selection is not None
    if choice.size == analysis.selection.chosen.size:
        return f"For the chosen grade the size would have been the same, {choice.size.id}."
    found = choice.verification
    start = f"Without sag, {choice.size.id} of the chosen grade would have been bought."
    if not np.isfinite(found.max_tension_N):
        return f"{start} With sag it cannot hold the whole workspace at all."
    required = fmt.trimmed(analysis.study.selection.safety_factor)
    return (
        f"{start} With sag its safety factor is {fmt.fixed(choice.safety_factor, 2)} instead of "
        f"{required}."
    )
