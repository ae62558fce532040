"""Clearances: pieces and triangles in closed form, true curves by an optimiser, bounds, tilt."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from sample_robots import COGIRO, ROPE, poses_under
from scipy.optimize import lsq_linear, minimize
from scipy.spatial.transform import Rotation

from designer.arrays import frozen_array
from designer.kernel.calling import plain
from designer.kernel.distance import nearest_faces, nearest_pieces
from designer.model.cable import Cable
from designer.model.load_case import STATIC, Loaded
from designer.model.region import PointList, Prism
from designer.model.robot import Platform, Poses, Robot
from designer.model.space import Orientations
from designer.model.verdict import State
from designer.model.workspace import Workspace
from designer.physics import catenary
from designer.selection.criteria import CaseLoads, criteria_of, evaluate
from designer.statics.fixed_length import cables_of_length
from designer.statics.inverse import Statics, solve_sagging
from designer.workspace.clearance import (
    PLATFORM,
    Curves,
    cable_margin_m,
    cable_pairs,
    clearance_among_cables,
    clearance_to_platform,
    platform_hull,
    smallest_clearance,
    survey,
)


def segment_distance_m(a, b, c, d):
    """Return distances (n,) of segments ab and cd (n, 3), and the middles; plain for one."""
    first, second = (plain(np.stack(ends, axis=-2).reshape(-1, 2, 3)) for ends in ((a, b), (c, d)))
    distance, middle = np.empty(len(first)), np.empty((len(first), 3))
    nearest_pieces(first, second, distance, middle, np.zeros((len(first), 2), dtype=np.int64))
    return distance.reshape(a.shape[:-1]), middle.reshape(a.shape)


def triangle_distance_m(a, b, corners):
    """Return the distance of one segment from triangles (..., 3, 3), and the nearest place."""
    distance, place = np.empty(1), np.empty((1, 3))
    surface = plain(corners.reshape(-1, 3, 3))
    nearest_faces(plain([[a, b]]), surface, distance, place, np.zeros(1, dtype=np.int64))
    return distance[0], place[0]


def array(*rows: list[float]) -> list[np.ndarray]:
    return [np.array(row, dtype=float) for row in rows]


@pytest.mark.parametrize(
    ("ends", "distance", "middle"),
    [
        (array([-1, 0, 0], [1, 0, 0], [0, -1, 2], [0, 1, 2]), 2.0, [0, 0, 1]),
        (array([-1, 0, 0], [1, 0, 0], [0, 0, -1], [0, 0, 1]), 0.0, [0, 0, 0]),
        (array([0, 0, 0], [1, 0, 0], [3, 0, 0], [4, 0, 0]), 2.0, [2, 0, 0]),
        (array([0, 0, 0], [1, 0, 0], [2, 1, 0], [2, 5, 0]), np.sqrt(2.0), [1.5, 0.5, 0]),
        (array([0, 0, 0], [0, 0, 0], [3, 4, 0], [3, 4, 0]), 5.0, [1.5, 2, 0]),
        (array([0, 0, 0], [0, 0, 0], [-1, 2, 0], [1, 2, 0]), 2.0, [0, 1, 0]),
    ],
)
def test_known_segments(ends: list[np.ndarray], distance: float, middle: list[float]) -> None:
    for order in (ends, [ends[1], ends[0], *ends[2:]], [*ends[2:], *ends[:2]]):
        found, place = segment_distance_m(*order)
        assert found == pytest.approx(distance, abs=1e-12)
        assert np.allclose(place, middle, atol=1e-12)


def test_parallel_segments_side_by_side() -> None:
    a, b, c, d = array([0, 0, 0], [4, 0, 0], [1, 3, 0], [9, 3, 0])
    assert segment_distance_m(a, b, c, d)[0] == pytest.approx(3.0)


def test_segments_against_an_optimiser() -> None:
    rng = np.random.default_rng(1)
    a, b, c, d = rng.normal(size=(4, 200, 3))
    found, _ = segment_distance_m(a, b, c, d)
    for k in range(200):
        matrix = np.stack([b[k] - a[k], c[k] - d[k]], axis=1)
        best = lsq_linear(matrix, c[k] - a[k], (0.0, 1.0), tol=1e-14)
        assert found[k] == pytest.approx(np.sqrt(2.0 * best.cost), abs=1e-7)


CORNERS = np.array([[0.0, 0, 0], [4, 0, 0], [0, 4, 0]])


@pytest.mark.parametrize(
    ("a", "b", "distance"),
    [
        ([1, 1, 2], [1, 1, 5], 2.0),
        ([1, 1, -3], [1, 1, 3], 0.0),
        ([1, 1, 2], [2, 1, 2], 2.0),
        ([-1, 1, 0], [-1, 3, 0], 1.0),
        ([3, 3, 0], [5, 5, 0], np.sqrt(2.0)),
        ([3, 3, -1], [3, 3, 1], np.sqrt(2.0)),
        ([1, 1, 0], [2, 1, 0], 0.0),
        ([1, 1, 3], [1, 1, 3], 3.0),
    ],
)
def test_known_triangles(a: list[float], b: list[float], distance: float) -> None:
    for turn in range(3):
        corners = np.roll(CORNERS, turn, axis=0)
        for ends in ((a, b), (b, a)):
            found, place = triangle_distance_m(*array(*ends), corners)
            assert found == pytest.approx(distance, abs=1e-12)
            assert np.isfinite(place).all()


def test_triangles_against_an_optimiser() -> None:
    rng = np.random.default_rng(2)
    a, b = rng.normal(size=(2, 60, 3))
    corners = rng.normal(size=(60, 3, 3))
    found = [triangle_distance_m(a[k], b[k], corners[k])[0] for k in range(60)]
    crossing = 0
    for k in range(60):
        u, v = corners[k, 1] - corners[k, 0], corners[k, 2] - corners[k, 0]

        def gap(x: np.ndarray, k: int = k, u: np.ndarray = u, v: np.ndarray = v) -> float:
            return float(
                np.sum((a[k] + x[0] * (b[k] - a[k]) - corners[k, 0] - x[1] * u - x[2] * v) ** 2)
            )

        best = minimize(
            gap,
            [0.5, 0.3, 0.3],
            bounds=[(0, 1)] * 3,
            constraints={"type": "ineq", "fun": lambda x: 1.0 - x[1] - x[2]},
            method="SLSQP",
            options={"ftol": 1e-15, "maxiter": 500},
        )
        assert found[k] == pytest.approx(np.sqrt(best.fun), abs=2e-5)
        crossing += found[k] == 0.0
    assert crossing > 0


LIGHT = Cable(0.01, 1e-6, 1e9, 1e6)


def held_at(robot: Robot, poses: Poses, cable: Cable, slack: float) -> Statics:
    """Cables of given slack in given poses, whether or not the platform would stay there."""
    chord = np.linalg.norm(poses.attachment_points_m(robot) - robot.exit_points_m, axis=-1)
    ones = np.ones((*chord.shape[:-1], 1))
    return cables_of_length(
        robot,
        poses,
        chord * (1.0 + slack),
        cable.axial_stiffness_N * ones,
        cable.weight_N_per_m * ones,
    )


def two_cables(height: float) -> Robot:
    """Cable 1 along x at the level of the platform, cable 2 across it, higher by some height."""
    exits = [[-10.0, 0, 0], [-4.0, 8.0, height], [12.0, 0, 0.5]]
    attachments = [[0.0, 0, 0], [-4.0, -8.0, height], [2.0, 0, 0.5]]
    return Robot(frozen_array(exits), Platform(100.0, frozen_array(attachments)))


def test_two_crossing_cables() -> None:
    statics = held_at(two_cables(0.7), Poses.at([[0, 0, 0.0], [0, 0, -0.2]]), LIGHT, -1e-6)
    found = clearance_among_cables(statics)
    assert found.distance_m[0] == pytest.approx(0.7, abs=1e-6)
    assert list(found.pair[0]) == [0, 1]
    assert np.allclose(found.place_m[0], [-4.0, 0.0, 0.35], atol=1e-4)
    assert found.error_m[0] < 1e-6


def test_a_hanging_cable_comes_nearer_than_its_chord() -> None:
    """The crossing cable sags on the one below it by half a metre or so."""
    robot = two_cables(0.7)
    taut = replace_cable(held_at(robot, Poses.at([[0, 0, 0.0]]), LIGHT, -1e-6), robot)
    found = clearance_among_cables(taut)
    s = np.linspace(0.0, taut.length_m[0, 1], 20001)
    x, z = catenary.position_m(
        s,
        taut.length_m[0, 1],
        taut.force_x_N[0, 1],
        taut.force_z_N[0, 1],
        ROPE.axial_stiffness_N,
        ROPE.weight_N_per_m,
    )
    at_crossing = np.interp(8.0, x, z)  # the chord is level and 16 m long
    assert 0.1 < found.distance_m[0] < 0.5
    assert found.distance_m[0] == pytest.approx(0.7 + at_crossing, abs=found.error_m[0] + 1e-4)


def replace_cable(statics: Statics, robot: Robot) -> Statics:
    """The second cable heavy and 0.2 % too long, the others light and taut."""
    heavy = held_at(robot, statics.poses, ROPE, 2e-3)
    second = np.array([False, True, False])
    return replace(
        statics,
        length_m=np.where(second, heavy.length_m, statics.length_m),
        force_x_N=np.where(second, heavy.force_x_N, statics.force_x_N),
        force_z_N=np.where(second, heavy.force_z_N, statics.force_z_N),
        weight_N_per_m=np.where(second, ROPE.weight_N_per_m, LIGHT.weight_N_per_m)[None],
        axial_stiffness_N=np.where(second, ROPE.axial_stiffness_N, LIGHT.axial_stiffness_N)[None],
    )


@pytest.mark.cases_by_default(1)
@pytest.mark.parametrize("slack", [-5e-4, 0.01, 0.3])
def test_true_curves_against_a_finer_and_finer_grid(slack: float) -> None:
    """All pairs of cables of some poses: points on both, closer and closer about the nearest."""
    rng = np.random.default_rng(3)
    poses = Poses.at(rng.uniform([-3, -3, 0], [3, 3, 2], (3, 3)), rng.normal(0, 0.3, (3, 3)))
    statics = held_at(COGIRO, poses, ROPE, slack)
    found = clearance_among_cables(statics)
    curves = Curves.of(statics)
    for pose in range(3):
        pairs = [(8 * pose + i, 8 * pose + j) for i, j in cable_pairs(COGIRO)]
        best = min(nearest_points_m(curves, *pair) for pair in pairs)
        assert found.distance_m[pose] == pytest.approx(best, abs=1e-5)
        assert best >= found.distance_m[pose] - found.error_m[pose] - 1e-9


def nearest_points_m(curves: Curves, first: int, second: int) -> float:
    """Distance of two curves by points alone."""
    ends = np.array([[0.0, 1.0], [0.0, 1.0]])
    for _ in range(8):
        lines = [
            curves.polylines(np.array([which]), low, high, 120)
            for which, (low, high) in zip((first, second), ends[..., None], strict=True)
        ]
        gaps = np.linalg.norm(lines[0].points_m[0][:, None] - lines[1].points_m[0], axis=-1)
        at = np.unravel_index(np.argmin(gaps), gaps.shape)
        for k in (0, 1):
            share = lines[k].share[0]
            ends[k] = share[max(at[k] - 8, 0)], share[min(at[k] + 8, 120)]
    return float(gaps.min())


def test_the_bound_covers_a_coarse_polyline() -> None:
    statics = held_at(COGIRO, Poses.at([[0.5, 0, 1.0]], [[0, 0, 0]]), ROPE, 0.2)
    curves = Curves.of(statics)
    which, zero, one = np.arange(8), np.zeros(8), np.ones(8)
    coarse, fine = (curves.polylines(which, zero, one, n) for n in (6, 600))
    start, end = coarse.points_m[:, :-1, None], coarse.points_m[:, 1:, None]
    parts = np.stack([fine.points_m[:, 100 * k : 100 * k + 101] for k in range(6)], axis=1)
    along = end - start
    share = np.sum((parts - start) * along, axis=-1) / np.sum(along**2, axis=-1)
    foot = start + np.clip(share, 0.0, 1.0)[..., None] * along
    strays = np.linalg.norm(parts - foot, axis=-1).max(axis=-1)
    assert (strays <= coarse.sagitta_m + 1e-12).all()
    assert (coarse.sagitta_m < 3.0 * strays + 1e-9).all()


def test_cables_that_share_an_end_are_not_compared(fast_robot, six_cable_robot) -> None:
    assert not len(cable_pairs(fast_robot))
    pairs = cable_pairs(six_cable_robot).tolist()
    assert [0, 1] not in pairs  # one exit point
    assert [0, 3] not in pairs  # one attachment
    assert [0, 2] in pairs
    statics = solve_sagging(fast_robot, Poses.at([[250.0, 200, -50]]), ROPE)
    assert np.isnan(smallest_clearance(statics).distance_m).all()


BOX = np.array([[x, y, z] for x in (-1.0, 1.0) for y in (-1.0, 1.0) for z in (-0.5, 0.0)])


def boxed(exit_point: list[float]) -> Robot:
    """One cable from the middle of the top of a box, and two that leave it straight up."""
    exits = [exit_point, [-1.0, -1.0, 30.0], [-1.0, 1.0, 30.0]]
    attachments = frozen_array([[0.0, 0, 0], [-1.0, -1.0, 0.0], [-1.0, 1.0, 0.0]])
    return Robot(frozen_array(exits), Platform(100.0, attachments, hull_m=frozen_array(BOX)))


@pytest.mark.cases_by_default(1)
@pytest.mark.parametrize("angle_deg", [3.0, 30.0, 60.0])
def test_a_cable_that_leaves_a_box_at_an_angle(angle_deg: float) -> None:
    slope = np.radians(angle_deg)
    robot = boxed([20.0 * np.cos(slope), 0.0, 20.0 * np.sin(slope)])
    statics = held_at(robot, Poses.at([[0, 0, 0.0]], [[0, 0, 0]]), LIGHT, -1e-6)
    found = clearance_to_platform(statics)
    # A quarter of the diagonal of the box does not count.
    margin = 0.25 * np.sqrt(2.0**2 + 2.0**2 + 0.5**2)
    assert found.distance_m[0] == pytest.approx(margin * np.sin(slope), rel=1e-4)
    assert list(found.pair[0]) == [0, PLATFORM]


def test_a_cable_through_the_box_touches_it() -> None:
    robot = boxed([20.0, 0.0, -3.0])
    statics = held_at(robot, Poses.at([[0, 0, 0.0]], [[0, 0, 0]]), LIGHT, -1e-6)
    assert clearance_to_platform(statics).distance_m[0] == 0.0


def test_an_attachment_inside_the_box_gets_out_of_it_first() -> None:
    robot = boxed([0.0, 0.0, 30.0])
    lowered = replace(
        robot,
        platform=replace(
            robot.platform, attachments_m=frozen_array(robot.attachments_m - [0, 0, 0.2])
        ),
    )
    hull = platform_hull(lowered)
    assert hull is not None
    quarter = 0.25 * np.sqrt(2.0**2 + 2.0**2 + 0.5**2)
    assert np.allclose(cable_margin_m(lowered, hull), quarter + np.array([0.2, 0.0, 0.0]))
    statics = held_at(lowered, Poses.at([[0, 0, 0.0]], [[0, 0, 0]]), LIGHT, -1e-6)
    found = clearance_to_platform(statics)
    # The nearest are the other two, which run up the side of the box for 0.2 m at first.
    assert found.distance_m[0] == pytest.approx(quarter - 0.2, rel=1e-4)
    assert found.pair[0, 0] in (1, 2)


def test_hull_of_the_attachments_flat_and_solid(six_cable_robot) -> None:
    flat, solid = platform_hull(six_cable_robot), platform_hull(COGIRO)
    assert flat is not None and solid is not None
    assert np.allclose(flat.triangles_m[..., 2], 0.0)
    middle = COGIRO.attachments_m.mean(axis=0)
    assert solid.depth_m(middle) > 0.2
    assert flat.depth_m(np.zeros(3)) == 0.0
    assert np.allclose(flat.heights_m(six_cable_robot.attachments_m).max(axis=-1), 0.0, atol=1e-12)
    assert flat.heights_m(np.array([0.0, 0, 2.0])).max() == pytest.approx(2.0)
    line = frozen_array([[0.0, 0, 0], [1.0, 0, 0], [2.0, 0, 0]])
    assert platform_hull(Robot(line, Platform(1.0, line))) is None


@pytest.mark.slow
def test_distance_to_the_hull_against_an_optimiser() -> None:
    """Points of each cable against convex combinations of the attachments."""
    rng = np.random.default_rng(5)
    poses = Poses.at(rng.uniform([-3, -3, 0], [3, 3, 2], (2, 3)), rng.normal(0, 0.3, (2, 3)))
    statics = held_at(COGIRO, poses, ROPE, 0.01)
    found = clearance_to_platform(statics)
    curves = Curves.of(statics)
    hull = platform_hull(COGIRO)
    assert hull is not None
    margin = cable_margin_m(COGIRO, hull)
    for pose in range(2):
        corners = poses.attachment_points_m(COGIRO)[pose]
        best = np.inf
        for cable in range(8):
            which = np.array([8 * pose + cable])
            end = 1.0 - margin[cable] / curves.length_m[which]
            points = curves.polylines(which, 0.9 * end, end, 60).points_m[0]
            best = min(best, *(to_hull(point, corners) for point in points[-25:]))
        assert found.distance_m[pose] == pytest.approx(best, abs=2e-4)


def to_hull(point: np.ndarray, corners: np.ndarray) -> float:
    """Distance of a point from the convex combinations of some corners, by an optimiser."""
    result = minimize(
        lambda share: float(np.sum((share @ corners - point) ** 2)),
        np.full(8, 0.125),
        jac=lambda share: 2.0 * corners @ (share @ corners - point),
        bounds=[(0, 1)] * 8,
        constraints={"type": "eq", "fun": lambda share: share.sum() - 1.0},
        method="SLSQP",
        options={"ftol": 1e-14, "maxiter": 300},
    )
    return float(np.sqrt(result.fun))


def test_batch_equals_loop_and_tilt_and_turns_change_nothing(six_cable_robot) -> None:
    poses = poses_under(six_cable_robot, 12, 6)
    statics = solve_sagging(six_cable_robot, poses, ROPE)
    batch = smallest_clearance(statics)
    assert np.array_equal(np.isnan(batch.distance_m), ~statics.is_solved)
    for k in np.flatnonzero(statics.is_solved):
        one = solve_sagging(six_cable_robot, Poses(poses.position_m[k], poses.rotation[k]), ROPE)
        alone = smallest_clearance(one)
        assert alone.distance_m == pytest.approx(batch.distance_m[k], abs=1e-9)
        assert list(alone.pair) == list(batch.pair[k])
    Q = Rotation.from_rotvec([0.3, -0.2, 0.0]).as_matrix()
    # The same machine, seen from a frame that leans: tilt takes it back upright.
    leaning = replace(
        six_cable_robot,
        exit_points_m=frozen_array(six_cable_robot.exit_points_m @ Q),
        tilt_rad=frozen_array([0.3, -0.2]),
    )
    seen = Poses(poses.position_m @ Q, Q.T @ poses.rotation)
    again = smallest_clearance(solve_sagging(leaning, seen, ROPE))
    good = statics.is_solved
    assert np.allclose(again.distance_m[good], batch.distance_m[good], atol=1e-7)
    assert np.allclose(again.place_m[good] @ Q.T, batch.place_m[good], atol=1e-3)


@pytest.mark.slow
def test_survey_finds_the_worst_pose_and_says_which_pair(six_cable_robot) -> None:
    region = Prism.over(six_cable_robot.exit_points_m, 40.0, (-60.0, -30.0))
    workspace = Workspace(region, samples=60)
    found = survey(six_cable_robot, workspace, ROPE, 0.2)
    assert found.samples > 50
    assert found.among_cables is not None and found.to_platform is not None
    worst = found.worst
    assert worst is not None
    assert worst.distance_m == min(found.among_cables.distance_m, found.to_platform.distance_m)
    assert found.is_violated == (worst.distance_m < 0.2)
    for nearest in (found.among_cables, found.to_platform):
        statics = solve_sagging(six_cable_robot, Poses.at(nearest.place), ROPE)
        again = (
            clearance_to_platform(statics)
            if nearest is found.to_platform
            else clearance_among_cables(statics)
        )
        assert again.distance_m == pytest.approx(nearest.distance_m, abs=1e-9)
        assert region.contains(nearest.place[:3])
    assert found.to_platform.names[1] == "the platform"
    samples = replace(workspace, region=PointList(frozen_array([found.to_platform.place[:3]])))
    listed = survey(six_cable_robot, samples, ROPE, 0.2)
    assert listed.to_platform is not None
    assert listed.to_platform.distance_m == pytest.approx(found.to_platform.distance_m)


def test_survey_of_a_point_mass_has_nothing_to_compare(fast_robot, steel) -> None:
    workspace = Workspace(PointList(frozen_array([[250.0, 200, -50]])))
    found = survey(fast_robot, workspace, steel.cable(0.03), 0.1)
    assert found.worst is None
    assert not found.is_violated
    assert found.samples == 1


CARRYING = replace(
    COGIRO,
    platform=replace(COGIRO.platform, wrench_N=frozen_array([0.0, 0, -2000, 0, 0, 0])),
    sag_max=0.5,  # so that cables may hang down to others
)


@pytest.mark.slow
def test_cables_that_cross_in_a_small_part_of_the_space_are_found() -> None:
    """Fewer than one in a hundred poses have cables 3 and 8 nearer than any others ever come."""
    half_rad = np.array([0.0126, 0.0323, 0.0526])
    turned = Orientations.within(-half_rad, half_rad)
    region = Prism.box((-4.55, -0.74), (-1.32, 1.58), (0.62, 1.24))
    workspace = Workspace(region, seed=893, orientations=turned, clearance_m=0.1)
    cable = Cable(0.00283, 0.0333, 394600.0, 1246.0)
    found = survey(CARRYING, workspace, cable, 0.1).among_cables
    assert found is not None
    assert found.pair == (2, 7)
    assert found.distance_m < 1e-6
    loads = CaseLoads(workspace, (Loaded(STATIC, (CARRYING, cable), CARRYING, cable),))
    asked = [c for c in criteria_of(CARRYING, workspace, None) if c.id == "clearance"]
    (evaluation,) = evaluate([loads], asked)
    assert evaluation.requirement.capacity < 1e-6
    assert evaluation.requirement.state is State.FAILS


@pytest.mark.slow
def test_survey_leaves_out_what_the_study_leaves_out() -> None:
    half_rad = np.array([0.0557, 0.0, 0.0051])
    turned = Orientations.within(-half_rad, half_rad)
    region = Prism.box((-3.42, -1.35), (-0.38, 3.27), (1.1, 2.29))
    cable = Cable(0.0028, 0.0326, 386000.0, 1219.0)
    below, without = (
        survey(CARRYING, Workspace(region, orientations=turned, hangs_below=policy), cable, 0.1)
        for policy in ("include", "exclude")
    )
    assert below.among_cables is not None
    assert without.among_cables is not None
    assert below.among_cables.distance_m < 1e-6  # a cable that hangs below crosses another
    assert without.among_cables.distance_m > 0.2
    at = Poses.at(without.among_cables.place)
    assert not solve_sagging(CARRYING, at, cable).hangs_below
