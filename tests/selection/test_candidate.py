"""What candidates are compared by, and the set that nothing beats.

Prices where the catalogue has none.
"""

from __future__ import annotations

import itertools
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from ropes import rope

from designer.analysis.result_json import selection_dict
from designer.arrays import frozen_array
from designer.grades.grade import Grade, Units
from designer.model.cable import Cable, Preference, PriceList, RopePrice
from designer.model.region import PointList, Prism
from designer.model.workspace import Workspace
from designer.selection.candidate import (
    BORROWED,
    MEANINGS,
    Candidate,
    CandidateFigures,
    common_currency,
    priced,
    with_prices,
)
from designer.selection.compare import dominator_of, is_undominated
from designer.selection.select import best_product, select
from designer.study import Objective, Selection
from designer.workspace.stiffness import smallest_stiffness_N_per_m

TRIANGLE = [[0, 0, 0], [500, 0, 0], [250, 433.01, 0]]
SIZES = [14.0, 16.0, 18.0, 20.0, 22.0, 24.0, 28.0, 32.0]

rows = st.lists(
    st.tuples(*[st.integers(0, 4).map(float) | st.just(float("inf"))] * 3), min_size=1, max_size=12
)


def beats(a: tuple[float, ...], b: tuple[float, ...]) -> bool:
    return all(x <= y for x, y in zip(a, b, strict=True)) and a != b


@given(rows)
def test_pareto_set_is_that_of_its_definition(table: list[tuple[float, ...]]) -> None:
    burdens = np.array(table)
    expected = [not any(beats(other, row) for other in table) for row in table]
    assert is_undominated(burdens).tolist() == expected


@given(rows)
def test_whoever_is_dominated_is_so_by_a_member_of_the_set(table: list[tuple[float, ...]]) -> None:
    burdens = np.array(table)
    front = burdens[is_undominated(burdens)]
    for row, member in zip(burdens, is_undominated(burdens), strict=True):
        number = dominator_of(row, front)
        assert (number is None) == member
        if number is not None:
            assert beats(tuple(front[number]), tuple(row))


@pytest.mark.parametrize("objective", sorted(MEANINGS))
def test_a_figure_that_is_not_known_is_worse_than_any(objective: Objective) -> None:
    known = CandidateFigures(*5 * [1e300])
    unknown = replace(known, **{MEANINGS[objective].field: np.nan})
    assert unknown.burden(objective) == np.inf > known.burden(objective)


@pytest.fixture(scope="module")
def workspace() -> Workspace:
    return Workspace(Prism.over(TRIANGLE, 40.0, (-200.0, -60.0)), samples=1000)


def grades():
    """A light one on large drums, a cheap heavy one on small drums, a stiff one."""
    return [
        rope("light", SIZES, weight=0.7, sheave_ratio=40.0, price_per_kg=9.0, currency="EUR"),
        rope("cheap", SIZES, sheave_ratio=18.0, price_per_kg=2.0, currency="EUR"),
        rope("stiff", SIZES, weight=0.705, stiffness=3.0, sheave_ratio=60.0),
    ]


@pytest.mark.cases_by_default(1)
@pytest.mark.parametrize(
    ("objectives", "grade"),
    [
        (("mass",), "light"),
        (("mass", "drum_diameter"), "light"),
        (("drum_diameter", "mass"), "cheap"),
        (("cost", "mass"), "cheap"),
        (("max_tension",), "light"),
        (("stiffness", "mass"), "stiff"),
    ],
)
def test_first_objective_decides(objectives, grade: str, fast_robot, workspace) -> None:
    found = select(fast_robot, workspace, Selection(None, 2.0, objectives), grades())
    assert found.chosen is not None
    assert found.chosen.grade.id == grade
    best = found.chosen.figures.burden(objectives[0])
    comparable = [c for c in found.candidates if c.verification.holds]
    assert best == min(c.figures.burden(objectives[0]) for c in comparable)
    assert found.front[0] is found.chosen
    alone = best_product(fast_robot, workspace, Selection(None, 2.0, objectives), grades())
    assert alone is not None
    assert (alone.grade.id, alone.size.id) == (grade, found.chosen.size.id)
    for objective in objectives:
        assert alone.figures.burden(objective) == found.chosen.figures.burden(objective)
    assert alone.verification.max_tension_N == found.chosen.verification.max_tension_N


