"""What the answer covers: orientations, losses of strength, the configured pose."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from altered import altered
from report_parts import first_page, statements, table

from designer.analysis.analyse import Analysis
from designer.analysis.result_json import result_dict
from designer.arrays import frozen_array
from designer.cli.tables import summary_rows
from designer.io.config import read_study
from designer.model.region import PointList, Prism
from designer.model.robot import Poses
from designer.model.space import Orientations, Space
from designer.report.design.drawings import Drawings
from designer.report.design.report import section
from designer.report.phrases import orientation_words
from designer.resources import example_file
from designer.study import Selection, Study

pytestmark = pytest.mark.slow

BOX = Prism.box((0.0, 2.0), (0.0, 2.0), (0.0, 1.0))
TURN = [0.0, 0.1, 0.0]


def turned(orientations: Orientations) -> Study:
    study = read_study(example_file("cogiro"))
    assert study.workspace is not None
    return replace(study, workspace=replace(study.workspace, orientations=orientations))


@pytest.mark.parametrize(
    ("orientations", "said"),
    [
        (Orientations(), "Level only: the platform was not turned."),
        (Orientations(frozen_array([TURN])), "Turned by (0.00, 5.73, 0.00)°."),
        (
            Orientations(frozen_array([[0.0, 0.0, 0.0], TURN])),
            "Each of (0.00, 0.00, 0.00)°; (0.00, 5.73, 0.00)°: rotation vectors, the worst of them "
            "counts.",
        ),
        (
            Orientations.within([0.0, -0.1, 0.0], TURN),
            "All between (0.00, −5.73, 0.00)° and (0.00, 5.73, 0.00)°: 19 of them at each sample, "
            "the worst searched between.",
        ),
    ],
)
def test_orientations_that_were_checked_are_said(orientations: Orientations, said: str) -> None:
    words, how = orientation_words(turned(orientations)) or ("", "")
    text = f"{words[0].upper()}{words[1:]}{': ' if how else ''}{how}."
    assert text.replace("\u00a0", " ") == said


def test_a_point_mass_has_no_orientation() -> None:
    assert orientation_words(read_study(example_file("fast"))) is None


def test_losses_of_strength_are_said_also_where_none_is_assumed(
    analyses: dict[str, Analysis],
) -> None:
    analysis = analyses["positive"]
    assert analysis.selection is not None and analysis.selection.chosen is not None
    chosen = analysis.selection.chosen

    def said(selection: Selection) -> tuple[str, str]:
        changed = altered(analysis, study=replace(analysis.study, selection=selection))
        statement = statements(section(Drawings(changed), "answer"))["Losses of strength"]
        return statement.text.replace("\u00a0", " "), statement.tone

    nothing, tone = said(Selection())
    assert nothing.startswith("No loss assumed: end fittings 100 %, bending 100 %")
    assert tone == "doubt"
    ends, tone = said(Selection(termination_efficiency=0.9))
    assert "End fittings 90.0 %, bending 100 % (none assumed)" in ends
    assert tone == "doubt"
    sheave_m = 25.0 * chosen.size.diameter_m
    both, tone = said(Selection(termination_efficiency=0.95, sheave_diameter_m=sheave_m))
    assert f"90.0 % for {chosen.size.id} (D/d 25)" in both
    assert tone == ""
    page = first_page(Drawings(analysis))
    assert "Losses of strength" in [statement.title for statement in page.confidence]
    assert page.card is not None
    assert "breaking load, no loss, over 2" in [fact.note for fact in page.card.facts]


@pytest.mark.parametrize(
    ("place", "outside"),
    [
        ([1.0, 1.0, 0.5, 0.0, 0.0, 0.0], (False, False)),
        ([2.0, 2.0, 1.0, *TURN], (False, False)),
        ([2.0, 2.1, 1.0, 0.0, 0.0, 0.0], (True, False)),
        ([1.0, 1.0, 1.1, 0.0, 0.2, 0.0], (True, True)),
    ],
)
def test_space_knows_what_lies_outside(place: list[float], outside: tuple[bool, bool]) -> None:
    given = Orientations(frozen_array([[0.0, 0.0, 0.0], TURN]))
    assert Space(BOX, given).outside(np.array(place)) == outside
    between = Orientations.within([0.0, 0.0, 0.0], TURN)
    assert Space(BOX, between).outside(np.array(place)) == outside
    points = PointList(frozen_array([place[:3], [9.0, 9.0, 9.0]]))
    assert Space(points, given).outside(np.array(place)) == (False, outside[1])


def test_a_pose_outside_the_region_is_flagged_everywhere(analyses: dict[str, Analysis]) -> None:
    inside = analyses["positive"]
    assert inside.study.pose_outside == ""
    assert inside.pose is not None
    assert result_dict(inside)["pose"]["in_workspace"] is True
    moved = replace(inside, study=replace(inside.study, pose=Poses.at([250.0, 200.0, -30.0])))
    assert moved.study.pose_outside == "lies outside the region"
    assert result_dict(moved)["pose"]["in_workspace"] is False
    source = Drawings(moved)
    flagged = first_page(source).confidence[0]
    assert flagged.title == "The configured pose is not in the workspace"
    assert "It lies outside the region. There, " in flagged.text
    assert flagged.tone in ("doubt", "bad")
    assert statements(section(source, "pose"))[flagged.title] == flagged
    assert ("", "[bold red]lies outside the region[/]") in [*summary_rows(moved)]
    assert flagged.title not in statements(section(Drawings(inside), "pose"))


def test_forces_of_one_table_row_have_one_unit(analyses: dict[str, Analysis]) -> None:
    selection = analyses["positive"].selection
    assert selection is not None and selection.chosen is not None
    chosen = selection.chosen
    weak = replace(chosen.verification, max_tension_N=20.5)
    small = replace(chosen, verification=weak)
    outcomes = tuple(
        replace(
            o,
            candidates=tuple(small if c is chosen else c for c in o.candidates),
            best=small if o.best is chosen else o.best,
        )
        for o in selection.outcomes
    )
    for shown in (selection, replace(selection, outcomes=outcomes, chosen=small)):
        page = section(Drawings(altered(analyses["positive"], selection=shown)), "selection")
        heads = {c.title: c.unit for c in table(page, "Sizes that hold everywhere").columns}
        units = {heads[name] for name in ("Breaking load", "Allowable", "Largest tension")}
        assert units == ({"kN"} if shown is selection else {"N"})


def test_answer_names_the_product_of_every_cable(analyses: dict[str, Analysis]) -> None:
    answer = result_dict(analyses["positive"])["answer"]
    assert answer["products"][0]["cables"] == [1, 2, 3]
    too_thin = result_dict(analyses["too_thin"])["answer"]
    assert (too_thin["verdict"], too_thin["products"]) == ("no", [])
