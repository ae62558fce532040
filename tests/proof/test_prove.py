"""A bound that holds in all poses: proved where it is true, refused where it is not."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from twins.thinnest import thinnest

from designer.arrays import frozen_array
from designer.model.cable import Cable, Material
from designer.model.region import PointList, Prism, Rectangle
from designer.model.robot import Platform, Poses, Robot
from designer.model.space import Orientations, Space
from designer.proof.encloser import Encloser, covers_of
from designer.proof.prove import Budget, _BranchAndBound, prove
from designer.proof.servable import servable
from designer.statics.inverse import solve_sagging

LEVEL = Orientations()
PAPER_M = 0.05123027498765374
"""Diameter that the paper's robot needs in the region of the shipped study."""

pytestmark = pytest.mark.slow  # compiling alone takes half a minute


def _paper_space(robot: Robot) -> Space:
    return Space(Prism.over(robot.exit_points_m, 10.35, (-200.0, -40.0)), LEVEL)


def _used(robot: Robot, cable: Cable, places: np.ndarray) -> np.ndarray:
    statics = solve_sagging(robot, Poses.at(places), cable)
    assert statics.is_solved.all()
    return statics.largest_tension_N / cable.allowable_tension_N


def test_the_paper_robot_is_proved(fast_robot: Robot, steel: Material) -> None:
    space, cable = _paper_space(fast_robot), steel.cable(PAPER_M)
    proof = prove(fast_robot, cable, space, 0.99, Budget(boxes=20_000), enough=1.001)
    assert proof.status == "proved"
    assert proof.worst is not None  # 0.99 was too low
    assert 1.0 - 1e-4 < proof.found < 1.0 + 1e-6
    assert proof.found <= proof.bound <= proof.found * 1.001
    assert proof.fraction == 1.0
    points = space.region.inside_m(np.random.default_rng(0), 10_000)
    assert _used(fast_robot, cable, points).max() <= proof.bound


def test_a_bound_that_is_too_low_is_not_proved(fast_robot: Robot, steel: Material) -> None:
    space, cable = _paper_space(fast_robot), steel.cable(PAPER_M)
    proof = prove(fast_robot, cable, space, 0.9, Budget(boxes=20_000), enough=0.999)
    assert proof.status == "refuted"
    assert proof.found > 0.999
    blind = _BranchAndBound(fast_robot, cable, covers_of(space), 0.998, 1e-3, 0.999)
    blind._try = lambda *_: None  # type: ignore[method-assign]
    while blind.is_open and blind.boxes < 6000:
        blind.step(blind.batch)
    left = blind.result()
    assert left.status == "partial"
    assert left.bound > 1.0
    assert left.fraction < 1.0


def test_a_rope_that_fails_is_refuted(fast_robot: Robot, steel: Material) -> None:
    thin = steel.cable(PAPER_M * 0.98)
    proof = prove(fast_robot, thin, _paper_space(fast_robot), 0.9, Budget(boxes=30_000))
    assert proof.status == "refuted"
    assert proof.worst is not None
    assert _used(fast_robot, thin, proof.worst[None])[0] == pytest.approx(proof.found)


def test_the_twin_needs_no_thicker_cable_anywhere(fast_robot: Robot, steel: Material) -> None:
    points = _paper_space(fast_robot).region.inside_m(np.random.default_rng(2), 4)
    rng = np.random.default_rng(3)
    for point in [*points, np.array([243.48458762, 10.35, -40.0])]:
        found = thinnest(fast_robot, point, np.zeros(3), steel, rng, starts=3)
        assert found.diameter_m <= PAPER_M * 1.001


