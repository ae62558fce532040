"""Load cases on ropes that can be bought: who holds, what governs, agreement with twins.

Ropes whose stiffness depends on their tension: it is that at the tension met in each case.

Sets of wrenches: nothing in a box asks for more than is stated of it.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from grade_samples import family_grade
from redundant_robots import FOUR
from scipy.optimize import brentq, linprog
from scipy.spatial.transform import Rotation
from twins.loaded import Twin, acting, held, least_largest, rest, tensions_N

import designer
from designer.arrays import FloatArray
from designer.effects.design import AsBuilt
from designer.grades.grade import Grade, RelativeStiffness
from designer.grades.registry import load_catalogue
from designer.io.config import read_study
from designer.model.cable import Cable, Stiffening
from designer.model.load_case import Ice, LoadCase, Loaded, Wind, WrenchSet
from designer.model.region import PointList, Prism, Region
from designer.model.robot import Platform, Poses, Robot
from designer.model.workspace import Workspace
from designer.progress import Advance
from designer.resources import example_file
from designer.selection.candidate import candidates_of, undominated
from designer.selection.cases import (
    CaseResult,
    Cases,
    converge_stiffness,
    envelope,
    governing,
    refine_all,
    resettled,
    worst_load_direction,
)
from designer.selection.groups import MOST_PROPOSALS, choose_groups_of
from designer.selection.result import SelectionResult
from designer.selection.select import select
from designer.selection.verify import verify
from designer.statics.cable_loss import Fate, settle
from designer.statics.inverse import solve_massless, solve_sagging
from designer.study import CableGroup, Selection, Study

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


ROBOT = Robot(
    np.array([[0, 0, 11.5], [30, 1, 12.5], [14, 26, 11.0]]), Platform(180.0, drag_area_m2=0.6)
)
PLACES = np.random.default_rng(3).uniform([8, 5, 1], [19, 13, 8], (25, 3))
POINTS = Workspace(PointList(PLACES))
CASES = (
    LoadCase("rest"),
    LoadCase("strict", safety_factor=6.0),
    LoadCase("heavy", mass_kg=240.0),
    LoadCase("storm", wind=Wind(12.0, 1.2, count=3)),
    LoadCase("cold", temperature_change_K=-50.0),
    LoadCase("lost", cable_lost=2, safety_factor=2.0),
)
LAW = RelativeStiffness((4.0, 30.0, 40.0), (0.02, 0.3, 0.6), "printed", "made up for a test", 0.1)


def fibre(law: RelativeStiffness = LAW, diameters_mm: tuple[float, ...] = (6.0, 8.0)) -> Grade:
    grade = family_grade(700.0, breaking_stress_Pa=9e8, diameters_mm=diameters_mm)
    return replace(grade, modulus=None, stiffness=law, material="HMPE")


def chosen_in(
    workspace: Workspace,
    cases: tuple[LoadCase, ...],
    safety_factor: float = 3.0,
    proof_s: float = 0.0,
) -> SelectionResult:
    selection = Selection(safety_factor=safety_factor, objectives=("mass",))
    built = AsBuilt(ROBOT)
    return select(
        ROBOT, workspace, selection, [fibre()], built=built, load_cases=cases, proof_s=proof_s
    )


def largest_N(case: LoadCase, cable: Cable, words: str) -> float:
    """Return the largest tension at all points in one direction, by the solvers alone."""
    (one,) = (loaded for loaded in case.on(ROBOT, cable) if loaded.words == words)
    places = Poses.at(PLACES)
    if one.keeps_lengths:
        found = settle(one.robot, places, one.cable, one.lost_cable, one.growth)
        return float(found.largest_tension_N.max())
    return float(solve_sagging(one.robot, places, one.cable).largest_tension_N.max())


@pytest.mark.slow
def test_each_case_has_the_stiffness_at_its_own_tension() -> None:
    chosen = chosen_in(POINTS, CASES).chosen
    assert chosen is not None
    breaking_N = chosen.size.minimum_breaking_load_N
    for found in chosen.cases:
        bare = found.loaded.bare[1]

        def off(stiffness_N: float, case=found.case, words=found.loaded.words, bare=bare) -> float:
            cable = replace(bare, axial_stiffness_N=stiffness_N)
            fraction = largest_N(case, cable, words) / breaking_N
            return float(np.interp(fraction, LAW.load_fraction, LAW.ea_over_breaking_load)) - (
                stiffness_N / breaking_N
            )

        expected_N = brentq(off, 4.0 * breaking_N, 40.0 * breaking_N, rtol=1e-9)
        assert found.loaded.cable.axial_stiffness_N == pytest.approx(expected_N, rel=3e-6)
    stiffness = {one.case.name: one.loaded.cable.axial_stiffness_N for one in chosen.cases}
    assert stiffness["strict"] == stiffness["rest"]
    assert stiffness["heavy"] > 1.05 * stiffness["rest"]
    assert chosen.cable.axial_stiffness_N == chosen.governing.loaded.cable.axial_stiffness_N


def test_the_safety_factor_is_not_in_it() -> None:
    few, many = (chosen_in(POINTS, (), factor).candidates for factor in (1.5, 4.0))
    for one, other in zip(few, many, strict=True):
        stiffness_N = pytest.approx(other.cable.axial_stiffness_N, rel=1e-12)
        assert one.cable.axial_stiffness_N == stiffness_N
        assert one.cable.allowable_tension_N > other.cable.allowable_tension_N


@pytest.mark.slow
def test_the_tension_is_that_between_the_samples() -> None:
    workspace = Workspace(Prism.box((8, 19), (5, 13), (1, 8)), samples=20)
    found = chosen_in(workspace, CASES[:3], proof_s=2.0)
    assert found.chosen is not None
    for one in found.chosen.cases:
        cable = one.loaded.cable
        assert cable.stiffening is not None
        met_N = one.verification.max_tension_N
        assert cable.axial_stiffness_N == pytest.approx(cable.stiffening.at(met_N), rel=1e-6)
    governing = found.chosen.governing
    statics = solve_sagging(governing.loaded.robot, governing.pose, governing.loaded.cable)
    assert float(statics.largest_tension_N[0]) == pytest.approx(
        governing.verification.max_tension_N, rel=1e-9
    )
    assert found.proof is not None
    assert found.proof.found == pytest.approx(governing.utilisation, rel=1e-9)


@pytest.mark.parametrize("exponent", [0.3, 0.9, -0.9])
def test_a_stiffness_that_moves_its_own_tension_is_found(exponent: float) -> None:
    """Where the tension grows with the stiffness, plain turns would come near it too slowly."""
    rising = np.geomspace(0.01, 1.0, 40)
    law = Stiffening(tuple(1e4 * rising), tuple(2e5 * rising**exponent))
    start = Cable(0.01, 0.1, 1e4, 1e4, stiffening=law)

    def max_tension_N(cable: Cable) -> float:
        return 1e3 * (cable.axial_stiffness_N / 1e5)

    found = converge_stiffness(start, max_tension_N)
    at_N = law.at(max_tension_N(found))
    assert found.axial_stiffness_N == pytest.approx(at_N, rel=2e-6)


def test_one_stiffness_for_all_tensions_is_left_alone() -> None:
    grade = family_grade()
    cable = grade.cable(grade.sizes[0], 5.0)
    assert cable.stiffening is None
    assert cable.at_tension(1e3) is cable
    one_figure = fibre(replace(LAW, ea_over_breaking_load=(56.0,), load_fraction=(0.2,)))
    assert one_figure.cable(one_figure.sizes[0], 5.0).stiffening is None


def test_an_effect_changes_all_of_the_stiffness() -> None:
    grade = fibre()
    cable = grade.cable(grade.sizes[0], 5.0)
    built = AsBuilt(ROBOT, lambda one: replace(one, axial_stiffness_N=0.5 * one.axial_stiffness_N))
    changed = built.cable(cable)
    for tension_N in (100.0, 3e3, 2e4):
        there = changed.at_tension(tension_N).axial_stiffness_N
        assert there == pytest.approx(0.5 * cable.at_tension(tension_N).axial_stiffness_N)


def test_groups_have_the_stiffness_at_their_largest_tension() -> None:
    groups = (CableGroup("a", (1,)), CableGroup("b", (2, 3)))
    selection = Selection(safety_factor=5.0, groups=groups)
    choice = choose_groups_of(
        POINTS, selection, [fibre(diameters_mm=(4.0, 5.0, 6.0))], AsBuilt(ROBOT), None
    )
    assert choice.chosen.is_found
    tension_N = choice.chosen.max_tension_N
    assert math.isfinite(tension_N)
    for product in choice.chosen.ropes:
        expected = product.cable.at_tension(tension_N).axial_stiffness_N
        assert product.cable.axial_stiffness_N == pytest.approx(expected, rel=1e-3)


def test_a_bar_advances_by_one_with_each_proposal_for_groups() -> None:
    steps: list[int] = []

    class Counter:
        @contextmanager
        def task(self, name: str, total: int) -> Iterator[Advance]:
            assert total == MOST_PROPOSALS
            yield steps.append

    selection = Selection(
        safety_factor=5.0, groups=(CableGroup("a", (1,)), CableGroup("b", (2, 3)))
    )
    steel = family_grade(700.0, diameters_mm=(3.0, 4.0, 5.0, 6.0))  # chosen in a single round
    choice = choose_groups_of(POINTS, selection, [steel], AsBuilt(ROBOT), None, Counter())
    assert sum(steps) == len(choice.proposals) > 0


def test_no_rope_is_beaten_by_one_that_may_be_the_stiffer() -> None:
    """A weaker rope that is softer where both may be: it is what is met that tells."""
    (strong,) = candidates_of(Selection(), [fibre(diameters_mm=(6.0,))], AsBuilt(ROBOT))
    breaking_N = 0.9 * strong.cable.allowable_tension_N
    weak = replace(strong, cable=replace(strong.cable, allowable_tension_N=breaking_N))
    assert undominated([strong, weak]) == (strong,)
    assert undominated([strong, weak], at_any_tension=True) == (strong, weak)
    assert weak.cable.stiffening is not None
    stiffest_N = max(weak.cable.stiffening.axial_stiffness_N)
    steel = replace(weak.cable, axial_stiffness_N=stiffest_N, stiffening=None)
    stiff = replace(weak, cable=steel)
    assert undominated([strong, stiff], at_any_tension=True) == (strong,)


G = 9.81
CABLE = Cable(0.006, 0.1, 2e6, 5e3)
CRANE = """
name: Crane
robot:
  anchors: [[0, 0, 12], [14, 0, 12], [6, 11, 12]]
  platform: {mass: 60 kg}
