"""Load cases on ropes that can be bought: who holds, what governs, agreement with twins."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from redundant_robots import FOUR
from scipy.spatial.transform import Rotation
from twins.loaded import Twin, acting, held, least_largest, rest, tensions_N

from designer.arrays import FloatArray
from designer.effects.design import AsBuilt
from designer.grades.registry import load_catalogue
from designer.io.config import read_study
from designer.model.cable import Cable
from designer.model.load_case import Ice, LoadCase, Loaded, Wind
from designer.model.region import PointList, Prism, Region
from designer.model.robot import Poses
from designer.model.workspace import Workspace
from designer.resources import example_file
from designer.selection.cases import (
    CaseResult,
    Cases,
    envelope,
    governing,
    refine_all,
    resettled,
    worst_load_direction,
)
from designer.selection.result import SelectionResult
from designer.selection.select import select
from designer.selection.verify import verify
from designer.statics.cable_loss import Fate, settle
from designer.statics.inverse import solve_sagging
from designer.study import Study

PARKED = {
    "yard": Prism.box((13, 17), (7, 11), (1, 2)),
    "cogiro": Prism.box((-1, 1), (-1, 1), (0.5, 1)),
}


def study_of(name: str, samples: int) -> Study:
    """A shipped study with the platform in the wind, and fewer samples."""
    study = read_study(example_file(name))
    assert study.workspace is not None
    body = replace(study.robot.platform, drag_area_m2=0.55)
    workspace = replace(study.workspace, samples=samples)
    return replace(study, robot=replace(study.robot, platform=body), workspace=workspace)


def five(name: str) -> tuple[LoadCase, ...]:
    return (
        LoadCase("static"),
        LoadCase("hoisting", dynamic_factor=1.3),
        LoadCase("wind", wind=Wind(20.0, 1.2)),
        LoadCase(
            "storm", wind=Wind(30.0, 1.2), ice=Ice(0.005), safety_factor=3.0, region=PARKED[name]
        ),
        LoadCase("lost", cable_lost="each", safety_factor=3.0),
    )


def chosen_for(study: Study, cases: tuple[LoadCase, ...]) -> SelectionResult:
    assert study.workspace is not None
    assert study.selection is not None
    grades = load_catalogue(()).grades
    named = [grade for grade in grades if grade.id in (study.selection.grades or ())]
    if study.robot.is_redundant:  # which takes long: one size
        named = [replace(g, sizes=tuple(s for s in g.sizes if s.id == "5 mm")) for g in named[:1]]
    return select(
        study.robot, study.workspace, study.selection, named,
        built=AsBuilt(study.robot), load_cases=cases,
    )  # fmt: skip


def twin_tension_N(study: Study, found: CaseResult) -> FloatArray:
    """Largest tension of each cable at the pose found, by the twin; its start is ours."""
    robot, cable = found.loaded.bare
    body, case, one = robot.platform, found.case, found.loaded
    twin = Twin(
        robot.exit_points_m, body.mass_kg, cable.axial_stiffness_N, cable.linear_density_kg_per_m,
        cable.diameter_m, body.attachments_m, body.centre_of_mass_m, body.wrench_N,
        body.drag_area_m2 or 0.0, body.drag_centre_m, 1.2,
    )  # fmt: skip
    load = acting(
        twin,
        wind=None if one.wind is None or case.wind is None else case.wind.speed_m_per_s * one.wind,
        ice_m=case.ice.thickness_m if case.ice else 0.0,
        factor=case.dynamic_factor,
    )
    position, turn = found.pose.position_m[0], np.eye(3)
    if not robot.is_redundant:
        pull, length = held(twin, load, position, turn)
    else:
        ours = solve_sagging(one.robot, found.pose, one.cable)
        force = -np.concatenate(
            [ours.force_x_N[0, :, None] * ours.geometry().outward[0], ours.force_z_N[0, :, None]],
            axis=1,
        )
        shift = np.random.default_rng(0).uniform(0.97, 1.03, (robot.n_cables, 1))
        start = shift * (force @ one.robot.upright)
        pull, length = least_largest(twin, load, position, turn, start, ours.length_m[0])
    if one.lost_cable is None:
        return tensions_N(pull, length, load.q)
    if robot.is_redundant:  # the internal forces before the loss need not be the twin's
        length = ours.length_m[0]
    others = np.delete(np.arange(robot.n_cables), one.lost_cable - 1)
    loss = settle(one.robot, found.pose, one.cable, one.lost_cable)
    near, turned = loss.rest.position_m[0] + 1e-3, loss.rest.rotation[0]
    turned = Rotation.from_rotvec([1e-3, -1e-3, 1e-3]).as_matrix() @ turned
    _, _, pull = rest(twin, load, near, turned, length[others], others)
    return tensions_N(pull, length[others], load.q)


BOX = Prism.box((20, 70), (20, 60), (-30, -8))


@pytest.mark.slow
@pytest.mark.parametrize(
    "region", [BOX, PointList(np.concatenate([*BOX.samples_m(40, "low_discrepancy", 3)]))]
)
def test_few_samples_at_first_change_no_figure_of_what_is_searched(region: Region) -> None:
    robot = replace(FOUR, platform=replace(FOUR.platform, drag_area_m2=2.0))
    workspace = Workspace(region, samples=40)
    each = LoadCase("static"), LoadCase("wind", wind=Wind(15.0, 1.2, count=2))
    cases = Cases(robot, workspace, each)
    thin, thick = (Cable(d, 5000.0 * d**2, 5e10 * d**2, 6e8 * d**2) for d in (0.004, 0.01))
    found = [
        one.sampled([[thin, thick]] * 2, lambda _: None)
        for one in (cases, replace(cases, sample_limit=10))
    ]
    assert [tried[0].verification.holds for tried in found[1]] == [False, True]
    assert {one.sampled.samples for one in found[1][1]} == {10}
    full, few = (refine_all(tried[1]) for tried in found)
    assert {one.sampled.samples for one in few} == {40}
    assert [one.utilisation for one in few] == [one.utilisation for one in full]
    assert [one.is_full for one in few] == [one.is_full for one in full]


@pytest.mark.parametrize("seed", range(4))
def test_a_load_is_turned_to_where_a_linear_severity_is_largest(seed: int) -> None:
    slope, tried = np.random.default_rng(seed).normal(size=3), 0

    def severity_of(loaded: Loaded) -> float:
        nonlocal tried
        tried += 1
        return float(slope @ loaded.inertia)

    case = LoadCase("starting", acceleration_m_per_s2=1.0)
    first = next(iter(case.on(FOUR, Cable(0.006, 0.13, 1.5e6, 2e4))))
    turned, severity = worst_load_direction(first, severity_of(first), severity_of)
    assert turned.inertia == pytest.approx(slope / np.linalg.norm(slope), abs=1e-6)
    assert severity == pytest.approx(np.linalg.norm(slope), rel=1e-12)
    assert tried < 60


def test_what_was_not_searched_stays_after_a_proof() -> None:
    workspace, cable = Workspace(BOX, samples=40), Cable(0.01, 0.5, 5e6, 6e4)
    case = LoadCase("starting", acceleration_m_per_s2=1.0)
    cases = Cases(FOUR, workspace, (case,)).sampled([[cable]], lambda _: None)[0]
    assert len(cases) > 1
    assert all(resettled(result) is result for result in cases)


def test_all_but_slow_robots_in_one_case_hurry() -> None:
    workspace = Workspace(BOX)
    three = replace(FOUR, exit_points_m=FOUR.exit_points_m[:3])
    both = LoadCase("static"), LoadCase("hoisting", dynamic_factor=1.3)
    assert Cases(FOUR, workspace, both).with_coarse_sampling().sample_limit is not None
    assert Cases(FOUR, workspace, both[:1]).with_coarse_sampling().sample_limit is None
    for cases in (both, both[:1]):
        assert Cases(three, workspace, cases).with_coarse_sampling().sample_limit is not None


@pytest.mark.slow
@pytest.mark.parametrize("name", ["yard", "cogiro"])
def test_governing_case_and_utilisation_agree_with_a_twin(name: str) -> None:
    study = study_of(name, 200)
    chosen = chosen_for(study, five(name)).chosen
    assert chosen is not None
    assert [one.case.name for one in chosen.cases] == [case.name for case in five(name)]
    theirs = []
    for found in chosen.cases:
        allowed = chosen.size.minimum_breaking_load_N / (found.case.safety_factor or 5.0)
        used = float(twin_tension_N(study, found).max()) / allowed
        assert found.utilisation == pytest.approx(used, rel=1e-6)
        assert found.verification.is_refined
        theirs.append(used)
    assert chosen.governing is chosen.cases[int(np.argmax(theirs))]
    assert chosen.governing.case.name == "hoisting"
    assert chosen.verification.utilisation == chosen.governing.utilisation <= 1.0


@pytest.mark.slow
def test_a_study_without_cases_has_the_static_one() -> None:
    study = study_of("yard", 300)
    bare, one = chosen_for(study, ()), chosen_for(study, (LoadCase("static"),))
    assert bare.chosen is not None
    assert one.chosen is not None
    assert bare.chosen.name == one.chosen.name
    assert {c.name for c in bare.candidates if c.requirements} == {bare.chosen.name}
    assert bare.chosen.verification.utilisation == one.chosen.verification.utilisation
    assert [c.reason for c in bare.candidates if c.verified] == [
        c.reason for c in one.candidates if c.verified
    ]


def test_a_case_that_nothing_holds_is_named() -> None:
    study = study_of("yard", 300)
    gale = LoadCase("gale", wind=Wind(60.0, 1.2))
    result = chosen_for(study, (LoadCase("static"), gale))
    assert result.chosen is None
    thick = result.outcomes[0].candidates[-1]
    assert "in the load case 'gale'" in thick.reason
    assert thick.cases[0].verification.holds
    assert "gale" in result.outcomes[0].sentence
    assert result.reason is not None
    assert "gale" in result.reason


@pytest.mark.slow
def test_inertia_points_where_it_is_worst() -> None:
    study = study_of("yard", 300)
    case = LoadCase("jerk", acceleration_m_per_s2=2.0)
    chosen = chosen_for(study, (case,)).chosen
    assert chosen is not None
    found = chosen.cases[0]
    assert found.loaded.inertia is not None
    sample = max(found.tension_N(one) for one in case.on(*found.loaded.bare))
    assert found.verification.max_tension_N > sample
    rng = np.random.default_rng(1)
    for _ in range(200):
        along = found.loaded.inertia + rng.normal(size=3) * 10.0 ** rng.uniform(-4, 0)
        pushed = case.under(*found.loaded.bare, None, along / np.linalg.norm(along))
        assert found.tension_N(pushed) <= found.verification.max_tension_N * (1 + 1e-9)


@pytest.mark.slow
def test_a_lost_cable_is_told() -> None:
    study = study_of("yard", 300)
    lost = LoadCase("second lost", cable_lost=2, safety_factor=2.0)
    chosen = chosen_for(study, (LoadCase("static"), lost)).chosen
    assert chosen is not None
    found = chosen.cases[1]
    loss = found.loss
    assert loss is not None
    assert loss.fate[0] == Fate.RESTS_ELSEWHERE
    assert found.loaded.lost_cable == 2
    assert found.most_used in (1, 3)
    assert float(loss.largest_tension_N[0]) == pytest.approx(
        found.verification.max_tension_N, rel=1e-9
    )


@pytest.mark.slow
def test_a_lost_cable_alone_needs_the_lengths_before_the_loss() -> None:
    study = study_of("yard", 20)
    assert study.workspace is not None
    cable = Cable(0.006, 0.13, 1.5e6, 2e4)
    cases = Cases(study.robot, study.workspace, (LoadCase("lost", cable_lost=2),))
    (found,) = cases.sampled([[cable]], lambda _: None)
    whole = verify(study.robot, study.workspace, cable)
    sampled, searched = envelope(found), envelope(refine_all(found))
    assert (sampled.longest_m > 0.9 * whole.longest_m).all()
    assert searched.longest_m == pytest.approx(whole.longest_m, rel=1e-6)
    assert searched.shortest_m == pytest.approx(whole.shortest_m, rel=1e-4)


def test_a_list_of_points_in_the_wind_with_poses_left_out() -> None:
    study = study_of("yard", 60)
    assert study.workspace is not None
    points = np.array([[15.0, 9.0, 4.0], [14.0, 8.0, 3.0], [16.0, 7.0, 2.0]])
    workspace = replace(study.workspace, region=PointList(points), hangs_below="exclude")
    cable = Cable(0.006, 0.13, 1.5e6, 2e4)
    gust = LoadCase("gust", wind=Wind(12.0, 1.2, count=3))
    (found,) = Cases(study.robot, workspace, (gust,)).sampled([[cable]], lambda _: None)
    for one in found:
        load = one.loaded
        used = solve_sagging(load.robot, Poses.at(points), load.cable).largest_tension_N.max()
        assert one.sampled.counted == 3
        assert one.utilisation == pytest.approx(used / cable.allowable_tension_N, rel=1e-9)


def test_poses_are_left_out_in_each_direction_of_a_case_by_itself() -> None:
    study = study_of("yard", 60)
    assert study.workspace is not None
    region = Prism.over(np.array(study.robot.exit_points_m[:, :2]), 1.5, (1.0, 10.0))
    workspace = replace(study.workspace, region=region, hangs_below="exclude")
    cable = Cable(0.012, 2.0, 6e6, 8e4)
    gust = LoadCase("gust", wind=Wind(12.0, 1.2, count=3))
    (found,) = Cases(study.robot, workspace, (gust,)).sampled([[cable]], lambda _: None)
    places = np.concatenate([workspace.space.landmarks(), *workspace.places()])
    shares = set()
    for one in found:
        load = one.loaded
        statics = solve_sagging(load.robot, Poses.at(places), load.cable)
        plan = statics.force_x_N[..., None] * statics.geometry().outward
        pull = -np.concatenate([plan, statics.force_z_N[..., None]], axis=2) @ load.robot.upright
        hangs = (pull[..., 2] < 0.0).any(axis=1)
        used = statics.largest_tension_N[~hangs].max() / load.cable.allowable_tension_N
        assert one.utilisation == pytest.approx(used, rel=1e-9)
        assert one.sampled.counted == (~hangs).sum() < len(places)
        shares.add(one.sampled.counted)
    assert len(shares) > 1
    lost = LoadCase("lost", cable_lost=1)
    ((after,),) = Cases(study.robot, workspace, (lost,)).sampled([[cable]], lambda _: None)
    loss = settle(study.robot, Poses.at(places), cable, 1)
    counts = ~loss.before.hangs_below
    assert 0 < counts.sum() < len(places)
    used = loss.largest_tension_N[counts].max() / cable.allowable_tension_N
    assert after.utilisation == pytest.approx(used, rel=1e-9)


@pytest.mark.slow
def test_wind_is_searched_to_its_worst_direction() -> None:
    study = study_of("yard", 60)
    assert study.workspace is not None
    points = np.array([[11.0, 6.0, 4.0], [18.0, 7.0, 5.0]])
    workspace = replace(study.workspace, region=PointList(points), hangs_below="include")
    robot, cable = replace(study.robot, pulley_radius_m=0.2), Cable(0.006, 0.13, 1.5e6, 2e4)
    (found,) = Cases(robot, workspace, (LoadCase("gust", wind=Wind(12.0, 1.2)),)).sampled(
        [[cable]], lambda _: None
    )
    most = governing(refine_all(found))
    used = [
        solve_sagging(one.robot, Poses.at(points), one.cable).largest_tension_N.max()
        for one in LoadCase("gust", wind=Wind(12.0, 1.2, count=72)).on(robot, cable)
    ]
    assert len(found) == 8
    assert most.utilisation > governing(found).utilisation * (1.0 + 1e-5)
    assert most.utilisation * cable.allowable_tension_N >= max(used) * (1.0 - 1e-9)
    assert most.utilisation * cable.allowable_tension_N <= max(used) * 1.002
