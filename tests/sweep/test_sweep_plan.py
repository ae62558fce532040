"""Points of a sweep, and sweep files with mistakes."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from sweep_cases import STUDY, SWEEP, written

from designer.documents.document import Node, path_keys, path_text
from designer.errors import InputError
from designer.sweeps.plan import Range, ValueList, columns_of, read_sweep
from designer.sweeps.report import unit_of

MASS = Range(("robot", "platform", "mass"), 100.0, 300.0, "kg", 5)
GRADE = ValueList(("cable", "grade"), (Node(1, "a", True), Node(1, "b", True)))


def test_the_last_field_of_a_grid_varies_fastest() -> None:
    mass, grade = columns_of((MASS, GRADE), "grid", 0, 0)
    assert mass.stored.tolist() == np.repeat([100.0, 150, 200, 250, 300], 2).tolist()
    assert grade.stored.tolist() == ["a", "b"] * 5
    assert mass.name == "robot.platform.mass"
    assert mass.node(2).as_written() == "150.0 kg"
    assert grade.node(3).as_written() == "b"


def test_latin_hypercubes_have_a_point_in_each_layer_and_repeat() -> None:
    first, again, other = (columns_of((MASS, GRADE), "latin_hypercube", 40, s) for s in (1, 1, 2))
    layers = np.floor((first[0].values - 100.0) / 5.0).astype(int)
    assert sorted(layers) == list(range(40))
    assert np.bincount(first[1].values).tolist() == [20, 20]
    assert all(np.array_equal(a.values, b.values) for a, b in zip(first, again, strict=True))
    assert not np.array_equal(first[0].values, other[0].values)


def test_random_points_stay_in_their_range() -> None:
    mass, grade = columns_of((MASS, GRADE), "random", 500, 3)
    assert 100.0 <= mass.values.min() < 110.0
    assert 290.0 < mass.values.max() <= 300.0
    assert set(grade.stored) == {"a", "b"}


def test_a_value_without_a_unit_is_a_number_and_with_one_a_text() -> None:
    factor = Range(("cable", "safety_factor"), 3.0, 5.0, "", 3)
    assert factor.node(3.5).data() == 3.5
    assert MASS.node(150.0).data() == "150.0 kg"


@pytest.mark.parametrize("text", ["robot.anchors[2][0]", "robot.anchors.2.0"])
def test_a_path_may_name_an_item_in_two_ways(text: str) -> None:
    assert path_text(path_keys(text)) == "robot.anchors[2][0]"


def test_a_value_takes_its_place_and_nothing_else_moves() -> None:
    tree = Node(1, {"a": Node(2, (Node(3, "1", True), Node(4, "2", True))), "b": Node(5, "x")})
    changed = tree.with_value(("a", 1), Node(9, "7", True))
    assert changed.data() == {"a": [1, 7], "b": "x"}
    assert tree.data() == {"a": [1, 2], "b": "x"}
    assert tree.with_value(("c", "d"), Node(9, "7", True)).data() == {**tree.data(), "c": {"d": 7}}  # type: ignore[dict-item]
    for keys in (("a", 2), ("b", "c"), ("a", "b")):
        with pytest.raises(KeyError):
            tree.with_value(keys, Node(9, "7", True))


IN_ONE_UNIT = (
    "(expected a list of values, or {from: 100 kg, to: 300 kg, count: 21}; both ends in one unit)"
)


def lines(path: Path) -> list[str]:
    with pytest.raises(InputError) as caught:
        read_sweep(path, with_plugins=False)
    return [str(fault).replace(f"{path}:", "") for fault in caught.value.faults]


def test_a_plan_knows_its_points_and_kinds(tmp_path: Path) -> None:
    plan = read_sweep(written(tmp_path), with_plugins=False)
    assert plan.n_points == 9
    assert plan.kinds == {"pose.optimum.diameter_m": float, "pose.sagging.status": str}
    assert plan.goals == {"pose.optimum.diameter_m": 1}
    study = plan.base.study(plan.changes(8))
    assert study.robot.platform.mass_kg == 200.0
    assert study.pose is not None
    assert study.pose.position_m.tolist() == [10.0, 6.0, 5.0]


def test_a_range_of_one_value_is_a_grid_of_one_point(tmp_path: Path) -> None:
    narrow = SWEEP.replace("to: 200 kg, count: 3", "to: 100 kg, count: 1")
    plan = read_sweep(written(tmp_path, narrow), with_plugins=False)
    assert plan.n_points == 3


def test_the_digest_is_that_of_what_counts(tmp_path: Path) -> None:
    digests = [
        read_sweep(written(tmp_path, sweep), with_plugins=False).digest
        for sweep in (SWEEP, "# a remark\n" + SWEEP, SWEEP.replace("count: 3", "count: 4"))
    ]
    assert digests[0] == digests[1] != digests[2]


@pytest.mark.parametrize(
    ("old", "new", "line"),
    [
        ("mass: {", "masss: {", "3: vary.robot.platform.masss: unknown field 'masss'"),
        ("pose[2]", "pose[3]", "4: vary.pose[3]: the study has no such field"),
        ("200 kg", "0.2 t", f"mass: its ends are in 'kg' and 't' {IN_ONE_UNIT}"),
        (", count: 3", "", f"mass: has no whole number 'count' {IN_ONE_UNIT}"),
        ("count", "number", "3: vary.robot.platform.mass: unknown field 'number'"),
        ("from: 100 kg", "from: few", "has no two numbers 'from' and 'to'"),
        ("[4, 12, 5]", "4 m", "4: vary.pose[2]: '4 m' is no list"),
        ("diameter_m,", "diametre_m,", "(expected one of diameter_m; did you mean 'diameter_m'?)"),
        ("pose.optimum.diameter_m", "pose.optimum", "values (expected pose.optimum.diameter_m)"),
        ("keep: [pose.optimum.diameter_m, pose.sagging.status]", "kept: []", "did you mean"),
        ("keep:", "sampling: random\nkeep:", "points: is missing (expected how many, for random)"),
        ("[4, 12, 5]", "[]", "4: vary.pose[2]: the list is empty"),
        ("count: 3", "count: 9999999", "2: vary: the grid has 3e+07 points (expected 10,000,000"),
        ("pose[2]: [4, 12, 5]", "pose[2]: [4, 5]\n  pose.2: [4]", "5: vary.pose.2: is named twice"),
        ("pose.sagging.status]", "pose.optimum.diameter_m]", "is named twice"),
        ("count: 3", "count: 1", "a count of 1, which does not reach from one end to the other"),
        (
            "pose[2]: [4",
            "pose: [[1, 2, 3]]\n  pose[2]: [4",
            "4: vary.pose: holds pose[2], which is varied too (expected one of pose and pose[2])",
        ),
        ("keep:", "points: 7\nkeep:", "points: a grid has no number of points of its own"),
        ("keep:", "maximise: [x]\nkeep:", "is no number that is kept"),
    ],
)  # fmt: skip
def test_a_mistake_gets_one_line(tmp_path: Path, old: str, new: str, line: str) -> None:
    assert old in SWEEP
    found = lines(written(tmp_path, SWEEP.replace(old, new)))
    assert any(line in one for one in found), found


def test_no_study_and_no_fields(tmp_path: Path) -> None:
    path = written(tmp_path, "study: none.yaml\nvary: {}\nkeep: [name]\n")
    assert lines(path) == [
        "2: vary: the mapping is empty (expected at least one field of the study)"
    ]
    path = written(tmp_path, SWEEP.replace("crane.yaml", "none.yaml"))
    assert "none.yaml: there is no such file" in lines(path)[0]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("prices", "units", "estimate"),
    [("", "USD", "borrowed, of 2024, may be 0.5 to 2 times"), ("prices: prices.csv, ", "EUR", "")],
)
def test_prices_that_are_kept_have_a_currency_and_say_what_is_borrowed(
    tmp_path: Path, prices: str, units: str, estimate: str
) -> None:
    rows = "grade,size,price_per_m,currency,date\nunirope-6x36-iwrc-1960,8 mm,2,EUR,2026\n"
    (tmp_path / "prices.csv").write_text(rows)
    study = STUDY + (
        "workspace: {region: {points: [[10, 6, 4]]}}\n"
        f"selection: {{{prices}objectives: [cost], grades: [unirope-6x36-iwrc-1960]}}\n"
    )
    sweep = SWEEP.replace("pose.sagging.status", "selection.chosen.cost")
    plan = read_sweep(written(tmp_path, sweep, study), with_plugins=False)
    found = dict(plan.attributes["selection.chosen.cost"])
    assert found.pop("units") == units
    assert found.pop("estimate", "").startswith(estimate)
    assert not found
    assert unit_of(plan.attributes["selection.chosen.cost"]) == (
        f"{units}, estimated" if estimate else units
    )


PRICED = STUDY + (
    "workspace: {region: {points: [[10, 6, 4]]}}\n"
    "selection: {prices: EUR.csv, objectives: [cost], grades: [unirope-6x36-iwrc-1960]}\n"
)


def price_sweep(folder: Path, lists: str) -> Path:
    """Write three lists, of one size each, and a sweep over some of them."""
    for name, currency, price in (("EUR", "EUR", 2), ("dear", "EUR", 3), ("USD", "USD", 2)):
        row = f"unirope-6x36-iwrc-1960,8 mm,{price},{currency},2026\n"
        (folder / f"{name}.csv").write_text("grade,size,price_per_m,currency,date\n" + row)
    sweep = f"study: crane.yaml\nvary: {{selection.prices: [{lists}]}}\n"
    return written(folder, sweep + "keep: [selection.chosen.cost]\n", PRICED)


@pytest.mark.slow
def test_price_lists_in_one_currency_are_swept(tmp_path: Path) -> None:
    plan = read_sweep(price_sweep(tmp_path, "EUR.csv, dear.csv"), with_plugins=False)
    assert plan.attributes == {"selection.chosen.cost": {"units": "EUR"}}
    costs = [
        plan.base.result(plan.base.study(plan.changes(point)))["selection"]["chosen"]["cost"]
        for point in range(plan.n_points)
    ]
    assert costs[1] == pytest.approx(1.5 * costs[0])


@pytest.mark.slow
def test_a_list_that_a_point_names_counts_for_the_digest(tmp_path: Path) -> None:
    path = price_sweep(tmp_path, "EUR.csv, dear.csv")
    before = read_sweep(path, with_plugins=False).digest
    dear = tmp_path / "dear.csv"
    dear.write_text(dear.read_text().replace(",3,", ",4,"))
    assert read_sweep(path, with_plugins=False).digest != before


@pytest.mark.slow
@pytest.mark.parametrize(
    ("lists", "found"),
    [("EUR.csv, USD.csv", "in EUR and in USD"), ("null", "in EUR and borrowed in USD")],
)
def test_prices_that_cannot_be_compared_are_refused(tmp_path: Path, lists: str, found: str) -> None:
    (line,) = lines(price_sweep(tmp_path, lists))
    assert line == (
        f"2: vary: its points have prices {found} "
        "(expected points whose prices can be compared, or no prices in keep)"
    )
