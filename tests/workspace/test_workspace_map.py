"""Samples, sweep, refinement and store; straight cables, cables that hang far, no poses at all."""

from __future__ import annotations

import itertools
from dataclasses import replace

import numpy as np
import pytest
from report_parts import paragraphs

from designer.analysis.analyse import analyse
from designer.arrays import frozen_array
from designer.cli.tables import summary_rows
from designer.io.config import read_study
from designer.model.cable import Material
from designer.model.region import CHUNK, PointList, Prism
from designer.model.robot import Platform, Poses, Robot
from designer.model.space import Orientations, Space
from designer.model.workspace import Workspace
from designer.report.design.drawings import Drawings
from designer.report.design.report import section
from designer.resources import example_file, example_names
from designer.sizing.newton import size_poses
from designer.statics.inverse import solve_massless, solve_sagging
from designer.statics.task import LONG
from designer.study import Study
from designer.workspace.demand import diameter_demand, is_left_out, massless_demand, rope_demand
from designer.workspace.refine import Pool, Worst, refine, refine_each
from designer.workspace.sweep import (
    HangingCables,
    map_workspace,
    open_sweep,
    survey_hanging,
)

TRIANGLE = [[0, 0, 0], [500, 0, 0], [250, 433.01, 0]]


def paper_workspace(inset: float, **options) -> Workspace:
    return Workspace(Prism.over(TRIANGLE, inset, (-200.0, -40.0)), **options)


def all_positions(workspace: Workspace) -> np.ndarray:
    return np.concatenate(list(workspace.positions_m()))


def worst_of(*search) -> Worst:
    (worst,) = refine(*search)
    return worst


def test_low_discrepancy_samples_are_inside_repeatable_and_even() -> None:
    workspace = paper_workspace(10.35, samples=5000, seed=3)
    positions = all_positions(workspace)
    assert positions.shape == (5000, 3)
    assert workspace.region.contains(positions).all()
    assert np.array_equal(positions, all_positions(workspace))
    assert not np.array_equal(
        positions, all_positions(paper_workspace(10.35, samples=5000, seed=4))
    )
    assert np.mean(positions[:, 2] < -120) == pytest.approx(0.5, abs=0.01)


def test_grid_reaches_the_boundary() -> None:
    positions = all_positions(paper_workspace(0.0, samples=5000, sampling="grid"))
    assert 3000 < len(positions) < 9000
    assert positions[:, 2].min() == -200
    assert positions[:, 2].max() == -40
    assert positions[:, 1].min() == pytest.approx(0.0)


def test_samples_come_in_chunks() -> None:
    workspace = paper_workspace(10.35, samples=CHUNK + 10)
    sizes = [len(chunk) for chunk in workspace.positions_m()]
    assert sum(sizes) == CHUNK + 10
    assert max(sizes) <= CHUNK
    assert workspace.sample_count == CHUNK + 10


def test_point_list_is_taken_whole() -> None:
    points = frozen_array([[0.0, 0, 0], [1, 2, 3]])
    assert np.array_equal(all_positions(Workspace(PointList(points), samples=7)), points)


def test_refine_finds_a_peak_inside_and_a_kink_on_the_boundary() -> None:
    box = Space(Prism.box((0, 10), (0, 10), (0, 10)), Orientations())
    peak = np.array([3.21, 7.654, 5.5])

    def inside(x):
        return -np.linalg.norm(x - peak, axis=1)

    def kinked(x):
        return np.minimum(x[:, 0] + 2 * x[:, 1], 12 - x[:, 0]) - 0.1 * (x[:, 2] - 4) ** 2

    start = np.array([[1.0, 1, 1], [9, 9, 9]])
    assert worst_of(box, inside, start).place == pytest.approx(peak, abs=1e-6)
    worst = worst_of(box, kinked, start)
    assert worst.demand == pytest.approx(12.0, abs=1e-6)
    assert worst.place[2] == pytest.approx(4.0, abs=1e-3)


