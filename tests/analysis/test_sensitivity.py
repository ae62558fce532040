"""Sensitivities of ropes for groups: differences of solved states give the same."""

from __future__ import annotations

import re
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from designer.analysis.sensitivity import Sensitivities, group_sensitivities
from designer.grades.grade import Grade, Modulus, Reference, Size
from designer.model.cable import Cable, Cables
from designer.model.region import Prism
from designer.model.robot import Platform, Poses, Robot
from designer.model.workspace import Workspace
from designer.report.design import sections
from designer.report.document import Section
from designer.report.render import rendered
from designer.selection.assignment import Assignment, GroupVerification
from designer.selection.candidate import Candidate
from designer.statics.inverse import solve_sagging
from designer.study import CableGroup

EXITS = np.array([[0.0, 0.0, 11.5], [30.0, 0.0, 11.5], [15.0, 70.0, 25.0]])
PLACE = np.array([12.0, 5.0, 6.5])
GROUPS = CableGroup("near", (1, 2)), CableGroup("far", (3,))


def rope(diameter_mm: float) -> Candidate:
    size = Size(
        f"{diameter_mm:g} mm", diameter_mm / 1e3, 780 * diameter_mm**2, 0.00415 * diameter_mm**2
    )
    modulus = Modulus(62.7e9, "nominal", "borrowed", "a like rope", 0.15)
    grade = Grade(
        id="rope", manufacturer="maker", product="rope", construction="7x19", core="WSC",
        finish="bright", sizes=(size,), source=Reference("a", "b"), trust="B", modulus=modulus,
    )  # fmt: skip
    return Candidate(grade, size, grade.cable(size, 5.0))


def assignment() -> Assignment:
    places = PLACE + np.array([[0.0, 0.0, 0.0], [3.0, 5.0, -1.0]])
    lengths = np.full(3, 80.0)
    met = GroupVerification(places, np.array([0.9, 0.8]), lengths, lengths, True)
    return Assignment(GROUPS, (rope(12.0), rope(8.0)), met)


def used(robot: Robot, each: list[Cable], place: np.ndarray, cables: list[int]) -> float:
    statics = solve_sagging(robot, Poses.at(place[None]), Cables(tuple(each)))
    tension = statics.cable_tension_N[0]
    return max(float(tension[k]) / each[k].allowable_tension_N for k in cables)


@pytest.fixture(scope="module")
def robot() -> Robot:
    return Robot(EXITS, Platform(900.0, wrench_N=np.array([300.0, 0, -500.0, 0, 0, 0])))


@pytest.fixture(scope="module")
def found(robot: Robot) -> tuple[Sensitivities, ...]:
    workspace = Workspace(Prism.box((8, 22), (4, 14), (1, 7)))
    return group_sensitivities(robot, workspace, assignment())


def test_slopes_of_groups_are_those_of_differences(
    robot: Robot, found: tuple[Sensitivities, ...]
) -> None:
    known, step = assignment(), 1e-5
    cables = [one.cable for one in known.by_cable]
    for one, place in zip(found, known.verification.worst_place, strict=True):
        assert one.group is not None
        members = [cable - 1 for cable in one.group.cables]
        assert one.utilisation == pytest.approx(used(robot, cables, place, members), rel=1e-12)

        def slope(change, place=place, members=members) -> float:
            ends = [used(*change(sign * step), place, members) for sign in (1.0, -1.0)]
            return (ends[0] - ends[1]) / (2.0 * step)

        def heavier(by: float):
            body = robot.platform
            more = replace(body, mass_kg=(1 + by) * body.mass_kg, wrench_N=(1 + by) * body.wrench_N)
            return replace(robot, platform=more), cables

        assert one.of("payload").derivative == pytest.approx(slope(heavier), rel=1e-6)
        for group in GROUPS:
            for name, figure in (
                ("modulus", "axial_stiffness_N"),
                ("linear_mass", "linear_density_kg_per_m"),
            ):

                def other(by: float, group=group, figure=figure):
                    each = [
                        replace(c, **{figure: (1 + by) * getattr(c, figure)})
                        if k + 1 in group.cables
                        else c
                        for k, c in enumerate(cables)
                    ]
                    return robot, each

                row = one.of(f"{name}_{group.name}")
                theirs = slope(other) / one.utilisation
                assert row.elasticity == pytest.approx(theirs, rel=1e-4, abs=1e-9)
        for cable, axis in np.ndindex(3, 3):

            def moved(by: float, cable=cable, axis=axis):
                exits = EXITS.copy()
                exits[cable, axis] += by
                return replace(robot, exit_points_m=exits), cables

            ours = one.exit_points_per_m[cable, axis]
            assert ours == pytest.approx(slope(moved), rel=1e-5, abs=1e-9)


def test_report_shows_them(found: tuple[Sensitivities, ...]) -> None:
    analysis: Any = SimpleNamespace(sensitivity=None, group_slopes=found)
    page = rendered(Section("carries", context=sections.sensitivities(analysis) or {})).body
    cells = re.findall(r"<td[^>]*>([^<]*)</td>", page)
    now = cells.index("Utilisation now")
    assert cells[now + 2].startswith(f"{100 * found[0].utilisation:.1f}")
    assert cells[cells.index("Breaking load") + 2].startswith("−")
    assert page.count('scope="col"') == 2 + len(GROUPS)
    assert "Stiffness EA of far" in cells