def _random_square(rng: np.random.Generator) -> tuple[Robot, Space]:
    """Six cables from three masts or so to a platform, in a box below, in two orientations."""
    angle = np.radians([0, 0, 120, 120, 240, 240]) + rng.normal(0.0, 0.1, 6)
    exits = np.column_stack([20 * np.cos(angle), 20 * np.sin(angle), rng.uniform(9, 11, 6)])
    angle = np.radians([60, -60, 180, 60, 300, 180]) + rng.normal(0.0, 0.1, 6)
    ends = np.column_stack([2 * np.cos(angle), 2 * np.sin(angle), rng.uniform(-0.2, 0.2, 6)])
    robot = Robot(frozen_array(exits), Platform(2000.0, frozen_array(ends)))
    low = rng.uniform([-3, -3, 0], [-1, -1, 2])
    sides = [(float(a), float(a + s)) for a, s in zip(low, rng.uniform(0.5, 2.0, 3), strict=True)]
    turns = np.vstack([np.zeros(3), rng.normal(0.0, 0.05, 3)])
    return robot, Space(Prism.box(*sides), Orientations(turns))


@pytest.mark.parametrize("seed", range(2))
def test_random_platforms_stay_below_their_bound(seed: int) -> None:
    rng = np.random.default_rng(seed)
    robot, space = _random_square(rng)
    cable = Cable(0.02, 1.5, 2e7, 1e6)
    places = space.places(space.region.inside_m(rng, 300))
    used = _used(robot, cable, places)
    proof = prove(
        robot, cable, space, float(used.max()), Budget(boxes=4000), within=0.02, enough=np.inf
    )
    assert proof.status == "proved"
    assert used.max() <= proof.found <= proof.bound <= 1.02 * proof.found
    assert _used(robot, cable, space.places(space.region.inside_m(rng, 500))).max() <= proof.bound


def test_a_range_of_turns_stays_below_its_bound() -> None:
    rng = np.random.default_rng(9)
    robot, _ = _random_square(rng)
    turns = Orientations.within([-0.01, 0.02, -0.02], [0.02, 0.03, 0.02])
    space = Space(Prism.box((0.0, 0.2), (-0.1, 0.1), (0.0, 0.3)), turns)
    places = np.hstack([space.region.inside_m(rng, 300), rng.uniform(*turns.range_rad, (300, 3))])
    cable = Cable(0.02, 1.5, 2e7, 1e6)
    used = _used(robot, cable, places)
    proof = prove(
        robot, cable, space, float(used.max()), Budget(boxes=3000), within=0.05, enough=np.inf
    )
    assert proof.status == "proved"
    assert used.max() <= proof.found <= proof.bound <= 1.05 * proof.found


@pytest.mark.parametrize(("least_N", "sag_max"), [(0.0, 0.2), (200.0, 0.5), (0.0, 0.05)])
def test_a_redundant_robot_stays_below_its_bound(least_N: float, sag_max: float) -> None:
    exits = frozen_array([[0, 0, 0], [100, 0, 0], [100, 80, 0], [0, 80, 0]])
    robot = Robot(exits, Platform(1000.0), tension_min_N=least_N, sag_max=sag_max)
    space = Space(Prism.box((30.0, 70.0), (20.0, 60.0), (-40.0, -20.0)), LEVEL)
    cable = Cable(0.01, 0.4, 6e6, 12_000.0)
    points = space.region.inside_m(np.random.default_rng(1), 1000)
    used = _used(robot, cable, points)
    proof = prove(
        robot, cable, space, float(used.max()), Budget(boxes=6000), within=0.02, enough=np.inf
    )
    assert proof.status == "proved"
    assert used.max() <= proof.found <= proof.bound <= 1.02 * proof.found


def test_a_list_of_points_is_proved_point_by_point(fast_robot: Robot, steel: Material) -> None:
    points = _paper_space(fast_robot).region.inside_m(np.random.default_rng(3), 50)
    cable = steel.cable(1.2 * PAPER_M)
    used = _used(fast_robot, cable, points)
    space = Space(PointList(points), LEVEL)
    proof = prove(fast_robot, cable, space, float(used.max()), Budget(boxes=200))
    assert proof.status == "proved"
    assert proof.bound == pytest.approx(used.max(), rel=1e-6)
    assert proof.boxes == 50