@pytest.mark.slow
def test_refine_ends_where_the_demand_grows_for_ever_at_one_start() -> None:
    """One start climbs on and on while the other's cloud shrinks to nothing."""
    box = Space(Prism.box((0, 1), (0, 1), (0, 1)), Orientations())
    height = itertools.count()

    def demand(places: np.ndarray) -> np.ndarray:
        return np.where(places[:, 0] > 0.5, float(next(height)), -1.0)

    worst = worst_of(box, demand, np.array([[0.9, 0.5, 0.5], [0.1, 0.5, 0.5]]))
    assert worst.demand == next(height) - 1


def test_refine_stops_where_nothing_is_enough() -> None:
    box = Space(Prism.box((0, 1), (0, 1), (0, 1)), Orientations())

    def demand(x):
        return np.where(x[:, 0] > 0.999, np.inf, x[:, 0])

    worst = worst_of(box, demand, np.array([[0.5, 0.5, 0.5]]))
    assert np.isposinf(worst.demand)
    assert worst.place[0] > 0.999


def test_every_peak_of_a_sweep_is_kept_and_memory_does_not_grow() -> None:
    """Two peaks of unlike height, one of them narrow; a ridge along an edge does not hide it."""
    box = Space(Prism.box((0, 1), (0, 1), (0, 1)), Orientations())
    rng = np.random.default_rng(0)
    pool = Pool(box)

    def demand(x):
        ridge = 1.0 - x[:, 1] - x[:, 2]
        return np.maximum(ridge, 1.2 - 40.0 * np.linalg.norm(x - [0.31, 0.77, 0.52], axis=1))

    for _ in range(20):
        places = rng.random((5000, 3))
        pool.add(places, demand(places))
    assert len(pool.places) == 12**3
    assert worst_of(box, demand, pool.places).demand == pytest.approx(1.2, abs=1e-6)
    pool = Pool(box)
    pool.add(places, np.full(5000, -np.inf))
    assert pool.places.shape == (0, 3)


def test_corners_and_edges_are_tried_though_no_sample_lies_there() -> None:
    """A spike in one corner, thinner than what samples of the inside could meet."""
    box = Space(Prism.over([[0, 0], [9, 0], [3, 7]], 0.0, (1.0, 4.0)), Orientations())
    corner = np.array([3.0, 7.0, 4.0])

    def spike(x):
        return 1.0 / (1e-3 + np.linalg.norm(x - corner, axis=1))

    nowhere = np.empty((0, 3))
    assert worst_of(box, spike, nowhere).demand == pytest.approx(1e3, rel=1e-6)

    def gap(x):
        on_edge = (np.abs(x[:, 1]) < 1e-9) & (np.abs(x[:, 2] - 1.0) < 1e-9)
        return np.where(on_edge & (x[:, 0] > 4.0) & (x[:, 0] < 4.5), np.inf, 0.0)

    assert np.isposinf(worst_of(box, gap, nowhere).demand)


def test_several_extremes_are_found_in_one_search() -> None:
    box = Space(Prism.box((0, 10), (0, 10), (0, 10)), Orientations())
    peaks = np.array([[3.21, 7.654, 5.5], [0, 0, 0], [10, 4.4, 9.9]])

    def nearness(x):
        return -np.linalg.norm(x[:, None] - peaks, axis=2)

    found = refine(box, nearness, np.empty((0, 3)))
    assert np.array([one.place for one in found]) == pytest.approx(peaks, abs=1e-6)


def test_a_search_finds_the_same_alone_and_beside_others() -> None:
    box = Space(Prism.box((0, 10), (0, 8), (0, 3)), Orientations())
    peaks = np.array([[3.21, 7.654, 1.5], [0, 0, 0], [10, 4.4, 2.9]])

    def nearness(x, search):
        distance = np.linalg.norm(x - peaks[search], axis=1)
        return np.column_stack([-distance, np.minimum(distance, 4.0 + search)])

    starts = [np.full((k, 3), 1.0 + k) for k in range(3)]
    together = refine_each(box, nearness, starts)
    for k, found in enumerate(together):
        (alone,) = refine_each(box, lambda x, _, k=k: nearness(x, np.full(len(x), k)), [starts[k]])
        for ours, theirs in zip(found, alone, strict=True):
            assert (ours.place == theirs.place).all() and ours.demand == theirs.demand
        assert found[0].place == pytest.approx(peaks[k], abs=1e-6)
        assert found[1].demand == pytest.approx(4.0 + k)


