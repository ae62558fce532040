"""The small extra solves behind the report."""

from __future__ import annotations

import re

import numpy as np
import pytest
from report_parts import said

from designer.analysis.analyse import Analysis
from designer.model.region import Prism
from designer.model.robot import Poses
from designer.report.design.drawings import Drawings
from designer.report.design.report import section
from designer.selection.verify import verify
from designer.statics.inverse import solve_sagging

pytestmark = pytest.mark.slow


def test_massless_choice_is_thinner_and_falls_short(analyses: dict[str, Analysis]) -> None:
    analysis = analyses["positive"]
    choice = analysis.findings.massless_choice
    assert choice is not None
    assert analysis.selection is not None
    assert analysis.selection.chosen is not None
    assert analysis.workspace is not None
    assert analysis.workspace.massless is not None
    assert choice.size.minimum_breaking_load_N >= 2 * analysis.workspace.massless.max_tension_N
    assert choice.size.diameter_m < analysis.selection.chosen.size.diameter_m
    assert choice.safety_factor == pytest.approx(1.80, abs=0.01)


def test_massless_choice_is_verified_like_any_size(analyses: dict[str, Analysis]) -> None:
    analysis = analyses["positive"]
    findings = analysis.findings
    choice, outcome = findings.massless_choice, findings.chosen_outcome
    assert choice is not None
    assert outcome is not None
    assert analysis.study.workspace is not None
    cable = outcome.grade.cable(choice.size, 2.0)
    fresh = verify(analysis.study.robot, analysis.study.workspace, cable)
    assert fresh.max_tension_N == pytest.approx(choice.verification.max_tension_N, rel=1e-9)


def test_modulus_matters_little_where_sag_rules(analyses: dict[str, Analysis]) -> None:
    analysis = analyses["positive"]
    low, high = analysis.findings.modulus_utilisation or (np.nan, np.nan)
    assert analysis.selection is not None
    chosen = analysis.selection.chosen
    assert chosen is not None
    assert low != high
    assert chosen.grade.modulus.uncertainty > 0.0
    assert min(low, high) < chosen.verification.utilisation < max(low, high)
    assert low == pytest.approx(high, rel=1e-2)


def test_limit_ratio_of_the_rope_is_that_of_a_very_thick_one(
    analyses: dict[str, Analysis],
) -> None:
    analysis = analyses["positive"]
    findings = analysis.findings
    assert analysis.selection is not None
    chosen, outcome = analysis.selection.chosen, findings.chosen_outcome
    assert chosen is not None
    assert outcome is not None
    thick = outcome.family.cable(100.0)
    worst = Poses.at(chosen.verification.worst_place)
    statics = solve_sagging(analysis.study.robot, worst, thick)
    ratio = float(statics.largest_tension_N) / thick.allowable_tension_N
    assert findings.chosen_limit_ratio == pytest.approx(ratio, rel=1e-3)


def test_other_policy_is_the_opposite(analyses: dict[str, Analysis]) -> None:
    included, excluded = analyses["positive"], analyses["exclude"]
    other = included.findings.other_policy
    assert other is not None
    assert other.hangs_below == "exclude"
    assert excluded.workspace is not None
    assert other.map.sagging is not None
    assert excluded.workspace.sagging is not None
    assert other.map.sagging.diameter_m == pytest.approx(
        excluded.workspace.sagging.diameter_m, rel=1e-3
    )


def test_no_policy_where_nothing_hangs(yard: Analysis) -> None:
    assert yard.findings.other_policy is None


def test_unserved_samples_lie_along_the_sides(analyses: dict[str, Analysis]) -> None:
    unserved = analyses["no_finite_cable"].findings.unserved
    assert unserved is not None
    # Reference: no finite cable at 4.8 m from the edge of the hull or nearer, at z = -40 m.
    assert 1.0 < unserved.depth_m < 4.81
    assert 100.0 < unserved.inradius_m < 144.4
    assert analyses["positive"].findings.unserved is None


def test_distance_to_sides() -> None:
    box = Prism.box((0.0, 10.0), (0.0, 4.0), (0.0, 1.0))
    positions = np.array([[5.0, 1.0, 0.5], [9.5, 2.0, 0.0], [0.0, 3.0, 1.0]])
    assert box.depth_m(positions) == pytest.approx([1.0, 0.5, 0.0])


def test_nothing_is_found_for_a_pose_alone(pose_only: Analysis) -> None:
    findings = pose_only.findings
    assert findings.chosen_outcome is None
    assert findings.other_policy is None
    assert findings.unserved is None


def test_hanging_share_is_that_of_the_chosen_rope(
    analyses: dict[str, Analysis], yard: Analysis, pose_only: Analysis
) -> None:
    included = analyses["positive"].findings.hanging
    assert analyses["positive"].workspace is not None
    census = analyses["positive"].workspace.census
    assert included is not None
    # The rope needs less than half the diameter of the idealised cable, so it hangs less often.
    assert 0.0 < included < census.hangs_below / census.samples
    assert yard.findings.hanging == 0.0
    assert pose_only.findings.hanging is None


def test_findings_and_assumptions_are_of_the_machine_as_built(solve, yard) -> None:
    from designer.report.design.drawings import Drawings
    from designer.report.design.report import section
    from designer.resources import example_file

    text = example_file("yard").read_text(encoding="utf-8")
    built = solve(text + "\neffects: {pulley_radius: {radius_m: 0.3}, linear_mass: {scale: 2}}\n")
    assumptions = said(section(Drawings(built), "assumptions"))
    assert "300 mm radius" in assumptions
    assert "the study declares: pulley_radius, linear_mass. They act" in assumptions
    assert "without pulleys" in said(section(Drawings(yard), "assumptions"))
    assert built.selection is not None
    outcome = built.selection.outcomes[0]
    # The mass was found of the study's own cable: a rope of the catalogue keeps its data sheet.
    given = outcome.grade.family(5.0)
    assert outcome.family.density_kg_per_m3 == given.density_kg_per_m3
    assert outcome.family.youngs_modulus_Pa == pytest.approx(given.youngs_modulus_Pa, rel=1e-12)
    assert built.built.material(built.study.material).density_kg_per_m3 == pytest.approx(
        2 * built.study.material.density_kg_per_m3
    )
    assert "Linear_mass belongs to the configured family. It is not applied" in assumptions


def test_sizes_that_fail_are_told_as_tried_until_then(analyses: dict[str, Analysis]) -> None:
    words = said(section(Drawings(analyses["positive"]), "selection"))
    assert re.search(r"the \d+ that hold in every sample, the others until failure\.", words)
    assert "breaking load, until failure." in said(
        section(Drawings(analyses["too_thin"]), "selection")
    )
