"""All that a study asks for, in every load case, and the answer that follows."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest
from typer.testing import CliRunner

from designer.analysis.analyse import Analysis
from designer.analysis.requirements import Terms
from designer.cli.commands import app
from designer.cli.tables import _summary_of_requirements
from designer.grades.registry import load_catalogue
from designer.io.config import read_study
from designer.model.robot import Poses
from designer.model.verdict import Answer, Requirement, State, Verdict, answer_of
from designer.report.design.drawings import Drawings
from designer.report.design.report import section
from designer.report.render import rendered
from designer.statics import task
from designer.statics.inverse import solve_sagging

Solve = Callable[[str], Analysis]

CRANE = """
name: Crane
robot:
  anchors: [[0, 0, 11.5], [30, 0, 11.5], [15, 26, 11.5]]
  platform: {mass: 60 kg}
cable: {density: 5290 kg/m^3, youngs_modulus: 62.7 GPa, allowable_stress: 198 MPa}
"""
BODY = """
name: Body
robot:
  anchors: [[0, 0, 12], [0, 0, 11], [30, 0, 12], [30, 0, 11], [15, 26, 12], [15, 26, 11]]
  platform:
    mass: 60 kg
    attachments: [[-0.3, -0.2, 0.2], [-0.3, -0.2, -0.2], [0.3, -0.2, 0.2], [0.3, -0.2, -0.2],
                  [0, 0.3, 0.2], [0, 0.3, -0.2]]
cable: {density: 5290 kg/m^3, youngs_modulus: 62.7 GPa, allowable_stress: 198 MPa}
"""
REGION = "workspace: {region: {box: [[12, 18], [6, 10], [2, 6]]}, samples: 60, proof: 0 s}\n"
ROPES = "[unirope-7x7-galvanised, unirope-7x19-galvanised]"


@pytest.fixture(scope="module")
def solve(tmp_path_factory: pytest.TempPathFactory) -> Solve:
    def solved(text: str) -> Analysis:
        config = tmp_path_factory.mktemp("study") / "study.yaml"
        config.write_text(text, encoding="utf-8")
        return Analysis.begin(read_study(config), load_catalogue(with_plugins=False))

    return solved


def of_id(analysis: Analysis, name: str, case: str = "static") -> Requirement:
    (found,) = [r for r in analysis.requirements if (r.id, r.load_case) == (name, case)]
    return found


def requirement(state: State) -> Requirement:
    return Requirement("floor", "Floor", "", "", state, "static")


def test_a_failing_requirement_decides_then_an_open_one() -> None:
    holds, fails, is_open = (requirement(state) for state in State)
    assert answer_of([holds]) is answer_of([]) is Answer.YES
    assert answer_of([holds, is_open]) is Answer.OPEN
    assert answer_of([is_open, fails, holds]) is Answer.NO


@pytest.mark.slow
def test_limits_that_no_rope_meets_are_a_no(tmp_path: Path, solve: Solve) -> None:
    limits = "limits: {stiffness: 1 GN/m, excitation: [0.01 Hz, 1 kHz], drum_capacity: 1 m}"
    text = f"{CRANE}{REGION}selection: {{grades: [unirope-7x19-galvanised], {limits}}}\n"
    analysis = solve(text)
    assert analysis.answer is Answer.NO and not analysis.is_positive
    assert {r.id for r in analysis.unmet} == {"stiffness", "excitation", "drum_capacity"}
    assert analysis.chosen is not None
    assert analysis.chosen.verification.holds
    result = analysis.to_dict()
    assert result["answer"]["verdict"] == "no" and result["positive"] is False
    assert {each["id"] for each in result["answer"]["reasons"]} == {r.id for r in analysis.unmet}
    (tmp_path / "crane.yaml").write_text(text, encoding="utf-8")
    told = CliRunner().invoke(
        app, ["report", str(tmp_path / "crane.yaml"), "-o", str(tmp_path / "out"), "--no-plugins"]
    )
    assert told.exit_code == 1
    for words in ("stiffness", "excitation", "drum", "demand 1000000000 N/m", "demand 8.193 m"):
        assert words in told.output


@pytest.mark.slow
def test_a_rope_that_may_be_bent_is_chosen_before_a_lighter_one(solve: Solve) -> None:
    """The lighter 7×7 construction asks for a larger sheave than the study has."""
    crane = CRANE.replace("60 kg", "100 kg")
    light = solve(f"{crane}{REGION}selection: {{grades: {ROPES}}}\n").chosen
    assert light is not None and light.grade.id == "unirope-7x7-galvanised"
    assert light.grade.sheave_ratio is not None and light.grade.sheave_ratio.minimum is not None
    analysis = solve(f"{crane}{REGION}selection: {{grades: {ROPES}, sheave_diameter: 80 mm}}\n")
    chosen = analysis.chosen
    assert chosen is not None and analysis.is_positive
    assert chosen.grade.id == "unirope-7x19-galvanised"
    assert chosen.grade.sheave_ratio is not None
    sheave = of_id(analysis, "sheave_ratio", "all")
    assert sheave.capacity >= chosen.grade.sheave_ratio.minimum
    assert sheave.utilisation == pytest.approx(sheave.demand / sheave.capacity)
    assert analysis.selection is not None
    same = [
        c
        for c in analysis.selection.candidates
        if (c.grade.id, c.size.id) == (light.grade.id, light.size.id)
    ]
    assert [c.standing for c in same] == ["rejected"]
    assert "sheave fails: demand" in same[0].reason


@pytest.mark.slow
def test_ice_takes_a_cable_below_the_floor_in_its_load_case(solve: Solve) -> None:
    cases = "load_cases: [{name: dry}, {name: icy, ice: {thickness: 60 mm}}]\n"
    floor = REGION.replace("samples", "floor: 1.4 m, sag: 50 %, samples")
    analysis = solve(f"{CRANE}{floor}selection: {{grades: {ROPES}}}\n{cases}")
    dry, icy = of_id(analysis, "floor", "dry"), of_id(analysis, "floor", "icy")
    assert icy.capacity < dry.capacity
    chosen = analysis.chosen
    assert chosen is not None and icy.place is not None
    found = next(each for each in chosen.cases if each.case.name == "icy")
    statics = solve_sagging(found.loaded.robot, Poses.at(icy.place[None]), found.loaded.cable)
    assert icy.capacity == pytest.approx(float(statics.lowest_m.min()), abs=1e-9)
    assert icy.state is (State.HOLDS if icy.capacity >= 1.4 else State.FAILS)


@pytest.mark.slow
def test_clearance_is_that_of_the_region_of_its_load_case(solve: Solve) -> None:
    """Cables of a platform come nearer to each other in the region of another load case."""
    cases = "load_cases: [{name: work}, {name: parked, region: {points: [[0.7, 0.7, 10.8]]}}]\n"
    robot = f"{BODY}workspace: {{region: {{points: [[15, 8, 6]]}}, clearance: 50 mm, sag: 50 %}}\n"
    analysis = solve(f"{robot}selection: {{grades: [unirope-7x19-galvanised]}}\n{cases}")
    clearances = {r.load_case: r for r in analysis.requirements if r.id == "clearance"}
    if "parked" in clearances:
        assert clearances["parked"].place is not None
        np.testing.assert_allclose(clearances["parked"].place[:3], [0.7, 0.7, 10.8])
    assert set(clearances) == {r.load_case for r in analysis.requirements if r.id == "stability"}


@pytest.mark.slow
def test_a_pose_that_is_not_decided_is_open_and_not_impossible(
    solve: Solve, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Of a pose whose attachments are beside and above the pulleys, with all proofs left out."""

    def leave_open(*given: Any, **_: bool) -> None:
        verdict = given[2].verdict
        verdict[verdict != Verdict.SOLVED] = Verdict.NOT_CONVERGED

    monkeypatch.setattr(task, "_judge_unsolved", leave_open)
    body = f"{BODY}effects: {{pulley_radius: {{radius_m: 0.3}}}}\n"
    region = "workspace: {region: {points: [[15.519594, 25.787359, 12.075636]]}}"
    analysis = solve(f"{body}{region}\nselection: {{grades: [unirope-7x19-galvanised]}}\n")
    assert analysis.workspace is not None and analysis.selection is not None
    assert analysis.workspace.census.statuses["not_converged"] == 1
    assert analysis.answer is Answer.OPEN
    (outcome,) = analysis.selection.outcomes
    assert outcome.outcome == "open"
    assert analysis.to_dict()["answer"]["verdict"] == "open"
    page = rendered(section(Drawings(analysis), "answer")).body
    assert "<strong>Open.</strong> Not decided" in page
    assert "cannot be held" not in page