def test_what_the_budget_leaves_is_said(fast_robot: Robot, steel: Material) -> None:
    cable, space, budget = steel.cable(PAPER_M), _paper_space(fast_robot), Budget(boxes=2000)
    told: list[float] = []
    proof = prove(fast_robot, cable, space, 1.0, budget, enough=1.001, progress=told.append)
    assert proof.status == "partial"
    assert told == sorted(told)
    assert told[-1] == 1.0 > told[0]  # of the budget, of which the last of the volume takes most
    assert 0.0 < proof.fraction < 1.0
    assert proof.boxes == 2000
    assert proof.reason == "2000 boxes ended it before all was decided"


def test_pulleys_are_told_not_to_be_proved(fast_robot: Robot, steel: Material) -> None:
    robot = replace(fast_robot, pulley_radius_m=0.5)
    proof = prove(robot, steel.cable(0.06), _paper_space(robot), 0.9, Budget(boxes=10))
    assert proof.status == "off"
    assert "pulleys" in proof.reason


def test_volumes_that_no_rope_serves_are_bounded_from_both_sides(fast_robot: Robot) -> None:
    """Below the exit points, exactly the prism inside their outline can be served."""
    region = Prism.box((0.0, 500.0), (0.0, 433.01), (-200.0, -100.0))
    found = servable(fast_robot, Space(region, LEVEL), Budget(boxes=400))
    assert found is not None
    assert found.impossible <= 0.5 <= 1.0 - found.possible
    assert found.impossible > 0.3
    assert found.possible > 0.25
    x, y, _ = found.border_m.reshape(-1, 3).T
    steep = np.sqrt(0.75)
    inward_m = np.minimum(steep * x, steep * (500.0 - x)) - 0.5 * y
    assert len(inward_m) > 300
    assert -60.0 < inward_m.min() <= inward_m.max() < 1e-2  # outside the outline, and near


def test_the_budget_of_volumes_begins_when_all_is_compiled(
    fast_robot: Robot, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The first box takes as long as compiling does, longer than the budget."""
    region = Prism.box((0.0, 500.0), (0.0, 433.01), (-200.0, -100.0))
    bound, passed_s = Encloser.bound, [0.0]

    def slow_at_first(*arguments: object) -> object:
        passed_s[0] += 0.01 if passed_s[0] else 60.0
        return bound(*arguments)

    monkeypatch.setattr(Encloser, "bound", slow_at_first)
    monkeypatch.setattr("designer.proof.prove.time.monotonic", lambda: passed_s[0])
    found = servable(fast_robot, Space(region, LEVEL), Budget(boxes=400, seconds=20.0))
    assert found is not None
    assert found.boxes == 400


def test_a_planar_platform_on_three_cables_is_no_point_mass() -> None:
    exits = frozen_array([[-10, 0, 10], [10, 0, 10], [10, 0, 10.5]])
    ends = frozen_array([[-1, 0, 0], [1, 0, 0], [0.8, 0, 0.6]])
    robot = Robot(exits, Platform(500.0, ends), is_planar=True)
    space = Space(Rectangle(np.array([[-1.0, 0.0], [1.0, 0.0]]), (1.0, 3.0)), LEVEL)
    cable = Cable(0.01, 0.4, 6e6, 30_000.0)
    statics = solve_sagging(robot, Poses.at([[0.0, 0.0, 2.0], [0.5, 0.0, 1.5]]), cable)
    proof = prove(robot, cable, space, 0.1, Budget(boxes=500), within=0.05, enough=np.inf)
    used = statics.largest_tension_N[statics.is_solved] / cable.allowable_tension_N
    assert proof.status in ("proved", "partial")
    assert (used <= proof.bound).all()