cable: {grade: unirope-6x36-iwrc-1960}
workspace:
  region: {box: [[4, 8], [3, 5], [2, 8]]}
  samples: 200
  proof: 0 s
selection: {grades: [unirope-6x36-iwrc-1960], safety_factor: 5}
load_cases:
  - name: pulled
    dynamic_factor: 1.2
    wrench_set: {force: [[-60, 90], [-80, 40], [-900, 250]]}
  - name: tool
    wrench_set: [{force: [50, 0, -400]}, {force: [-80, 20, 0]}]
"""


def straight_tension_N(exits_m: np.ndarray, place_m: np.ndarray, load_N: np.ndarray) -> float:
    """Return the least largest tension of straight cables; infinite where none holds the load."""
    along = (exits_m - place_m).T
    along = along / np.linalg.norm(along, axis=0)
    n = len(exits_m)
    held = np.column_stack([along, np.zeros(3)])
    below = np.column_stack([np.eye(n), -np.ones(n)])
    answer = linprog(
        np.eye(n + 1)[n], below, np.zeros(n), held, -load_N, bounds=[(0.0, None)] * (n + 1)
    )
    return float(answer.fun) if answer.status == 0 else np.inf


@pytest.mark.cases_by_default(1)
@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("n_cables", [3, 4])
def test_corners_bound_straight_cables(n_cables: int, seed: int) -> None:
    rng = np.random.default_rng([734, n_cables, seed])
    turn = 2.0 * np.pi * (np.arange(n_cables) + rng.uniform(-0.2, 0.2, n_cables)) / n_cables
    exits_m = np.column_stack(
        [8.0 * np.cos(turn), 8.0 * np.sin(turn), rng.uniform(8, 10, n_cables)]
    )
    robot, place = Robot(exits_m, Platform(80.0)), rng.uniform([-1, -1, 2], [1, 1, 5])
    ends = rng.uniform([-80, -80, -500], [80, 80, 200], (2, 3))
    bounds = [np.append(end, np.zeros(3)) for end in ends]
    case = LoadCase("box", dynamic_factor=1.3, wrench_set=WrenchSet.between(*bounds))
    loads = list(case.on(robot, CABLE))
    assert len(loads) == case.direction_count(robot) == 8
    corners = [float(solve_massless(one.robot, Poses.at(place)).largest_tension_N) for one in loads]
    shares = rng.uniform(size=(300, 3))
    weight = np.array([0.0, 0.0, -80.0 * G])
    forces = ends[0] + shares * (ends[1] - ends[0])
    inside = [straight_tension_N(exits_m, place, 1.3 * (weight + force)) for force in forces]
    assert max(inside) <= max(corners) * (1.0 + 1e-9)
    at_corners = [
        straight_tension_N(exits_m, place, 1.3 * weight + one.robot.platform.wrench_N[:3])
        for one in loads
    ]
    np.testing.assert_allclose(corners, at_corners, rtol=1e-7)


@pytest.fixture(scope="module")
def analysis(tmp_path_factory: pytest.TempPathFactory) -> designer.Analysis:
    path = Path(tmp_path_factory.mktemp("crane")) / "crane.yaml"
    path.write_text(CRANE, encoding="utf-8")
    return designer.analyse(designer.read_study(path))


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(3))
def test_no_wrench_of_a_box_asks_sagging_cables_for_more(
    analysis: designer.Analysis, seed: int
) -> None:
    rng = np.random.default_rng([91, seed])
    assert analysis.chosen is not None
    pulled, tool = analysis.chosen.cases
    places = rng.uniform([4, 3, 2], [8, 5, 8], (150, 3))
    for found, low, high in (
        (pulled, [-60, -80, -900], [90, 40, 250]),
        (tool, [50, 0, -400], [50, 0, -400]),
        (tool, [-80, 20, 0], [-80, 20, 0]),
    ):
        for _ in range(20):
            wrench_N = np.append(rng.uniform(low, high), np.zeros(3))
            robot, cable = found.loaded.bare
            other = found.case.under(robot, cable, wrench_N=wrench_N)
            statics = solve_sagging(other.robot, Poses.at(places), other.cable)
            assert statics.is_solved.all()
            most_N = found.verification.max_tension_N * (1.0 + 1e-6)
            assert statics.cable_tension_N.max() <= most_N
    assert pulled.utilisation > tool.utilisation


@pytest.mark.slow
def test_worst_wrench_is_in_words_and_files(analysis: designer.Analysis) -> None:
    pulled, tool = analysis.to_dict()["load_cases"]
    assert pulled["wrench_N"][2] == -900.0
    assert tool["wrench_N"][:3] in ([50.0, 0.0, -400.0], [-80.0, 20.0, 0.0])
    directions = [check["direction"] for check in analysis.to_dict()["checks"]]
    assert any("-900) N" in (direction or "") for direction in directions)


def test_the_inside_of_a_box_is_searched() -> None:
    robot = Robot(np.array([[0, 0, 9.0], [9, 0, 9], [4, 8, 9]]), Platform(50.0))
    ends = np.array([[-40.0, 0, -90, 0, 0, 0], [60.0, 0, 10, 0, 0, 0]])
    case = LoadCase("box", wrench_set=WrenchSet.between(*ends))
    peak = np.array([23.0, 0, -31, 0, 0, 0])

    def severity_of(loaded: Loaded) -> float:
        assert loaded.wrench_N is not None
        return -float(np.linalg.norm(loaded.wrench_N - peak))

    first = next(iter(case.on(robot, CABLE)))
    found, _ = worst_load_direction(first, severity_of(first), severity_of)
    assert found.wrench_N is not None
    np.testing.assert_allclose(found.wrench_N, peak, atol=1e-3)


def test_a_list_has_nothing_between() -> None:
    robot = Robot(np.array([[0, 0, 9.0], [9, 0, 9], [4, 8, 9]]), Platform(50.0))
    listed = LoadCase("list", wrench_set=WrenchSet(np.eye(6)[:3]))
    assert not any(one.is_direction_searched for one in listed.on(robot, CABLE))
    with pytest.raises(ValueError, match="1 to 64 wrenches"):
        WrenchSet(np.zeros((65, 6)))
    with pytest.raises(ValueError, match="exclude each other"):
        LoadCase("both", wrench_N=np.zeros(6), wrench_set=WrenchSet(np.eye(6)))
