"""Stiffness and clearance in the analysis, in result.json, in the report and its maps."""

from __future__ import annotations

import json
import re
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from altered import altered
from report_cases import SIX
from report_parts import facts, page, pictures, said, statements, tables

from designer.analysis.analyse import Analysis
from designer.analysis.maps import SectionMap
from designer.analysis.result_json import result_dict
from designer.report.design.drawings import Drawings
from designer.report.design.report import design_report, section
from designer.report.figures.sections import section_map
from designer.report.render import render_html
from designer.selection.assignment import Qualities

pytestmark = pytest.mark.slow

Solve = Callable[[str], Analysis]


def surveyed(qualities: Qualities, **surveys: object) -> Qualities:
    """Return qualities whose surveys have come to something else."""
    changed = replace(qualities)
    vars(changed).update(surveys)
    return changed


def test_the_cable_is_the_chosen_rope_or_that_of_the_family(
    kept: Analysis, not_kept: Analysis
) -> None:
    assert kept.qualities is not None and kept.selection is not None
    chosen = kept.selection.chosen
    assert chosen is not None
    assert kept.qualities.cable.cable is chosen.cable
    assert chosen.grade.id in kept.qualities.cable.name
    assert not_kept.qualities is not None
    assert "configured family" in not_kept.qualities.cable.name


def test_result_json(kept: Analysis, not_kept: Analysis) -> None:
    for analysis, violated in ((kept, False), (not_kept, True)):
        found = json.loads(json.dumps(result_dict(analysis)["workspace"], allow_nan=False))
        interference = found["interference"]
        assert interference["violated"] is violated
        assert analysis.is_positive is not violated
        assert (interference["min_distance_m"] < interference["clearance_m"]) is violated
        assert (interference["violating"] > 0) is violated
        assert len(interference["pose"]) == 3
        assert len(interference["pair"]) == 2
        assert interference["pair"][0].startswith("cable ")
        assert found["stiffness"]["unstable"] == 0
        assert 0.0 < found["stiffness"]["largest_displacement_m_per_N"] < 1e-3


def test_what_was_not_asked_for_is_null(yard: Analysis, pose_only: Analysis) -> None:
    workspace = result_dict(yard)["workspace"]
    assert workspace["interference"] is None
    assert workspace["stiffness"]["samples"] == 300
    assert pose_only.qualities is None


def test_no_cable_has_no_qualities(analyses: dict[str, Analysis]) -> None:
    assert analyses["no_finite_cable"].qualities is None
    assert result_dict(analyses["no_finite_cable"])["workspace"]["stiffness"] is None
    assert section(Drawings(analyses["no_finite_cable"]), "stiffness") is None


def test_sections_say_what_was_found(kept: Analysis, not_kept: Analysis) -> None:
    good, bad = (design_report(a, draws=False) for a in (kept, not_kept))
    assert statements(good.section("clearance"))["The clearance is kept"].tone == "good"
    found = statements(bad.section("clearance"))
    assert "of the samples" in found["The clearance is not kept"].text
    assert "All searched poses are stable" in statements(bad.section("stiffness"))
    ids = [section.id for section in bad.sections]
    assert ids.index("stiffness") + 1 == ids.index("clearance")
    html = render_html(bad)
    assert "Clearance of cables from each other" in html
    assert "Contact of cables with each other" not in html


def test_a_clearance_broken_between_samples_only(not_kept: Analysis) -> None:
    found = not_kept.qualities
    assert found is not None and found.interference is not None
    none_of_the_samples = replace(found.interference, violating=0)
    changed = altered(not_kept, qualities=surveyed(found, interference=none_of_the_samples))
    assert "only between the samples" in said(section(Drawings(changed), "clearance"))


def test_unstable_poses_are_told(kept: Analysis) -> None:
    found = kept.qualities
    assert found is not None and found.stiffness is not None
    softest = replace(found.stiffness, unstable=3, softest_m_per_N=np.inf)
    shaky = surveyed(found, stiffness=softest)
    shown = section(Drawings(altered(kept, qualities=shaky)), "stiffness")
    verdict = statements(shown)["Some poses are not stable"]
    assert verdict.tone == "bad"
    assert "unstable in 5.00\u00a0% of the samples" in verdict.text
    assert facts(shown)["Softest pose"].value == "not stable"


def test_maps_are_drawn(not_kept: Analysis) -> None:
    drawings = Drawings(not_kept, draws=True, missing="no scenes")
    shown = [section(drawings, name) for name in ("stiffness", "clearance")]
    (soft,), (near,) = map(pictures, shown)
    assert "largest displacement [mm/kN]" in soft.svg
    assert "the clearance that is asked for" in near.svg
    html = page(shown)
    assert 'id="stiffness-' in html and 'id="clearance-' in html


def test_a_list_of_points_has_no_map(solve: Solve) -> None:
    points = "{points: [[0, 0, 4], [2, 1, 5]]}"
    analysis = solve(SIX.format(region=points, clearance="0.1 m", selection=""))
    for name in ("stiffness", "clearance"):
        shown = section(Drawings(analysis, draws=True), name)
        assert shown is not None
        assert pictures(shown) == []


def test_a_point_mass_has_nothing_to_compare(solve: Solve) -> None:
    text = """
robot: {anchors: [[0, 0, 12], [30, 0, 12], [15, 26, 12]], platform: {mass: 180 kg}}
cable: {density: 5290 kg/m^3, youngs_modulus: 62.7 GPa, allowable_stress: 198 MPa}
workspace: {region: {points: [[15, 9, 4]]}, clearance: 0.1 m}
"""
    analysis = solve(text)
    shown = section(Drawings(analysis, draws=True), "clearance")
    assert "No clearance to evaluate" in statements(shown)
    assert tables(shown) == []
    assert result_dict(analysis)["workspace"]["interference"]["min_distance_m"] is None


@pytest.mark.parametrize("case", ["all", "some bad", "nothing", "limit"])
def test_height_maps(case: str) -> None:
    from designer.model.region import Prism

    region = Prism.box((0.0, 4.0), (0.0, 3.0), (1.0, 2.0))
    position = region.section_m(0.5, 6, 24)
    values = 1.0 + position[..., 0]
    bad = np.zeros(values.shape, dtype=bool)
    if case != "all":
        bad = position[..., 0] > 3.0
        values = np.where(bad, np.nan, values)
    if case == "nothing":
        values = np.full(values.shape, np.nan)
    exits = np.array([[0.0, 0, 5], [4, 0, 5], [2, 3, 5]])
    limit = 2.0 if case == "limit" else None
    shown = SectionMap(position, values, bad, exits)
    svg = section_map(shown, "test", "depth [m]", "not held", limit)
    assert ("not held" in svg) == (case != "all")
    assert "depth [m]" in svg
    assert ("asked for" in svg) == (case == "limit")
    assert ("left out" in svg) == (case == "nothing")
    assert re.search(r"<title>depth \[m\], z = 1.5 m</title>", svg)
