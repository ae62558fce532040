"""How likely a rope is enough: against closed forms, brute force, and by its own definitions."""

from __future__ import annotations

from dataclasses import replace
from statistics import NormalDist

import numpy as np
import pytest
from brute_force import G, utilisation
from scipy.stats import binomtest
from selection.ropes import rope

from designer.analysis.uncertainty import (
    GoverningCandidates,
    UncertaintyAnalysis,
    draws_at,
    exact_interval,
    largest,
    searched,
    shares_of,
    uncertainty_of,
)
from designer.documents.plain import finite
from designer.effects.design import AsBuilt
from designer.grades.grade import Grade, Modulus
from designer.model.cable import Cable, Material
from designer.model.load_case import Ice, LoadCase, Wind
from designer.model.region import PointList, Prism
from designer.model.robot import Platform, Robot
from designer.model.uncertainty import Normal, Spread, Uncertainty, Uniform
from designer.model.workspace import Workspace
from designer.progress import SILENT
from designer.selection.result import SelectionResult
from designer.selection.select import select
from designer.study import Selection, Study

ANCHORS = np.array([[0.0, 0, 12], [30, 0, 12], [15, 26, 12]])
ROBOT = Robot(ANCHORS, Platform(180.0))
PLACES = np.array([[15.0, 9, 4], [8, 4, 2], [20, 5, 8], [15, 18, 6]])
FINE = [round(2.0 + 0.05 * k, 2) for k in range(80)]
POINTS = Workspace(PointList(PLACES))
STEEL = Material(5290.0, 62.7e9, 198e6)
ALL: dict[str, Spread] = {
    "payload": Normal(0.05),
    "modulus": Uniform(-0.15, 0.15),
    "linear_mass": Uniform(-0.05, 0.1),
    "breaking_load": Normal(0.04),
    "exit_points": Normal(0.1),
}


def study_of(
    uncertainty: Uncertainty | None = None,
    grade: Grade | None = None,
    robot: Robot = ROBOT,
    workspace: Workspace = POINTS,
    cases: tuple[LoadCase, ...] = (),
) -> tuple[Study, SelectionResult]:
    selection = Selection(safety_factor=5.0)
    grade = grade or rope("a", [4.0, 5.0, 6.0])
    found = select(robot, workspace, selection, [grade], load_cases=cases)
    study = Study(
        "a", robot, STEEL, workspace=workspace, selection=selection, uncertainty=uncertainty,
        load_cases=cases,
    )  # fmt: skip
    return study, found


def odds(study: Study, found: SelectionResult) -> UncertaintyAnalysis:
    known = uncertainty_of(study, found, AsBuilt(study.robot), SILENT)
    assert known is not None
    return known


def printed(grade: Grade, uncertainty: float = 0.15) -> Grade:
    modulus = Modulus(62.7e9, "nominal", "printed", "a sheet", uncertainty)
    return replace(grade, modulus=modulus)


@pytest.mark.slow
def test_a_payload_on_all_but_weightless_ropes_has_its_closed_form() -> None:
    # Tension is proportional to the payload: u = u0 p / b, and p - b / u0 is normal.
    grade = printed(rope("light", FINE, weight=1e-6), 0.0)
    asked = Uncertainty(payload=Normal(0.06), breaking_load=Normal(0.05), samples=20_000)
    study, chosen = study_of(asked, grade)
    found = odds(study, chosen)
    stated = found.chosen.candidate.verification.utilisation
    exact = NormalDist().cdf((1 / stated - 1) / np.hypot(0.06, 0.05 / stated))
    assert 0.5 < exact < 0.999
    low, high = found.chosen.probability_95
    assert low < exact < high
    assert high - low < 0.02
    shares = {one.input: one for one in found.shares}
    slope = np.array([0.06, 0.05])  # of log u: of first order the shares of the squares
    first = slope**2 / (slope**2).sum()
    for name, share in zip(("payload", "breaking_load"), first, strict=True):
        assert shares[name].first_order == pytest.approx(share, abs=0.03)


