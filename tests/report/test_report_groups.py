"""Products for groups in report and result: the same figures, and what is proved."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import pytest
from altered import altered
from report_parts import cells, facts, first_page, statements, table, tables

from designer.analysis.analyse import Analysis
from designer.analysis.result_json import result_dict
from designer.cli.tables import summary_rows
from designer.report.design.drawings import Drawings
from designer.report.design.report import section as section_of
from designer.report.figures.groups_plan import groups_plan
from designer.selection.assignment import NOT_ASSIGNED

pytestmark = pytest.mark.slow

YARD = """
name: Yard with a far mast
robot:
  anchors: [[0, 0, 11.5], [30, 0, 11.5], [15, 70, 25]]
  platform: {mass: 900 kg}
cable: {density: 5290 kg/m^3, youngs_modulus: 62.7 GPa, allowable_stress: 198 MPa}
workspace:
  region: {box: [[8, 22], [4, 14], [1, 7]]}
  samples: 200
selection:
  grades: [GRADES]
  safety_factor: 5
  groups: {'<b>near</b>': [1, 2], far: [3]}
"""


@pytest.fixture(scope="module")
def found(solve: Callable[[str], Analysis]) -> Analysis:
    return solve(YARD.replace("GRADES", "unirope-7x19-galvanised, unirope-6x19-iwrc-eips"))


@pytest.fixture(scope="module")
def none(solve: Callable[[str], Analysis]) -> Analysis:
    return solve(YARD.replace("GRADES", "unirope-7x19-galvanised"))


def test_result_has_the_groups_beside_the_single_choice(found: Analysis) -> None:
    selection = result_dict(found)["selection"]
    chosen, groups, choice = (selection[k] for k in ("chosen", "groups", "group_choice"))
    assert [group["cables"] for group in groups] == [[1, 2], [3]]
    assert choice["proof"] == "optimal"
    assert choice["gap"] == 0.0
    assert choice["bound_kg"] == choice["total_mass_kg"]
    mass = sum(sum(g["longest_m"]) * g["linear_mass_kg_per_m"] for g in groups)
    assert choice["total_mass_kg"] == pytest.approx(mass, rel=1e-12)
    assert choice["single_product_mass_kg"] == pytest.approx(chosen["total_mass_kg"], rel=1e-12)
    assert choice["saving_kg"] == pytest.approx(chosen["total_mass_kg"] - mass, rel=1e-9)
    assert choice["saving_kg"] > 5.0
    assert all(0.5 < group["utilisation"] <= 1.0 for group in groups)
    held = [one for one in choice["proposals"] if one["outcome"] == "holds"]
    assert held[-1]["products"][1] == {k: groups[1][k] for k in ("grade", "size_id")}


def test_section_says_the_same(found: Analysis) -> None:
    section = section_of(Drawings(found), "groups")
    assert statements(section)["Products were found for the groups"].tone == "good"
    rows = cells(section, "What each group gets")
    assert [row[1] for row in rows] == ["1, 2", "3"]
    assert found.groups is not None
    for row, product in zip(rows, found.assignment.ropes, strict=True):
        assert row[2] == product.label
    proposals = table(section, "Assignments that were tried")
    assert len(proposals.columns) == len(proposals.groups[0].rows[0].cells)
    assert "Proof" in facts(section)


def test_plan_names_each_group(found: Analysis) -> None:
    assert found.assignment.has_groups
    assert found.study.workspace is not None
    region = found.study.workspace.region
    svg = groups_plan(found.built.robot, region, found.assignment)
    assert "&lt;b&gt;near&lt;/b&gt;" in svg
    assert "<b>" not in svg


def test_nothing_found_is_said(none: Analysis) -> None:
    part = result_dict(none)["selection"]
    assert part["groups"] == []
    assert part["group_choice"]["proof"] == "infeasible"
    assert part["group_choice"]["total_mass_kg"] is None
    section = section_of(Drawings(none), "groups")
    assert statements(section)["No products were found for the groups"].tone == "bad"
    assert not any(one.caption.startswith("What each group") for one in tables(section))


def test_study_without_groups_has_none(analyses: dict[str, Analysis]) -> None:
    analysis = analyses["positive"]
    assert section_of(Drawings(analysis), "groups") is None
    selection = result_dict(analysis)["selection"]
    assert (selection["groups"], selection["group_choice"]) == ([], None)


def test_groups_are_the_answer(found: Analysis) -> None:
    """On the first page, in result.json, and where no product for all cables holds."""
    answer = result_dict(found)["answer"]
    assert [one["cables"] for one in answer["products"]] == [[1, 2], [3]]
    assert found.groups is not None
    assert answer["total_mass_kg"] == pytest.approx(found.assignment.total_mass_kg)
    assert found.selection is not None
    alone = replace(found.selection, chosen=None, reason="no single product holds")
    groups = replace(found.groups, single=NOT_ASSIGNED)
    without = altered(found, selection=alone, groups=groups)
    assert without.is_positive
    page = first_page(Drawings(without))
    assert page.verdict.title.startswith("Yes, subject to a certificate of breaking load")
    assert page.reasons == page.actions == ()
    assert page.card is not None and page.card.heading == "Ropes for groups of cables"
    rows = [*summary_rows(without)]
    labels = [label for label, _ in rows]
    assert labels.index("cables") < labels.index("one for all")


def test_where_no_groups_are_found_the_answer_is_no(none: Analysis) -> None:
    assert not none.is_positive
    assert result_dict(none)["answer"]["verdict"] in ("no", "open")
    assert result_dict(none)["answer"]["products"] == []
    page = first_page(Drawings(none))
    assert page.verdict.title == "No"
    assert "No products were found for the groups" in [reason.title for reason in page.reasons]
