"""What carries the result: put back in, and as the report shows it."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from report_parts import cells, said

from designer.analysis.analyse import Analysis
from designer.analysis.result_json import result_dict
from designer.analysis.sensitivity import SensitivityReport, sensitivities, with_payload
from designer.documents.plain import json_text
from designer.report.design.drawings import Drawings
from designer.report.design.report import section as section_of
from designer.selection.verify import verify

pytestmark = pytest.mark.slow

CRANE = """
name: Crane
robot:
  anchors: [[0, 0, 11.5], [30, 1, 12.5], [14, 26, 11.5]]
  platform: {mass: 180 kg, drag: {area: 0.5 m^2, coefficient: 1.1}}
cable:
  density: 5290 kg/m^3
  youngs_modulus: 62.7 GPa
  allowable_stress: 198 MPa
  drag_coefficient: 1.2
workspace: {region: {prism: anchors, inset: 4 m, z: [1, 7]}, samples: 200}
selection: {grades: [unirope-7x19-galvanised]}
"""
CASES = """
load_cases:
  - name: static
  - {name: storm, wind: {speed: 30 m/s, directions: 4}, safety_factor: 4}
"""


@pytest.fixture(scope="module")
def found(solve: Callable[[str], Analysis]) -> Analysis:
    return solve(CRANE)


@pytest.fixture(scope="module")
def windy(solve: Callable[[str], Analysis]) -> Analysis:
    return solve(CRANE + CASES)


def of(found: Analysis) -> SensitivityReport:
    assert found.sensitivity is not None
    return found.sensitivity


@pytest.mark.parametrize("name", ["found", "windy"])
def test_payload_reserve_put_back_in_uses_all(name: str, request: pytest.FixtureRequest) -> None:
    one = of(request.getfixturevalue(name))
    assert one.payload is not None
    assert one.payload.value > 1.0
    used = []
    assert request.getfixturevalue(name).selection.chosen is not None
    for case in request.getfixturevalue(name).selection.chosen.cases:
        loaded = with_payload(case.loaded, one.payload.value)
        used.append(verify(loaded.robot, case.workspace, loaded.cable).utilisation)
    assert max(used) == pytest.approx(1.0, abs=1e-4)


def test_region_reserve_put_back_in_uses_all(found: Analysis) -> None:
    one, study = of(found), found.study
    assert one.region is not None
    assert study.workspace is not None
    region = study.workspace.region.grown(one.region.value)
    loaded = one.governing.loaded
    met = verify(loaded.robot, replace(study.workspace, region=region), loaded.cable)
    assert met.utilisation == pytest.approx(1.0, abs=1e-4)
    assert one.region.value > 0.5


def test_first_failures_are_failures_and_no_nearer_than_the_reserve(found: Analysis) -> None:
    one = of(found)
    assert one.region is not None
    level = [f for f in one.failures if f.name not in ("up", "down")]
    signs = {"+": 1.0, "-": -1.0}
    for failure in level:
        ways = [signs[way[0]] * np.eye(3)["xyz".index(way[1])] for way in failure.name.split()]
        assert failure.direction == pytest.approx(np.sum(ways, axis=0) / np.sqrt(len(ways)))
    assert min(f.distance_m for f in level) == pytest.approx(one.region.value, rel=0.05)
    assert one.nearest is not None
    known = [f.distance_m for f in one.failures if f.distance_m >= 0.0]
    assert one.nearest.distance_m == min(known) < max(known)
    for failure in one.failures:
        if np.isfinite(failure.distance_m):
            beyond = failure.position_m + 1e-3 * failure.direction
            met = replace(one.governing.verification, worst_place=beyond)
            used = replace(one.governing, verification=met).tension_N(one.governing.loaded)
            assert used >= one.governing.loaded.cable.allowable_tension_N


@pytest.mark.parametrize("name", ["found", "windy"])
def test_slopes_are_those_of_the_worst_pose_searched_again(
    name: str, request: pytest.FixtureRequest
) -> None:
    one = of(request.getfixturevalue(name)).governing
    step = 1e-3
    used = []
    for factor in (1.0 - step, 1.0 + step):
        loaded = with_payload(one.loaded, factor)
        used.append(verify(loaded.robot, one.workspace, loaded.cable).utilisation)
    theirs = (used[1] - used[0]) / (2.0 * step)
    ours = of(request.getfixturevalue(name)).sensitivities.of("payload").derivative
    assert ours == pytest.approx(theirs, rel=1e-5)


def test_ties_have_no_slope_where_only_one_cable_gains(solve: Callable[[str], Analysis]) -> None:
    text = CRANE.replace("[[0, 0, 11.5], [30, 1, 12.5], [14, 26, 11.5]]",
                         "[[0, 0, 11.5], [30, 0, 11.5], [15, 26, 11.5]]")  # fmt: skip
    text = text.replace("{prism: anchors, inset: 4 m, z: [1, 7]}", "{points: [[15, 8, 6]]}")
    one = of(solve(text))
    assert "used alike" in one.sensitivities.why_not
    assert np.isnan(one.sensitivities.exit_points_per_m).any()
    assert one.sensitivities.of("payload").elasticity == pytest.approx(1.0, abs=0.1)
    assert one.region is None


def test_sizes_stand_beside_the_chosen_one(found: Analysis) -> None:
    thinner, chosen, thicker = of(found).sizes
    assert thinner.utilisation > 1.0 > chosen.utilisation > thicker.utilisation
    assert chosen.safety_factor == pytest.approx(5.0 / chosen.utilisation)


def test_lost_cable_has_slopes_by_differences(solve: Callable[[str], Analysis]) -> None:
    lost = "{name: lost, cable_lost: 2, safety_factor: 8}"
    found = solve(CRANE + f"load_cases: [{{name: static}}, {lost}]\n")
    assert found.selection is not None
    chosen = found.selection.chosen
    assert chosen is not None
    one = sensitivities(chosen.governing, chosen.efficiency, chosen.size.minimum_breaking_load_N)
    assert chosen.governing.loaded.lost_cable == 2
    assert one.method == "differences"
    assert one.of("payload").elasticity == pytest.approx(1.0, abs=0.1)


def test_result_and_report_have_it(windy: Analysis) -> None:
    result = json.loads(json_text(result_dict(windy)))
    inputs = {row["input"]: row for row in result["sensitivities"]}
    assert inputs["breaking_load"]["elasticity"] == -1.0
    assert "exit_point_3_z" in inputs
    assert result["reserve"]["payload_factor"] > 1.0
    assert result["reserve"]["region_margin_m"] > 0.0
    section = section_of(Drawings(windy), "carries")
    assert section is not None
    rows = {row[0]: row for row in cells(section, "Change of the utilisation")}
    assert rows["Breaking load"][3].startswith("−")
    assert "utilisation reaches 100.0 %" in said(section)