@pytest.mark.slow
def test_front_is_mutually_undominated_and_beats_the_rest(fast_robot, workspace) -> None:
    objectives = ("mass", "drum_diameter", "cost", "stiffness")
    found = select(fast_robot, workspace, Selection(None, 2.0, objectives), grades())

    def burdens(candidate) -> tuple[float, ...]:
        return tuple(candidate.figures.burden(o) for o in objectives)

    assert len(found.front) > 2
    for a, b in itertools.permutations(found.front, 2):
        assert not beats(burdens(a), burdens(b))
    for candidate in found.candidates:
        if candidate.standing == "dominated":
            assert any(beats(burdens(c), burdens(candidate)) for c in found.front)
    assert all(c.verified for c in found.front)


def test_figures_are_what_they_say(fast_robot, workspace) -> None:
    found = select(fast_robot, workspace, Selection(None, 2.0, ("mass", "cost")), grades())
    assert found.currency == "EUR"
    for candidate in found.candidates:
        length = candidate.verification.longest_m.sum()
        mass = candidate.cable.linear_density_kg_per_m * length
        assert candidate.figures.mass_kg == pytest.approx(mass)
        assert candidate.figures.max_tension_N == candidate.verification.max_tension_N
        ratio, price = {"light": (40, 9), "cheap": (18, 2), "stiff": (60, np.nan)}[
            candidate.grade.id
        ]
        diameter = candidate.size.diameter_m
        assert candidate.figures.drum_diameter_m == pytest.approx(ratio * diameter)
        assert candidate.figures.cost == pytest.approx(price * mass, nan_ok=True)


def test_without_a_price_nothing_can_be_the_cheapest(fast_robot, workspace) -> None:
    unpriced = rope("unpriced", SIZES, weight=0.5)
    dear = rope("dear", SIZES, price_per_kg=50.0, currency="EUR")
    found = select(fast_robot, workspace, Selection(None, 2.0, ("cost",)), [unpriced, dear])
    assert found.chosen is not None
    assert found.chosen.grade.id == "dear"
    holding = [c for c in found.candidates if c.grade is unpriced and c.verification.holds]
    assert {c.standing for c in holding} == {"not_comparable"}
    assert {c.reason for c in holding} == {"its price is not known"}
    sentences = {outcome.grade.id: outcome.sentence for outcome in found.outcomes}
    assert sentences["unpriced"] == "holds, but is not compared: its price is not known"
    none = select(fast_robot, workspace, Selection(None, 2.0, ("cost",)), [unpriced])
    assert none.chosen is None
    assert "price" in (none.reason or "")
    assert best_product(fast_robot, workspace, Selection(None, 2.0, ("cost",)), [unpriced]) is None


def test_prices_in_another_currency_do_not_count(fast_robot, workspace) -> None:
    euro = rope("euro", SIZES, price_per_kg=5.0, currency="EUR")
    yen = rope("yen", SIZES[:3], price_per_kg=0.1, currency="JPY")
    assert common_currency([yen, euro]) == "EUR"
    assert common_currency([rope("free", SIZES)]) is None
    found = select(fast_robot, workspace, Selection(None, 2.0, ("cost",)), [euro, yen])
    assert found.chosen is not None
    assert found.chosen.grade.id == "euro"


def test_stiffness_of_taut_cables_is_the_textbooks(fast_robot) -> None:
    """Σ EA/l u uᵀ + T/l (1 - u uᵀ) for straight weightless cables."""
    cable = Cable(0.01, 1e-7, 5e6, 1e6)
    position = np.array([[250.0, 150.0, -50.0]])
    chord = position - fast_robot.exit_points_m
    length = np.linalg.norm(chord, axis=1)
    u = chord / length[:, None]
    tension = np.linalg.solve(-u.T, [0.0, 0.0, fast_robot.weight_N])
    along = u[:, :, None] * u[:, None, :]
    unstrained = length / (1.0 + tension / cable.axial_stiffness_N)
    matrix = (cable.axial_stiffness_N / unstrained)[:, None, None] * along + (tension / length)[
        :, None, None
    ] * (np.eye(3) - along)
    expected = np.linalg.eigvalsh(matrix.sum(axis=0))[0]
    workspace = Workspace(PointList(frozen_array(position)))
    for searched in (False, True):
        found = smallest_stiffness_N_per_m(fast_robot, workspace, cable, searched=searched)
        assert found == pytest.approx(expected, rel=1e-6)


def test_search_finds_softer_poses_than_the_samples(fast_robot, steel) -> None:
    workspace = Workspace(Prism.over(TRIANGLE, 40.0, (-200.0, -60.0)), samples=50)
    sampled, found = (
        smallest_stiffness_N_per_m(fast_robot, workspace, steel.cable(0.05), searched=searched)
        for searched in (False, True)
    )
    assert found < 0.99 * sampled


