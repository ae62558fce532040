"""Products for groups of cables: brute force finds the same, and nothing is cut off wrongly.

Bounds on which the choice for groups rests, against catenaries; and what its programme tells.
"""

from __future__ import annotations

import subprocess
import sys
from dataclasses import replace
from itertools import product
from typing import Any

import cvxpy as cp
import numpy as np
import pytest
from scipy.optimize import brentq

from designer.arrays import FloatArray, frozen_array
from designer.cli.tables import _summary_of_groups
from designer.effects.design import AsBuilt
from designer.grades.grade import Grade, Modulus, Reference, Size
from designer.model.cable import Cable, Cables
from designer.model.region import PointList, Prism
from designer.model.robot import Poses, Robot
from designer.model.workspace import Workspace
from designer.selection.candidate import Candidate, priced, undominated
from designer.selection.groups import GroupChoice, Master, choose_groups, choose_groups_of
from designer.selection.refutation import (
    Trials,
    _least_moment_m2,
    balance_at,
    block_by_trial,
    block_by_weight,
    is_monotone,
    verify_groups,
)
from designer.selection.select import select
from designer.statics.inverse import solve_sagging
from designer.study import CableGroup, Selection
from designer.workspace.demand import is_left_out

pytestmark = pytest.mark.slow

# Strength per mass scatters as it does in tables, so that no size is just a scaled other one.
SCATTER = (1.0, 0.9, 1.12, 1.0, 0.95, 1.1, 0.97, 1.05)


def rope(diameters_mm: list[float], name: str = "rope", modulus_Pa: float = 62.7e9) -> Grade:
    sizes = tuple(
        Size(
            id=f"{d:g} mm",
            diameter_m=d / 1e3,
            minimum_breaking_load_N=780.0 * d**2 * SCATTER[k % 8],
            linear_density_kg_per_m=4.15e-3 * d**2,
        )
        for k, d in enumerate(diameters_mm)
    )
    modulus = Modulus(modulus_Pa, "nominal", "borrowed", "a like rope", 0.15)
    source = Reference("a", "b")
    return Grade(
        id=name,
        manufacturer="maker",
        product="rope",
        construction="7x19",
        core="WSC",
        finish="bright",
        sizes=sizes,
        source=source,
        trust="B",
        modulus=modulus,
    )


def candidates_of(grade: Grade, safety_factor: float = 5.0) -> tuple[Candidate, ...]:
    return tuple(Candidate(grade, size, grade.cable(size, safety_factor)) for size in grade.sizes)


def points_in(low_m: list[float], high_m: list[float], count: int = 40) -> FloatArray:
    return frozen_array(np.random.default_rng(4).uniform(low_m, high_m, (count, 3)))


def three(fast_robot: Robot) -> tuple[Robot, Workspace]:
    """Positions near one side, so that the far cable carries less."""
    return fast_robot, Workspace(PointList(points_in([150, 60, -160], [260, 130, -70])))


def six(six_cable_robot: Robot) -> tuple[Robot, Workspace]:
    """Positions to one side, so that the masts carry unequal shares."""
    return six_cable_robot, Workspace(PointList(points_in([-10, -20, -110], [30, 10, -60])))


@pytest.fixture(params=[three, six], ids=["3 cables", "6 cables"])
def case(request, fast_robot, six_cable_robot) -> tuple[Robot, Workspace]:
    return request.param(fast_robot if request.param is three else six_cable_robot)


def groups_of(robot: Robot, count: int = 3) -> list[CableGroup]:
    parts = np.array_split(np.arange(1, robot.n_cables + 1), count)
    return [CableGroup(f"group {k}", tuple(int(c) for c in part)) for k, part in enumerate(parts)]


EIGHT = {
    3: [16.0, 18.0, 20.0, 22.0, 24.0, 26.0, 28.0, 30.0],
    6: [9.0, 10.0, 11, 12, 13, 14, 15, 16],
}


def mass_by_hand(
    robot: Robot, workspace: Workspace, groups: list[CableGroup], chosen: tuple[Candidate, ...]
) -> float:
    """Mass of all cables at their longest; inf if they do not hold. Nothing of the search's."""
    of_cable = {c: one for group, one in zip(groups, chosen, strict=True) for c in group.cables}
    each = [of_cable[c].cable for c in range(1, robot.n_cables + 1)]
    assert isinstance(workspace.region, PointList)
    statics = solve_sagging(robot, Poses.at(workspace.region.points_m), Cables(tuple(each)))
    counts = ~is_left_out(statics, workspace.hangs_below)
    allowable = np.array([cable.allowable_tension_N for cable in each])
    tension = np.maximum(statics.exit_tension_N, statics.platform_tension_N)[counts]
    if not (statics.is_solved[counts].all() and (tension <= allowable).all()):
        return np.inf
    density = np.array([cable.linear_density_kg_per_m for cable in each])
    return float(density @ statics.length_m[counts].max(axis=0))


