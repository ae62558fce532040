"""What ignoring sag would have cost."""

from __future__ import annotations

import numpy as np

from designer.analysis.analyse import Analysis
from designer.analysis.findings import Findings, MasslessChoice
from designer.report import format as fmt
from designer.report.blocks import Block, Column, Table


def sag_cost(analysis: Analysis, findings: Findings) -> tuple[Block, ...]:
    """Compare with and without sag at the worst pose, or at the configured pose.

    Also what a design without sag would have bought, and how it would fare; empty where there is
    nothing to compare.
    """
    pairs = _workspace_pairs(analysis) or _pose_pairs(analysis)
    if pairs is None:
        return ()
    (diameter_m, massless_diameter_m), (tension_N, massless_tension_N), place = pairs
    diameters = fmt.millimetres(massless_diameter_m), fmt.millimetres(diameter_m)
    tensions = fmt.newtons_alike(massless_tension_N, tension_N)
    table = Table.of(
        f"Configured cable family, {place}.",
        ("", Column("Without sag"), Column("With sag"), Column("Factor")),
        ("Diameter", *diameters, fmt.factor(diameter_m / massless_diameter_m)),
        ("Tension", *tensions, fmt.factor(tension_N / massless_tension_N)),
        kind="small",
    )
    choice = findings.massless_choice
    return (table, _consequence(analysis, choice)) if choice else (table,)


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
