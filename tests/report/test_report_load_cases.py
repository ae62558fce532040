"""Load cases, checks and the governing pose in report, result and terminal."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from altered import altered
from report_parts import cells, first_page, said, table

from designer.analysis.analyse import Analysis
from designer.analysis.result_json import result_dict
from designer.cli.tables import summary_rows
from designer.documents.plain import json_text
from designer.model.verdict import State
from designer.report.design.drawings import Drawings
from designer.report.design.first_page import Unmet
from designer.report.design.report import section as section_of

pytestmark = pytest.mark.slow

YARD = """
name: Yard
robot:
  anchors: [[0, 0, 11.5], [30, 0, 11.5], [15, 26, 11.5]]
  platform: {mass: 180 kg, drag: {area: 0.5 m^2, coefficient: 1.1}}
cable:
  density: 5290 kg/m^3
  youngs_modulus: 62.7 GPa
  allowable_stress: 198 MPa
  drag_coefficient: 1.2
workspace: {region: {box: [[10, 20], [4, 12], [1, 7]]}, samples: 200}
selection: {grades: [unirope-7x19-galvanised], sheave_diameter: 150 mm}
"""
CASES = """
load_cases:
  - name: static
  - {name: "<b>hoisting</b>", dynamic_factor: 1.5}
  - {name: storm, wind: {speed: 20 m/s, directions: 2}, ice: {thickness: 5 mm}, safety_factor: 3}
  - {name: lost, cable_lost: 2, safety_factor: 3}
"""


@pytest.fixture(scope="module")
def found(solve: Callable[[str], Analysis]) -> Analysis:
    return solve(YARD + CASES)


@pytest.fixture(scope="module")
def bare(solve: Callable[[str], Analysis]) -> Analysis:
    return solve(YARD)


@pytest.fixture(scope="module")
def drawings(found: Analysis) -> Drawings:
    return Drawings(found)


def test_result_has_each_case(found: Analysis) -> None:
    result = json.loads(json_text(result_dict(found)))
    cases = result["load_cases"]
    assert [case["name"] for case in cases] == ["static", "<b>hoisting</b>", "storm", "lost"]
    assert all(case["holds"] and case["refined"] for case in cases)
    assert cases[1]["utilisation"] == pytest.approx(1.5 * cases[0]["utilisation"], rel=0.02)
    assert cases[3]["lost_cable"] == 2
    assert cases[3]["fate"] == "rests_elsewhere"
    assert cases[3]["moved_m"] > 0.5
    most = max(cases, key=lambda case: case["utilisation"])
    assert result["governing"]["load_case"] == most["name"]
    assert result["governing"]["cable"] == most["cable"]
    assert result["selection"]["chosen"]["utilisation"] == most["utilisation"]


def test_forces_of_the_governing_pose_add_up(found: Analysis) -> None:
    governing = result_dict(found)["governing"]
    pulls = np.sum([cable["pull_N"] for cable in governing["cables"]], axis=0)
    np.testing.assert_allclose(pulls, [0.0, 0.0, 1.5 * 180.0 * 9.81], atol=1e-6)
    np.testing.assert_allclose(governing["force_sum_N"], 0.0, atol=1e-6)
    used = [max(c["exit_tension_N"], c["platform_tension_N"]) for c in governing["cables"]]
    assert int(np.argmax(used)) + 1 == governing["cable"]
    for cable in governing["cables"]:
        pull = np.array(cable["pull_N"])
        assert np.linalg.norm(pull) == pytest.approx(cable["platform_tension_N"], rel=1e-9)
        assert np.sin(cable["angle_rad"]) == pytest.approx(pull[2] / np.linalg.norm(pull))
        mean = 0.5 * (cable["exit_tension_N"] + cable["platform_tension_N"])
        assert found.selection is not None
        assert found.selection.chosen is not None
        rope = found.selection.chosen.cable
        strain = mean / rope.axial_stiffness_N
        assert cable["stretch_m"] == pytest.approx(strain * cable["length_m"], rel=1e-4)
        level = np.hypot(*pull[:2]) / np.linalg.norm(pull)
        sag = rope.weight_N_per_m * level * cable["length_m"] ** 2 / (8.0 * mean)
        assert cable["sag_m"] == pytest.approx(sag, rel=0.02)


def test_the_tables(drawings: Drawings) -> None:
    section = section_of(drawings, "load-cases")
    rows = cells(section, "Unirope-7x19-galvanised")
    assert [row[0] for row in rows] == ["static", "<b>hoisting</b>", "storm", "lost"]
    assert [row[-1] for row in rows] == ["holds", "holds, governs", "holds", "holds"]
    assert "without cable 2" in rows[3][-2]
    assert "comes to rest elsewhere" in said(section)
    assert table(section, "The load cases").groups[0].rows[1].cells[1] == "Dynamic factor 1.5"


def test_the_checks(drawings: Drawings) -> None:
    section = section_of(drawings, "checks")
    rows = {
        (row[0], row[-2].split(",")[0]): row[-1]
        for row in cells(section, "Requirements of the study")
    }
    for case in ("static", "<b>hoisting</b>", "storm", "lost"):
        assert rows["Equilibrium", case] == rows["Breaking load", case] == "holds"
    assert rows["Sheave", "all"] == rows["Slack", "storm"] == rows["Stability", "storm"] == "holds"
    assert "clearance (none is given)" in said(section)
    total = cells(section, "The governing pose, in the load case <b>hoisting</b>: force")[-1]
    assert total[0] == "Sum"
    assert all(abs(float(cell.split("\u00a0")[0])) == 0.0 for cell in total[1:])


def test_what_fails_is_on_page_one(found: Analysis) -> None:
    assert not found.unmet
    bent = [
        replace(each, state=State.FAILS) if each.id == "sheave_ratio" else each
        for each in found.requirements
    ]
    page = first_page(Drawings(altered(found, requirements=tuple(bent))))
    assert {one.title: one for one in page.reasons}["Sheave does not hold"].tone == "bad"


def test_the_terminal_has_a_line_a_case(found: Analysis) -> None:
    rows = dict(summary_rows(found))
    assert {"  static", "  <b>hoisting</b>", "  storm", "  lost"} <= rows.keys()
    assert "in the load case '<b>hoisting</b>'" in rows["  utilisation"]


def test_page_one_says_what_is_in_the_loads(drawings: Drawings, bare: Analysis) -> None:
    verdict = first_page(drawings).verdict
    assert verdict.title.endswith("for 4 load cases")
    assert verdict.text.startswith("Not asked: change of temperature, end fittings. ")
    alone = Drawings(bare)
    verdict = first_page(alone).verdict
    assert verdict.title.endswith("for one static case")
    assert verdict.text.startswith(
        "Not asked: wind, dynamics, ice, loss of a cable, change of temperature, end fittings. "
    )
    assert section_of(alone, "load-cases") is None
    assert [case["name"] for case in result_dict(bare)["load_cases"]] == ["static"]


FAMILY = (
    YARD.replace("selection: {grades: [unirope-7x19-galvanised], sheave_diameter: 150 mm}", "")
    + """
