"""What results are of: which rope, and which state of the study."""

from __future__ import annotations

import threading
from typing import Any

import numpy as np
import pytest
from PySide6.QtWidgets import QLabel, QTableView
from window_driver import LONGEST_MS, Driver

from designer.explore import worker

FAMILY = "Thinnest cable of the family"


def test_map_and_pose_name_the_rope_that_they_are_of(yard: Driver) -> None:
    legend, here = yard.scene.colour_legend, yard.find(QLabel, "here cables")
    best = yard.session.state.rope
    assert legend.texts[1] == here.text() == best.label
    yard.keys("Ctrl+2")
    assert legend.texts[1] == FAMILY  # which diameter is needed is of no rope
    assert here.text() == best.label
    yard.keys("Ctrl+3")
    assert legend.texts[1] == best.label
    yard.press("no rope")
    yard.rest()
    assert legend.texts[1] == here.text() == FAMILY


def test_a_difference_names_both_ropes(yard: Driver) -> None:
    best = yard.session.state.rope
    yard.keys("Ctrl+D")
    table = yard.find(QTableView, "candidates")
    table.setFocus()
    yard.keys("Down")
    yard.window.docks["Compare"].raise_()
    yard.bot.wait(50)
    yard.press("difference in the map")
    yard.rest()
    now = yard.session.state.rope
    assert now != best
    assert yard.scene.colour_legend.texts[1] == f"{now.label}; A: {best.label}"
    yard.press("release")
    yard.window.docks["Ropes"].raise_()
    yard.rest()


def test_a_first_map_is_not_of_a_cable_that_is_used_up_everywhere(yard: Driver) -> None:
    seen: list[tuple[str, Any]] = []

    def note(kind: str, answer: Any) -> None:
        painting = yard.window.work.painting
        if kind in ("coarse", "fine") and painting is not None:
            seen.append((painting.quantity.key, answer.rope))

    yard.window.live.answered.connect(note)
    yard.open(yard.session.path)
    yard.window.live.answered.disconnect(note)
    assert seen[0] == ("diameter", None)
    assert all(rope is not None for key, rope in seen if key == "utilisation")
    assert seen[-1] == ("utilisation", yard.session.state.rope)
    yard.press("no rope")
    yard.keys("Ctrl+1")  # there is none whose utilisation could be shown
    yard.rest()
    assert yard.window.work.painting.quantity.key == "diameter"


def saturation(driver: Driver) -> int:
    """How far from grey the bar of the legend is."""
    bar = driver.picture(driver.scene.colour_legend)[:, 10:18].astype(int)
    return int(np.ptp(bar, axis=2).max())


def test_results_of_an_older_state_are_grey(yard: Driver, monkeypatch: pytest.MonkeyPatch) -> None:
    names = ("verdict", "here tension", "best rope")
    results = [*(yard.find(QLabel, name) for name in names)]
    results += [yard.find(QTableView, name) for name in ("cables", "candidates")]
    legend, goes_on = yard.scene.colour_legend, threading.Event()
    waits = threading.Event()

    def held_back(answer: Any) -> Any:
        def wait(*options: Any, **named: Any) -> Any:
            waits.set()
            goes_on.wait(LONGEST_MS / 1e3)
            return answer(*options, **named)

        return wait

    for name in ("here", "map_answer"):
        monkeypatch.setattr(worker, name, held_back(getattr(worker, name)))
    assert saturation(yard) > 60
    colours = yard.picture(results[1])
    yard.type_into("entry robot.platform.mass", "190 kg")
    assert waits.wait(LONGEST_MS / 1e3)
    yard.bot.waitUntil(lambda: bool(results[0].property("old")), timeout=LONGEST_MS)
    assert all(one.property("old") for one in results)
    assert (yard.picture(results[1]) != colours).any()
    assert legend.texts[1].endswith("of an older state")
    assert saturation(yard) < 30  # the ink is not quite grey
    shades = np.asarray(yard.window.work.painting.table.values)[:, :3]
    assert np.ptp(shades, axis=1).max() <= 1
    goes_on.set()
    yard.rest()
    assert not any(one.property("old") for one in results)
    assert not legend.texts[1].endswith("of an older state")
    assert saturation(yard) > 60
    yard.keys("Ctrl+Z")
    yard.rest()
