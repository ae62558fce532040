"""The configured pose alone: massless, the loop turn by turn, the optimum, every cable."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from designer.analysis.analyse import Analysis, PoseAnalysis
from designer.model.verdict import Verdict
from designer.report import format as fmt
from designer.report.design.scope import pose_statement
from designer.report.parts import Column, Fact, Picture, Row, Statement, Table
from designer.sizing.loop import LoopSizing

_MOST_TURNS = 8
_LAST_TURNS = 3


@dataclass(frozen=True, slots=True)
class PoseSection:
    """The configured pose.

    Parameters
    ----------
    verdict : Statement
        Whether it can be held.
    outside : Statement or None
        Where it is none of the workspace; None if it is one of it.
    facts : tuple of Fact
        Position, margins and residuals.
    methods : Table or None
        The diameter by each way of sizing; None if no way gives one.
    cables : Table or None
        Every cable at the optimum; None if the pose is not solved.
    turns : Table or None
        Iterates of the loop; None if it could not start.
    loop_chart, scene : Picture or None
        The iterates over the turns, and the robot in this pose.
    """

    verdict: Statement
    outside: Statement | None
    facts: tuple[Fact, ...]
    methods: Table | None
    cables: Table | None
    turns: Table | None
    loop_chart: Picture | None
    scene: Picture | None


def pose_section(
    analysis: Analysis, loop_chart: Picture | None, scene: Picture | None
) -> PoseSection | None:
    """Return the section on the configured pose; None if the study has none."""
    pose = analysis.pose
    if pose is None:
        return None
    verdict = Verdict(int(pose.sizing.statics.verdict))
    solved = verdict is Verdict.SOLVED
    return PoseSection(
        verdict=_statement(pose, verdict),
        outside=next(pose_statement(analysis), None),
        facts=_facts(pose),
        methods=_methods(pose),
        cables=_cables(pose) if solved else None,
        turns=turns_table(pose.loop) if pose.loop.iterates else None,
        loop_chart=loop_chart,
        scene=scene,
    )


def _statement(pose: PoseAnalysis, verdict: Verdict) -> Statement:
    if verdict is not Verdict.SOLVED:
        return Statement("This pose cannot be held", verdict.sentence, "bad")
    text = (
        f"A cable of {fmt.millimetres(float(pose.sizing.diameter_m))} holds this pose. "
        f"Its largest tension is {fmt.newtons(float(pose.sizing.statics.largest_tension_N))}."
    )
    if pose.caution:
        return Statement("This pose can be held", f"{text} {pose.caution}", "doubt")
    return Statement("This pose can be held", text, "good")


def _facts(pose: PoseAnalysis) -> tuple[Fact, ...]:
    statics = pose.sizing.statics
    facts = [Fact("Position", fmt.position(statics.poses.position_m))]
    if not statics.robot.is_point_mass:
        facts.append(Fact("Rotation vector", _rotation(statics.poses.rotation)))
    if np.isfinite(pose.limit_ratio):
        meaning = (
            "stress of a cable of unlimited thickness over the allowable stress; "
            "at 100 % no finite cable is left"
        )
        facts.append(Fact("Limit ratio", fmt.percent(pose.limit_ratio), meaning))
    if pose.rest is not None:
        facts.append(Fact("Forward statics", pose.rest.sentence))
    if statics.is_solved:
        closure = float(np.max(statics.closure_residual_m()))
        balance = float(np.max(np.abs(statics.equilibrium_residual_N())))
        scale = f"weight of the platform {fmt.newtons(statics.robot.weight_N)}"
        facts.append(Fact("Largest closure residual", fmt.power_of_ten(closure, "m")))
        unit = "N" if statics.robot.is_point_mass else "N or N·m"
        facts.append(Fact("Largest balance residual", fmt.power_of_ten(balance, unit), scale))
    return tuple(facts)


def _rotation(matrix: np.ndarray) -> str:
    from scipy.spatial.transform import Rotation

    degrees = np.degrees(Rotation.from_matrix(matrix).as_rotvec())
    return f"({', '.join(fmt.fixed(float(x), 2) for x in degrees)}) deg"


def _methods(pose: PoseAnalysis) -> Table | None:
    massless, sizing, loop = pose.massless, pose.sizing, pose.loop
    rows = []
    if np.isfinite(massless.largest_tension_N):
        rows.append(
            Row(
                (
                    "Straight weightless cables",
                    fmt.millimetres(float(sizing.massless_diameter_m)),
                    fmt.newtons(float(massless.largest_tension_N)),
                    "sag ignored",
                )
            )
        )
    if loop.iterates:
        last = loop.iterates[-1]
        found = (fmt.millimetres(last.diameter_m), fmt.newtons(last.max_tension_N))
        if loop.has_diverged:
            found = (fmt.MISSING, fmt.MISSING)
        rows.append(Row(("Loop of section IV-B", *found, loop.outcome)))
    if sizing.statics.is_solved:
        found = (
            fmt.millimetres(float(sizing.diameter_m)),
            fmt.newtons(float(sizing.statics.largest_tension_N)),
        )
        rows.append(Row(("Optimum of section IV-C", *found, "Newton's method"), "good"))
    columns = (
        Column("Way", is_number=False),
        Column("Diameter"),
        Column("Largest tension"),
        Column("Remark", is_number=False),
    )
    caption = "The diameter of this pose by each way; sections are those of Riehl et al. (2010)."
    return Table.of(caption, columns, *rows) if rows else None


def _cables(pose: PoseAnalysis) -> Table:
    statics = pose.sizing.statics
    largest = float(statics.largest_tension_N)
    unit, scale = _force_unit(largest)
    columns = (
        Column("Cable"),
        Column("Straight distance", "m"),
        Column("Unstrained length", "m"),
        Column("Horizontal force", unit),
        Column("Vertical force", unit),
        Column("Tension at platform", unit),
        Column("Tension at exit", unit),
        Column("Tension without sag", unit),
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
    for index, (lengths, loads) in enumerate(zip(metres, forces, strict=True)):
        cells = [fmt.fixed(float(x), length_places) for x in lengths]
        cells += [fmt.fixed(float(x) / scale, force_places) for x in loads]
        is_worst = max(loads[2:4]) >= largest * (1.0 - 1e-9)
        rows.append(Row((str(index + 1), *cells), "good" if is_worst else ""))
    caption = (
        "Every cable at the optimum; the most loaded is marked. The forces act on the cable at "
        "the platform: the horizontal one away from the exit point, the vertical one upward."
    )
    return Table.of(caption, columns, *rows)


def _force_unit(largest_N: float) -> tuple[str, float]:
    """Return the unit for a column of forces, and how many newtons it has."""
    return ("kN", 1e3) if largest_N >= 1e3 else ("N", 1.0)


def turns_table(loop: LoopSizing) -> Table:
    """Return the turns of the loop; of a long one, the first and the last."""
    numbered = list(enumerate(loop.iterates))
    if len(numbered) > _MOST_TURNS:
        numbered = [*numbered[: _MOST_TURNS - _LAST_TURNS], *numbered[-_LAST_TURNS:]]
    typical = loop.iterates[0 if loop.has_diverged else -1]
    unit, scale = _force_unit(typical.max_tension_N)
    force_places = fmt.decimals([typical.max_tension_N / scale], 5)
    places = fmt.decimals([1e3 * typical.diameter_m], 4)
    rows: list[Row] = []
    for turn, iterate in numbered:
        if rows and turn > int(rows[-1].cells[0]) + 1:
            rows.append(Row(("…", "…", "…"), "muted"))
        tension = fmt.fixed(iterate.max_tension_N / scale, force_places)
        rows.append(Row((str(turn), tension, fmt.fixed(1e3 * iterate.diameter_m, places))))
    columns = (Column("Turn"), Column("Largest tension", unit), Column("Diameter", "mm"))
    caption = "Turns of the loop; turn 0 is the massless start."
    if loop.has_diverged:
        caption += " It diverges: each turn asks for more than the one before."
    return Table.of(caption, columns, *rows)
