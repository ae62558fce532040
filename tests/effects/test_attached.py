"""What is attached along the cables, against a statics of their own and by hand."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml
from pairs.options import BASES, GRADES
from pairs.reference import Pose, solve
from pairs.scenario import lines_of, problem_of
from pairs.table import analysed, study_in

from designer.analysis.sensitivity import with_density
from designer.analysis.uncertainty import Draws
from designer.model.cable import Attached, Cable
from designer.model.load_case import Ice, LoadCase, Wind
from designer.model.robot import Machine, Platform, Poses, Robot
from designer.statics.inverse import solve_sagging

HOSE = (Attached(0.4, 0.03),)
BARE = Cable(0.008, 0.25, 3e6, 8e3)


def _crane(rng: np.random.Generator, **more: Any) -> dict[str, Any]:
    """Return a random crane of three cables, with a pose and a line along its cables."""
    corners = np.array([[0.0, 0.0, 12.0], [20.0, 0.0, 12.0], [10.0, 17.0, 12.0]])
    anchors = corners + rng.uniform(-2.0, 2.0, (3, 3))
    at = np.array([10.0, 6.0, 5.0]) + rng.uniform(-2.0, 2.0, 3)
    text: dict[str, Any] = yaml.safe_load(yaml.safe_dump(BASES["crane"]))
    line = {"linear_mass": float(rng.uniform(0.1, 1.5)), "diameter": 0.02}
    text["robot"] |= {"anchors": anchors.tolist(), "attached": line}
    text["robot"]["platform"]["mass"] = float(rng.uniform(80.0, 300.0))
    text["workspace"]["region"] = {"points": [at.tolist()]}
    return text | {"pose": at.tolist()} | more


def _needed_m(text: dict[str, Any]) -> float:
    """Return the thinnest cable of the family at the pose by bisection on its diameter [m]."""
    cable = text["cable"]
    lines = [line["linear_mass"] if line else 0.0 for line in lines_of(text["robot"])]
    pose = Pose(np.array(text["pose"]), np.zeros(3))
    low, high = 1e-3, 0.02
    while high / low > 1.0 + 1e-9:
        d = math.sqrt(low * high)
        area = math.pi * d**2 / 4.0
        size = {"diameter": d, "linear_mass": cable["density"] * area, "minimum_breaking_load": 1.0}
        grade = {"modulus": {"value": cable["youngs_modulus"]}, "material": "steel"}
        problem = problem_of(text, [(grade, size)] * 3)
        assert np.allclose(problem.mass_kg_per_m, size["linear_mass"] + np.array(lines))
        state = solve(problem, pose, starts=2)
        holds = state is not None and (
            np.linalg.norm(state.exit_pull_N, axis=1).max() <= cable["allowable_stress"] * area
        )
        low, high = (low, d) if holds else (d, high)
    return high


def _each(rng: np.random.Generator, count: int) -> list[dict[str, float] | None]:
    """Return lines along some of the cables, none like another."""
    lines = [
        {"linear_mass": float(m), "diameter": float(d)}
        for m, d in rng.uniform((0.1, 0.005), (1.5, 0.03), (count, 2))
    ]
    return [None if k == rng.integers(count) else line for k, line in enumerate(lines)]


@pytest.mark.cases_by_default(1)
@pytest.mark.parametrize("differs", [False, True])
@pytest.mark.parametrize("seed", range(4))
def test_family_is_as_thick_as_bisection_finds(seed: int, differs: bool, tmp_path: Path) -> None:
    rng = np.random.default_rng([seed, 71])
    text = _crane(rng)
    if differs:
        text["robot"]["attached"] = _each(rng, 3)
    analysis = analysed(text, tmp_path)
    needed_m = _needed_m(text)
    assert analysis.workspace is not None
    assert analysis.workspace.sagging is not None
    assert analysis.pose is not None
    assert analysis.workspace.sagging.diameter_m == pytest.approx(needed_m, rel=1e-6)
    assert float(analysis.pose.sizing.diameter_m) == pytest.approx(needed_m, rel=1e-6)


@pytest.mark.cases_by_default(1)
@pytest.mark.parametrize("differs", [False, True])
@pytest.mark.parametrize("seed", range(4))
def test_ropes_of_the_catalogue_carry_it_and_keep_their_own_mass(
    seed: int, differs: bool, tmp_path: Path
) -> None:
    rng = np.random.default_rng([seed, 72])
    text = _crane(rng)
    if differs:
        text["robot"]["attached"] = _each(rng, 3)
    analysis = analysed(text, tmp_path)
    rope = analysis.assignment.rope
    assert rope is not None
    grade = GRADES["pairs-wire"]
    (size,) = [s for s in grade["sizes"] if s["id"] == rope.size.id]
    state = solve(problem_of(text, [(grade, size)] * 3), Pose(np.array(text["pose"]), np.zeros(3)))
    assert state is not None
    tension_N = np.linalg.norm(state.exit_pull_N, axis=1).max()
    assert rope.verification.max_tension_N == pytest.approx(tension_N, rel=1e-7)
    longest = rope.verification.longest_m.sum()
    assert rope.total_mass_kg == pytest.approx(size["linear_mass"] * longest, rel=1e-9)
    assert rope.figures.cost == pytest.approx(size["price_per_m"] * longest, rel=1e-9)
    assert analysis.sensitivity is not None
    slope = analysis.sensitivity.sensitivities.of("linear_mass")
    assert slope.value == pytest.approx(size["linear_mass"])
    assert slope.elasticity == pytest.approx(
        slope.derivative * slope.value / rope.sampled.utilisation
    )


def test_it_is_a_second_cylinder_in_wind_and_ice() -> None:
    robot = Robot(np.array(BASES["crane"]["robot"]["anchors"]), Platform(200.0, drag_area_m2=0.5))
    case = LoadCase("storm", wind=Wind(20.0, 1.2), ice=Ice(0.005, 800.0))
    loaded = case.under(robot, BARE.with_attached(HOSE), np.array([1.0, 0.0, 0.0]))
    tubes = sum(math.pi / 4 * ((d + 0.01) ** 2 - d**2) for d in (0.008, 0.03))
    mass = 0.25 + 0.4 + 800.0 * tubes
    drag = 0.5 * 1.25 * 20.0**2 * 1.2 * (0.018 + 0.04)
    assert loaded.moving_density_kg_per_m == pytest.approx(mass)
    assert loaded.cable.weight_N_per_m == pytest.approx(math.hypot(9.81 * mass, drag))


def test_only_the_rope_is_drawn_and_scaled() -> None:
    robot = Robot(np.array(BASES["crane"]["robot"]["anchors"]), Platform(200.0))
    loaded = LoadCase("static").under(robot, BARE.with_attached(HOSE))
    ones = np.ones(1)
    draws = Draws(ones, ones, 1.3 * ones, ones, np.zeros((1, 3, 3)))
    for changed in (draws.on(loaded, 0), with_density(loaded, 1.3)):
        assert changed.cable.linear_density_kg_per_m == pytest.approx(1.3 * 0.25 + 0.4)
        assert changed.cable.rope_density_kg_per_m == pytest.approx(1.3 * 0.25)


def test_a_measured_machine_has_it_and_effects_of_one_rope_do_not_reach_it() -> None:
    robot = Robot(np.array(BASES["crane"]["robot"]["anchors"]), Platform(200.0), attached=HOSE)
    machine = Machine(robot, BARE)
    lighter = replace(machine, relative_mass=np.array([1.0, 0.5, 1.0]))
    assert machine.cables.linear_density_kg_per_m == pytest.approx(0.65)
    assert lighter.cables.linear_density_kg_per_m == pytest.approx([0.65, 0.525, 0.65])


@pytest.mark.parametrize("seed", range(3))
def test_lines_along_some_cables_of_a_body(seed: int, tmp_path: Path) -> None:
    """A pose on eight cables, iced and not, against the statics of the pairs."""
    rng = np.random.default_rng([seed, 73])
    text: dict[str, Any] = yaml.safe_load(yaml.safe_dump(BASES["body"]))
    n = len(text["robot"]["anchors"])
    text["robot"]["attached"] = _each(rng, n)
    robot = study_in(text, tmp_path).robot
    grade = GRADES["pairs-wire"]
    size = grade["sizes"][2]
    at = np.array([0.0, 0.0, 1.5]) + rng.uniform(-0.5, 0.5, 3)
    for case in ({}, {"ice": {"thickness": 0.004, "density": 700.0}}):
        problem = problem_of(text, [(grade, size)] * n, case)
        state = solve(problem, Pose(at, np.zeros(3)))
        assert state is not None
        rope = Cable(
            size["diameter"], size["linear_mass"], problem.stiffness_N[0], problem.allowable_N[0]
        )
        ice = Ice(0.004, 700.0) if case else None
        loaded = LoadCase("case", ice=ice).under(robot, rope.with_attached(robot.attached))
        assert loaded.moving_density_kg_per_m == pytest.approx(problem.mass_kg_per_m)
        statics = solve_sagging(loaded.robot, Poses.at(np.append(at, [0.0] * 3)), loaded.cable)
        tension_N = np.linalg.norm(state.exit_pull_N, axis=1).max()
        assert statics.largest_tension_N == pytest.approx(tension_N, rel=1e-6)


def test_a_lost_cable_takes_its_line_with_it(tmp_path: Path) -> None:
    lines = Attached(0.4, 0.03), Attached(), Attached(0.2, 0.01)
    robot = Robot(np.array(BASES["crane"]["robot"]["anchors"]), Platform(200.0), attached=lines)
    assert robot.without_cable(2).attached == (lines[0], lines[2])
    assert BARE.with_attached(lines).without(2).linear_density_kg_per_m == pytest.approx(
        [0.65, 0.45]
    )
    with pytest.raises(ValueError, match="2 lines along 3 cables"):
        replace(robot, attached=lines[:2])


def test_wind_on_cables_that_carry_different_things_is_refused() -> None:
    lines = Attached(0.4, 0.03), Attached(), Attached()
    robot = Robot(np.array(BASES["crane"]["robot"]["anchors"]), Platform(200.0, drag_area_m2=0.5))
    storm, along = LoadCase("storm", wind=Wind(20.0, 1.2)), np.array([1.0, 0.0, 0.0])
    with pytest.raises(ValueError, match="different things"):
        storm.under(robot, BARE.with_attached(lines), along)
