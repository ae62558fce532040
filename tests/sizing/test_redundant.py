"""The thinnest cable of redundant robots: optimality, verdicts, and the fixed cable's choice."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from redundant_robots import (
    FOUR,
    SEVEN,
    anywhere,
    cogiro_poses,
    four_poses,
    one,
    seven_poses,
    steel,
)
from sample_robots import COGIRO

from designer.arrays import frozen_array
from designer.model.cable import Cable, Cables, Material
from designer.model.robot import Platform, Poses, Robot
from designer.model.verdict import Verdict
from designer.physics import catenary
from designer.sizing import scp
from designer.sizing.loop import size_by_loop
from designer.sizing.newton import Sizing, limit_ratio, size_poses
from designer.sizing.nlp import size_by_nlp
from designer.sizing.scp import _Problem, size_by_scp
from designer.statics.geometry import cable_geometry, load_wrench_N, structure_matrix
from designer.statics.inverse import distribute_evenly, sag_ratio, solve_sagging

WEIGHTS = (1.0, 30.0, 60.0)
CASES = {
    "cogiro": (COGIRO, cogiro_poses(6, 1)),
    "cogiro, taut": (replace(COGIRO, tension_min_N=40.0), cogiro_poses(4, 2)),
    "four": (FOUR, four_poses(6)),
    "four, taut": (replace(FOUR, tension_min_N=300.0), four_poses(4)),
    "seven": (SEVEN, seven_poses(4)),
}


def optimality_of(robot, pose, material, diameter_m: float, force_x_N) -> tuple[float, float]:
    """Residuals of feasibility and optimality of an answer, as in `ScpSizing`, whoever found it."""
    problem = _Problem.of(robot, pose, material)
    allowable = material.cable(diameter_m).weight_N_per_m * material.strength_length_m
    c = problem.load_N / allowable
    y = force_x_N * problem.chord_m / (problem.distance_m * allowable)
    state = problem.state(y)
    return problem.violation(state, c), problem.gap(state, y, c)


@pytest.mark.slow
@pytest.mark.parametrize("weights", WEIGHTS)
def test_random_poses_are_solved_and_optimal(weights, monkeypatch) -> None:
    """The conditions are written down and evaluated by other code than the kernel's.

    The kernel's barrier leaves pulls at the largest sag up to 3e-5 above it.
    """
    monkeypatch.setattr(scp, "_AT_BOUND", 1e-4)
    poses, material = cogiro_poses(300, 5), steel(weights)
    sizing = size_poses(COGIRO, poses, material)
    assert np.all(sizing.statics.verdict == Verdict.SOLVED)
    for k in range(300):
        found = sizing.diameter_m[k], sizing.statics.force_x_N[k]
        feasibility, optimality = optimality_of(COGIRO, one(poses, k), material, *found)
        assert feasibility < 1e-8
        assert optimality < 1e-6


@pytest.mark.slow
@pytest.mark.parametrize("weights", [1.0, 8.0])
@pytest.mark.parametrize("case", CASES)
def test_sizing_is_that_of_the_convex_programmes(case, weights) -> None:
    robot, poses = CASES[case]
    sizing = size_poses(robot, poses, steel(weights))
    solved = np.nonzero(sizing.statics.is_solved)[0]
    assert len(solved) > 0
    at_largest_sag = sag_ratio(sizing.statics).max(axis=-1) > 0.9999 * robot.sag_max
    for k in solved:
        reference = size_by_scp(robot, one(poses, k), steel(weights))
        assert reference.has_converged
        # The kernel's barrier leaves pulls at the largest sag up to 3e-5 above it.
        close = 2e-6 if at_largest_sag[k] else 1e-8
        assert sizing.diameter_m[k] == pytest.approx(reference.diameter_m, rel=close)
        assert sizing.statics.length_m[k] == pytest.approx(reference.length_m, rel=1e-4)


def test_sizing_is_that_of_slsqp_on_the_papers_equations() -> None:
    poses = cogiro_poses(4, 7)
    for weights in (1.0, 60.0):
        sizing = size_poses(COGIRO, poses, steel(weights))
        # The paper's equations know no largest sag.
        free = np.flatnonzero(sag_ratio(sizing.statics).max(axis=-1) < 0.99 * COGIRO.sag_max)
        assert len(free) >= 2
        for k in free:
            nlp = size_by_nlp(COGIRO, one(poses, k), steel(weights))
            assert nlp.has_converged
            assert sizing.diameter_m[k] == pytest.approx(nlp.diameter_m, rel=1e-8)
    with pytest.raises(ValueError, match="no least tension"):
        size_by_nlp(SEVEN, one(seven_poses(1), 0), steel())


class InternalForces:
    """One pose with a given cable: all pulls that balance it, from the pulls of two cables."""

    def __init__(self, robot: Robot, pose: Poses, cable: Cable | Cables) -> None:
        geometry = cable_geometry(robot, pose)
        self.X, self.D = geometry.horizontal_distance_m, geometry.drop_m
        self.matrix = structure_matrix(robot, geometry)
        self.load = load_wrench_N(robot, pose)
        self.cable, self.sag_max = cable, robot.sag_max
        columns = self.matrix[:, 0::2] * self.X - self.matrix[:, 1::2] * self.D
        pairs = [(a, b) for a in range(8) for b in range(a)]
        quality = [np.linalg.cond(np.delete(columns, pair, axis=1)) for pair in pairs]
        self.chosen = list(pairs[int(np.argmin(quality))])
        self.rest = [i for i in range(8) if i not in self.chosen]

    def forces(self, pull_N: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Wrench that is left, and largest tension over allowable, of pulls (..., 8) [N/m].

        Infinite where a cable sags by more than it may.
        """
        EA, w = self.cable.axial_stiffness_N, self.cable.weight_N_per_m
        length, force_z = catenary.length_and_force_z(pull_N, self.X, self.D, EA, w)
        force_x = pull_N * self.X
        ends = catenary.end_tensions_N(length, force_x, force_z, w)
        pairs = np.stack([force_x, force_z], axis=-1).reshape(*pull_N.shape[:-1], 16)
        largest = (np.maximum(*ends) / self.cable.allowable_tension_N).max(axis=-1)
        sag = catenary.sag_m(length, force_x, force_z, EA, w, self.X, self.D)
        is_taut = (sag <= self.sag_max * np.hypot(self.X, self.D) * (1.0 + 1e-9)).all(axis=-1)
        largest = np.where(is_taut, largest, np.inf)
        return pairs @ self.matrix.T - self.load, largest

    def best(self, internal_N: np.ndarray, start_N: np.ndarray) -> np.ndarray:
        """Largest tension over allowable at pulls (n, 2) of the chosen; inf where none balance."""
        pull = np.broadcast_to(start_N, (len(internal_N), 8)).copy()
        pull[:, self.chosen] = internal_N
        for _ in range(12):
            left, ratio = self.forces(pull)
            slope = np.empty((len(pull), 6, 6))
            for column, i in enumerate(self.rest):
                ahead = pull.copy()
                ahead[:, i] *= 1.0 + 1e-6
                slope[:, :, column] = (self.forces(ahead)[0] - left) / (1e-6 * pull[:, i])[:, None]
            step = np.linalg.solve(slope, left[..., None])[..., 0]
            moved = pull[:, self.rest] - step
            pull[:, self.rest] = np.clip(moved, 0.2 * pull[:, self.rest], 5 * pull[:, self.rest])
        balanced = np.abs(left).max(axis=1) < 1e-6 * np.abs(self.load).max()
        return np.where(balanced, ratio, np.inf)


