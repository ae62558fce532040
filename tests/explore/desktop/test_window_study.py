"""The study's numbers: entries, sliders, what is refused, undo and redo."""

from __future__ import annotations

import pytest
from PySide6.QtCore import Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QLabel, QLineEdit, QToolButton, QWidget
from window_driver import Driver

MASS = "robot.platform.mass"


def test_an_entry_with_its_unit_is_taken_and_answered(yard: Driver) -> None:
    before = yard.window.live.answers["pose"].max_tension_N
    yard.type_into(f"entry {MASS}", "0.36 t")
    yard.rest()
    assert yard.session.study.robot.platform.mass_kg == 360.0
    assert yard.window.live.answers["pose"].max_tension_N > 1.9 * before
    assert "mass: 0.36 t" in yard.session.text
    assert yard.window.isWindowModified()


@pytest.mark.parametrize("wrong", ["180 metres", "heavy", "-5 kg", "nan", "1e400 kg"])
def test_a_wrong_entry_is_told_beside_the_field(yard: Driver, wrong: str) -> None:
    yard.type_into(f"entry {MASS}", wrong)
    told = yard.find(QLabel, f"fault {MASS}")
    assert told.isVisible()
    assert told.text()
    assert yard.find(QLineEdit, f"entry {MASS}").text() == wrong
    assert yard.session.study.robot.platform.mass_kg == 180.0
    assert not yard.session.is_modified
    QTest.keyClick(yard.find(QLineEdit, f"entry {MASS}"), Qt.Key.Key_Escape)
    assert not told.isVisible()
    assert yard.find(QLineEdit, f"entry {MASS}").text() == "180 kg"


def test_what_was_refused_stays_to_be_mended(yard: Driver) -> None:
    entry, place = yard.find(QLineEdit, f"entry {MASS}"), yard.find(QLineEdit, "place x")
    yard.type_into("place x", "nowhere")
    yard.type_into(f"entry {MASS}", "190 kgg")
    yard.type_into("entry cable.density", "5000 kg/m^3")
    yard.rest()
    assert (entry.text(), place.text()) == ("190 kgg", "nowhere")
    assert entry.property("faulty")
    assert place.property("faulty")
    yard.click(entry)
    yard.keys("End")
    yard.keys("Backspace")
    yard.keys("Return")
    assert yard.session.study.robot.platform.mass_kg == 190.0
    assert not entry.property("faulty")
    yard.press("keep pose")  # the platform is where it was: what was refused stays
    assert place.text() == "nowhere"
    yard.scene.setFocus()
    yard.keys("PgUp")
    assert place.text() == "15"
    yard.rest()


@pytest.mark.parametrize("name", [f"entry {MASS}", "find field", "place x"])
def test_keys_of_menus_work_from_a_field(yard: Driver, name: str) -> None:
    entry = yard.find(QLineEdit, name)
    yard.click(entry)
    assert entry.hasFocus()
    yard.keys("Ctrl+D")
    assert yard.session.state.pin is not None
    yard.click(entry)
    yard.keys("Ctrl+E")
    assert yard.window.pages.currentWidget() is yard.window.text
    yard.keys("Ctrl+Return")
    assert yard.window.pages.currentWidget() is yard.window.work
    yard.rest()


def test_what_is_being_written_is_taken_by_the_text(yard: Driver) -> None:
    entry = yard.find(QLineEdit, f"entry {MASS}")
    yard.click(entry)
    entry.selectAll()
    QTest.keyClicks(entry, "190 kg")
    yard.keys("Ctrl+E")
    assert "mass: 190 kg" in yard.window.text.editor.toPlainText()
    yard.keys("Ctrl+Return")
    yard.rest()


def test_what_differs_is_marked_and_put_back_alone(yard: Driver) -> None:
    yard.type_into(f"entry {MASS}", "200 kg")
    yard.type_into("entry cable.density", "5000 kg/m^3")
    back = yard.find(QToolButton, f"put back {MASS}")
    assert back.isVisible()
    yard.click(back)
    assert not back.isVisible()
    assert yard.session.study.robot.platform.mass_kg == 180.0
    assert yard.session.study.material.density_kg_per_m3 == 5000.0
    yard.rest()