def test_a_search_that_meets_what_nothing_holds_ends_without_the_others() -> None:
    box = Space(Prism.box((0, 10), (0, 8), (0, 3)), Orientations())

    def demand(x, search):
        return np.where((search == 1) & (x[:, 0] > 9.0), np.inf, x[:, 0] - (x[:, 1] - 2.0) ** 2)

    (first,), (second,), (third,) = refine_each(box, demand, [np.empty((0, 3))] * 3)
    assert np.isposinf(second.demand)
    assert first.demand == third.demand == pytest.approx(10.0)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("curved", "level"),
    [(0, 5.0), (1, 5.0), (2, 5.0), (0, -5.0)],
    ids=["edge", "face", "inside", "below zero"],
)
def test_two_maxima_that_are_almost_as_large_and_near_each_other(curved: int, level: float) -> None:
    """As where different cables are the most loaded: the sample nearest to its top may be of the
    lower one, and little of the higher one exceeds that."""
    box = Space(Prism.box((0, 10), (0, 8), (0, 3)), Orientations())
    for seed in range(40):
        rng = np.random.default_rng(seed)
        left = rng.uniform(2.0, 8.0)
        right = left + rng.uniform(0.3, 0.6)

        def demand(x, left=left, right=right):
            y_z = x[:, 1:]
            below = 0.1 * np.where(np.arange(2) < curved, (y_z - [4.0, 2.0]) ** 2, y_z).sum(axis=1)
            peaks = 0.1 * (x[:, :1] - [left, right]) ** 2 - [0.0, 2e-5]
            return np.column_stack([level - peaks.min(axis=1) - below, x[:, 1]])

        starts = rng.uniform(0.0, [10.0, 8.0, 3.0], (50, 3))
        found = refine(box, demand, starts)[0].demand
        assert found == pytest.approx(level + 2e-5, abs=1e-8)


def test_orientations_that_are_almost_the_same_are_each_searched() -> None:
    turns = frozen_array([[0.0, 0.0, 0.0], [0.0, 0.0, 0.01], [0.0, 0.0, 0.02]])
    space = Space(Prism.box((0, 1), (0, 1), (0, 1)), Orientations(turns))
    peaks = np.array([[0.2, 0.2, 0.2], [0.8, 0.3, 0.6], [0.5, 0.9, 0.1]])

    def demand(x):
        which = np.rint(x[:, 5] / 0.01).astype(int)
        near = np.linalg.norm(x[:, :3] - peaks[which], axis=1)
        return which - 3.0 * near

    found = worst_of(space, demand, space.places(np.full((1, 3), 0.4)))
    assert found.demand == pytest.approx(2.0, abs=1e-7)


def test_a_thinned_workspace_spans_all_of_it(fast_robot) -> None:
    workspace = Workspace(
        Prism.box((0, 1), (0, 1), (0, 1)),
        samples=8000,
        sampling="grid",
        orientations=Orientations(frozen_array([[0, 0, 0.0], [0, 0, 0.1], [0, 0, 0.2]])),
    )
    some = workspace.thinned(600)
    assert some.shape == (600, 6)
    assert np.unique(some[:, 5]).tolist() == [0.0, 0.1, 0.2]
    assert np.ptp(some[:, :3], axis=0) == pytest.approx([1, 1, 1], abs=0.1)


def test_the_papers_workspace(fast_robot, steel) -> None:
    found = map_workspace(fast_robot, paper_workspace(10.35), steel)
    assert found.is_feasible
    assert found.sagging is not None
    assert found.massless is not None
    assert 1e3 * found.sagging.diameter_m == pytest.approx(51.230, abs=5e-4)
    assert found.sagging.max_tension_N / 1e3 == pytest.approx(371.03, abs=0.01)
    assert 1e3 * found.massless.diameter_m == pytest.approx(29.304, abs=5e-4)
    assert found.massless.max_tension_N / 1e3 == pytest.approx(121.40, abs=0.005)
    assert found.sampled is not None
    assert found.sampled.diameter_m < found.sagging.diameter_m
    # (243, 10.35, -40) and its five mirror images lie 7 m beside the middle of an inset edge.
    centre = np.array([250.0, 433.01 / 3])
    assert np.linalg.norm(found.sagging.position_m[:2] - centre) == pytest.approx(
        np.linalg.norm(np.array([243.2, 10.35]) - centre), abs=0.1
    )
    assert found.sagging.position_m[2] == -40


