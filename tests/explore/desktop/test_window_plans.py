"""Optimising and sweeping the open study from the menu."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from PySide6.QtGui import QDesktopServices
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QFileDialog, QLabel, QMenu, QTableView
from window_driver import LEFT, LONGEST_MS, Driver

from designer.explore.question import Long
from designer.sweeps.run import read_store

OPTIMISATION = """study: yard.yaml
objective: rope_mass
variables:
  robot.anchors[2][1]: [22 m, 32 m]
budget: {evaluations: 12}
starts: 1
samples: 40
"""
SWEEP = """study: yard.yaml
vary: {robot.platform.mass: [160 kg, 180 kg]}
keep: [selection.chosen.utilisation]
"""


def choose(driver: Driver, entry: str) -> None:
    """Click on an entry of the menu of tools."""
    bar, menu = driver.window.menuBar(), driver.find(QMenu, "tools menu")
    driver.click(bar, bar.actionGeometry(menu.menuAction()).center())
    driver.bot.waitUntil(menu.isVisible, timeout=LONGEST_MS)
    action = driver.window.menus.actions[entry]
    QTest.mouseClick(menu, LEFT, pos=menu.actionGeometry(action).center())


def written(folder: Path, text: str, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Write a plan, have it chosen where one is asked for, and return where its store goes."""
    plan = folder / "plan.yaml"
    plan.write_text(text, encoding="utf-8")
    store = folder / "masses.zarr"
    monkeypatch.setattr(QFileDialog, "getOpenFileName", lambda *_, **__: (str(plan), ""))
    monkeypatch.setattr(QFileDialog, "getSaveFileName", lambda *_, **__: (str(store), ""))
    return store


def notice(driver: Driver) -> str:
    """The line above the scene; empty where there is none."""
    frame = driver.window.work._notice
    texts = [label.text() for label in frame.findChildren(QLabel) if label.isVisible()]
    return " ".join(texts)


@pytest.mark.slow
def test_better_study_is_offered_and_taken_over(
    yard: Driver, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    written(tmp_path, OPTIMISATION, monkeypatch)
    before = yard.session.text
    choose(yard, "optimise")
    assert yard.window.status.long.isVisible()
    yard.rest()
    assert "Mass of all ropes: " in notice(yard)
    assert "robot.anchors[2][1]: 26 m → " in notice(yard)
    assert "not proved the best" in yard.window.messages.toPlainText()
    assert yard.session.text == before
    yard.press("notice Take over")
    yard.rest()
    assert yard.session.study.robot.exit_points_m[2, 1] != 26.0
    table = yard.find(QTableView, "differences")
    assert table.isVisible()
    assert "Mass of all cables, best rope" in {row.title for row in table.rows.rows}
    assert notice(yard) == ""
    yard.keys("Ctrl+Z")
    assert yard.session.text == before
    yard.keys("Ctrl+Z")
    assert yard.window.live.pinned is None
    yard.rest()


@pytest.mark.slow
def test_optimisation_tells_of_changes_made_meanwhile(
    yard: Driver, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    written(tmp_path, OPTIMISATION, monkeypatch)
    yard.keys("Ctrl+Shift+O")
    helper = yard.window.live._worker._helpers["optimise"]
    yard.bot.waitUntil(lambda: yard.window.status.long._bar.maximum() > 0, timeout=LONGEST_MS)
    yard.type_into("entry robot.platform.mass", "190 kg")
    yard.rest()
    assert helper._process is not None
    yard.press("notice Take over")
    yard.rest()
    assert "Changes made since the search began" in yard.window.messages.toPlainText()
    assert yard.session.study.robot.platform.mass_kg == 180.0
    yard.keys("Ctrl+Z")
    assert yard.session.study.robot.platform.mass_kg == 190.0
    yard.rest()


@pytest.mark.slow
def test_optimisation_is_cancelled(
    yard: Driver, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    written(tmp_path, OPTIMISATION.replace("12", "100000"), monkeypatch)
    yard.keys("Ctrl+Shift+O")
    yard.bot.waitUntil(lambda: yard.window.status.long._bar.maximum() > 0, timeout=LONGEST_MS)
    yard.press("cancel")
    yard.rest()
    assert not yard.window.status.long.isVisible()
    assert notice(yard) == ""


@pytest.mark.slow
def test_sweep_writes_its_store_and_report(
    yard: Driver, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    store, opened = written(tmp_path, SWEEP, monkeypatch), []
    monkeypatch.setattr(QDesktopServices, "openUrl", lambda url: opened.append(url.toLocalFile()))
    choose(yard, "sweep")
    assert yard.window.status.long.isVisible()
    yard.rest()
    page = tmp_path / "masses-report" / "sweep.html"
    assert notice(yard) == f"sweep.html is in {page.parent}."
    assert page.is_file()
    assert bool(read_store(store)["done"].values.all())
    assert str(store) in yard.window.messages.toPlainText()
    yard.press("notice Open")
    assert opened == [str(page)]


REFUSED: dict[str, Any] = {
    "no plan": ("name: no plan\n", "plan.yaml"),
    "another study": (SWEEP.replace("yard.yaml", "other.yaml"), "other.yaml, and"),
    "not saved": (SWEEP, "a study that is saved"),
}


@pytest.mark.slow
@pytest.mark.parametrize("fault", REFUSED)
def test_faulty_plan_is_refused_in_a_line(
    yard: Driver, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, fault: str
) -> None:
    text, expected = REFUSED[fault]
    store = written(tmp_path, text, monkeypatch)
    (tmp_path / "other.yaml").write_text(yard.session.text, encoding="utf-8")
    if fault == "not saved":
        yard.type_into("entry robot.platform.mass", "190 kg")
    for keys, name in (("Ctrl+Shift+O", "the optimisation"), ("Ctrl+Shift+W", "the sweep")):
        if fault != "no plan" and name == "the optimisation":
            continue
        yard.keys(keys)
        yard.rest()
        assert yard.window.statusBar().currentMessage().startswith(f"{name}: {tmp_path}")
        assert expected in yard.window.messages.toPlainText()
    assert not store.exists()
    assert not list(tmp_path.glob("*-report"))


def test_bar_goes_on_with_other_long_work(empty: Driver) -> None:
    live, bar = empty.window.live, empty.window.status.long
    kinds: tuple[Long, ...] = ("sweep", "optimise")
    for number, kind in enumerate(kinds):
        live._pending[kind] = number
        live.begun.emit(kind)
    for kind, shown in zip(reversed(kinds), ("the sweep", ""), strict=True):
        del live._pending[kind]
        live.busy_changed.emit()
        assert bar.isVisible() == bool(shown)
        assert not shown or shown == bar._task.text()


def test_without_a_study_there_is_nothing_to_optimise(empty: Driver) -> None:
    assert not empty.window.menus.actions["optimise"].isEnabled()
    assert not empty.window.menus.actions["sweep"].isEnabled()