@pytest.mark.slow
@pytest.mark.parametrize("weights", WEIGHTS)
def test_brute_force_over_internal_forces_finds_nothing_thinner(weights) -> None:
    """With the sized cable no internal forces stay below the strength; the found ones reach it."""
    poses, material = cogiro_poses(7, 11), steel(weights)
    sizing = size_poses(COGIRO, poses, material)
    for k in range(7):
        cable = material.cable(float(sizing.diameter_m[k]))
        problem = InternalForces(COGIRO, one(poses, k), cable)
        found = sizing.statics.force_x_N[k] / problem.X
        centre = found[problem.chosen]
        assert problem.best(centre[None], found)[0] == pytest.approx(1.0, abs=1e-7)
        width = 1.0
        for _ in range(5):  # a grid over all there is, then ever finer ones around the best
            share = np.exp(np.linspace(-3.0 * width, 1.2 * width, 15))
            grid = np.stack(np.meshgrid(*(c * share for c in centre)), axis=-1).reshape(-1, 2)
            ratio = problem.best(grid, found)
            assert ratio.min() > 1.0 - 1e-7
            centre, width = grid[np.argmin(ratio)], 0.2 * width
        assert ratio.min() < 1.01  # the search has come back to where the optimum is


def size_of(poses: Poses, weights: float) -> Sizing:
    return size_poses(COGIRO, poses, Material(7800.0 * weights, 100e9, 180e6))