def test_only_what_changed_and_what_is_sought_is_listed(yard: Driver) -> None:
    rows = yard.window.study_panel.rows
    yard.type_into(f"entry {MASS}", "200 kg")
    yard.press("changed only")
    assert [path for path, row in rows.items() if row.isVisible()] == [MASS]
    yard.press("changed only")
    yard.type_into("find field", "anchors")
    assert {path.split("[")[0] for path, row in rows.items() if row.isVisible()} == {
        "robot.anchors"
    }
    yard.type_into("find field", "")
    yard.rest()


def test_a_section_folds(yard: Driver) -> None:
    row = yard.window.study_panel.rows[MASS]
    yard.press("section Robot and load")
    assert not row.isVisible()
    yard.press("section Robot and load")
    assert row.isVisible()


def test_a_slider_follows_at_once_and_is_one_step(yard: Driver) -> None:
    asked: list[str] = []
    yard.window.live.answered.connect(lambda kind, _: asked.append(kind))
    yard.slide(f"slider {MASS}", 0.55, 0.6, 0.65, 0.7, 0.75)
    assert yard.session.study.robot.platform.mass_kg > 220.0
    yard.rest()
    assert "coarse" in asked
    assert asked.index("coarse") < asked.index("fine")
    yard.keys("Ctrl+Z")
    assert yard.session.study.robot.platform.mass_kg == 180.0
    assert not yard.session.is_modified
    yard.keys("Ctrl+Shift+Z")
    assert yard.session.study.robot.platform.mass_kg > 220.0
    yard.rest()


def test_keys_move_a_slider(yard: Driver) -> None:
    slider = yard.find(QWidget, f"slider {MASS}")
    slider.setFocus()
    for _ in range(3):
        QTest.keyClick(slider, Qt.Key.Key_Right)
    assert yard.session.study.robot.platform.mass_kg > 180.0
    yard.rest()
    yard.keys("Ctrl+Z")
    assert yard.session.study.robot.platform.mass_kg == 180.0
    yard.rest()


def test_undo_takes_back_moves_and_ropes_as_well(yard: Driver) -> None:
    place = yard.place.copy()
    yard.scene.setFocus()
    yard.keys("PgUp")
    yard.rest()
    yard.press("no rope")
    yard.rest()
    assert yard.session.state.rope is None
    assert yard.window.work.quantity.currentData() == "diameter"
    yard.keys("Ctrl+Z")
    assert yard.session.state.rope is not None
    yard.keys("Ctrl+Z")
    assert yard.place == pytest.approx(place)
    yard.rest()


def test_a_place_is_typed_and_kept_as_the_pose(yard: Driver) -> None:
    yard.type_into("place z", "5.5")
    assert yard.place[2] == 5.5
    entry = yard.find(QLineEdit, "place x")
    meaning = entry.toolTip()
    yard.type_into("place x", "nowhere")
    assert entry.property("faulty")
    assert entry.toolTip() == "a number is expected"
    assert yard.place[0] == 15.0
    yard.press("keep pose")
    assert yard.session.study.pose.position_m.tolist() == [15.0, 9.0, 5.5]
    yard.type_into("place x", "14")
    assert not entry.property("faulty")
    assert entry.toolTip() == meaning != ""
    yard.rest()


def test_the_text_can_be_edited(yard: Driver) -> None:
    yard.keys("Ctrl+E")
    editor = yard.window.text.editor
    yard.bot.waitUntil(editor.isVisible)
    cursor = editor.document().find("180 kg", editor.document().find("mass:"))
    editor.setTextCursor(cursor)
    QTest.keyClicks(editor, "240 kg")
    yard.press("leave text")
    assert yard.session.study.robot.platform.mass_kg == 240.0
    yard.rest()
    yard.keys("Ctrl+Z")
    assert yard.session.study.robot.platform.mass_kg == 180.0
    yard.rest()