@pytest.mark.slow
def test_loads_are_turned_to_where_a_requirement_is_nearest_to_failing(solve: Solve) -> None:
    """No direction of the inertia force takes more tension off a cable at that place."""
    case = "load_cases: [{name: moving, acceleration: 1.5 m/s^2}]\n"
    ropes = "selection: {grades: [unirope-7x19-galvanised]}\n"
    analysis = solve(f"{CRANE}{REGION}{ropes}{case}")
    slack = of_id(analysis, "least_tension", "moving")
    chosen = analysis.chosen
    assert chosen is not None and slack.place is not None
    robot, cable = chosen.cases[0].loaded.bare
    rng = np.random.default_rng(5)
    least = []
    for along in rng.normal(size=(400, 3)):
        loaded = chosen.cases[0].case.under(robot, cable, None, along / np.linalg.norm(along))
        statics = solve_sagging(loaded.robot, Poses.at(slack.place[None]), loaded.cable)
        least.append(float(statics.least_tension_N.min()))
    assert min(least) >= slack.capacity * (1.0 - 1e-9)
    assert min(least) == pytest.approx(slack.capacity, rel=0.02)


def test_the_terminal_names_what_fails_its_cable_and_its_place() -> None:
    failing = Requirement(
        "floor", "Floor", "", "", State.FAILS, "ice", 8.0, 2.0, "m", 4.0, 3,
        np.array([1.0, 2.0, 3.0, 0.1, 0.2, 0.3]),
    )  # fmt: skip
    analysis = SimpleNamespace(
        qualities=None, answer=Answer.NO, requirements=[requirement(State.HOLDS), failing],
        unmet=[failing], terms=Terms("one static case", ()),
        findings=SimpleNamespace(equilibrium_losses=()),
    )  # fmt: skip
    answer, told = _summary_of_requirements(cast(Analysis, analysis))
    assert answer[1].endswith("1 of 2 hold")
    assert told[0].strip() == "floor"
    assert "'ice', cable 3, at (1, 2, 3) m" in told[1]
