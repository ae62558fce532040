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
    found = _at_the_worst_poses(analysis) or _at_the_configured_pose(analysis)
    if found is None:
        return ()
    place, diameter_m, massless_diameter_m, tension_N, massless_tension_N = found
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


_Found = tuple[str, float, float, float, float]
"""Where, diameter with and without sag, tension with and without."""


def _at_the_worst_poses(analysis: Analysis) -> _Found | None:
    workspace = analysis.workspace
    if workspace is None or workspace.sagging is None or workspace.massless is None:
        return None
    sagging, massless = workspace.sagging, workspace.massless
    diameters = sagging.diameter_m, massless.diameter_m
    return "each at its own worst pose", *diameters, sagging.max_tension_N, massless.max_tension_N


def _at_the_configured_pose(analysis: Analysis) -> _Found | None:
    pose = analysis.pose
    if pose is None or not pose.sizing.statics.is_solved:
        return None
    sizing, massless_N = pose.sizing, float(pose.massless.largest_tension_N)
    if not np.isfinite(massless_N):
        return None
    diameters = float(sizing.diameter_m), float(sizing.massless_diameter_m)
    tension_N = float(sizing.statics.largest_tension_N)
    return "at the configured pose", *diameters, tension_N, massless_N


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
