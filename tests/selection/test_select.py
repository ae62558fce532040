"""Snap and verify: the choice is proved with the product's own figures.

Every candidate can be proved again with `designer size` on its worst pose, with its own data.
"""

from __future__ import annotations

import json
import math
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from ropes import rope

from designer.cli.commands import main
from designer.grades.grade import Grade
from designer.model.cable import Material
from designer.model.load_case import STATIC, LoadCase, Wind
from designer.model.region import PointList, Prism
from designer.model.robot import Poses
from designer.model.workspace import Workspace
from designer.selection.assignment import for_all
from designer.selection.candidate import Candidate
from designer.selection.cases import over_samples
from designer.selection.result import GradeOutcome
from designer.selection.select import select
from designer.selection.verify import verify
from designer.sizing.newton import size_poses
from designer.statics.inverse import solve_sagging
from designer.study import Selection

TRIANGLE = [[0, 0, 0], [500, 0, 0], [250, 433.01, 0]]


@pytest.fixture(scope="module")
def workspace() -> Workspace:
    return Workspace(Prism.over(TRIANGLE, 40.0, (-200.0, -60.0)), samples=2000)


ALL = Selection(None, 2.0)


def try_grade(robot, workspace, grade: Grade, safety_factor: float) -> GradeOutcome:
    return select(robot, workspace, Selection(None, safety_factor), [grade]).outcomes[0]


def test_snap_takes_the_next_size_up(fast_robot, workspace) -> None:
    outcome = try_grade(fast_robot, workspace, rope("a", list(np.arange(8.0, 40.0, 2.0))), 2.0)
    need = 1e3 * outcome.continuous_diameter_m
    assert outcome.best is not None
    assert 1e3 * outcome.best.size.diameter_m == pytest.approx(2 * np.ceil(need / 2))
    for candidate in outcome.candidates:
        is_enough = candidate.size.diameter_m >= outcome.continuous_diameter_m
        assert candidate.verification.holds == is_enough


def test_size_at_the_continuous_optimum_is_used_fully(fast_robot, workspace) -> None:
    grade = rope("a", [10.0, 40.0])
    optimum = 1e3 * try_grade(fast_robot, workspace, grade, 2.0).continuous_diameter_m
    outcome = try_grade(fast_robot, workspace, rope("b", [optimum * 0.999, optimum * 1.0001]), 2.0)
    assert [c.verification.holds for c in outcome.candidates] == [False, True]
    assert outcome.candidates[1].verification.utilisation == pytest.approx(1.0, abs=1e-3)


def test_verification_holds_at_the_worst_pose_found_by_other_means(fast_robot, workspace) -> None:
    grade = rope("a", [24.0])
    cable = grade.cable(grade.sizes[0], 2.0)
    result = verify(fast_robot, workspace, cable)
    at_worst = solve_sagging(fast_robot, Poses.at(result.worst_place), cable)
    assert at_worst.largest_tension_N == pytest.approx(result.max_tension_N, rel=1e-9)
    rng = np.random.default_rng(9)
    low, high = workspace.region.bounds_m
    others = rng.uniform(low, high, (20_000, 3))
    others = others[workspace.region.contains(others)]
    tension = solve_sagging(fast_robot, Poses.at(others), cable).largest_tension_N
    assert np.nanmax(tension) <= result.max_tension_N
    assert result.longest_m.max() < 600


def test_one_rope_is_a_group_of_all_cables(fast_robot, workspace) -> None:
    best = try_grade(fast_robot, workspace, rope("a", [24.0, 30.0]), 2.0).best
    assert best is not None
    assigned = for_all(best)
    assert [group.cables for group in assigned.groups] == [(1, 2, 3)]
    assert assigned.max_tension_N == pytest.approx(best.verification.max_tension_N)
    assert not for_all(None).groups


