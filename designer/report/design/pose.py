"""The configured pose alone: massless, the loop turn by turn, the optimum, every cable."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace
from typing import SupportsFloat

import numpy as np

from designer.analysis.pose import PoseAnalysis
from designer.model.verdict import Verdict
from designer.report import format as fmt
from designer.report.blocks import (
    Block,
    Box,
    Column,
    Fact,
    Facts,
    Picture,
    Row,
    Section,
    Statement,
    Table,
    Tone,
)
from designer.report.design.scope import pose_statement
from designer.report.design.source import Source
from designer.report.pictures import chart
from designer.sizing.loop import LoopSizing

_MOST_TURNS = 8
_LAST_TURNS = 3
_FAR = 100.0
"""Tension over that of the first turn from where on a diverging iteration has no figures."""
_NEGLIGIBLE, _LITTLE = 0.005, 0.02
"""Shares by which sag may change a tension: not worth a word, not worth a figure."""


def section(source: Source) -> Section | None:
    """Return what is known of the configured pose; None if the study has none."""
    pose = source.analysis.pose
    if pose is None:
        return None
    return Section.of(
        "pose",
        "The configured pose",
        _statement(pose),
        next(pose_statement(source.analysis), None),
        Box.of("lead keep", replace(source.robot, kind="space"), _facts(pose))
        if source.robot
        else _facts(pose),
        *_ways(pose, draws=source.draws),
        _cables(pose) if pose.sizing.statics.is_solved else None,
    )


def _ways(pose: PoseAnalysis, *, draws: bool) -> Iterator[Block | None]:
    """Yield the diameter by each way, and the turns of the iteration, with their curves if any."""
    methods = _methods(pose)
    if not pose.loop.iterates:
        yield methods
        return
    drawn, turns = _loop_chart(pose) if draws else None, turns_table(pose.loop)
    how = (
        "Each turn of the fixed-point iteration solves the pose with the last diameter, takes the "
        "largest tension, and asks for the diameter that carries it at the allowable stress."
    )
    if drawn is None:
        yield Box.of("lead keep", Box.of("", methods, how), turns)
    else:
        yield methods
        yield how
        yield Box.of("lead keep", drawn, turns)


def _statement(pose: PoseAnalysis) -> Statement:
    verdict = Verdict(int(pose.sizing.statics.verdict))
    if verdict is not Verdict.SOLVED:
        held = "cannot be held" if verdict.is_proved else "was not found to be held"
        title = f"This pose {held}"
        return Statement(title, verdict.sentence, "bad" if verdict.is_proved else "doubt")
    text = (
        f"A cable of {fmt.millimetres(float(pose.sizing.diameter_m))} holds this pose. "
        f"Its largest tension is {fmt.newtons(float(pose.sizing.statics.largest_tension_N))}."
    )
    if pose.caution:
        return Statement("This pose can be held", f"{text} {pose.caution}", "doubt")
    return Statement("This pose can be held", text, "good")


def _facts(pose: PoseAnalysis) -> Facts:
    from scipy.spatial.transform import Rotation

    statics = pose.sizing.statics
    facts = [Fact("Position", fmt.position(statics.poses.position_m))]
    if not statics.robot.is_point_mass:
        turn = np.degrees(Rotation.from_matrix(statics.poses.rotation).as_rotvec())
        row = ", ".join(fmt.fixed(float(x), 2) for x in turn)
        facts.append(Fact("Rotation vector", f"({row}) deg"))
    if np.isfinite(pose.limit_ratio):
        meaning = (
            "stress of a cable of unlimited thickness over the allowable stress; "
            "at 100 % no finite cable is left"
        )
        facts.append(Fact("Self-weight ratio", fmt.percent(pose.limit_ratio), meaning))
    if pose.rest is not None:
        facts.append(Fact("Forward statics", pose.rest.sentence))
    if statics.is_solved:
        closure = float(np.max(statics.closure_residual_m()))
        balance = float(np.max(np.abs(statics.equilibrium_residual_N())))
        scale = f"weight of the platform {fmt.newtons(statics.robot.weight_N)}"
        facts.append(Fact("Largest closure residual", fmt.power_of_ten(closure, "m")))
        unit = "N" if statics.robot.is_point_mass else "N or N·m"
        facts.append(Fact("Largest balance residual", fmt.power_of_ten(balance, unit), scale))
    return Facts(tuple(facts))


def _methods(pose: PoseAnalysis) -> Table | None:
    """Return the diameter by each way of sizing; None if no way gives one."""
    massless, sizing, loop = pose.massless, pose.sizing, pose.loop
    rows = []
    if np.isfinite(massless.largest_tension_N):
        found = sizing.massless_diameter_m, massless.largest_tension_N
        rows.append(_way("Straight weightless cables", *found, "rope weight ignored"))
    if loop.iterates:
        last = loop.iterates[-1]
        ends = (math.nan, math.nan) if loop.has_diverged else (last.diameter_m, last.max_tension_N)
        rows.append(_way("Fixed-point iteration, section IV-B", *ends, loop.outcome))
    if sizing.statics.is_solved:
        found = sizing.diameter_m, sizing.statics.largest_tension_N
        rows.append(_way("Optimum, section IV-C", *found, "Newton's method", "good"))
    columns = ("Way", Column("Diameter"), Column("Largest tension"), "Remark")
    caption = "The diameter of this pose by each way; sections are those of Riehl et al. (2010)."
    return Table.of(caption, columns, *rows) if rows else None


def _way(
    name: str,
    diameter_m: SupportsFloat,
    tension_N: SupportsFloat,
    remark: str,
    tone: Tone = "",
) -> Row:
    found = fmt.millimetres(float(diameter_m)), fmt.newtons(float(tension_N))
    return Row((name, *found, remark), tone)


def _cables(pose: PoseAnalysis) -> Table:
    statics = pose.sizing.statics
    largest = float(statics.largest_tension_N)
    unit, scale = fmt.force_unit(largest)
    columns = (
        *(Column("Cable"), Column("Straight distance", "m"), Column("Unstrained length", "m")),
        *(Column("Horizontal force", unit), Column("Vertical force", unit)),
        *(Column("Tension at platform", unit), Column("Tension at exit", unit)),
        Column("Tension without weight", unit),
    )
    metres = zip(statics.geometry().chord_m, statics.length_m, strict=True)
    forces = zip(
        statics.force_x_N,
        statics.force_z_N,
        statics.platform_tension_N,
        statics.exit_tension_N,
        pose.massless.tension_N,
        strict=True,
    )
    length_places = fmt.decimals([float(statics.length_m.max())], 5)
    force_places = fmt.decimals([largest / scale], 4)
    rows = []
    for number, (lengths, loads) in enumerate(zip(metres, forces, strict=True), start=1):
        cells = [fmt.fixed(float(x), length_places) for x in lengths]
        cells += [fmt.fixed(float(x) / scale, force_places) for x in loads]
        is_worst = max(loads[2:4]) >= largest * (1.0 - 1e-9)
        rows.append(Row((str(number), *cells), "good" if is_worst else ""))
    caption = (
        "Every cable at the optimum; the most loaded is marked. The forces act on the cable at "
        "the platform: the horizontal one away from the exit point, the vertical one upward."
    )
    return Table.of(caption, columns, *rows)


def _loop_chart(pose: PoseAnalysis) -> Picture | None:
    """Return the turns as curves; None where they would be flat, as the loop ends at its start."""
    from designer.report.figures.charts_pose import loop_chart

    start, end = pose.massless.largest_tension_N, pose.sizing.statics.largest_tension_N
    more, is_solved = float(end / start) - 1.0, pose.sizing.statics.is_solved
    if is_solved and pose.loop.has_converged and abs(more) < _LITTLE:
        return None
    caption = "Largest tension and diameter over the turns"
    if not (is_solved and np.isfinite(start)):
        caption += "."
    elif abs(more) < _NEGLIGIBLE:
        caption += ". In this pose the rope weight hardly matters."
    else:
        caption += (
            ", and the optimum. The effect of rope weight on the tension of this pose is "
            f"{fmt.signed_percent(more)}."
        )
    return chart(caption, "Two curves that rise from the massless start", loop_chart(pose))


def turns_table(loop: LoopSizing) -> Table:
    """Return the turns of the loop; of a long one, the first and the last."""
    numbered = list(enumerate(loop.iterates))
    if len(numbered) > _MOST_TURNS:
        numbered = [*numbered[: _MOST_TURNS - _LAST_TURNS], *numbered[-_LAST_TURNS:]]
    typical = loop.iterates[0 if loop.has_diverged else -1]
    unit, scale = fmt.force_unit(typical.max_tension_N)
    force_places = fmt.decimals([typical.max_tension_N / scale], 5)
    places = fmt.decimals([1e3 * typical.diameter_m], 4)
    rows: list[Row] = []
    for turn, iterate in numbered:
        if rows and turn > int(rows[-1].cells[0]) + 1:
            rows.append(Row(("…", "…", "…"), "muted"))
        tension = fmt.fixed(iterate.max_tension_N / scale, force_places)
        diameter = fmt.fixed(1e3 * iterate.diameter_m, places)
        if loop.has_diverged and iterate.max_tension_N > _FAR * typical.max_tension_N:
            tension = diameter = "diverges"
        rows.append(Row((str(turn), tension, diameter)))
    columns = (Column("Turn"), Column("Largest tension", unit), Column("Diameter", "mm"))
    caption = "Turns of the iteration; turn 0 is the massless start."
    if loop.has_diverged:
        caption += " It diverges: each turn asks for more than the one before."
    return Table.of(caption, columns, *rows, kind="turns")
