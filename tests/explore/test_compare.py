"""What has become otherwise since a state was pinned."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from designer.explore.answers import (
    Pin,
    compare,
    full_ropes,
    map_answer,
    pose_answer,
    quick_ropes,
    worst_answer,
)
from designer.explore.question import Rope
from designer.explore.session import Session

WIRE = "unirope-7x19-galvanised"


def pin_of(session: Session, **how: Any) -> Pin:
    question = session.question()
    assert question is not None
    parts = {"worst": worst_answer(question), "ropes": quick_ropes(question)} | how
    return Pin(question, session.fields(), here=pose_answer(question), **parts)


@pytest.fixture
def few(yard: Session) -> Session:
    yard.edit("workspace.samples", "200")
    return yard


@pytest.mark.slow
def test_nothing_differs_from_itself(few: Session) -> None:
    pin = pin_of(few)
    found = compare(pin, pin_of(few))
    assert (found.changes, found.gained, found.lost) == ((), (), ())
    assert all(line.difference == 0.0 for line in found.figures)
    assert found.is_like_with_like


@pytest.mark.slow
def test_a_heavier_load(few: Session) -> None:
    few.choose(Rope(WIRE, "7/32 in"))
    before = pin_of(few)
    few.edit("robot.platform.mass", "0.4 t")
    after = pin_of(few)
    found = compare(before, after)
    changed = {one.title: (one.before, one.after) for one in found.changes}
    assert changed["Platform with payload"] == ("180 kg", "0.4 t")
    assert changed["Best rope"][0] == f"7/32 in of {WIRE}"
    lines = {one.title: one for one in found.figures}
    worse = ["Diameter needed here", "Utilisation at worst", "Diameter needed at worst"]
    assert all(lines[title].difference > 0.0 for title in worse)
    assert "Mass of all cables, best rope" in lines
    in_unit = {
        "Diameter needed here": ("diameter_m", 1e3),
        "Largest tension here": ("max_tension_N", 1e-3),
        "Utilisation here": ("utilisation", 100.0),
        "Stiffness here": ("stiffness_N_per_m", 1e-3),
    }
    for title, (figure, scale) in in_unit.items():
        gain = getattr(after.here, figure) - getattr(before.here, figure)
        assert lines[title].difference == pytest.approx(scale * gain)
    assert Rope(WIRE, "7/32 in") in found.lost
    assert found.gained == ()


@pytest.mark.slow
def test_a_full_selection_and_a_quick_one_are_told_apart(few: Session) -> None:
    question = few.question()
    assert question is not None
    found = compare(pin_of(few), pin_of(few, ropes=full_ropes(question)))
    assert not found.is_like_with_like
    unknown = compare(pin_of(few, ropes=None, worst=None), pin_of(few))
    assert {one.title.split()[-1] for one in unknown.figures} == {"here"}


def test_the_map_against_another_state(few: Session) -> None:
    before = few.question()
    few.edit("robot.platform.mass", "0.4 t")
    few.edit("workspace.region.inset", "4 m")  # other positions
    question = few.question()
    assert question is not None
    found = map_answer(question, against=before)
    assert before is not None
    assert np.all(found.difference("diameter") > 0.0)  # type: ignore[operator]
    governing = found.difference("governing")
    assert governing is not None
    assert set(np.unique(governing)) <= {0.0, 1.0}
    assert map_answer(question).difference("diameter") is None
    same = map_answer(question, against=question)
    assert np.all(same.difference("governing") == 0.0)