def test_no_point_of_a_long_list_is_left_out_of_the_optimum(fast_robot, workspace) -> None:
    grade = rope("a", [10.0, 40.0])
    points = workspace.region.inside_m(np.random.default_rng(8), 5000)
    need_m = size_poses(fast_robot, Poses.at(points), grade.family(2.0)).diameter_m
    points = points[np.roll(np.argsort(need_m), 2)]  # the second needs most
    listed = replace(workspace, region=PointList(points))
    optimum_m = try_grade(fast_robot, listed, grade, 2.0).continuous_diameter_m
    assert optimum_m == pytest.approx(need_m.max(), rel=1e-9)


def test_poses_over_the_limit_are_counted_one_by_one_as_by_the_compiled_sweep(
    fast_robot, workspace
) -> None:
    """In a breath of wind, which has poses told by the true vertical, and in none."""
    grade = rope("a", [14.0])
    cable = grade.cable(grade.sizes[0], 2.0)
    points = workspace.region.inside_m(np.random.default_rng(8), 500)
    few = replace(workspace, region=PointList(points), hangs_below="exclude")
    breath = LoadCase("breath", wind=Wind(1e-4, 1.2, direction=np.array([1.0, 0.0, 0.0])))
    counts = []
    for case in (STATIC, breath):
        (sampled,) = over_samples([next(iter(case.on(fast_robot, cable)))], few)
        counts.append((sampled.counted, sampled.overloaded, sampled.not_held))
    assert counts[0] == counts[1]
    assert 0 < counts[0][1] < counts[0][0]


@pytest.mark.slow
def test_a_weak_size_is_passed_over(fast_robot, workspace) -> None:
    sizes = [12.0, 14.0, 16.0, 18.0, 20.0, 22.0, 24.0]
    sound = try_grade(fast_robot, workspace, rope("a", sizes), 2.0)
    assert sound.best is not None
    first = 1e3 * sound.best.size.diameter_m
    weak = try_grade(fast_robot, workspace, rope("b", sizes, weaker={first: 0.6}), 2.0)
    assert weak.best is not None
    assert 1e3 * weak.best.size.diameter_m > first


@pytest.mark.slow
def test_a_strong_size_below_the_snap_is_found(fast_robot, workspace) -> None:
    sizes = [12.0, 14.0, 16.0, 18.0, 20.0, 22.0, 24.0]
    sound = try_grade(fast_robot, workspace, rope("a", sizes), 2.0)
    assert sound.best is not None
    below = 1e3 * sound.best.size.diameter_m - 2
    strong = try_grade(fast_robot, workspace, rope("b", sizes, weaker={below: 1.5}), 2.0)
    assert strong.best is not None
    assert 1e3 * strong.best.size.diameter_m == pytest.approx(below)


def test_the_lightest_of_several_grades_is_chosen(fast_robot, workspace) -> None:
    fine, coarse = rope("fine", list(np.arange(10.0, 40.0, 1.0))), rope("coarse", [10.0, 30.0])
    found = select(fast_robot, workspace, ALL, [coarse, fine])
    assert found.chosen is not None
    assert found.chosen.grade.id == "fine"
    assert found.chosen.total_mass_kg == min(
        c.total_mass_kg for c in found.candidates if c.verified
    )


@pytest.mark.slow
def test_grade_that_ends_too_thin_names_what_goes_on(fast_robot, workspace) -> None:
    thin, thick = rope("thin", [4.0, 8.0, 12.0]), rope("thick", [20.0, 24.0, 28.0])
    found = select(fast_robot, workspace, Selection(("thin",), 2.0), [thin, thick])
    assert found.chosen is None
    assert found.outcomes[0].outcome == "too_thin"
    assert [c.size.id for c in found.candidates] == ["4 mm", "8 mm", "12 mm"]
    assert all(c.verification.utilisation > 1.0 for c in found.candidates)
    assert {c.standing for c in found.candidates} == {"too_thin"}
    assert "12 mm" in (found.reason or "")
    assert [outcome.grade.id for outcome in found.alternatives] == ["thick"]


