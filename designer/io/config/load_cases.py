"""The load cases of a config: checked against the rest of the study, and built."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping

from designer.arrays import frozen_array
from designer.errors import Fault
from designer.io.config.parts import Parts
from designer.io.config.regions import RegionSection
from designer.io.config.schema import (
    CableSection,
    GradeCableSection,
    LoadCaseSection,
)
from designer.model.load_case import Ice, LoadCase, Wind
from designer.model.region import Region

_CASES = "load_cases"


def load_case(
    section: LoadCaseSection,
    cable: CableSection | GradeCableSection,
    region_of: Callable[[RegionSection], Region],
) -> LoadCase:
    """Return the load case that a section describes."""
    wrench, ice, wind = section.wrench, section.ice, section.wind
    along = None if wind is None or wind.direction is None else frozen_array(wind.direction)
    drag = cable.drag_coefficient or 0.0
    count = None if wind is None or isinstance(wind.directions, str) else wind.directions
    return LoadCase(
        name=section.name,
        mass_kg=section.mass,
        wrench_N=None if wrench is None else frozen_array([*wrench.force, *wrench.moment]),
        dynamic_factor=section.dynamic_factor,
        acceleration_m_per_s2=section.acceleration,
        wind=None if wind is None else Wind(wind.speed, drag, count, along),
        ice=None if ice is None else Ice(ice.thickness, ice.density),
        cable_lost=section.cable_lost,
        temperature_change_K=section.temperature_change,
        expansion_per_K=cable.thermal_expansion,
        safety_factor=section.safety_factor,
        termination_efficiency=section.termination_efficiency,
        region=None if section.region is None else region_of(section.region),
    )


def load_cases_fit(parts: Parts) -> Iterator[Fault]:
    """Load cases have a workspace that they are for, names of their own, and cables that exist."""
    cases = parts.raw(_CASES)
    if not isinstance(cases, list) or not cases:
        return
    if parts.raw("workspace") is None:
        expected = "a workspace: a load case is for all its poses"
        yield parts.fault(_CASES, "there is no workspace", expected)
    if parts.raw("selection.groups") is not None:
        problem = (
            "groups of cables are chosen for the static load alone: wind loads ropes of different "
            "thickness in different directions, and all cables are solved with one"
        )
        yield parts.fault("selection.groups", problem, "load_cases or groups, not both")
    first_use: dict[str, int] = {}
    for index, case in enumerate(cases):
        if isinstance(case, dict):
            yield from _case_fits(parts, index, case, first_use)


def _case_fits(
    parts: Parts, index: int, case: Mapping[str, object], first_use: dict[str, int]
) -> Iterator[Fault]:
    name, lost = case.get("name"), case.get("cable_lost")
    if isinstance(name, str) and first_use.setdefault(name, index) != index:
        problem = f"load_cases[{first_use[name]}] has the name '{name}' already"
        yield parts.fault(_CASES, problem, "a name of its own", index, "name")
    if isinstance(lost, int) and not isinstance(lost, bool) and lost > parts.n_cables:
        problem = f"there is no cable {lost}, the robot has {parts.n_cables}"
        yield parts.fault(_CASES, problem, f"1 to {parts.n_cables} or each", index, "cable_lost")
    if lost is not None and parts.n_cables - 1 < (2 if parts.is_planar else 1):
        yield parts.fault(
            _CASES, "too few cables are left", "a robot with more", index, "cable_lost"
        )
    for factor_name in ("safety_factor", "termination_efficiency"):
        if case.get(factor_name) is not None and parts.raw("selection") is None:
            problem = "there is no selection whose figure it could replace"
            yield parts.fault(
                _CASES, problem, "a selection, or a case without it", index, factor_name
            )
    region = case.get("region")
    if parts.is_planar and isinstance(region, dict) and ("prism" in region or "box" in region):
        problem = "is a solid region, but the robot is planar"
        yield parts.fault(_CASES, problem, "rectangle or points", index, "region")
    if case.get("wind") is None:
        return
    if parts.raw("robot.platform.drag") is None:
        problem = "the platform has no area in the wind"
        expected = "robot.platform.drag: {area: …, coefficient: …}"
        yield parts.fault(_CASES, problem, expected, index, "wind")
    if parts.raw("cable.drag_coefficient") is None:
        problem = "the drag of the cables is not given"
        expected = "cable.drag_coefficient, such as 1.2; 0 for none"
        yield parts.fault(_CASES, problem, expected, index, "wind")