def test_shares_of_a_sum_and_of_ishigamis_function() -> None:
    from scipy.special import ndtri

    a = np.array([3.0, 2.0, 1.0])
    found = shares_of(
        lambda x: ndtri(x) @ a, {k: slice(i, i + 1) for i, k in enumerate("abc")}, 128, 1
    )
    for one, exact in zip(found, a**2 / (a**2).sum(), strict=True):
        assert one.first_order_95[0] - 0.01 < exact < one.first_order_95[1] + 0.01
        assert one.total_order == pytest.approx(exact, abs=0.01)

    def ishigami(x: np.ndarray) -> np.ndarray:
        y = np.pi * (2 * x - 1)
        return np.sin(y[:, 0]) + 7 * np.sin(y[:, 1]) ** 2 + 0.1 * y[:, 2] ** 4 * np.sin(y[:, 0])

    found = shares_of(ishigami, {k: slice(i, i + 1) for i, k in enumerate("abc")}, 1024, 1)
    assert [one.first_order for one in found] == pytest.approx([0.3139, 0.4424, 0.0], abs=0.01)
    assert [one.total_order for one in found] == pytest.approx([0.5576, 0.4424, 0.2437], abs=0.01)


def test_first_order_of_few_draws_scatters_little() -> None:
    from scipy.special import ndtri

    a = np.array([1.0, 0.8, 0.5, 0.3, 0.2])
    columns = {k: slice(i, i + 1) for i, k in enumerate("abcde")}
    exact = a**2 / (a**2).sum()
    for seed in range(3):
        found = shares_of(lambda x: ndtri(x) @ a, columns, 32, seed)
        assert [one.first_order for one in found] == pytest.approx(exact, abs=0.03)
        assert found[-1].first_order == pytest.approx(exact[-1], abs=0.005)


def test_coordinates_of_one_input_share_as_one() -> None:
    columns = {"a": slice(0, 1), "b": slice(1, 4)}
    found = shares_of(lambda x: x.sum(axis=1), columns, 256, 0)
    assert [one.first_order for one in found] == pytest.approx([0.25, 0.75], abs=0.01)


def test_no_shares_without_a_variance() -> None:
    with pytest.raises(ValueError, match="does not vary"):
        shares_of(lambda x: np.ones(len(x)), {"a": slice(0, 1)}, 16, 0)
    with pytest.raises(ValueError, match="is not held"):
        shares_of(lambda x: np.where(x[:, 0] < 0.5, x[:, 0], np.inf), {"a": slice(0, 1)}, 16, 0)


@pytest.mark.parametrize(("successes", "trials"), [(0, 10), (10, 10), (3, 7), (4060, 4096)])
def test_the_interval_is_the_exact_one(successes: int, trials: int) -> None:
    exact = binomtest(successes, trials).proportion_ci(0.95, "exact")
    assert exact_interval(successes, trials) == pytest.approx((exact.low, exact.high), rel=1e-9)


@pytest.mark.parametrize(("seed", "exits"), [(11, True), (12, True), (13, False)])
def test_each_draw_is_what_brute_force_finds_on_random_robots(seed: int, exits: bool) -> None:
    rng = np.random.default_rng(seed)
    anchors = ANCHORS + rng.uniform(-3, 3, (3, 3))
    robot = Robot(anchors, Platform(float(rng.uniform(50, 400))))
    cable = Cable(0.006, rng.uniform(0.1, 1.0), rng.uniform(2e5, 3e6), 3000.0)
    places = rng.dirichlet([3, 3, 3], 4) @ anchors - [0, 0, 1] * rng.uniform(3, 8, (4, 1))
    spreads = {name: one for name, one in ALL.items() if exits or name != "exit_points"}
    draws = draws_at(spreads, robot, rng.random((12, 13 if exits else 4)))
    (loaded,) = LoadCase("static").on(robot, cable)
    asked = GoverningCandidates(loaded, replace(POINTS, region=PointList(places)), places)
    ours = asked.utilisation(draws)
    for k in range(len(draws)):
        figures = (
            draws.linear_mass[k] * cable.linear_density_kg_per_m,
            draws.modulus[k] * cable.axial_stiffness_N,
            draws.breaking_load[k] * cable.allowable_tension_N,
        )
        load = np.array([0, 0, -draws.payload[k] * robot.platform.mass_kg * G])
        theirs = [utilisation(anchors + draws.exit_points_m[k], at, load, figures) for at in places]
        np.testing.assert_allclose(ours[k], theirs, rtol=1e-6, err_msg=f"seed {seed}, draw {k}")