_BY_HAND: dict[tuple[object, ...], float] = {}
"""Masses of assignments, each computed once for all tests."""


def lightest_by_hand(
    robot: Robot,
    workspace: Workspace,
    groups: list[CableGroup],
    products: tuple[Candidate, ...],
    most_distinct: int,
) -> float:
    def mass(chosen: tuple[Candidate, ...]) -> float:
        assert isinstance(workspace.region, PointList)
        asked = robot, workspace.hangs_below, [one.cables for one in groups]
        of = (*map(repr, asked), workspace.region.points_m.tobytes(), *(c.cable for c in chosen))
        if of not in _BY_HAND:
            _BY_HAND[of] = mass_by_hand(robot, workspace, groups, chosen)
        return _BY_HAND[of]

    return min(
        mass(chosen)
        for chosen in product(products, repeat=len(groups))
        if len({one.size.id for one in chosen}) <= most_distinct
    )


def check_against_hand(choice: GroupChoice, truth: float) -> None:
    assert choice.proof == "optimal"
    assert choice.chosen.is_found
    assert choice.chosen.verification.holds
    assert choice.chosen.total_mass_kg == pytest.approx(truth, rel=1e-12)
    assert choice.gap == 0.0


@pytest.mark.parametrize("most_distinct", [1, 2, 3])
def test_brute_force_finds_the_same(case, most_distinct) -> None:
    robot, workspace = case
    groups = groups_of(robot)
    products = candidates_of(rope(EIGHT[robot.n_cables]))
    truth = lightest_by_hand(robot, workspace, groups, products, most_distinct)
    assert np.isfinite(truth)
    choice = choose_groups(robot, workspace, groups, products, most_distinct=most_distinct)
    check_against_hand(choice, truth)
    assert choice.chosen.is_found
    assert len({one.size.id for one in choice.chosen.ropes}) <= most_distinct


def test_groups_save_mass_where_loads_differ(case) -> None:
    robot, workspace = case
    groups, products = groups_of(robot), candidates_of(rope(EIGHT[robot.n_cables]))
    one = choose_groups(robot, workspace, groups, products, most_distinct=1)
    assert one.chosen.is_found
    single = one.chosen.ropes[0]
    choice = choose_groups(robot, workspace, groups, products, single=single)
    assert choice.saving_kg is not None
    assert choice.saving_kg > 0.02 * one.chosen.total_mass_kg
    assert choice.single.is_found
    assert choice.single.total_mass_kg == pytest.approx(one.chosen.total_mass_kg, rel=1e-12)


def test_without_its_shortcuts_the_search_finds_the_same(case, monkeypatch) -> None:
    """Neither balance nor weight: every lighter assignment is solved."""
    robot, workspace = case
    monkeypatch.setattr("designer.selection.groups.is_sound", lambda *_: False)
    monkeypatch.setattr("designer.selection.groups.is_monotone", lambda *_: False)
    groups, products = groups_of(robot), candidates_of(rope(EIGHT[robot.n_cables]))
    choice = choose_groups(robot, workspace, groups, products)
    check_against_hand(choice, lightest_by_hand(robot, workspace, groups, products, 3))
    assert "balance" not in choice.proof_sentence
    assert "heavier" not in choice.proof_sentence


def test_the_argument_on_weight_cuts_whole_blocks(fast_robot) -> None:
    robot, workspace = three(fast_robot)
    choice = choose_groups(robot, workspace, groups_of(robot), candidates_of(rope(EIGHT[3])))
    assert choice.by_weight
    assert max(one.excluded for one in choice.proposals) > 8


def test_balance_alone_finds_the_same(fast_robot, monkeypatch) -> None:
    robot, workspace = three(fast_robot)
    monkeypatch.setattr("designer.selection.groups.is_monotone", lambda *_: False)
    groups, products = groups_of(robot), candidates_of(rope(EIGHT[3]))
    choice = choose_groups(robot, workspace, groups, products)
    assert choice.by_balance
    check_against_hand(choice, lightest_by_hand(robot, workspace, groups, products, 3))