def test_the_sagging_optimum_meets_the_massless_one_at_first_order() -> None:
    poses = cogiro_poses(200, 3)
    massless = distribute_evenly(COGIRO, poses).max(axis=-1)
    excess = []
    for weights in (1e-3, 5e-4, 2.5e-4):
        section = size_of(poses, weights).diameter_m ** 2
        excess.append(section / Material(1.0, 1.0, 180e6).diameter_for_tension_m(1.0) ** 2)
    excess = [tension / massless - 1.0 for tension in excess]
    assert np.all(np.abs(excess[0]) < 1e-4)
    ratio = np.abs(excess[0]).sum() / np.abs(excess[1]).sum()
    assert ratio == pytest.approx(2.0, rel=0.01)
    assert np.abs(excess[1]).sum() / np.abs(excess[2]).sum() == pytest.approx(2.0, rel=0.01)


@pytest.mark.slow
@pytest.mark.parametrize("weights", WEIGHTS)
def test_no_pose_is_solved_with_a_residual(weights) -> None:
    """Poses anywhere, with closure and balance by the paper's own equations."""
    poses = anywhere(3000, 4)
    sizing = size_poses(COGIRO, poses, steel(weights))
    fixed = solve_sagging(COGIRO, poses, steel(weights).cable(0.004))
    for statics in (sizing.statics, fixed):
        solved = statics.is_solved
        assert 0.1 < solved.mean() < 0.9
        closure = statics.closure_residual_m()[solved] / statics.length_m[solved]
        balance = np.abs(statics.equilibrium_residual_N()[solved]).max(axis=1)
        assert closure.max() < 1e-8
        assert (balance / statics.largest_tension_N[solved]).max() < 1e-8
        assert np.isnan(statics.length_m[~solved]).all()
        # There is not always a proof that no section will do, least of all with heavy cables.
        unproved = 1e-3
        assert (statics.verdict == Verdict.NOT_CONVERGED).mean() < unproved
    allowable = steel(weights).allowable_stress_Pa * np.pi / 4 * sizing.diameter_m**2
    use = (sizing.statics.largest_tension_N / allowable)[sizing.statics.is_solved]
    assert use.max() < 1.0 + 1e-8


@pytest.mark.slow
def test_verdicts_beyond_what_any_section_holds() -> None:
    poses = cogiro_poses(300, 6)
    heavy = steel(100.0)
    sizing, ratio = size_poses(COGIRO, poses, heavy), limit_ratio(COGIRO, poses, heavy)
    unheld = {Verdict.NO_FINITE_CABLE, Verdict.NOT_CONVERGED}
    assert set(sizing.statics.verdict) <= {Verdict.SOLVED, *unheld}
    exists = ~np.isnan(ratio)  # without a load to pull them, some poses' cables cannot be taut
    assert 0.9 < exists.mean() < 1.0
    assert np.array_equal(sizing.statics.is_solved[exists], ratio[exists] < 1.0)
    assert set(size_poses(COGIRO, poses, steel(300.0)).statics.verdict) <= unheld
    above = Poses.at([[0.0, 0.0, 9.0], [20.0, 0.0, 2.0]])
    assert list(size_poses(COGIRO, above, steel()).statics.verdict) == [Verdict.OUTSIDE_HULL] * 2


def test_dependent_cables_are_told() -> None:
    robot = Robot(frozen_array([[0, 0, 0], [10, 0, 0], [4, 0, 0], [7, 0, 0]]), Platform(100.0))
    pose = Poses.at([[5.0, 0.0, -3.0]])
    assert size_poses(robot, pose, steel()).statics.verdict == [Verdict.RANK_DEFICIENT]
    statics = solve_sagging(robot, pose, steel().cable(0.01))
    assert statics.verdict == [Verdict.RANK_DEFICIENT]
    assert np.isnan(statics.length_m).all()


def test_fewer_cables_than_degrees_of_freedom_are_refused() -> None:
    robot = Robot(COGIRO.exit_points_m[:2], Platform(100.0))
    with pytest.raises(ValueError, match="2 cables cannot hold 3 degrees"):
        size_poses(robot, four_poses(1), steel())


@pytest.mark.parametrize("weights", WEIGHTS)
def test_a_given_cable_is_pulled_as_evenly_as_can_be(weights) -> None:
    """A thinner cable than the given one, but with its allowable tension, is sized to it."""
    poses, material = cogiro_poses(50, 8), steel(weights)
    sizing = size_poses(COGIRO, poses, material)
    for k in range(50):
        cable = material.cable(float(sizing.diameter_m[k]))
        statics = solve_sagging(COGIRO, one(poses, k), cable)
        assert statics.largest_tension_N == pytest.approx(cable.allowable_tension_N, rel=1e-8)
        thicker = material.cable(1.2 * float(sizing.diameter_m[k]))
        use = solve_sagging(COGIRO, one(poses, k), thicker).largest_tension_N
        assert use < thicker.allowable_tension_N