def in_inches(weight: float, strength: float = 1.0) -> Grade:
    """Return a like grade of the sizes of `SIZES`, named in inches."""
    grade = rope("inches", SIZES, weight=weight, strength=strength)
    sizes = (replace(size, id=f"{k}/32 in") for k, size in enumerate(grade.sizes, 17))
    return replace(grade, sizes=tuple(sizes))


@pytest.mark.cases_by_default(2)
@pytest.mark.parametrize(
    ("weight", "prefer", "chosen", "words"),
    [
        (0.993, "metric", "metric", "16 mm instead of 18/32 in of inches (16 mm), as metric sizes"),
        (
            0.95,
            "metric",
            "inches",
            "no metric size is as good within 2 %; the best is 16 mm of metric: ",
        ),
        (0.993, "none", "inches", ""),
        (0.993, "imperial", "inches", ""),
    ],
)
def test_preferred_units_decide_between_sizes_as_good(
    weight: float, prefer: Preference, chosen: str, words: str, fast_robot, workspace
) -> None:
    grades = [rope("metric", SIZES), in_inches(weight)]
    selection = Selection(None, 2.0, ("mass", "max_tension"), prefer=prefer)
    found = select(fast_robot, workspace, selection, grades)
    assert found.chosen is not None
    assert found.chosen.grade.id == chosen
    assert found.preference.startswith(words)
    assert bool(words) == bool(found.preference)
    assert found.front[0] is found.chosen
    alone = best_product(fast_robot, workspace, selection, grades)
    assert alone is not None
    assert alone.grade.id == chosen
    preference = selection_dict(found, None, None)["preference"]
    if found.chosen.preferred_to is not None:
        ratio = found.chosen.figures.mass_kg / preference["instead_of"]["total_mass_kg"]
        assert 1.0 < ratio < 1.02
        assert f"+{100 * ratio - 100:.1f} % mass" in found.preference == preference["why"]
        assert found.chosen.verified
    else:
        assert preference["instead_of"] is None


@pytest.mark.parametrize(
    ("id", "units", "expected"),
    [
        ("7/32 in", None, "imperial"),
        ('1/2"', None, "imperial"),
        ("19 mm (3/4 in)", None, "metric"),
        ("DC 160", "mm", "metric"),
        ("No. 7", "in", "imperial"),
    ],
)
def test_units_of_sizes(id: str, units: str | None, expected: str) -> None:
    grade = replace(rope("grade", [10.0]), units=units and Units(diameter=units))
    size = replace(grade.sizes[0], id=id)
    assert Candidate(grade, size, SimpleNamespace()).units == expected


PRICED_SIZES = [10.0, 60.0]
BY_COST = Selection(None, 2.0, ("cost", "mass"))


def of(material) -> Grade:
    return rope(f"{material or 'no'} rope", PRICED_SIZES, material=material)


def prices(grade: Grade) -> list[float | None]:
    return [size.price_per_m for size in grade.sizes]


def test_curves_are_those_of_the_source() -> None:
    grades, estimate = with_prices([of("steel"), of("HMPE"), of("aramid"), of(None)], BY_COST)
    assert estimate is BORROWED
    assert prices(grades[0]) == pytest.approx([258e-2 + 1.43, 258 * 0.06 + 14300 * 0.0036])
    assert prices(grades[1])[0] is None  # the curve is below zero for thin ropes
    assert prices(grades[1])[1] == pytest.approx(-2270 * 0.06 + 110000 * 0.0036)
    assert [grade.currency for grade in grades] == ["USD", "USD", None, None]
    assert prices(grades[2]) == prices(grades[3]) == [None, None]
    again, _ = with_prices([of("steel")], BY_COST)
    assert again[0] is grades[0]


def test_a_price_of_its_own_comes_before_all_estimates() -> None:
    own = rope("own", PRICED_SIZES, material="steel", price_per_kg=3.0, currency="EUR")
    catalogue = [of("steel"), own]
    assert with_prices(catalogue, BY_COST) == (catalogue, None)
    named = replace(BY_COST, grades=("steel rope",))
    grades, estimate = with_prices(catalogue, named)
    assert prices(grades[0])[0] is not None
    assert estimate is BORROWED
    assert grades[1] is own
    assert with_prices(catalogue[:1], Selection(None, 2.0)) == (catalogue[:1], None)


