"""What `CONTRIBUTING.md` tells to do for a new thing is all that it takes."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from pairs.agreement import QUANTITIES

import designer
from designer.analysis.analyse import Analysis
from designer.analysis.result_json import result_dict
from designer.arrays import FloatArray
from designer.explore.answers import full_ropes
from designer.explore.session import Session
from designer.model.load_case import Loaded
from designer.model.robot import Poses, Robot
from designer.model.verdict import Answer, Verdict
from designer.model.workspace import Workspace
from designer.plugins import find_plugins
from designer.report.design.report import design_report
from designer.report.figures.charts_shares import parts
from designer.report.render import render_html
from designer.resources import data_folder, example_file
from designer.selection import criteria
from designer.statics.inverse import Statics
from designer.workspace.sweep import Census


def test_every_verdict_has_its_part_of_the_bar() -> None:
    met = Census(len(Verdict), {verdict.label: 1 for verdict in Verdict}, 0, 0)
    found = parts(met)
    assert sum(part.count for part in found) == met.samples
    assert {part.label for part in found} >= {v.reason for v in Verdict} - {Verdict.SOLVED.reason}
    assert len({(part.colour, part.hatch) for part in found}) == len(found)


def test_every_verdict_but_solved_says_why() -> None:
    assert all(verdict.reason and verdict.clause for verdict in set(Verdict) - {Verdict.SOLVED})


@pytest.mark.slow
def test_verdicts_are_listed_only_where_they_are_defined() -> None:
    package = Path(designer.__file__).parent
    home = package / "model" / "verdict.py"
    listed = [
        f"{path.relative_to(package)}:{node.lineno}"
        for path in sorted(package.rglob("*.py"))
        if path != home
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8")))
        if isinstance(node, ast.Tuple | ast.List | ast.Set | ast.Dict)
        if sum(ast.unparse(part).startswith("Verdict.") for part in ast.iter_child_nodes(node)) > 2
    ]
    assert listed == []


OF_EVERY_STUDY = {
    "pose", "workspace", "rope", "equilibrium", "breaking_load", "least_tension", "stability",
}  # fmt: skip
"""Requirements that none lacks; what to do follows from what was tried, but for stability."""


def ids_of(*records: str) -> set[str]:
    """Return the ids of the requirements or criteria that the code makes."""
    package = Path(designer.__file__).parent
    return {
        argument.value.value
        for room in ("selection", "analysis")
        for path in (package / room).rglob("*.py")
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8")))
        if isinstance(node, ast.Call) and ast.unparse(node.func) in records
        for argument in node.keywords
        if argument.arg == "id" and isinstance(argument.value, ast.Constant)
    }


def test_every_criterion_is_held_against_a_second_program() -> None:
    assert ids_of("Criterion") == set(QUANTITIES)


def test_every_requirement_has_its_words_on_the_pages() -> None:
    """What is not asked is told as not evaluated, and what fails comes with advice."""
    ids = ids_of("Criterion", "Requirement")
    assert ids > OF_EVERY_STUDY
    for page, needless in (
        ("checks", OF_EVERY_STUDY),
        ("answer_actions", OF_EVERY_STUDY - {"stability"}),
    ):
        text = (data_folder("reports") / "report" / f"{page}.html.j2").read_text(encoding="utf-8")
        assert {name for name in ids - needless if f'"{name}"' not in text} == set(), page


LARGEST_FLEET_ANGLE_DEG = 20.0


def fleet_angle_deg(robot: Robot, poses: Poses) -> FloatArray:
    """Angle in plan of each cable (..., n_cables) to a drum that faces the origin [deg]."""
    exits = robot.exit_points_m[:, :2]
    cables = poses.attachment_points_m(robot)[..., :2] - exits
    axis, across = -exits, np.stack([exits[:, 1], -exits[:, 0]], axis=-1)
    return np.degrees(
        np.arctan2(np.abs((cables * across).sum(axis=-1)), (cables * axis).sum(axis=-1))
    )


@pytest.mark.slow
def test_a_requirement_is_asked_wherever_the_others_are(monkeypatch: pytest.MonkeyPatch) -> None:
    """A fleet angle, by the steps of the recipe."""
    asked_before = criteria._of_workspace

    def asked(workspace: Workspace) -> Iterator[criteria.Criterion]:
        yield from asked_before(workspace)

        def quantity(_: Loaded, statics: Statics) -> FloatArray:
            return fleet_angle_deg(statics.robot, statics.poses)

        yield criteria.Criterion(
            id="plan_angle",
            title="Angle in plan",
            formula="angle of a cable to its drum ≤ what spools evenly",
            source=f"a test; {criteria.WHERE}",
            unit="deg",
            quantity=quantity,
            limits=(LARGEST_FLEET_ANGLE_DEG,),
            kind="at_most",
        )

    monkeypatch.setattr(criteria, "_of_workspace", asked)
    session = Session.open(example_file("yard"), find_plugins(with_plugins=False))
    session.edit("workspace.samples", "500")
    session.edit("workspace.proof", "0 s")
    question = session.question()
    assert question is not None
    analysis = Analysis.begin(question.study, question.catalogue)
    (fleet,) = (each for each in analysis.requirements if each.id == "plan_angle")
    workspace = question.study.workspace
    assert workspace is not None
    inside = workspace.region.inside_m(np.random.default_rng(20261125), 50_000)
    dense = fleet_angle_deg(question.study.robot, Poses.at(inside))
    assert fleet.place is not None and fleet.cable is not None
    at_place = fleet_angle_deg(question.study.robot, Poses.at(fleet.place))
    assert fleet.demand == pytest.approx(at_place[fleet.cable - 1])
    assert dense.max() <= fleet.demand <= dense.max() * 1.02  # nothing dense goes into corners
    # No rope meets it: the answer, each file and each page follow.
    assert analysis.answer is Answer.NO
    reasons: Any = result_dict(analysis)["answer"]
    assert "plan_angle" in str(reasons)
    html = render_html(design_report(analysis))
    assert html.count("Angle in plan") > 1
    shown = full_ropes(question)
    assert shown.answer is Answer.NO
    assert [each.words for each in shown.requirements] == [
        each.words for each in analysis.requirements
    ]