@pytest.mark.slow
def test_the_worst_does_not_depend_on_the_samples(fast_robot, steel) -> None:
    found = [
        map_workspace(fast_robot, paper_workspace(10.35, samples=samples, seed=seed), steel)
        for samples, seed in ((500, 0), (2000, 1), (5000, 2))
    ]
    sampled = [one.sampled.diameter_m for one in found]
    refined = [one.sagging.diameter_m for one in found]
    assert np.ptp(sampled) > 1e-4
    assert refined == pytest.approx(np.full(3, refined[0]), rel=1e-7)


def test_without_an_inset_it_says_where_no_cable_exists(fast_robot, steel) -> None:
    found = map_workspace(fast_robot, paper_workspace(0.0), steel)
    assert not found.is_feasible
    assert found.sagging is None
    assert found.census.fraction("no_finite_cable") == pytest.approx(0.041, abs=0.003)
    assert found.infeasible_example_m is not None
    example = size_poses(fast_robot, Poses.at(found.infeasible_example_m), steel)
    assert not example.statics.is_solved


def test_search_meets_the_infeasible_part_between_samples(fast_robot, steel) -> None:
    """At 4.7 m every sample may be solved, yet a strip along the edges has no finite cable."""
    found = map_workspace(fast_robot, paper_workspace(4.7, samples=2000), steel)
    assert found.census.statuses["solved"] == 2000
    assert not found.is_feasible
    assert found.infeasible_example_m is not None


@pytest.mark.slow
def test_poses_with_hanging_cables_can_be_left_out(fast_robot, steel) -> None:
    found = map_workspace(fast_robot, paper_workspace(0.0, hangs_below="exclude"), steel)
    assert found.is_feasible
    assert found.sagging is not None
    assert found.census.excluded > found.census.statuses["no_finite_cable"] > 0
    assert 1e3 * found.sagging.diameter_m == pytest.approx(40.4, abs=0.1)
    worst = size_poses(fast_robot, Poses.at(found.sagging.position_m), steel)
    assert not worst.statics.hangs_below


def test_list_of_points(fast_robot, steel) -> None:
    points = frozen_array([[250.0, 200, -50], [250, 40, -40]])
    found = map_workspace(fast_robot, Workspace(PointList(points)), steel)
    assert found.census.samples == 2
    assert found.sagging is not None
    assert 1e3 * found.sagging.diameter_m == pytest.approx(43.359, abs=5e-4)


def test_positions_outside_the_hull_are_counted(fast_robot, steel) -> None:
    box = Prism.box((-100, 600), (0, 400), (-100, -50))
    found = map_workspace(fast_robot, Workspace(box, samples=1000), steel)
    assert found.census.statuses["outside_hull"] > 300
    assert not found.is_feasible


def test_sweep_is_stored_with_units_and_read_back(fast_robot, steel, tmp_path) -> None:
    file = tmp_path / "workspace.nc"
    steps = []
    workspace = paper_workspace(0.0, samples=CHUNK + 100)
    found = map_workspace(
        fast_robot, workspace, steel, file=file, attributes={"title": "a"}, progress=steps.append
    )
    with open_sweep(file) as sweep:
        assert sweep.sizes == {"sample": CHUNK + 100, "axis": 3, "cable": 3}
        assert sweep.attrs["title"] == "a"
        assert all("units" in sweep[name].attrs for name in ("diameter", "length", "exit_tension"))
        unsolved = sweep["verdict"].to_numpy() != 0
        assert unsolved.sum() == found.census.samples - found.census.statuses["solved"]
        assert np.isnan(sweep["diameter"].to_numpy()[unsolved]).all()
        assert not np.isnan(sweep["diameter"].to_numpy()[~unsolved]).any()
        again = size_poses(fast_robot, Poses.at(sweep["position"].to_numpy()[:50]), steel)
        assert np.allclose(again.diameter_m, sweep["diameter"].to_numpy()[:50], equal_nan=True)
    assert sum(steps) == CHUNK + 100