load_cases:
  - name: static
  - {name: storm, wind: {speed: 20 m/s, directions: 2}, ice: {thickness: 5 mm}}
  - {name: cold, temperature_change: -40 K}
"""
)


def test_without_a_selection_the_diameter_of_each_case_is_told(
    solve: Callable[[str], Analysis],
) -> None:
    found = solve(FAMILY)
    assert found.workspace is not None
    assert found.workspace.sagging is not None
    cases = json.loads(json_text(result_dict(found)))["load_cases"]
    static, storm, cold = (case["diameter_m"] for case in cases)
    assert static == pytest.approx(found.workspace.sagging.diameter_m, rel=1e-4)
    assert storm > cold > static
    assert [case["temperature_change_K"] for case in cases] == [None, None, -40.0]
    drawings = Drawings(found)
    page = first_page(drawings)
    assert "'storm' governs" in page.verdict.text
    assert page.card is not None
    assert page.card.size == f"{1e3 * storm:.2f}\u00a0mm"
    section = section_of(drawings, "load-cases")
    rows = cells(section, "The thinnest diameter")
    assert [row[0] for row in rows] == ["static", "storm", "cold"]
    assert "Winches that regulate" in said(section)
    assert any("storm" in label for label, _ in summary_rows(found))
    assert found.qualities is not None
    assert f"{1e3 * storm:.1f} mm" in found.qualities.cable.name


def test_what_is_not_met_is_said_of_the_load_case_that_is_furthest_from_it() -> None:
    cases = [SimpleNamespace(utilisation=utilisation) for utilisation in (np.nan, 1.1, 1.4, 1.2)]
    assert Unmet(tuple(cases)).requirement is cases[2]


def test_the_marked_cable_is_the_most_loaded_one(found: Analysis, bare: Analysis) -> None:
    for analysis in (found, bare):
        governing = max(
            (each for each in analysis.requirements if each.id == "breaking_load"),
            key=lambda each: each.utilisation,
        )
        section = section_of(Drawings(analysis), "checks")
        assert section is not None
        assert section.context["governing_cable"] == governing.cable
