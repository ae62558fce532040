"""The effect of the weight of the cables, and what ignoring it would have cost."""

from __future__ import annotations

import numpy as np

from designer.analysis.analyse import Analysis
from designer.analysis.findings import MasslessChoice
from designer.analysis.governing_ropes import GoverningRopes
from designer.report import format as fmt
from designer.report.blocks import Block, Column, Table
from designer.report.design.source import Source


def sag_cost(source: Source) -> tuple[Block, ...]:
    """Compare with and without the weight of the cables: of the chosen ropes at their worst pose.

    Also what a design without it would have bought, and how it would fare. Without a rope of the
    configured family at the worst pose, or the configured one; empty where nothing compares.
    """
    analysis, choice = source.analysis, source.analysis.findings.massless_choice
    if source.analysis.ropes is not None:
        said = (_consequence(analysis, choice),) if choice else ()
        return (*_of_rope(source.analysis.ropes), *said)
    found = _at_the_worst_poses(analysis) or _at_the_configured_pose(analysis)
    if found is None:
        return ()
    place, diameter_m, massless_diameter_m, tension_N, massless_tension_N = found
    diameters = fmt.millimetres(massless_diameter_m), fmt.millimetres(diameter_m)
    tensions = fmt.newtons_alike(massless_tension_N, tension_N)
    table = Table.of(
        f"Configured cable family, {place}.",
        _HEADS,
        ("Diameter", *diameters, fmt.factor(diameter_m / massless_diameter_m)),
        ("Tension", *tensions, fmt.factor(tension_N / massless_tension_N)),
        kind="small",
    )
    return (table,)


_HEADS = ("", Column("Without"), Column("With"), Column("Factor"))


def _of_rope(rope: GoverningRopes) -> tuple[Block, ...]:
    """Return tension and utilisation without and with the weight of the ropes."""
    statics, straight = rope.worst, rope.straight.tension_N
    if not statics.is_solved or not (straight >= 0.0).all():
        return ("Straight weightless cables cannot hold the worst pose at all.",)
    without = float((straight / rope.cable.allowable_tension_N).max())
    used = float(rope.used(statics))
    tensions = float(straight.max()), float(statics.largest_tension_N)
    return (
        Table.of(
            f"{rope.name} at its worst pose.",
            _HEADS,
            ("Tension", *fmt.newtons_alike(*tensions), fmt.factor(tensions[1] / tensions[0])),
            ("Used", fmt.utilisation(without), fmt.utilisation(used), fmt.factor(used / without)),
            kind="small",
        ),
    )


_Found = tuple[str, float, float, float, float]
"""Where, diameter with and without sag, tension with and without."""


def _at_the_worst_poses(analysis: Analysis) -> _Found | None:
    workspace = analysis.workspace
    if workspace is None or workspace.sagging is None or workspace.massless is None:
        return None
    sagging, massless = workspace.sagging, workspace.massless
    diameters = sagging.diameter_m, massless.diameter_m
    where = "each at its own worst pose"
    where += ", at rest" if analysis.study.load_cases else ""
    return where, *diameters, sagging.max_tension_N, massless.max_tension_N


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
        return f"Without it the size would have been the same, {choice.size.id}."
    found = choice.verification
    start = f"Without it, {choice.size.id} of the chosen grade would have been bought."
    if not np.isfinite(found.max_tension_N):
        return f"{start} With it this was not found to hold the whole workspace."
    required = fmt.trimmed(analysis.study.selection.safety_factor)
    return (
        f"{start} With it its safety factor is {fmt.fixed(choice.safety_factor, 2)} instead of "
        f"{required}."
    )
