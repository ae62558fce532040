"""All requirements as one table, and the pose that governs in figures."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence

import numpy as np

from designer.analysis.governing import GoverningPose
from designer.model.requirement import Requirement, State
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
from designer.report.design.source import Source
from designer.report.pictures import scene
from designer.study import Study


def section(source: Source) -> Section | None:
    """Return all that the study asks for, and whether it holds."""
    requirements = source.analysis.requirements
    pose = source.analysis.governing
    shown: tuple[Block | None, ...] = ()
    if pose is not None:
        picture = _picture(pose) if source.draws_scenes else None
        shown = (Box.of("lead keep", picture, _facts(pose)), _cables(pose), _forces(pose))
    return Section.of(
        "checks",
        "Requirements and the governing pose",
        _table(requirements),
        _not_asked(source.analysis.study, requirements),
        *shown,
    )


def _picture(pose: GoverningPose) -> Picture:
    """Return the robot there, with the cable that governs marked."""
    from designer.report.figures.scenes import robot_scene

    statics = pose.alone
    most = int(statics.cable_tension_N.argmax())
    caption = (
        f"{_named(pose)}, its cables in their true shape, each with its tension at the exit "
        f"point; cable {pose.cables[most].cable}, which governs, is marked. Arrows are the loads "
        "on the platform."
    )
    drawn = robot_scene(statics, most, pose.loads)
    return scene(caption, "The robot in the governing pose, in space", drawn, kind="space")


def by_title(requirements: Iterable[Requirement]) -> list[list[Requirement]]:
    """Return the same requirement of all load cases together, in the order of the first."""
    groups: dict[str, list[Requirement]] = {}
    for requirement in requirements:
        groups.setdefault(requirement.title, []).append(requirement)
    return list(groups.values())


def unmet_by_title(requirements: Iterable[Requirement]) -> list[list[Requirement]]:
    """Return what does not hold, together by title: first what fails, then what is not known."""
    unmet = list(requirements)
    return [
        same
        for state in (State.FAILS, State.OPEN)
        for same in by_title(each for each in unmet if each.state is state)
    ]


def unmet_statement(same: Sequence[Requirement]) -> Statement:
    """Return what the first page says of a requirement that fails or is open in load cases.

    With the figures where it is furthest from holding.
    """
    requirement = max(same, key=lambda each: np.nan_to_num(each.utilisation))
    is_open = requirement.state is State.OPEN
    parts = [f"{fmt.capital(requirement.formula)}"]
    if math.isfinite(requirement.demand) and math.isfinite(requirement.capacity):
        demand, capacity = (
            value_words(value, requirement.unit)
            for value in (requirement.demand, requirement.capacity)
        )
        parts.append(f"demand {demand}, capacity {capacity}")
    parts += filter(None, [requirement.remark, _where(requirement)])
    others = {f"'{each.load_case}'": None for each in same}
    others.pop(f"'{requirement.load_case}'")
    if others:
        parts.append(f"nor in {fmt.listing(others)}")
    title = f"{requirement.title} {UNMET[requirement.state]}"
    return Statement(title, f"{'; '.join(parts)}.", "doubt" if is_open else "bad")


UNMET = {State.FAILS: "does not hold", State.OPEN: "is not known to hold"}
"""As a sentence has it."""
_TONES: dict[State, Tone] = {State.HOLDS: "", State.OPEN: "doubt", State.FAILS: "bad"}
STATES = {State.HOLDS: "holds", State.OPEN: "not known", State.FAILS: "does not hold"}
"""As a table has it."""


def _table(requirements: tuple[Requirement, ...]) -> Table:
    columns = (
        *("Requirement", "Formula and source", Column("Demand"), Column("Capacity")),
        *(Column("Utilisation"), "Where", "State"),
    )
    rows = [
        Row(
            (
                requirement.title,
                # Once, in the first of the load cases.
                "" if number else f"{fmt.capital(requirement.formula)} ({requirement.source}).",
                value_words(requirement.demand, requirement.unit),
                value_words(requirement.capacity, requirement.unit),
                "–"
                if math.isnan(requirement.utilisation)
                else fmt.utilisation(requirement.utilisation),
                _where(requirement),
                STATES[requirement.state],
            ),
            _TONES[requirement.state],
        )
        for same in by_title(requirements)
        for number, requirement in enumerate(same)
    ]
    caption = "All that the study asks for, in every load case."
    return Table.of(caption, columns, *rows, kind="long")


def value_words(value: float, unit: str) -> str:
    """Return a demand or a capacity with its unit, as a reader is told of it."""
    if math.isnan(value):
        return fmt.MISSING
    if unit == "N":
        return fmt.newtons(value)
    if unit == "m":
        return fmt.millimetres(value) if abs(value) < 1.0 else fmt.metres(value)
    return f"{fmt.trimmed(value)}\u00a0{unit}".rstrip()


def _where(requirement: Requirement) -> str:
    parts = [requirement.load_case]
    if requirement.direction:
        parts.append(fmt.printed(requirement.direction))
    if requirement.cable is not None:
        parts.append(f"cable {requirement.cable}")
    if requirement.place is not None:
        parts.append(f"at {fmt.position(requirement.place[:3])}")
    return ", ".join(parts)


_LIMITS = {
    "sag": "sag (any is allowed)",
    "floor": "height over a floor (none is given)",
    "clearance": "clearance (none is given)",
    "stiffness": "stiffness (no limit is given)",
    "excitation": "frequencies of cables (no excitation is given)",
    "drum_capacity": "drums (no capacity is given)",
}


def _not_asked(study: Study, requirements: tuple[Requirement, ...]) -> str:
    """Return what the study does not ask for, or gives no figures for; empty for nothing."""
    asked = {requirement.id for requirement in requirements}
    lacking = []
    if "sheave_ratio" not in asked:
        has_sheave = study.selection is not None and study.selection.sheave_diameter_m is not None
        lacking.append(
            "D/d (no least ratio is known)" if has_sheave else "D/d (no sheave is given)"
        )
    lacking += [words for name, words in _LIMITS.items() if name not in asked]
    return f"Not evaluated: {fmt.listing(lacking)}." if lacking else ""


def _facts(pose: GoverningPose) -> Facts:
    found = pose.case
    unit = "N" if found.loaded.robot.is_point_mass else "N or N·m"
    facts = [Fact("Load case", found.case.name, fmt.printed(found.loaded.words))]
    if found.loaded.keeps_lengths:
        facts.append(Fact("At rest", fmt.position(pose.statics.poses.position_m[0])))
    return Facts(
        (
            *facts,
            Fact("Platform at", fmt.position(found.verification.worst_place[:3])),
            Fact("Largest closure residual", fmt.power_of_ten(pose.closure_residual_m, "m")),
            Fact("Largest balance residual", fmt.power_of_ten(pose.balance_residual, unit)),
        )
    )


def _named(pose: GoverningPose) -> str:
    """Return what tables and pictures of the pose call it: other tables are of all load cases."""
    return f"The governing pose, in the load case {fmt.printed(pose.case.case.name)}"


def _cables(pose: GoverningPose) -> Table:
    columns = (
        *(Column("Cable"), Column("Length"), Column("At the exit"), Column("At the platform")),
        *(Column("Angle"), Column("Sag"), Column("Stretch"), Column("Safety factor")),
        Column("As a string"),
    )
    write = _alike(one.exit_tension_N for one in pose.cables)
    rows = [
        Row(
            (
                str(one.cable),
                f"{fmt.number(one.length_m, 5)}\u00a0m",
                *write(one.exit_tension_N, one.platform_tension_N),
                f"{fmt.fixed(math.degrees(one.angle_rad), 1)}°",
                fmt.millimetres(one.sag_m),
                fmt.millimetres(one.stretch_m),
                fmt.fixed(one.safety_factor, 2),
                f"{fmt.number(one.frequency_Hz, 3)}\u00a0Hz",
            )
        )
        for one in pose.cables
    ]
    caption = (
        f"{_named(pose)}: unstrained length, tension at both ends, angle of the pull on the "
        "platform above the horizontal, largest distance from the chord, stretch, breaking load "
        "left over the tension, and the lowest frequency of a string, √(T/m)/2l."
    )
    return Table.of(caption, columns, *rows)


def _forces(pose: GoverningPose) -> Table:
    named = [(f"cable {one.cable}", one.pull_N) for one in pose.cables]
    write = _alike(float(x) for _, force in (*named, *pose.loads) for x in force)
    rows = [Row((fmt.capital(name), *write(*force))) for name, force in (*named, *pose.loads)]
    left = write(*(pose.left_N.round(6) + 0.0))
    columns = ("Force on the platform", Column("x"), Column("y"), Column("z"))
    caption = f"{_named(pose)}: the forces add up to nothing, but for rounding."
    return Table.of(caption, columns, *rows, Row(("Sum", *left)))


def _alike(forces_N: Iterable[float]) -> Callable[..., tuple[str, ...]]:
    """Return what writes forces in one unit, the largest of these with five digits."""
    largest_N = max((abs(float(x)) for x in forces_N), default=0.0)
    unit, scale = fmt.force_unit(largest_N)
    places = max(4 - math.floor(math.log10(max(largest_N / scale, 1.0))), 0)
    return lambda *values: tuple(
        f"{fmt.fixed(float(x) / scale, places)}\u00a0{unit}" for x in values
    )
