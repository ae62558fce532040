"""The paper's robot: published numbers, and three methods that agree."""

from __future__ import annotations

import numpy as np
import pytest

from designer.model.robot import Poses
from designer.model.verdict import Verdict
from designer.sizing.loop import size_by_loop
from designer.sizing.newton import limit_ratio, size_poses
from designer.sizing.nlp import size_by_nlp

POSE = Poses.at([250.0, 200.0, -50.0])

# Along (250, y, -40): y [m], top tension [kN], diameter [mm], massless tension [kN], loop turns.
LINE = [
    (40, 265.779, 43.359, 114.111, 28),
    (20, 306.447, 46.558, 118.818, 33),
    (10, 376.520, 51.608, 121.411, 46),
    (8, 438.994, 55.725, 121.951, 60),
    (6, 711.721, 70.953, 122.498, 123),
]


def test_optimum_of_the_papers_pose(fast_robot, steel) -> None:
    sizing = size_poses(fast_robot, POSE, steel)
    assert 1e3 * sizing.diameter_m == pytest.approx(32.59917, abs=5e-6)
    assert sizing.statics.largest_tension_N == pytest.approx(150_236.49, abs=0.01)
    assert 1e3 * sizing.massless_diameter_m == pytest.approx(24.71948, abs=5e-6)
    assert sizing.massless_tension_N == pytest.approx(86_385.53, abs=0.01)
    statics = sizing.statics
    assert statics.length_m == pytest.approx([324.21623831, 324.21623831, 238.20189774], abs=3e-8)
    assert statics.force_x_N == pytest.approx([116172.937, 116172.937, 145145.317], abs=5e-3)
    assert statics.force_z_N == pytest.approx([-7836.756, -7836.756, -23566.487], abs=5e-3)
    assert statics.exit_tension_N == pytest.approx([119627.982, 119627.982, 150236.491], abs=5e-3)


def test_loop_iterates_of_figures_6_and_7(fast_robot, steel) -> None:
    loop = size_by_loop(fast_robot, POSE, steel)
    tension = [turn.max_tension_N / 1e3 for turn in loop.iterates[:6]]
    diameter = [1e3 * turn.diameter_m for turn in loop.iterates[:6]]
    assert tension == pytest.approx([86.386, 123.082, 138.686, 145.323, 148.146, 149.347], abs=5e-4)
    assert diameter == pytest.approx([24.719, 29.506, 31.321, 32.062, 32.372, 32.503], abs=5e-4)


def test_loop_that_runs_away_is_given_up_and_said_to_diverge(fast_robot, steel) -> None:
    beyond = size_by_loop(fast_robot, Poses.at([250.0, 200.0, -1.0]), steel)
    assert beyond.has_diverged and not beyond.has_converged
    assert "diverges" in beyond.outcome
    turns = [turn.max_tension_N for turn in beyond.iterates]
    assert turns[-2] < 1e4 * turns[0] < turns[-1] < 1e6 * turns[0]
    slow = size_by_loop(fast_robot, Poses.at([250.0, 4.85, -40.0]), steel)
    assert not slow.has_diverged and not slow.has_converged
    assert slow.outcome == f"not settled after {len(slow.iterates) - 1} turns"


@pytest.mark.parametrize(
    "position", [(250, 200, -50), (250, 150, -120), (120, 90, -60), (300, 40, -180), (200, 20, -40)]
)
def test_three_methods_agree(fast_robot, steel, position) -> None:
    pose = Poses.at(np.array(position, dtype=float))
    newton = float(size_poses(fast_robot, pose, steel).diameter_m)
    loop = size_by_loop(fast_robot, pose, steel, threshold_m=1e-13)
    nlp = size_by_nlp(fast_robot, pose, steel)
    assert loop.has_converged
    assert nlp.has_converged
    assert loop.diameter_m == pytest.approx(newton, rel=1e-8)
    assert nlp.diameter_m == pytest.approx(newton, rel=1e-8)


@pytest.mark.parametrize(("y", "tension_kN", "diameter_mm", "massless_kN", "turns"), LINE)
def test_toward_the_edge(fast_robot, steel, y, tension_kN, diameter_mm, massless_kN, turns) -> None:
    pose = Poses.at([250.0, y, -40.0])
    sizing = size_poses(fast_robot, pose, steel)
    assert 1e3 * sizing.diameter_m == pytest.approx(diameter_mm, abs=6e-4)
    assert sizing.statics.largest_tension_N / 1e3 == pytest.approx(tension_kN, abs=6e-4)
    assert sizing.massless_tension_N / 1e3 == pytest.approx(massless_kN, abs=6e-4)
    loop = size_by_loop(fast_robot, pose, steel, threshold_m=1e-9)
    assert len(loop.iterates) - 2 == turns  # neither the start nor the turn that changes nothing


