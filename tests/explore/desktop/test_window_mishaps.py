"""What goes wrong around the window: plugins, files that become faulty, closing in mid-work."""

from __future__ import annotations

import time
from pathlib import Path
from typing import Any

import pytest
from PySide6.QtCore import Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QFileDialog, QListWidget, QMessageBox
from test_window_compare import built_yard
from window_driver import LONGEST_MS, Driver, small_yard

from designer.plugins import find_plugins

BUTTON = QMessageBox.StandardButton


@pytest.fixture
def broken_plugin(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A plugin that has no licence."""
    site = tmp_path / "site"
    dist = site / "broken-1.0.dist-info"
    dist.mkdir(parents=True)
    (site / "broken.py").write_text("raise RuntimeError('no licence')\n", encoding="utf-8")
    (dist / "METADATA").write_text("Metadata-Version: 2.1\nName: broken\nVersion: 1.0\n", "utf-8")
    (dist / "entry_points.txt").write_text("[designer.plugins]\nbroken = broken\n", "utf-8")
    monkeypatch.syspath_prepend(str(site))


@pytest.mark.usefixtures("broken_plugin")
def test_a_plugin_that_fails_is_told_and_the_rest_works(qtbot: Any, tmp_path: Path) -> None:
    driver = Driver(qtbot, tmp_path, plugins=find_plugins())
    driver.window.files.open(small_yard(tmp_path))
    assert "no licence" in driver.window.statusBar().currentMessage()  # for some seconds
    driver.rest()
    assert "plugin broken (broken 1.0)" in driver.window.messages.toPlainText()
    assert "no licence" in driver.window.messages.toPlainText()
    assert driver.window.live.answers["ropes"].best is not None
    driver.close()


def test_a_file_that_becomes_faulty_is_shown_and_mended_by_typing(yard: Driver) -> None:
    file = yard.session.file
    text = file.read_text(encoding="utf-8")
    file.write_text(text.replace("180 kg\n", "180 apples\n"), encoding="utf-8")
    yard.window.files.look_at_disk()
    yard.press("notice Reload")
    assert yard.session.study.robot.platform.mass_kg == 180.0  # the last that was sound
    yard.keys("Ctrl+E")
    told = yard.find(QListWidget, "faults")
    assert "robot.platform.mass" in told.item(0).text()
    QTest.mouseClick(
        told.viewport(), Qt.MouseButton.LeftButton, pos=told.visualItemRect(told.item(0)).center()
    )
    editor = yard.window.text.editor
    assert editor.hasFocus()
    yard.keys("End")
    for _ in "apples":
        QTest.keyClick(editor, Qt.Key.Key_Backspace)
    QTest.keyClicks(editor, "kg")
    yard.keys("Ctrl+Return")
    yard.rest()
    assert yard.window.pages.currentWidget() is yard.window.work
    assert yard.session.faults == ()
    assert yard.session.text == text


@pytest.mark.slow
@pytest.mark.parametrize("work", ["report", "selection", "diagnosis"])
def test_closing_in_the_middle_of_long_work_loses_nothing(
    empty: Driver, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, work: str
) -> None:
    """What was changed is asked about and saved; the process ends, and leaves nothing half done."""
    empty.open(built_yard(tmp_path, empty) if work == "diagnosis" else small_yard(tmp_path))
    file = empty.session.file
    empty.type_into("entry robot.platform.mass", "190 kg")
    empty.rest()
    monkeypatch.setattr(QFileDialog, "getSaveFileName", lambda *_, **__: (str(tmp_path / "r"), ""))
    window = empty.window
    if work == "diagnosis":
        window.docks["Measured data"].raise_()
        empty.bot.wait(50)
        empty.press("diagnose")
    elif work == "selection":
        empty.press("full selection")
    else:
        empty.keys("Ctrl+R")
    kind = {"report": "export", "selection": "select", "diagnosis": "diagnose"}[work]
    helper = window.live._worker._helpers[kind]
    empty.bot.waitUntil(lambda: helper._process is not None, timeout=LONGEST_MS)
    process = helper._process
    told = empty.answer(BUTTON.Yes, BUTTON.Save)
    start = time.monotonic()
    window.close()
    assert "not finished" in told[0]
    assert "not saved" in told[1]
    assert not window.isVisible()
    assert time.monotonic() - start < 120.0
    process.join(900.0)
    assert process.exitcode is not None
    assert "mass: 190 kg" in file.read_text(encoding="utf-8")
    assert not (tmp_path / "r").exists() or not list((tmp_path / "r").iterdir())


def test_a_study_without_a_workspace_is_explored_pose_by_pose(yard: Driver, tmp_path: Path) -> None:
    text = yard.session.text
    bare = tmp_path / "bare.yaml"
    bare.write_text(text[: text.index("workspace:")], encoding="utf-8")
    yard.open(bare)
    assert yard.window.live.answers["here"].cables
    assert yard.window.live.answers["ropes"] is None
    assert "over the workspace" in yard.window.ropes.answer.text()
    yard.window.live.begin_long("select")
    yard.rest()
    yard.type_into("entry robot.platform.mass", "240 kg")
    yard.rest()
    assert "over the workspace" in yard.window.ropes.answer.text()
