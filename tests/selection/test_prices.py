"""Prices where the catalogue has none."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest
from ropes import rope

from designer.grades.grade import Grade
from designer.model.cable import Offer, PriceList
from designer.model.region import Prism
from designer.model.workspace import Workspace
from designer.selection.candidate import BORROWED, Candidate, common_currency, priced, with_prices
from designer.selection.select import best_product, select
from designer.study import Selection

SIZES = [10.0, 60.0]
BY_COST = Selection(None, 2.0, ("cost", "mass"))


def of(material) -> Grade:
    return rope(f"{material or 'no'} rope", SIZES, material=material)


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
    own = rope("own", SIZES, material="steel", price_per_kg=3.0, currency="EUR")
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


def listed(*offers: Offer) -> Selection:
    prices = PriceList(Path("prices.csv"), "EUR", offers)
    return replace(BY_COST, price_list=prices)


def test_a_list_comes_before_grades_and_estimates() -> None:
    by_list = listed(
        Offer("dollars", "10 mm", 0.0, 7.0, "2026", 2), Offer("euros", "", 0.06, 9.0, "2026", 3)
    )
    priced = [
        rope(name, SIZES, material="steel", price_per_kg=3.0, currency=currency)
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
        Offer("first", "30 mm", 0.0, 8.0, "2026", 2),
        Offer("first", "34 mm", 0.0, 6.0, "2026", 3),
        Offer("second", "34 mm", 0.0, 7.0, "2026", 4),
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