@pytest.mark.parametrize("change", ["pulleys", "exclude"])
def test_robots_without_a_shortcut(fast_robot, change) -> None:
    robot, workspace = three(fast_robot)
    if change == "pulleys":
        robot = replace(robot, pulley_radius_m=0.5)
    else:
        workspace = replace(workspace, hangs_below="exclude")
    groups, products = groups_of(robot), candidates_of(rope(EIGHT[3]))
    choice = choose_groups(robot, workspace, groups, products)
    assert not choice.by_balance
    assert not choice.by_weight
    truth = lightest_by_hand(robot, workspace, groups, products, 3)
    assert choice.chosen.is_found
    assert choice.chosen.total_mass_kg == pytest.approx(truth, rel=1e-12)
    assert choice.lengths_are_bounds == (change == "pulleys")


def test_answer_holds_between_the_samples(fast_robot) -> None:
    prism = Prism.box((150.0, 300.0), (80.0, 200.0), (-160.0, -70.0))
    workspace = Workspace(prism, samples=300)
    groups, products = groups_of(fast_robot), candidates_of(rope(EIGHT[3], modulus_Pa=60e9), 3.0)
    choice = choose_groups(fast_robot, workspace, groups, products)
    assert choice.proof == "optimal"
    assert choice.chosen.is_found
    cables = Cables(tuple(one.cable for one in choice.chosen.ropes))
    inside = np.random.default_rng(1).uniform(*prism.bounds_m, (20_000, 3))
    corners = np.array(list(product(*prism.bounds_m.T)))
    at = Poses.at(np.concatenate([inside, corners]))
    used = solve_sagging(fast_robot, at, cables).cable_tension_N / cables.allowable_tension_N
    found = choice.chosen.verification
    assert np.allclose(used.max(axis=0), found.utilisation, rtol=1e-9, atol=0)
    at_worst = solve_sagging(fast_robot, Poses.at(found.worst_place), cables).cable_tension_N
    again = np.diag(at_worst) / cables.allowable_tension_N
    assert np.allclose(again, found.utilisation, rtol=1e-9, atol=0)


@pytest.mark.parametrize("is_feasible", [True, False])
def test_balance_lets_pass_what_holds_and_not_much_more(case, is_feasible) -> None:
    """Cables that are used fully in a pose, elastic and sagging, pass; weaker ones do not.

    The constraints are sharper for three cables, where each must pull with some force.
    """
    import cvxpy as cp

    robot, workspace = case
    share = 1.0 + 1e-6 if is_feasible else {3: 0.98, 6: 0.7}[robot.n_cables]
    rng = np.random.default_rng(7)
    grade = rope([16.0] * 3)
    members = [np.array(group.cables) - 1 for group in groups_of(robot)]
    answers = []
    for position in _near(workspace):
        weights = rng.uniform(0.1, 6.0, 3)
        softness = rng.uniform(0.3, 1.0, 3)
        each = [Cable(0.02, w, 2e7 * s, 1.0) for w, s in zip(weights, softness, strict=True)]
        bare = tuple(Candidate(grade, grade.sizes[0], cable) for cable in each)
        cables = Trials(robot, workspace, bare, members).cables((0, 1, 2))
        statics = solve_sagging(robot, Poses.at(position), cables)
        if not statics.is_solved:
            continue
        tension = [float(statics.cable_tension_N[cables].max()) for cables in members]
        full = tuple(
            replace(one, cable=replace(one.cable, allowable_tension_N=share * t))
            for one, t in zip(bare, tension, strict=True)
        )
        balance = balance_at(robot, position, full, members)
        assert balance is not None
        x = cp.Constant(np.eye(3).ravel())
        problem = cp.Problem(cp.Minimize(0), balance.constraints(x))
        problem.solve(solver=cp.HIGHS)
        answers.append(problem.status == "optimal")
    assert len(answers) > 30
    assert np.mean(answers) == 1.0 if is_feasible else np.mean(answers) < 0.1


def _near(workspace: Workspace) -> FloatArray:
    assert isinstance(workspace.region, PointList)
    return workspace.region.points_m


def test_no_member_of_a_block_by_weight_holds(fast_robot) -> None:
    robot, workspace = three(fast_robot)
    assert is_monotone(robot, workspace)
    products = candidates_of(rope([8, 12, 16, 20, 24, 28, 32, 36]))
    members = [np.array([0]), np.array([1]), np.array([2])]
    trials = Trials(robot, workspace, products, members)
    trials.add_witnesses(_near(workspace))
    sizes = []
    for assignment in product(range(8), repeat=3):
        refuted = trials.refutation(assignment)
        if refuted is None or sum(assignment) % 5:
            continue
        block = block_by_weight(trials, assignment, refuted.group)
        assert assignment in set(product(*block))
        sizes.append(np.prod([len(s) for s in block]))
        assert all(trials.refutation(one) is not None for one in product(*block))
    assert max(sizes) > 50


