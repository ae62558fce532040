"""Points of a sweep."""

from __future__ import annotations

import numpy as np
import pytest

from designer.documents.document import Node, path_keys, path_text
from designer.sweeps.plan import Range, ValueList, columns_of

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