@pytest.mark.slow
def test_probability_against_brute_force_sampling() -> None:
    asked = Uncertainty(
        payload=ALL["payload"], modulus=ALL["modulus"], linear_mass=ALL["linear_mass"],
        breaking_load=ALL["breaking_load"], exit_points_m=ALL["exit_points"], samples=2000,
    )  # fmt: skip
    study, chosen = study_of(asked, rope("a", FINE))
    found = odds(study, chosen)
    size = found.chosen.candidate.size
    rng, count, enough = np.random.default_rng(21), 1000, 0
    cable = found.chosen.candidate.cable
    for _ in range(count):
        payload, strong = 1 + 0.05 * rng.normal(), 1 + 0.04 * rng.normal()
        figures = (
            size.linear_density_kg_per_m * rng.uniform(0.95, 1.1),
            cable.axial_stiffness_N * rng.uniform(0.85, 1.15),
            size.minimum_breaking_load_N * strong / 5.0,
        )
        exits, load = ANCHORS + rng.normal(0, 0.1, (3, 3)), np.array([0, 0, -180 * payload * G])
        enough += all(utilisation(exits, at, load, figures) <= 1 for at in PLACES)
    theirs = binomtest(enough, count).proportion_ci(0.999, "exact")
    low, high = found.chosen.probability_95
    assert 0.05 < found.chosen.probability < 0.999
    assert theirs.low < high
    assert low < theirs.high


@pytest.mark.slow
def test_one_pass_and_one_by_one_agree(six_cable_robot: Robot, monkeypatch) -> None:
    rng = np.random.default_rng(22)
    wrench = np.array([300.0, -200, 100, 0, 0, 0])
    heavy = replace(six_cable_robot, platform=replace(six_cable_robot.platform, wrench_N=wrench))
    places = np.array([[5.0, -3, -60], [0, 0, -40], [-20, 10, -80]])
    spreads = {name: one for name, one in ALL.items() if name != "exit_points"}
    case = LoadCase("cold", ice=Ice(0.005), acceleration_m_per_s2=0.3, dynamic_factor=1.2)
    for robot, at in ((heavy, places), (ROBOT, PLACES)):
        draws = draws_at(spreads, robot, rng.random((20, 4)))
        loaded = list(case.on(robot, Cable(0.02, 1.5, 2e7, 1e5)))[3]
        asked = GoverningCandidates(loaded, replace(POINTS, region=PointList(at)), at)
        assert asked.is_one_pass
        together = asked.utilisation(draws)
        monkeypatch.setattr(GoverningCandidates, "is_one_pass", False)
        np.testing.assert_allclose(together, asked.utilisation(draws), rtol=1e-7)
        monkeypatch.undo()


@pytest.mark.parametrize("is_planar", [False, True])
def test_moved_exit_points_in_one_batch_and_one_by_one_agree(is_planar, monkeypatch) -> None:
    rng = np.random.default_rng(23)
    body = Platform(180.0, wrench_N=np.array([100.0, 0, -50, 0, 0, 0]))
    exits = ANCHORS[:2] if is_planar else ANCHORS
    robot = Robot(exits, body, is_planar=is_planar, tilt_rad=np.array([0.0, 0.02]))
    robot = replace(robot, tilt_rad=np.zeros(2)) if is_planar else robot
    places = PLACES * [1, 0, 1] if is_planar else PLACES
    case = LoadCase("cold", ice=Ice(0.002), acceleration_m_per_s2=0.3)
    loaded = list(case.on(robot, Cable(0.005, 0.15, 1.2e6, 4000.0)))[2]
    asked = GoverningCandidates(loaded, replace(POINTS, region=PointList(places)), places)
    draws = draws_at(ALL, robot, rng.random((25, 4 + 3 * robot.n_cables)))
    together = asked.utilisation(draws)
    monkeypatch.setattr(GoverningCandidates, "is_one_pass", False)
    np.testing.assert_allclose(together, asked.utilisation(draws), rtol=1e-7)