@pytest.mark.slow
def test_the_search_slides_along_what_does_not_count() -> None:
    """The largest demand lies on a slanted border of what counts, curved and not."""
    box = Space(Prism.box((0, 1), (0, 1), (0, 1)), Orientations())
    nowhere = np.empty((0, 3))

    def behind_a_plane(x):
        inside = 0.577 * x[:, 0] + 0.8 * x[:, 1] + 0.16 * x[:, 2] <= 0.7
        return np.where(inside, x[:, 0] + 1.5 * x[:, 1] - (x[:, 2] - 0.4) ** 2, -np.inf)

    def behind_a_sphere(x):
        gap = np.linalg.norm(x - [0.1, 0.2, 0.3], axis=1)
        return np.where(gap <= 0.6, x @ [1.0, 2.0, 0.5], -np.inf)

    steep = [0.1, 0.2, 0.3] + 0.6 * np.array([1.0, 2.0, 0.5]) / np.linalg.norm([1.0, 2.0, 0.5])
    assert worst_of(box, behind_a_sphere, nowhere).demand == pytest.approx(
        steep @ [1.0, 2.0, 0.5], rel=1e-7
    )
    # On the plane's border the demand is linear in x and concave in z: at x = 0.
    z = np.linspace(0.0, 1.0, 100_001)
    along = 1.5 * (0.7 - 0.16 * z) / 0.8 - (z - 0.4) ** 2
    assert worst_of(box, behind_a_plane, nowhere).demand == pytest.approx(along.max(), rel=1e-7)


@pytest.mark.slow
def test_among_places_of_which_few_count_the_best_that_was_asked_is_found() -> None:
    box = Space(Prism.box((0, 1), (0, 1), (0, 1)), Orientations())
    asked = [-np.inf]

    def dust(x):
        counts = np.sin(1e5 * x.sum(axis=1)) > 0.99
        values = np.where(counts, -((x - 0.4) ** 2).sum(axis=1), -np.inf)
        asked.append(values.max(initial=-np.inf))
        return values

    assert worst_of(box, dust, np.empty((0, 3))).demand == max(asked)


def test_every_point_of_a_list_is_tried_for_every_extreme() -> None:
    """Neighbours that share a cell of the pool differ in what they are extreme in."""
    points = np.random.default_rng(1).random((9000, 3))
    space = Space(PointList(frozen_array(points)), Orientations())

    def demand(x):
        return np.hstack([x, -x])

    found = [one.demand for one in refine(space, demand, points[:1])]
    assert found == pytest.approx([*points.max(axis=0), *-points.min(axis=0)])


@pytest.mark.parametrize("name", example_names())
def test_no_poses_are_answered_by_none(name: str) -> None:
    study = read_study(example_file(name))
    robot, cable, none = study.robot, study.material.cable(5e-3), Poses.at(np.empty((0, 3)))
    assert solve_massless(robot, none).tension_N.shape == (0, robot.n_cables)
    assert solve_sagging(robot, none, cable).length_m.shape == (0, robot.n_cables)
    assert size_poses(robot, none, study.material).diameter_m.shape == (0,)
    assert study.workspace is not None
    places = np.empty((0, study.workspace.space.n_coordinates))
    assert diameter_demand(robot, study.material, "include", places).shape == (0,)
    for hangs_below in ("include", "exclude"):
        assert massless_demand(robot, study.material, hangs_below, places).shape == (0,)
    assert rope_demand(robot, cable, "exclude", places).shape == (0, 1 + 2 * robot.n_cables)