def test_ropes_that_are_all_too_heavy_are_called_so(fast_robot) -> None:
    light = replace(fast_robot, platform=replace(fast_robot.platform, mass_kg=20.0))
    region = Prism.over(TRIANGLE, 100.0, (-200.0, -150.0))
    low = Workspace(region, samples=200, hangs_below="exclude")
    found = select(light, low, Selection(None, 2.0), [rope("hawser", [40.0, 60.0])])
    assert found.chosen is None
    assert found.outcomes[0].continuous_diameter_m < 0.04
    assert "no size sold of any grade holds" in (found.reason or "")
    assert "too heavy even in its smallest size sold, 40 mm" in (found.reason or "")


def test_no_section_is_enough_for_a_weak_rope(fast_robot) -> None:
    prism = Prism.over(TRIANGLE, 5.0, (-200.0, -40.0))
    outcome = try_grade(fast_robot, Workspace(prism, samples=1000), rope("a", [20.0]), 16.0)
    assert outcome.outcome == "no_finite_cable"
    assert np.isnan(outcome.continuous_diameter_m)
    family = rope("a", [20.0]).family(16.0)
    assert size_poses(fast_robot, Poses.at([250.0, 5.0, -40.0]), family).statics.verdict == 2


def test_no_grade_at_all(fast_robot, workspace) -> None:
    found = select(fast_robot, workspace, ALL, [])
    assert found.chosen is None
    assert found.reason


def test_workspace_whose_every_pose_is_left_out_is_served_by_nothing(fast_robot) -> None:
    edge = Prism.over([[200, 8], [300, 8], [250, 12]], 0.0, (-60.0, -50.0))
    outside = Workspace(edge, samples=50, hangs_below="exclude")
    found = select(fast_robot, outside, ALL, [rope("a", [20.0, 40.0])])
    assert found.chosen is None
    assert found.reason


NOT_BY_DEFAULT = {
    "nominal": rope("nominal", [20.0, 22.0, 24.0], is_nominal=True),
    "stay": replace(rope("stay", [20.0, 22.0, 24.0]), construction="1x19 spiral strand"),
}


@pytest.mark.cases_by_default(1)
@pytest.mark.parametrize("kind", NOT_BY_DEFAULT)
def test_some_grades_are_taken_only_by_name(kind: str, fast_robot, workspace) -> None:
    grades = [rope("sold", [24.0, 28.0]), NOT_BY_DEFAULT[kind]]
    found = select(fast_robot, workspace, ALL, grades)
    assert {c.grade.id for c in found.candidates} == {"sold"}
    assert [(n.grade.id, n.size) for n in found.not_tried] == [(kind, None)]
    named = select(fast_robot, workspace, Selection((kind,), 2.0), grades)
    assert {c.grade.id for c in named.candidates} == {kind}


@pytest.mark.parametrize("construction", ["7x19", "19x7", "18x19, compacted strands", "1 braid"])
def test_ropes_are_no_single_strands(construction: str) -> None:
    assert replace(rope("a", [20.0]), construction=construction).why_only_by_name() is None


@pytest.mark.slow
def test_what_matters_is_searched_between_the_samples(fast_robot, workspace) -> None:
    grades = [rope("a", list(np.arange(8.0, 60.0, 1.0))), rope("b", [30.0, 50.0])]
    found = select(fast_robot, workspace, ALL, grades)
    for candidate in found.candidates:
        used = candidate.verification
        matters = candidate.standing in ("chosen", "undominated") or 0.9 < used.utilisation <= 1.0
        assert used.is_refined or not matters
        assert candidate.verified == (used.is_refined and used.utilisation <= 1.0)
    assert all(o.best is not None and o.best.verified for o in found.outcomes)
    assert sum(c.verification.holds and not c.verified for c in found.candidates) > 10


def test_every_candidate_has_its_reason(fast_robot, workspace) -> None:
    sizes = [8.0, 16.0, 24.0, 32.0]
    found = select(fast_robot, workspace, ALL, [rope("a", sizes), rope("b", sizes, strength=0.7)])
    standings = {c.standing for c in found.candidates}
    assert standings >= {"chosen", "too_thin", "dominated"}
    for candidate in found.candidates:
        if candidate.standing == "too_thin":
            assert "%" in candidate.reason
        if candidate.standing == "dominated":
            assert candidate.reason.startswith(f"dominated by {found.chosen.size.id} of a")