def test_no_member_of_a_block_by_trial_holds(six_cable_robot) -> None:
    robot, workspace = six(six_cable_robot)
    assert not is_monotone(robot, workspace)
    products = candidates_of(rope(EIGHT[6]))
    trials = Trials(robot, workspace, products, [np.arange(0, 2), np.arange(2, 4), np.arange(4, 6)])
    trials.add_witnesses(_near(workspace))
    refuted = trials.refutation((0, 0, 0))
    assert refuted is not None
    block = block_by_trial(trials, (0, 0, 0), refuted.group, lambda _: True, 600)
    assert len(set(product(*block))) > 8
    assert all(trials.refutation(one) is not None for one in product(*block))


def test_stopped_early_it_reports_a_true_bound(case) -> None:
    robot, workspace = case
    groups, products = groups_of(robot), candidates_of(rope(EIGHT[robot.n_cables]))
    truth = lightest_by_hand(robot, workspace, groups, products, 3)
    strongest = products[-1]
    choice = choose_groups(robot, workspace, groups, products, single=strongest, most_proposals=0)
    assert choice.proof == "stopped"
    assert choice.gap is not None
    assert choice.gap > 0.0
    assert choice.bound <= truth
    assert "Stopped after 0 proposals" in choice.proof_sentence


def test_too_thin_for_all_is_proved(case) -> None:
    robot, workspace = case
    products = candidates_of(rope([2.0, 3.0, 4.0]))
    choice = choose_groups(robot, workspace, groups_of(robot), products)
    assert not choice.chosen.is_found
    assert choice.proof == "infeasible"
    assert choice.gap is None


def test_nothing_offered(fast_robot) -> None:
    robot, workspace = three(fast_robot)
    choice = choose_groups(robot, workspace, groups_of(robot), [])
    assert not choice.chosen.is_found
    assert choice.proposals == ()


def test_beaten_products_are_not_offered() -> None:
    good, weak = rope([10.0, 12.0], "good"), rope([10.0, 12.0], "weak")
    sizes = tuple(
        replace(
            size,
            minimum_breaking_load_N=0.9 * size.minimum_breaking_load_N,
            linear_density_kg_per_m=1.01 * size.linear_density_kg_per_m,
        )
        for size in weak.sizes
    )
    weak = replace(weak, sizes=sizes)
    softer = replace(weak, id="softer", modulus=replace(good.modulus, value_Pa=10e9))
    offered = undominated([*candidates_of(weak), *candidates_of(good), *candidates_of(softer)])
    assert [one.label for one in offered] == [
        "10 mm of good", "10 mm of softer", "12 mm of good", "12 mm of softer",
    ]  # fmt: skip
    assert [one.label for one in undominated([*candidates_of(good)] * 2)] == [
        "10 mm of good", "12 mm of good",
    ]  # fmt: skip


def test_cost_decides_where_the_study_says_so(fast_robot) -> None:
    robot, workspace = three(fast_robot)
    groups, grade = groups_of(robot), rope(EIGHT[3])
    dear = replace(
        grade,
        id="dear",
        currency="EUR",
        sizes=tuple(replace(s, price_per_m=300.0 * s.diameter_m) for s in grade.sizes),
    )
    cheap = replace(
        dear,
        id="cheap",
        sizes=tuple(
            replace(
                s,
                price_per_m=200.0 * s.diameter_m,
                linear_density_kg_per_m=1.1 * s.linear_density_kg_per_m,
            )
            for s in grade.sizes
        ),
    )
    other = replace(dear, id="other", currency="USD", sizes=dear.sizes[:3])
    products = tuple(c for each in (grade, dear, cheap, other) for c in candidates_of(each))
    assert {one.grade.id for one in priced(products)} == {"dear", "cheap"}
    choice = choose_groups(robot, workspace, groups, products, objective="cost")
    assert choice.unit == "EUR"
    assert choice.chosen.is_found
    assert {one.grade.id for one in choice.chosen.ropes} == {"cheap"}
    longest = choice.chosen.verification.longest_m
    prices = [one.size.price_per_m for one in choice.chosen.ropes]
    assert choice.total == pytest.approx(float(np.dot(prices, longest)))
    told = dict(_summary_of_groups(choice, None))
    assert choice.proof == "optimal"
    assert told["  groups' cost"] == f"{choice.total:.4g} EUR in all; proved least"
    assert "proved" not in told["  groups' mass"]
    by_mass = choose_groups(robot, workspace, groups, products)
    assert by_mass.chosen.is_found
    assert by_mass.chosen.total_mass_kg < choice.chosen.total_mass_kg