def test_wind_and_lost_cables_are_solved_one_by_one() -> None:
    body = replace(ROBOT, platform=replace(ROBOT.platform, drag_area_m2=1.0))
    cable = Cable(0.006, 0.15, 1.7e6, 5000.0)
    windy = next(LoadCase("w", wind=Wind(10.0, 1.2, 4)).on(body, cable))
    lost = next(LoadCase("l", cable_lost=1).on(body, cable))
    assert not GoverningCandidates(windy, POINTS, PLACES).is_one_pass
    assert not GoverningCandidates(lost, POINTS, PLACES).is_one_pass
    draws = draws_at({"payload": Normal(0.1)}, body, np.array([[0.1], [0.5], [0.9]]))
    light, stated, heavy = GoverningCandidates(windy, POINTS, PLACES).utilisation(draws).max(axis=1)
    assert light < stated < heavy


def test_exit_points_of_a_planar_robot_stay_in_its_plane() -> None:
    exits = np.array([[0.0, 0, 10], [6.0, 8.0, 10]])
    robot = Robot(exits, Platform(100.0), is_planar=True)
    draws = draws_at({"exit_points": Normal(0.1)}, robot, np.random.default_rng(0).random((9, 6)))
    np.testing.assert_allclose(draws.exit_points_m @ [-0.8, 0.6, 0.0], 0.0, atol=1e-15)
    assert (np.abs(draws.exit_points_m @ [0.6, 0.8, 0.0]) > 0.0).all()


def test_the_search_adds_poses_that_are_worse() -> None:
    box = Workspace(Prism.box((10, 20), (6, 10), (2, 8)))
    cable = Cable(0.005, 0.1, 1.2e6, 4000.0)
    (loaded,) = LoadCase("static").on(ROBOT, cable)
    best = GoverningCandidates(loaded, box, np.array([[15.0, 8, 3]]))
    draws = draws_at({"payload": Normal(0.1)}, ROBOT, np.random.default_rng(1).random((40, 1)))
    first = largest([best], draws)
    more, used, checked = searched([best], draws, first)
    assert len(more) > 1
    assert checked.rounds > 1
    assert checked.missed == 0.0
    assert (used > 1.05 * first).all()
    rng = np.random.default_rng(2)
    dense = rng.uniform([10, 6, 2], [20, 10, 8], (3000, 3))
    assert (
        used >= GoverningCandidates(loaded, box, dense).utilisation(draws).max(axis=1) * (1 - 1e-9)
    ).all()


def test_what_is_not_held_is_not_enough_and_said() -> None:
    # A pose near the side of the triangle: with its exit points moved it lies outside.
    near = Workspace(PointList(np.array([[15.0, 0.5, 5.0]])))
    asked = Uncertainty(exit_points_m=Normal(0.3), payload=Normal(0.02), samples=300)
    study, chosen = study_of(asked, rope("a", [4.0, 8.0, 12.0], weight=1e-3), workspace=near)
    found = odds(study, chosen)
    assert 0 < found.chosen.not_held < 300
    assert found.chosen.enough + found.chosen.not_held <= 300
    assert found.shares == ()
    assert "not held" in found.why_no_shares
    plain = finite(found.to_dict())
    assert plain is not None
    assert plain["not_held"] == found.chosen.not_held
    assert plain["shares_reason"] == found.why_no_shares


def test_sizes_beside_and_the_same_again() -> None:
    asked = Uncertainty(payload=Normal(0.05), breaking_load=Normal(0.05), samples=400)
    study, chosen = study_of(asked, rope("a", [4.0, 4.4, 4.55, 6.0]))
    one, same = odds(study, chosen), odds(study, chosen)
    names = [size.candidate.size.id for size in one.sizes]
    assert names == ["4.4 mm", "4.55 mm", "6 mm"]
    down, own, up = (size.probability for size in one.sizes)
    assert down < own < up
    assert finite(one.to_dict()) == finite(same.to_dict())
    np.testing.assert_array_equal(one.chosen.utilisation, same.chosen.utilisation)
    used, reported = one.chosen.utilisation, one.to_dict()["utilisation"]
    shares = [np.mean(used <= reported[name]) for name in ("p05", "median", "p95", "largest")]
    assert shares == pytest.approx([0.05, 0.5, 0.95, 1.0], abs=0.005)
    other = odds(replace(study, uncertainty=replace(asked, seed=1)), chosen)
    assert not np.array_equal(one.chosen.utilisation, other.chosen.utilisation)