def test_no_finite_cable_is_proved_by_the_infinite_section(fast_robot, steel) -> None:
    y = np.array([5.0, 4.0, 3.0])
    poses = Poses.at(np.stack([250 + 0 * y, y, -40 + 0 * y], axis=1))
    ratio = limit_ratio(fast_robot, poses, steel)
    assert ratio == pytest.approx([0.974, 1.09, 1.29], abs=6e-3)
    sizing = size_poses(fast_robot, poses, steel)
    assert list(sizing.statics.verdict) == [
        Verdict.SOLVED,
        Verdict.NO_FINITE_CABLE,
        Verdict.NO_FINITE_CABLE,
    ]
    assert sizing.statics.largest_tension_N[0] / 1e3 == pytest.approx(2512, abs=1)


def test_loop_crawls_where_the_limit_is_near(fast_robot, steel) -> None:
    loop = size_by_loop(fast_robot, Poses.at([250.0, 5.0, -40.0]), steel, max_turns=150)
    assert not loop.has_converged
    assert np.isnan(loop.diameter_m)
    tensions = [turn.max_tension_N for turn in loop.iterates]
    assert np.all(np.diff(tensions) > 0)


def test_limit_ratio_reaches_one_where_the_cables_end(fast_robot, steel) -> None:
    """Both ways to the verdict agree: stress at infinite section, and c at the stress limit."""
    rng = np.random.default_rng(2)
    x, y = rng.uniform(100, 400, 4000), rng.uniform(2.0, 9.0, 4000)
    poses = Poses.at(np.stack([x, y, rng.uniform(-200, -40, 4000)], axis=1))
    sizing = size_poses(fast_robot, poses, steel)
    finite = sizing.statics.is_solved
    agree = finite == (limit_ratio(fast_robot, poses, steel) < 1.0)
    assert 0.2 < finite.mean() < 0.9
    # Where the slack cable sets the ratio, pulling it up may still help: few, and only one way.
    assert agree.mean() > 0.99
    assert finite[~agree].all()


def test_sizing_of_six_cables_agrees_with_the_nlp(six_cable_robot, steel) -> None:
    rng = np.random.default_rng(7)
    position = np.column_stack([rng.uniform(-25, 25, (12, 2)), rng.uniform(-120, -40, 12)])
    vector = rng.normal(0, 0.02, (12, 3))
    sizing = size_poses(six_cable_robot, Poses.at(position, vector), steel)
    for k in range(12):
        nlp = size_by_nlp(six_cable_robot, Poses.at(position[k], vector[k]), steel)
        assert nlp.has_converged
        assert sizing.diameter_m[k] == pytest.approx(nlp.diameter_m, rel=1e-8)


def test_nlp_refuses_a_pose_outside_the_hull(fast_robot, steel) -> None:
    with pytest.raises(ValueError, match="straight cables"):
        size_by_nlp(fast_robot, Poses.at([-10.0, 0.0, -50.0]), steel)


def test_loop_has_no_iterates_outside_the_hull(fast_robot, steel) -> None:
    loop = size_by_loop(fast_robot, Poses.at([-10.0, 0.0, -50.0]), steel)
    assert loop.iterates == ()
    assert not loop.has_converged


@pytest.mark.slow
def test_every_random_pose_is_solved_or_judged(fast_robot, steel) -> None:
    """The whole uninset prism: no pose without a verdict, no number without its residuals."""
    rng = np.random.default_rng(0)
    position = rng.dirichlet([1, 1, 1], 100_000) @ fast_robot.exit_points_m
    position[:, 2] = rng.uniform(-200, -40, len(position))
    sizing = size_poses(fast_robot, Poses.at(position), steel)
    verdict = sizing.statics.verdict
    assert not np.any(verdict == Verdict.NOT_CONVERGED)
    assert not np.any(verdict == Verdict.OUTSIDE_HULL)
    assert np.mean(verdict == Verdict.NO_FINITE_CABLE) == pytest.approx(0.041, abs=0.002)
    solved = sizing.statics.is_solved
    statics = sizing.statics
    closure = statics.closure_residual_m()[solved] / statics.length_m[solved]
    force = np.abs(statics.equilibrium_residual_N()[solved]).max(axis=1)
    assert closure.max() < 1e-8
    assert (force / statics.largest_tension_N[solved]).max() < 1e-8
    stress = statics.largest_tension_N / (np.pi / 4 * sizing.diameter_m**2)
    assert stress[solved] == pytest.approx(steel.allowable_stress_Pa, rel=1e-8)


@pytest.mark.slow
def test_six_cables_leave_no_pose_undecided(six_cable_robot, steel) -> None:
    rng = np.random.default_rng(3)
    position = np.column_stack([rng.uniform(-60, 60, (20_000, 2)), rng.uniform(-150, -20, 20_000)])
    poses = Poses.at(position, rng.normal(0, 0.08, (20_000, 3)))
    sizing = size_poses(six_cable_robot, poses, steel)
    held = np.isfinite(sizing.massless_tension_N)
    assert 0.5 < held.mean() < 0.95
    assert not np.any(sizing.statics.verdict[held] == Verdict.NOT_CONVERGED)
    # What straight cables cannot hold may still hang, but then one cable hangs below.
    hung = sizing.statics.is_solved & ~held
    assert sizing.statics.hangs_below[hung].all()