def test_the_cheapest_is_chosen_and_said_to_be_estimated(fast_robot) -> None:
    triangle = fast_robot.exit_points_m[:, :2]
    workspace = Workspace(Prism.over(triangle, 60.0, (-200.0, -80.0)), samples=100)
    sizes = [float(d) for d in range(10, 40, 4)]
    steel, nylon = (
        rope(name, sizes, material=name, weight=weight)
        for name, weight in (("steel", 1.0), ("nylon", 1.05))
    )
    found = select(fast_robot, workspace, BY_COST, [steel, nylon])
    assert found.chosen is not None
    assert (found.currency, found.price_estimate) == ("USD", BORROWED)
    holding = [c for c in found.candidates if c.verification.holds]
    assert {c.grade.id for c in holding} == {"steel", "nylon"}
    assert found.chosen.grade.id == "nylon"  # heavier, but cheaper by the metre
    price = found.chosen.size.price_per_m
    assert price is not None
    length_m = float(found.chosen.verification.longest_m.sum())
    assert found.chosen.figures.cost == pytest.approx(price * length_m)
    assert found.chosen.figures.cost == min(c.figures.cost for c in holding)
    same = best_product(fast_robot, workspace, BY_COST, [steel, nylon])
    assert same is not None
    assert same.size.id == found.chosen.size.id
    by_mass = select(fast_robot, workspace, Selection(None, 2.0, ("mass",)), [steel, nylon])
    assert by_mass.chosen is not None
    assert (by_mass.chosen.grade.id, by_mass.price_estimate) == ("steel", None)


def listed(*offers: RopePrice) -> Selection:
    prices = PriceList(Path("prices.csv"), "EUR", offers)
    return replace(BY_COST, price_list=prices)


def test_a_list_comes_before_grades_and_estimates() -> None:
    by_list = listed(
        RopePrice("dollars", "10 mm", 0.0, 7.0, "2026", 2),
        RopePrice("euros", "", 0.06, 9.0, "2026", 3),
    )
    priced = [
        rope(name, PRICED_SIZES, material="steel", price_per_kg=3.0, currency=currency)
        for name, currency in (("dollars", "USD"), ("euros", "EUR"), ("pounds", "GBP"))
    ]
    unpriced = of("steel")
    grades, estimate = with_prices([*priced, unpriced], by_list)
    assert estimate is None
    assert [grade.currency for grade in grades] == ["EUR", "EUR", "EUR", None]
    assert prices(grades[0]) == [7.0, None]  # its own is in another currency
    assert prices(grades[1]) == [priced[1].sizes[0].price_per_m, 9.0]
    assert prices(grades[2]) == [None, None]
    assert grades[3] is unpriced
    assert with_prices(priced, by_list)[0][0] is grades[0]


def test_the_least_by_the_list_is_chosen(fast_robot) -> None:
    triangle = fast_robot.exit_points_m[:, :2]
    workspace = Workspace(Prism.over(triangle, 60.0, (-200.0, -80.0)), samples=100)
    grades = [rope(name, [30.0, 34.0], material="steel") for name in ("first", "second")]
    by_list = listed(
        RopePrice("first", "30 mm", 0.0, 8.0, "2026", 2),
        RopePrice("first", "34 mm", 0.0, 6.0, "2026", 3),
        RopePrice("second", "34 mm", 0.0, 7.0, "2026", 4),
    )
    found = select(fast_robot, workspace, by_list, grades)
    assert found.chosen is not None
    assert found.chosen.ids == {"grade": "first", "size_id": "34 mm"}
    assert (found.currency, found.price_estimate) == ("EUR", None)
    assert found.price_list is by_list.price_list
    length_m = float(found.chosen.verification.longest_m.sum())
    assert found.chosen.figures.cost == pytest.approx(6.0 * length_m)
    unpriced = next(c for c in found.candidates if c.ids == {"grade": "second", "size_id": "30 mm"})
    assert unpriced.standing == "not_comparable"


def test_equally_common_currencies_are_settled_alike() -> None:
    offers = [of("steel"), of("HMPE")]
    grades = [
        replace(
            grade,
            id=currency,
            currency=currency,
            sizes=tuple(replace(size, price_per_m=1.0) for size in grade.sizes),
        )
        for grade, currency in zip(offers, ("USD", "EUR"), strict=True)
    ]
    candidates = [Candidate(g, s, g.cable(s, 5.0)) for g in grades for s in g.sizes]
    for order in (1, -1):
        assert {c.grade.currency for c in priced(candidates[::order])} == {"EUR"}
        assert common_currency(grades[::order]) == "EUR"