def test_without_a_block_only_a_borrowed_modulus_is_drawn() -> None:
    study, chosen = study_of()
    found = odds(study, chosen)
    assert not found.is_asked
    assert dict(found.spreads) == {"modulus": Uniform(-0.15, 0.15)}
    assert [one.first_order for one in found.shares] == [1.0]
    stated = found.chosen.candidate.verification.utilisation
    assert found.chosen.utilisation.min() < stated < found.chosen.utilisation.max()
    study, chosen = study_of(grade=printed(rope("a", [4.0, 5.0, 6.0])))
    assert uncertainty_of(study, chosen, AsBuilt(ROBOT), SILENT) is None
    asked = replace(study, uncertainty=Uncertainty(payload=Normal(0.01), samples=100))
    assert set(odds(asked, chosen).spreads) == {"payload", "modulus"}
    certain = Uncertainty(payload=Normal(0.01), modulus=Normal(0.0), samples=100)
    assert set(odds(replace(study, uncertainty=certain), chosen).spreads) == {"payload"}


def test_nothing_without_a_rope_or_without_an_uncertain_input() -> None:
    study, none = study_of(Uncertainty(payload=Normal(0.1)), rope("a", [1.0]))
    assert none.chosen is None
    assert uncertainty_of(study, none, AsBuilt(ROBOT), SILENT) is None
    study, chosen = study_of(Uncertainty(modulus=Normal(0.0)))
    assert uncertainty_of(study, chosen, AsBuilt(ROBOT), SILENT) is None


def test_the_case_that_governs_may_change_from_draw_to_draw() -> None:
    calm, hoist = LoadCase("calm", safety_factor=6.0), LoadCase("hoist", dynamic_factor=1.195)
    asked = Uncertainty(linear_mass=Uniform(-0.5, 2.0), samples=200)
    study, chosen = study_of(asked, printed(rope("a", [5.0, 6.0]), 0.0), cases=(calm, hoist))
    found = odds(study, chosen)
    each = []
    for case in (calm, hoist):
        alone = replace(study, load_cases=(case,))
        _, picked = study_of(asked, printed(rope("a", [5.0, 6.0]), 0.0), cases=(case,))
        each.append(odds(alone, picked).chosen.utilisation)
    np.testing.assert_allclose(found.chosen.utilisation, np.maximum(*each), rtol=1e-9)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: Normal(-0.1), "standard_deviation"),
        (lambda: Uniform(0.2, 0.1), "high"),
        (lambda: Uncertainty(payload=Normal(0.5)), "payload"),
        (lambda: Uncertainty(breaking_load=Uniform(-1.0, 0.0)), "breaking_load"),
        (lambda: Uncertainty(samples=0), "samples"),
        (lambda: Study("a", ROBOT, STEEL, uncertainty=Uncertainty()), "needs? a selection|need a"),
    ],
)
def test_what_cannot_be_is_refused(make, message) -> None:
    with pytest.raises(ValueError, match=message):
        make()


def test_a_draw_that_leaves_out_the_kept_poses_is_judged_by_others() -> None:
    """A heavy cable hangs below the one pose that is kept, and not below the other."""
    robot = Robot(ANCHORS, Platform(40.0))
    places = np.array([[3.0, 2.0, 11.0], [15.0, 9.0, 4.0]])
    workspace = Workspace(PointList(places), hangs_below="exclude")
    cable = Cable(0.012, 0.8, 5e6, 2e4)
    (loaded,) = LoadCase("static").on(robot, cable)
    draws = draws_at({"payload": Normal(0.01)}, robot, np.linspace(0.2, 0.8, 3)[:, None])
    asked = [GoverningCandidates(loaded, workspace, places[:1])]
    assert np.isneginf(asked[0].utilisation(draws)).all()
    both = GoverningCandidates(loaded, workspace, places).utilisation(draws)
    assert np.isfinite(both[:, 1]).all()
    assert largest(asked, draws) == pytest.approx(both[:, 1], rel=1e-12)
    alone = replace(workspace, region=PointList(places[:1]))
    assert np.isposinf(largest([GoverningCandidates(loaded, alone, places[:1])], draws)).all()