MIXED = Cables(tuple(steel(10.0).cable(0.004 if i % 2 else 0.006) for i in range(8)))


@pytest.mark.slow
@pytest.mark.parametrize("cable", [steel(30.0).cable(0.004), MIXED], ids=["one", "mixed"])
def test_a_given_cables_utilisation_cannot_be_lowered(cable) -> None:
    poses = cogiro_poses(4, 12)
    statics = solve_sagging(COGIRO, poses, cable)
    assert statics.is_solved.all()
    use = statics.cable_tension_N / cable.allowable_tension_N
    for k in range(4):
        problem = InternalForces(COGIRO, one(poses, k), cable)
        found = statics.force_x_N[k] / problem.X
        least = use[k].max()
        share = np.exp(np.linspace(-1.5, 0.8, 25))
        centre = found[problem.chosen]
        grid = np.stack(np.meshgrid(*(c * share for c in centre)), axis=-1).reshape(-1, 2)
        assert problem.best(grid, found).min() > least * (1.0 - 1e-7)


@pytest.mark.parametrize("case", ["cogiro, taut", "four, taut", "seven"])
def test_no_cable_falls_below_the_least_tension(case) -> None:
    robot, poses = CASES[case]
    slack = replace(robot, tension_min_N=0.0)
    for material in (steel(), steel(8.0)):
        sizing = size_poses(robot, poses, material)
        for statics in (sizing.statics, solve_sagging(robot, poses, material.cable(0.01))):
            solved = statics.is_solved
            assert solved.any()
            tension = tension_along_N(statics)[solved]
            assert tension.min() >= robot.tension_min_N * (1.0 - 1e-9)
        free = size_poses(slack, poses, material)
        both = sizing.statics.is_solved & free.statics.is_solved
        assert np.all(sizing.diameter_m[both] >= free.diameter_m[both] * (1.0 - 1e-9))


def tension_along_N(statics):
    """Integrate down each cable from its upper end: the load changes by its weight alone."""
    weight = statics.weight_N_per_m[..., None]
    s = np.linspace(0.0, 1.0, 20_001) * statics.length_m[..., None]
    upward = statics.force_z_N[..., None] - weight * s
    return np.hypot(statics.force_x_N[..., None], upward)


def test_pulleys_tilt_and_wrench_are_in_the_balance() -> None:
    wrench = frozen_array([30.0, -20.0, -100.0, 5.0, -8.0, 3.0])
    robot = replace(
        COGIRO,
        platform=replace(COGIRO.platform, wrench_N=wrench),
        pulley_radius_m=0.1,
        tilt_rad=frozen_array([0.02, -0.03]),
    )
    poses = cogiro_poses(60, 10)
    for weights in (1.0, 60.0):
        sizing = size_poses(robot, poses, steel(weights))
        statics = sizing.statics
        assert statics.is_solved.all()
        balance = np.abs(statics.equilibrium_residual_N()).max(axis=1)
        assert (balance / statics.largest_tension_N).max() < 1e-8
        plain = size_poses(COGIRO, poses, steel(weights)).diameter_m
        assert np.all(np.abs(sizing.diameter_m / plain - 1.0) > 1e-4)


FACADE = Robot(
    frozen_array([[0, 0, 20], [30, 0, 20], [0, 0, 0], [30, 0, 0]]),
    Platform(200.0, frozen_array([[-1, 0, 1], [1, 0, 1], [-1, 0, -1], [1, 0, -1]])),
    tension_min_N=200.0,
    is_planar=True,
)


@pytest.mark.parametrize("is_body", [True, False])
def test_robots_in_a_plane(is_body) -> None:
    robot = FACADE if is_body else replace(FACADE, platform=Platform(200.0))
    assert robot.degrees_of_freedom == (3 if is_body else 2)
    poses = Poses.at([[12.0, 0.0, 9.0], [20.0, 0.0, 12.0], [15.0, 0.0, 5.0]])
    for weights in (1.0, 10.0):
        sizing = size_poses(robot, poses, steel(weights))
        assert sizing.statics.is_solved.all()
        balance = np.abs(sizing.statics.equilibrium_residual_N()).max(axis=1)
        assert (balance / sizing.statics.largest_tension_N).max() < 1e-8
        for k in range(3):
            reference = size_by_scp(robot, one(poses, k), steel(weights))
            assert reference.has_converged
            assert sizing.diameter_m[k] == pytest.approx(reference.diameter_m, rel=1e-8)


