"""All requirements, and the pose that governs in figures: what the template gets."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping

from designer.analysis.analyse import Analysis
from designer.analysis.governing import GoverningPose
from designer.model.requirement import Requirement, State
from designer.report import format as fmt


def requirements(analysis: Analysis) -> Mapping[str, object]:
    """All that the study requires, and whether it holds."""
    pose = analysis.governing
    shown = {
        "requirements": by_title(analysis.requirements),
        "pose": pose,
    }
    if pose is None:
        return shown
    write = _alike(cable.exit_tension_N for cable in pose.cables)
    return {
        **shown,
        "governing_cable": pose.cables[int(pose.alone.cable_tension_N.argmax())].cable,
        "tensions": [write(one.exit_tension_N, one.platform_tension_N) for one in pose.cables],
        "forces": _forces(pose),
    }


def _forces(pose: GoverningPose) -> list[tuple[str, list[str]]]:
    """Return each force on the platform with its components, and their sum."""
    named = [(f"cable {one.cable}", one.pull_N) for one in pose.cables]
    write = _alike(float(x) for _, force in (*named, *pose.loads) for x in force)
    rows = [(fmt.capital(name), [*write(*force)]) for name, force in (*named, *pose.loads)]
    return [*rows, ("Sum", [*write(*(pose.force_sum_N.round(6) + 0.0))])]


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


def _alike(forces_N: Iterable[float]) -> Callable[..., tuple[str, ...]]:
    """Return what writes forces in one unit, the largest of these with five digits."""
    largest_N = max((abs(float(x)) for x in forces_N), default=0.0)
    unit, scale = fmt.force_unit(largest_N)
    places = max(4 - math.floor(math.log10(max(largest_N / scale, 1.0))), 0)
    return lambda *values: tuple(
        f"{fmt.fixed(float(x) / scale, places)}\u00a0{unit}" for x in values
    )
