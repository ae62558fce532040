"""The checks of the chosen rope as one table, and the pose that governs in figures."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator

from designer.analysis.analyse import Analysis
from designer.analysis.checks import Check, checks_of
from designer.analysis.governing import GoverningPose
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
)
from designer.report.design.source import Source
from designer.report.pictures import scene
from designer.study import Study


def section(source: Source) -> Section | None:
    """Return every check of the chosen rope; None where none is chosen for all cables."""
    checks = _checks(source.analysis)
    if not checks:
        return None
    pose = source.governing
    shown: tuple[Block | None, ...] = ()
    if pose is not None:
        picture = _picture(pose) if source.draws_scenes else None
        shown = (Box.of("lead keep", picture, _facts(pose)), _cables(pose), _forces(pose))
    return Section.of(
        "checks",
        "Checks and the governing pose",
        _table(checks),
        _not_checked(source.analysis.study, checks),
        *shown,
    )


def _picture(pose: GoverningPose) -> Picture:
    """Return the robot there, with the cable that governs marked."""
    from designer.report.figures.scenes import robot_scene

    statics = pose.alone
    most = int(statics.cable_tension_N.argmax())
    caption = (
        f"The governing pose, its cables in their true shape, each with its tension at the exit "
        f"point; cable {pose.cables[most].cable}, which governs, is marked. Arrows are the loads "
        "on the platform."
    )
    drawn = robot_scene(statics, most, pose.loads)
    return scene(caption, "The robot in the governing pose, in space", drawn, kind="space")


def failing_checks(analysis: Analysis) -> Iterator[Statement]:
    """Yield what page 1 must say of checks that do not hold."""
    for one in _checks(analysis):
        if not one.holds and one.id != "clearance":  # which page 1 has as a reason already
            text = (
                f"{fmt.capital(one.formula)}: {_value(one.demand, one.unit)} are asked for, "
                f"{_value(one.capacity, one.unit)} are there."
            )
            yield Statement(f"{one.title} does not hold", text, "bad")


def _checks(analysis: Analysis) -> tuple[Check, ...]:
    """Return the checks; none where no rope is chosen for all cables."""
    study, found = analysis.study, analysis.selection
    if found is None or found.chosen is None or study.selection is None or analysis.has_groups:
        return ()
    least_N = study.robot.tension_min_N
    return checks_of(found.chosen, study.selection, least_N, analysis.qualities)


def _table(checks: tuple[Check, ...]) -> Table:
    columns = (
        *("Check", "Formula and source", Column("Demand"), Column("Capacity"), Column("Used")),
        *("Where", "Verdict"),
    )
    rows = [
        Row(
            (
                one.title,
                f"{fmt.capital(one.formula)} ({one.source}).",
                _value(one.demand, one.unit),
                _value(one.capacity, one.unit),
                "–" if math.isnan(one.utilisation) else fmt.utilisation(one.utilisation),
                _where(one),
                "holds" if one.holds else "does not hold",
            ),
            "" if one.holds else "bad",
        )
        for one in checks
    ]
    return Table.of("Checks of the chosen rope.", columns, *rows)


def _value(value: float, unit: str) -> str:
    if unit == "N":
        return fmt.newtons(value)
    if unit == "m":
        return fmt.millimetres(value) if value < 1.0 else fmt.metres(value)
    return f"{fmt.trimmed(value)}\u00a0{unit}".rstrip()


def _where(one: Check) -> str:
    parts = [one.load_case]
    if one.cable is not None:
        parts.append(f"cable {one.cable}")
    if one.place is not None:
        parts.append(f"at {fmt.position(one.place[:3])}")
    return ", ".join(parts)


_LIMITS = {
    "stiffness": "stiffness (no limit is given)",
    "excitation": "frequencies of cables (no excitation is given)",
    "drum_capacity": "drums (no capacity is given)",
}


def _not_checked(study: Study, checks: tuple[Check, ...]) -> str:
    """Return what the study does not ask for, or gives no figures for; empty for nothing."""
    done = {one.id for one in checks}
    lacking = []
    if "sheave_ratio" not in done:
        known = study.selection is not None and study.selection.sheave_diameter_m is not None
        lacking.append("D/d (no least ratio is known)" if known else "D/d (no sheave is given)")
    if "clearance" not in done:
        lacking.append("clearance (none is asked for)")
    lacking += [words for name, words in _LIMITS.items() if name not in done]
    return f"Not checked: {fmt.listing(lacking)}." if lacking else ""


def _facts(pose: GoverningPose) -> Facts:
    found = pose.found
    unit = "N" if found.loaded.robot.is_point_mass else "N or N·m"
    facts = [Fact("Load case", found.case.name, fmt.printed(found.loaded.words))]
    if found.loaded.keeps_lengths:
        facts.append(Fact("At rest", fmt.position(pose.statics.poses.position_m[0])))
    return Facts(
        (
            *facts,
            Fact("Platform at", fmt.position(found.verification.worst_position_m[:3])),
            Fact("Largest closure residual", fmt.power_of_ten(pose.closure_residual_m, "m")),
            Fact("Largest balance residual", fmt.power_of_ten(pose.balance_residual, unit)),
        )
    )


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
        "The governing pose: unstrained length, tension at both ends, angle of the pull on the "
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
    return Table.of(
        "The forces there add up to nothing, but for rounding.", columns, *rows, Row(("Sum", *left))
    )


def _alike(forces_N: Iterable[float]) -> Callable[..., tuple[str, ...]]:
    """Return what writes forces in one unit, the largest of these with five digits."""
    largest_N = max((abs(float(x)) for x in forces_N), default=0.0)
    unit, scale = fmt.force_unit(largest_N)
    places = max(4 - math.floor(math.log10(max(largest_N / scale, 1.0))), 0)
    return lambda *values: tuple(
        f"{fmt.fixed(float(x) / scale, places)}\u00a0{unit}" for x in values
    )