@pytest.mark.parametrize("weights", [1.0, 10.0])
def test_a_least_tension_is_kept_and_where_it_governs_no_more(weights) -> None:
    """It governs light cables; heavy ones are pulled harder, by what their own weight asks for."""
    poses = Poses.at([[12.0, 0.0, 9.0], [20.0, 0.0, 12.0], [15.0, 0.0, 5.0]])
    sizing = size_poses(FACADE, poses, steel(weights))
    for statics in (sizing.statics, solve_sagging(FACADE, poses, steel(weights).cable(0.02))):
        least = tension_along_N(statics).min(axis=(-2, -1))
        assert least.min() > FACADE.tension_min_N * (1.0 - 1e-9)
        if weights == 1.0:
            at_sag = sag_ratio(statics).max(axis=-1) > 0.999 * FACADE.sag_max
            assert at_sag.sum() <= 1
            assert (least[~at_sag] < FACADE.tension_min_N * (1.0 + 1e-9)).all()
        # The lowest point of a heavy cable lies between those where its tension was taken.
        between = 1e-9 if weights == 1.0 else 1e-6
        assert statics.least_tension_N.min(axis=-1) == pytest.approx(least, rel=between)


def test_batch_equals_loop_over_any_leading_axes() -> None:
    flat = cogiro_poses(12, 13)
    shaped = Poses(flat.position_m.reshape(3, 4, 3), flat.rotation.reshape(3, 4, 3, 3))
    sizing = size_poses(COGIRO, shaped, steel(60.0))
    assert sizing.statics.length_m.shape == (3, 4, 8)
    for k in range(12):
        single = size_poses(COGIRO, one(flat, k), steel(60.0))
        assert sizing.diameter_m.ravel()[k] == single.diameter_m
        assert np.array_equal(sizing.statics.length_m.reshape(12, 8)[k], single.statics.length_m)


@pytest.mark.parametrize("weights", [1.0, 30.0])
def test_the_loop_ends_at_the_optimum(weights) -> None:
    poses = cogiro_poses(3, 14)
    sizing = size_poses(COGIRO, poses, steel(weights))
    for k in range(3):
        loop = size_by_loop(COGIRO, one(poses, k), steel(weights), threshold_m=1e-11)
        assert loop.has_converged
        assert loop.iterates[0].max_tension_N == pytest.approx(sizing.massless_tension_N[k])
        assert loop.diameter_m == pytest.approx(float(sizing.diameter_m[k]), rel=1e-7)


def test_the_reference_refuses_what_it_cannot_do() -> None:
    with pytest.raises(ValueError, match="cannot hold"):
        size_by_scp(COGIRO, Poses.at([0.0, 0.0, 9.0]), steel())
    with pytest.raises(ValueError, match="no pulleys"):
        size_by_scp(replace(COGIRO, pulley_radius_m=0.1), one(cogiro_poses(1), 0), steel())


def test_one_turn_is_not_taken_for_an_optimum() -> None:
    early = size_by_scp(COGIRO, one(cogiro_poses(1), 0), steel(60.0), max_turns=1)
    assert not early.has_converged
    assert np.isnan(early.diameter_m)


@pytest.mark.parametrize("away_m", [1e-3, 1e-6, 1e-9])
def test_pose_beside_an_exit_point(away_m: float) -> None:
    """A cable of almost no length closes to its own length, not to that of the others."""
    exits = np.array([[0.0, 0, 30], [40, 0, 32], [18, 35, 29], [30, 30, 33]])
    robot = Robot(exits, Platform(300.0))
    along = np.array([0.3, 0.2, -1.0]) / np.linalg.norm([0.3, 0.2, -1.0])
    for statics in (
        size_poses(robot, Poses.at(exits[:1] + away_m * along), steel()).statics,
        solve_sagging(robot, Poses.at(exits[:1] + away_m * along), steel().cable(0.01)),
    ):
        assert statics.is_solved[0]
        # The short cable lifts nearly all; its tension changes little with its length.
        assert statics.largest_tension_N[0] == pytest.approx(statics.cable_tension_N[0, 0])
        assert 3000.0 < statics.largest_tension_N[0] < 3500.0
        assert np.abs(statics.equilibrium_residual_N()).max() < 1e-6