def ipanema(region: Prism) -> Study:
    """IPAnema, where each cable keeps 30 N and the platform is turned a little."""
    study = read_study(example_file("ipanema"))
    turn = frozen_array([[0.04, -0.056, 0.073]])
    workspace = Workspace(region, samples=500, orientations=Orientations(turn))
    return replace(study, workspace=workspace, pose=None, selection=None)


INSIDE = Prism.box((-0.4, 0.2), (-0.2, 0.2), (0.4, 0.8))
ACROSS = Prism.box((-0.918, -0.159), (-0.382, 0.664), (1.018, 1.24))


def test_toward_a_pose_that_straight_cables_do_not_hold_their_tension_has_no_bound() -> None:
    study = ipanema(ACROSS)
    assert study.workspace is not None
    places = next(iter(study.workspace.places()))

    def tension(place: np.ndarray) -> float:
        return float(solve_massless(study.robot, Poses.at(place)).largest_tension_N)

    held = [place for place in places if np.isfinite(tension(place))]
    inside, outside = held[0], next(place for place in places if np.isnan(tension(place)))
    start = tension(inside)
    for _ in range(40):
        middle = 0.5 * (inside + outside)
        if np.isnan(tension(middle)):
            outside = middle
        else:
            inside = middle
    assert tension(inside) > 1e3 * start
    assert map_workspace(study.robot, study.workspace, study.material).massless is None


def test_where_straight_cables_hold_everything_their_worst_pose_is_told() -> None:
    study = ipanema(INSIDE)
    assert study.workspace is not None
    found = map_workspace(study.robot, study.workspace, study.material).massless
    assert found is not None
    tensions = solve_massless(study.robot, Poses.at(next(iter(study.workspace.places()))))
    assert found.max_tension_N >= np.max(tensions.largest_tension_N)
    again = solve_massless(study.robot, found.pose).largest_tension_N
    assert found.max_tension_N == pytest.approx(float(again))


@pytest.mark.slow
def test_it_is_of_the_poses_that_count(fast_robot, steel) -> None:
    triangle = [[0, 0, 0], [500, 0, 0], [250, 433.01, 0]]
    region = Prism.over(triangle, 0.0, (-200.0, -40.0))
    workspace = Workspace(region, samples=2000, hangs_below="exclude")
    found = map_workspace(fast_robot, workspace, steel).massless
    assert found is not None
    sizing = size_poses(fast_robot, found.pose, steel)
    assert not is_left_out(sizing.statics, "exclude")
    places = next(iter(workspace.places()))
    sizing = size_poses(fast_robot, Poses.at(places), steel)
    counts = ~is_left_out(sizing.statics, "exclude")
    assert np.isfinite(sizing.massless_tension_N[counts]).all()
    assert found.max_tension_N > sizing.massless_tension_N[counts].max()
    assert found.max_tension_N < sizing.massless_tension_N[~counts].max()


def test_sag_may_hold_what_straight_cables_do_not() -> None:
    study = read_study(example_file("robocrane"))
    region = Prism.box((-0.997, 0.601), (1.143, 1.159), (-0.473, 0.964))
    workspace = Workspace(region, samples=2000)
    found = map_workspace(study.robot, workspace, study.material)
    assert found.is_feasible
    assert found.massless is None


def test_terminal_and_report_say_that_there_is_none(tmp_path) -> None:
    analysis = analyse(ipanema(ACROSS), folder=tmp_path)
    said = dict(summary_rows(analysis))
    assert said["  massless"] == "none: straight cables do not hold every pose"
    page = section(Drawings(analysis, draws=False, missing="pictures"), "workspace")
    start = "Straight weightless cables do not hold every"
    assert any(text.startswith(start) for text in paragraphs(page))


STEEL = Material(7800.0, 200e9, 180e6)
MAST = frozen_array([[0, 0, 0], [100, 0, 0], [100, 80, 0], [0, 80, 0]])
ROBOT = Robot(MAST, Platform(400.0), sag_max=0.5)
REGION = Prism.box((10.0, 90.0), (10.0, 70.0), (-40.0, -10.0))
ROPE = STEEL.cable(0.012)