@pytest.mark.slow
def test_search_turns_down_a_size_that_only_the_samples_let_pass(fast_robot) -> None:
    """Few samples miss the worst pose; the size that is enough for them alone must not win."""
    few = Workspace(Prism.over(TRIANGLE, 40.0, (-200.0, -60.0)), samples=40)
    exact = select(fast_robot, few, ALL, [rope("a", [10.0, 60.0])])
    need = 1e3 * exact.outcomes[0].continuous_diameter_m
    found = select(fast_robot, few, ALL, [rope("b", [0.998 * need, 1.2 * need])])
    below, above = found.candidates
    assert below.standing == "too_thin"
    assert below.verification.is_refined
    assert 1.0 < below.verification.utilisation < 1.02
    assert found.chosen is above


@pytest.fixture(scope="module")
def candidates(fast_robot) -> tuple[Candidate, ...]:
    workspace = Workspace(Prism.over(TRIANGLE, 30.0, (-200.0, -50.0)), samples=800)
    grades = [
        rope("steel", [6.0, 12.0, 16.0, 20.0, 24.0, 40.0]),
        rope("light", [8.0, 12.0, 20.0], weight=0.2, stiffness=0.4),
        rope("weak", [20.0, 30.0], strength=0.6),
    ]
    selection = Selection(None, 2.0, termination_efficiency=0.9, sheave_diameter_m=0.5)
    return select(fast_robot, workspace, selection, grades).candidates


def as_material(candidate: Candidate) -> Material:
    """The product as a family whose allowable stress is what it was found to meet.

    Sizing then has to find the product's own diameter.
    """
    area_m2 = candidate.size.nominal_area_m2
    cable = candidate.cable
    return Material(
        density_kg_per_m3=cable.linear_density_kg_per_m / area_m2,
        youngs_modulus_Pa=cable.axial_stiffness_N / area_m2,
        allowable_stress_Pa=candidate.verification.max_tension_N / area_m2,
    )


@pytest.mark.slow
def test_sizing_at_the_worst_pose_finds_the_product_again(candidates, fast_robot) -> None:
    assert len(candidates) == 11
    for candidate in candidates:
        found = candidate.verification
        sizing = size_poses(fast_robot, Poses.at(found.worst_place), as_material(candidate))
        assert float(sizing.diameter_m) == pytest.approx(candidate.size.diameter_m, rel=1e-8)
        tension = float(sizing.statics.largest_tension_N)
        assert tension == pytest.approx(found.max_tension_N, rel=1e-8)
        load = candidate.size.minimum_breaking_load_N
        allowable = load * candidate.efficiency / 2.0
        assert found.utilisation == pytest.approx(tension / allowable, rel=1e-8)


def test_command_line_finds_it_too(candidates, tmp_path: Path, monkeypatch, capsys) -> None:
    candidate = next(c for c in candidates if c.standing == "chosen")
    material, found = as_material(candidate), candidate.verification
    config = tmp_path / "worst.yaml"
    config.write_text(
        "robot:\n"
        "  anchors: [[0, 0, 0], [500, 0, 0], [250, 433.01, 0]]\n"
        "  platform: {mass: 4000 kg}\n"
        f"cable: {{density: {material.density_kg_per_m3!r}, "
        f"youngs_modulus: {material.youngs_modulus_Pa!r}, "
        f"allowable_stress: {material.allowable_stress_Pa!r}}}\n"
        f"pose: {[float(x) for x in found.worst_place]}\n",
        encoding="utf-8",
    )
    monkeypatch.setattr(sys, "argv", ["designer", "size", str(config), "--json"])
    with pytest.raises(SystemExit) as stop:
        main()
    assert not stop.value.code
    pose = json.loads(capsys.readouterr().out)["pose"]
    assert math.isclose(pose["sagging"]["diameter_m"], candidate.size.diameter_m, rel_tol=1e-8)
    assert math.isclose(pose["sagging"]["max_tension_N"], found.max_tension_N, rel_tol=1e-8)
