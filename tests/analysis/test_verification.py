"""The second answers: by other methods, on every kind of robot, and telling where ours is wrong."""

from __future__ import annotations

import re
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from designer.analysis.verification import verify, verify_cables
from designer.errors import MissingLibraryError
from designer.io.config import read_study
from designer.model.robot import Poses
from designer.physics import catenary
from designer.physics.quadrature import end_position_m
from designer.report.templates import environment
from designer.resources import example_file, example_names
from designer.sizing.newton import Sizing, size_poses
from designer.statics.inverse import solve_sagging
from designer.study import Study, as_built_by, require_answerable


def worst_sampled(name: str) -> tuple[Study, Sizing]:
    """A pose near the edge of the region of a shipped study, sized."""
    study = read_study(example_file(name))
    assert study.workspace is not None
    low, high = study.workspace.region.bounds_m
    place = 0.5 * (low + high) + 0.1 * (high - low)
    return study, size_poses(as_built_by(study).robot, Poses.at(place), study.material)


@pytest.mark.parametrize("name", example_names())
def test_shipped_robots_are_found_again(name: str) -> None:
    study, sizing = worst_sampled(name)
    found = verify("here", study.material, sizing)
    assert [one.remark for one in found] == ["", ""]
    assert all(one.agrees for one in found)
    diameter, cables = found
    assert abs(diameter.difference) < 1e-6 * diameter.ours
    assert cables.theirs < 1e-9


def test_a_wrong_answer_is_seen() -> None:
    study, sizing = worst_sampled("yard")
    statics = sizing.statics
    wrong = replace(statics, length_m=statics.length_m * np.array([1.0, 1.001, 1.0]))
    told = verify_cables("here", wrong)
    assert told.theirs > 1e-4 * float(statics.length_m[1])
    thin = replace(sizing, diameter_m=0.99 * sizing.diameter_m)
    diameter, _ = verify("here", study.material, thin)
    assert diameter.difference == pytest.approx(0.01 * sizing.diameter_m, rel=1e-3)
    assert not told.agrees
    assert not diameter.agrees
    thick = replace(diameter, ours=0.9 * diameter.theirs, may_be_more=True)
    assert thick.agrees
    assert not replace(thick, may_be_more=False).agrees
    shown = environment().from_string(
        '{% from "report/statements.html.j2" import verification with context %}'
        "{{ verification(answers) }}"
    )
    text = shown.render(answers=(told, diameter), paged=False)
    assert '<p class="statement bad">' in text
    assert "by quadrature" in text
    assert "by SLSQP" in text


def test_where_the_convex_programmes_cannot_be_solved_the_page_names_what_is_missing(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setitem(sys.modules, "clarabel", None)
    study, sizing = worst_sampled("stadium")  # of more cables than degrees of freedom
    answers = verify("here", study.material, sizing)
    assert answers[0].remark.startswith("Clarabel is not installed")
    assert answers[1].remark == ""
    shown = environment().from_string(
        '{% from "report/statements.html.j2" import verification with context %}'
        "{{ verification(answers) }}"
    )
    text = shown.render(answers=answers, paged=False)
    assert "Other methods agree where they have an answer." in text
    assert "Needed diameter, here, by convex programmes (Clarabel): Clarabel is not" in text
    assert "good" not in text


def test_groups_are_refused_where_nothing_chooses_them(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    text = example_file("fast").read_text(encoding="utf-8")
    path = tmp_path / "crane.yaml"
    path.write_text(text.replace("  # groups: {west", "  groups: {west"), encoding="utf-8")
    study = read_study(path)
    require_answerable(study)
    monkeypatch.setitem(sys.modules, "cvxpy", None)
    with pytest.raises(MissingLibraryError) as error:
        require_answerable(study)
    assert re.fullmatch(
        r".*crane.yaml:\d+: selection.groups: CVXPY is not installed; some machines have no wheel "
        r"of it \(expected a study without groups\)",
        str(error.value),
    )
    require_answerable(read_study(example_file("fast")))


def test_pulleys_are_known_by_the_quadrature_alone() -> None:
    study, _ = worst_sampled("yard")
    robot = replace(study.robot, pulley_radius_m=0.2)
    statics = size_poses(robot, Poses.at(np.array([5.0, 4.0, 2.0])), study.material)
    diameter, cables = verify("here", study.material, statics)
    assert np.isnan(diameter.theirs)
    assert "pulleys" in diameter.remark
    assert cables.theirs < 1e-9


def test_a_given_rope_is_integrated_too() -> None:
    study, sizing = worst_sampled("fast")
    statics = solve_sagging(study.robot, sizing.statics.poses, study.material.cable(0.06))
    assert verify_cables("here", statics).theirs < 1e-7


@given(
    st.floats(0.5, 1000.0),
    st.floats(-5.0, 4.0),
    st.floats(-1e5, 1e5),
    st.floats(5.0, 9.0),
    st.floats(-1.0, 2.0),
)
def test_quadrature_and_closed_form_agree(length, pull, force_z, stiffness, weight) -> None:
    figures = (length, 10.0**pull, force_z, 10.0**stiffness, 10.0**weight)
    x, z = end_position_m(*figures)
    closed = catenary.end_position_m(*figures)
    assert np.hypot(x - closed[0], z - closed[1]) <= 1e-8 * max(length, float(np.hypot(*closed)))