def drawn_z_m(statics, robot) -> np.ndarray:
    """Heights along every cable, by adding up short straight pieces from the exit point."""
    steps = 4000
    w, EA = statics.weight_N_per_m[..., None], statics.axial_stiffness_N[..., None]
    s = (np.arange(steps) + 0.5) / steps * statics.length_m[..., None]
    upward = statics.force_z_N[..., None] + w * (s - statics.length_m[..., None])
    tension = np.hypot(statics.force_x_N[..., None], upward)
    piece = upward / tension * (1.0 + tension / EA) * statics.length_m[..., None] / steps
    return robot.exit_points_m[:, 2, None] + np.cumsum(piece, axis=-1)


def some_statics(cable=ROPE):
    rng = np.random.default_rng(4)
    low, high = REGION.bounds_m
    return solve_sagging(ROBOT, Poses.at(rng.uniform(low, high, (200, 3))), cable)


def test_the_lowest_point_is_that_of_the_drawn_cable() -> None:
    statics = some_statics(STEEL.cable(0.02))
    assert statics.is_solved.all()
    assert statics.hangs_below.any() and not statics.hanging_cables.all()
    drawn = np.minimum(drawn_z_m(statics, ROBOT).min(axis=-1), 0.0)
    assert np.abs(statics.lowest_m - drawn).max() < 0.05
    assert np.all(statics.lowest_m <= statics.poses.position_m[:, None, 2] + 1e-9)


def test_samples_are_counted_and_the_worst_is_told() -> None:
    statics = some_statics(STEEL.cable(0.03))
    places = statics.poses.position_m
    ratio, lowest = statics.length_over_chord, statics.lowest_m
    floor_m = float(np.median(lowest.min(axis=1)))
    counts = statics.is_solved & (np.arange(200) % 3 > 0)
    whole = HangingCables().with_samples(places, statics, counts, floor_m)
    assert whole.samples == counts.sum()
    assert whole.below_floor is not None
    below = lowest[counts].min(axis=1)
    assert whole.below_floor.samples == (below < floor_m).sum()
    assert whole.below_floor.extreme == below.min()
    at = int(np.flatnonzero((places == whole.below_floor.place).all(axis=1))[0])
    assert lowest[at, whole.below_floor.cable - 1] == below.min()
    assert (whole.long is not None) == (ratio[counts] > LONG).any()
    assert HangingCables().with_samples(places, statics, counts, None).below_floor is None


@pytest.mark.parametrize("samples", [300])
def test_a_sweep_counts_them(samples) -> None:
    workspace = Workspace(REGION, samples=samples, floor_m=-45.0)
    light = map_workspace(ROBOT, workspace, STEEL).census.hanging
    assert light.samples == samples
    with_heavy = survey_hanging(ROBOT, workspace, STEEL.cable(0.03))
    assert with_heavy.below_floor is not None
    assert with_heavy.below_floor.extreme < -45.0
    assert [heading for heading, _ in with_heavy.notes()][-1] == "below floor"
    none = survey_hanging(ROBOT, replace(workspace, floor_m=None), STEEL.cable(0.003))
    assert [*none.notes()] == []


def test_a_cable_is_not_left_to_hang_far_down_where_that_saves_nothing() -> None:
    """Of a hall of 60 m by 40 m; held or not, the needed diameter is the same to 0.05 %."""
    corners = [(x, y) for x in (-1, 1) for y in (-1, 1)]
    exits = [p for x, y in corners for p in ([30 * x, 19 * y, 25], [29 * x, 20 * y, 25])]
    body = [p for x, y in corners for p in ([x, -y, 1], [-x, y, -1])]
    robot = Robot(frozen_array(exits), Platform(500.0, frozen_array(body)))
    rope = Material(5290.0, 62.7e9, 198e6)
    places = [[17.53754872083664, 10.275146467611194, 4.830685159191489], [-21.55, 10.84, 3.36]]
    sizing = size_poses(robot, Poses.at(places), rope)
    held = size_poses(replace(robot, tension_min_N=0.5), Poses.at(places), rope)
    assert sizing.statics.is_solved.all()
    assert sizing.statics.length_over_chord.max() < LONG
    assert sizing.diameter_m == pytest.approx(held.diameter_m, rel=5e-4)
