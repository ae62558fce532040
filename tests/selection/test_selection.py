"""Snap and verify: the choice is proved with the product's own figures."""

from __future__ import annotations

import numpy as np
import pytest

from designer.catalogue.grade import Grade, Modulus, Reference, Size
from designer.region import Prism
from designer.robot import Poses
from designer.selection.select import select, try_grade
from designer.selection.verify import verify
from designer.sizing.newton import size_poses
from designer.statics.inverse import solve_sagging
from designer.study import Selection, Workspace

TRIANGLE = [[0, 0, 0], [500, 0, 0], [250, 433.01, 0]]


def rope(name: str, diameters_mm: list[float], weaker: dict[float, float] | None = None) -> Grade:
    """A grade after the law: 0.78 kN/mm² and 4.15 g/m per mm², some sizes weaker by a factor."""
    sizes = tuple(
        Size(
            id=f"{d:g} mm",
            diameter_m=d / 1e3,
            minimum_breaking_load_N=780.0 * d**2 * (weaker or {}).get(d, 1.0),
            linear_density_kg_per_m=4.15e-3 * d**2,
        )
        for d in diameters_mm
    )
    modulus = Modulus(62.7e9, "nominal", "borrowed", "a like rope", 0.15)
    return Grade(
        name, "maker", "rope", "7x19", "WSC", "galvanised", modulus, sizes, Reference("a", "b"), "B"
    )


@pytest.fixture(scope="module")
def workspace() -> Workspace:
    return Workspace(Prism.over(TRIANGLE, 40.0, (-200.0, -60.0)), samples=2000)


ALL = Selection(None, 2.0)


def test_snap_takes_the_next_size_up(fast_robot, workspace) -> None:
    outcome = try_grade(fast_robot, workspace, rope("a", list(np.arange(8.0, 40.0, 2.0))), 2.0)
    need = 1e3 * outcome.continuous_diameter_m
    assert outcome.best is not None
    assert 1e3 * outcome.best.size.diameter_m == pytest.approx(2 * np.ceil(need / 2))
    below = outcome.candidates[0]
    assert not below.verified
    assert below.size.diameter_m < outcome.continuous_diameter_m


def test_size_at_the_continuous_optimum_is_used_fully(fast_robot, workspace) -> None:
    grade = rope("a", [10.0, 40.0])
    optimum = 1e3 * try_grade(fast_robot, workspace, grade, 2.0).continuous_diameter_m
    outcome = try_grade(fast_robot, workspace, rope("b", [optimum * 0.999, optimum * 1.0001]), 2.0)
    assert [c.verified for c in outcome.candidates] == [False, True]
    assert outcome.candidates[1].verification.utilisation == pytest.approx(1.0, abs=1e-3)


def test_verification_holds_at_the_worst_pose_found_by_other_means(fast_robot, workspace) -> None:
    grade = rope("a", [24.0])
    cable = grade.cable(grade.sizes[0], 2.0)
    result = verify(fast_robot, workspace, cable)
    at_worst = solve_sagging(fast_robot, Poses.at(result.worst_position_m), cable)
    assert at_worst.largest_tension_N == pytest.approx(result.max_tension_N, rel=1e-9)
    rng = np.random.default_rng(9)
    low, high = workspace.region.bounds_m
    others = rng.uniform(low, high, (20_000, 3))
    others = others[workspace.region.contains(others)]
    tension = solve_sagging(fast_robot, Poses.at(others), cable).largest_tension_N
    assert np.nanmax(tension) <= result.max_tension_N
    assert result.longest_m.max() < 600


def test_a_weak_size_is_passed_over(fast_robot, workspace) -> None:
    sizes = [12.0, 14.0, 16.0, 18.0, 20.0, 22.0, 24.0]
    sound = try_grade(fast_robot, workspace, rope("a", sizes), 2.0)
    assert sound.best is not None
    first = 1e3 * sound.best.size.diameter_m
    weak = try_grade(fast_robot, workspace, rope("b", sizes, {first: 0.6}), 2.0)
    assert weak.best is not None
    assert 1e3 * weak.best.size.diameter_m > first


def test_a_strong_size_below_the_snap_is_found(fast_robot, workspace) -> None:
    sizes = [12.0, 14.0, 16.0, 18.0, 20.0, 22.0, 24.0]
    sound = try_grade(fast_robot, workspace, rope("a", sizes), 2.0)
    assert sound.best is not None
    below = 1e3 * sound.best.size.diameter_m - 2
    strong = try_grade(fast_robot, workspace, rope("b", sizes, {below: 1.5}), 2.0)
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


def test_grade_that_ends_too_thin_names_what_goes_on(fast_robot, workspace) -> None:
    thin, thick = rope("thin", [4.0, 8.0, 12.0]), rope("thick", [20.0, 24.0, 28.0])
    found = select(fast_robot, workspace, Selection(("thin",), 2.0), [thin, thick])
    assert found.chosen is None
    assert found.outcomes[0].outcome == "too_thin"
    assert found.candidates[0].size.id == "12 mm"
    assert found.candidates[0].verification.utilisation > 1.0
    assert "12 mm" in (found.reason or "")
    assert [outcome.grade.id for outcome in found.alternatives] == ["thick"]


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
