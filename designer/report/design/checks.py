"""The checks of the chosen rope as one table, and the pose that governs in figures."""

from __future__ import annotations

import math
from collections.abc import Iterator

from designer.analysis.analyse import Analysis
from designer.analysis.checks import Check, checks_of
from designer.analysis.governing import GoverningPose, governing_pose
from designer.report import format as fmt
from designer.report.blocks import Column, Fact, Facts, Row, Section, Statement, Table
from designer.report.design.source import Source
from designer.study import Study


def section(source: Source) -> Section | None:
    """Return every check of the chosen rope; None where none is chosen for all cables."""
    study, found = source.analysis.study, source.analysis.selection
    checks = _checks(source.analysis)
    if not checks or found is None or found.chosen is None or study.selection is None:
        return None
    pose = governing_pose(found.chosen, study.selection.safety_factor)
    return Section.of(
        "checks",
        "Checks and the governing pose",
        _table(checks),
        _not_checked(study, checks),
        *(() if pose is None else (_facts(pose), _cables(pose), _forces(pose))),
    )


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
    """Return what the study does not ask for, or gives no figures for."""
    done = {one.id for one in checks}
    lacking = []
    if "sheave_ratio" not in done:
        known = study.selection is not None and study.selection.sheave_diameter_m is not None
        lacking.append("D/d (no least ratio is known)" if known else "D/d (no sheave is given)")
    if "clearance" not in done:
        lacking.append("clearance (none is asked for)")
    lacking += [words for name, words in _LIMITS.items() if name not in done]
    return f"Not checked: {fmt.listing(lacking, 'and')}."


def _facts(pose: GoverningPose) -> Facts:
    found = pose.found
    unit = "N" if found.loaded.robot.is_point_mass else "N or N·m"
    facts = [Fact("Load case", found.case.name, found.loaded.words)]
    if found.loaded.lost_cable is not None:
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
    rows = [
        Row(
            (
                str(one.cable),
                f"{fmt.fixed(one.length_m, 3)}\u00a0m",
                f"{fmt.fixed(one.exit_tension_N, 1)}\u00a0N",
                f"{fmt.fixed(one.platform_tension_N, 1)}\u00a0N",
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
    rows = [
        Row((fmt.capital(name), *(f"{fmt.fixed(float(x), 1)}\u00a0N" for x in force)))
        for name, force in (*named, *pose.loads)
    ]
    left = [f"{fmt.fixed(float(x) + 0.0, 1)}\u00a0N" for x in pose.left_N.round(6)]
    columns = ("Force on the platform", Column("x"), Column("y"), Column("z"))
    return Table.of("The forces there add up to nothing.", columns, *rows, Row(("Sum", *left)))