def test_study_with_effects_and_safety_factor(fast_robot) -> None:
    """The single product of the selection is where the search starts, as built."""
    robot, workspace = three(fast_robot)
    grade = rope(EIGHT[3])
    built = AsBuilt(
        robot,
        lambda cable: replace(
            cable,
            linear_density_kg_per_m=1.1 * cable.linear_density_kg_per_m,
            axial_stiffness_N=0.9 * cable.axial_stiffness_N,
        ),
    )
    selection = Selection(None, 5.0, groups=tuple(groups_of(robot)), max_distinct_products=2)
    single = select(robot, workspace, selection, [grade], built=built).chosen
    assert single is not None
    choice = choose_groups_of(workspace, selection, [grade], built, single)
    assert choice.single.is_found
    assert choice.single.total_mass_kg == pytest.approx(single.total_mass_kg, rel=1e-12)
    assert choice.most_distinct == 2
    heavier = [Candidate(grade, s, built.cable(grade.cable(s, 5.0))) for s in grade.sizes]
    truth = lightest_by_hand(robot, workspace, groups_of(robot), tuple(heavier), 2)
    check_against_hand(choice, truth)


def test_verification_that_fails_says_where(fast_robot) -> None:
    robot, workspace = three(fast_robot)
    thin = candidates_of(rope([10.0]))[0].cable
    found = verify_groups(robot, workspace, Cables((thin,) * 3), [np.arange(3)])
    assert not found.holds
    there = solve_sagging(robot, Poses.at(found.worst_place[0]), thin)
    used = float(there.largest_tension_N) / thin.allowable_tension_N
    assert found.utilisation[0] == pytest.approx(used, rel=1e-12)
    assert used > 1.0


def test_the_optimiser_is_loaded_only_when_it_is_needed() -> None:
    code = "import sys, designer.selection.groups; sys.exit('cvxpy' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0


def moment_of_catenary(X: float, D: float, c: float) -> float:
    """Moment about the exit point of an inextensible cable of unit weight; c = H / w.

    With x from the exit point and z downward, z = c cosh(x0 / c) - c cosh((x - x0) / c).
    """

    def drop(x0: float) -> float:
        return c * (np.cosh(x0 / c) - np.cosh((X - x0) / c))

    far = c * 20.0 + X
    x0 = brentq(lambda x0: drop(x0) - D, -far, far, xtol=1e-14 * far)
    x = np.linspace(0.0, X, 4001)
    return float(np.trapezoid(x * np.cosh((x - x0) / c), x))


@pytest.mark.parametrize("slope", [0.01, 0.1, 0.3, 1.0, 3.0])
def test_least_moment_is_below_that_of_every_cable_that_pulls_as_much(slope: float) -> None:
    X = 100.0
    D = slope * X
    for pull in (55.0, 60.0, 100.0, 300.0, 3000.0):
        least = float(_least_moment_m2(*map(np.array, (X, D, pull, 1.0))))
        for more in (1.0, 1.3, 3.0, 30.0):
            assert 0.0 <= least <= moment_of_catenary(X, D, more * pull)
    # Of a cable that is nearly straight, it is that of its chord.
    assert least == pytest.approx(0.5 * X * np.hypot(X, D), rel=0.05)


def test_least_moment_is_that_of_the_formula_where_it_is_proved() -> None:
    """m c = c X / 2 - sin α S, S = W X² / 8 H, W = w (X + D) / (1 - w X / 2 H)."""
    X, D, H, w = 30.0, 40.0, 90.0, 2.0
    weight = w * 70.0 / (1.0 - 60.0 / 180.0)
    area = weight * 900.0 / (8.0 * 90.0)
    expected = 0.5 * 50.0 * 30.0 - 0.8 * area
    assert float(_least_moment_m2(*map(np.array, (X, D, H, w)))) == pytest.approx(expected)
    assert float(_least_moment_m2(*map(np.array, (X, D, 29.0, w)))) == 0.0


@pytest.mark.filterwarnings("ignore:Solution may be inaccurate")
def test_a_programme_that_ends_without_an_answer_is_no_proof(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    solve = cp.Problem.solve

    def without_time(problem: cp.Problem, **options: Any) -> Any:
        options["highs_options"] = options["highs_options"] | {"time_limit": 0.0}
        return solve(problem, **options)

    master = Master(np.random.default_rng(0).uniform(1.0, 2.0, (6, 40)), 2)
    assert master.propose() is not None
    monkeypatch.setattr(cp.Problem, "solve", without_time)
    with pytest.raises(RuntimeError, match="mixed-integer solver ended with"):
        master.propose()
