"""Opening, saving, leaving; files that are faulty, change or vanish."""

from __future__ import annotations

import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import pytest
from PySide6.QtCore import Qt, QTimer
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QFileDialog, QListWidget, QMessageBox, QPushButton
from window_driver import LONGEST_MS, Driver, small_yard

BUTTON = QMessageBox.StandardButton


def test_the_start_page_shows_shipped_and_recent_studies(empty: Driver, tmp_path: Path) -> None:
    names = [one.objectName() for one in empty.window.start.findChildren(QPushButton)]
    assert {"example yard", "example cogiro", "example fast"} <= set(names)
    empty.open(small_yard(tmp_path))
    empty.keys("Ctrl+W")
    assert empty.window.pages.currentWidget() is empty.window.start
    recent = empty.find(QPushButton, "recent yard")
    empty.click(recent)
    empty.rest()
    assert empty.session.file == tmp_path / "yard.yaml"


_START = """
import sys, time
from designer.explore.desktop.app import application
from designer.explore.desktop.files import Settings
from designer.explore.desktop.window import Window
from pathlib import Path
app = application()
window = Window(Settings(Path(sys.argv[1])))
window.show()
app.processEvents()
assert window.start.isVisible()
window.close()
heavy = {"vtkmodules", "pyvista", "pyvistaqt", "matplotlib", "numba", "pydantic"} & set(sys.modules)
print(sorted(heavy), time.process_time() < 2.0)
"""


def test_start_page_needs_no_library_of_the_scene(tmp_path: Path) -> None:
    command = [sys.executable, "-c", _START, str(tmp_path / "settings.ini")]
    done = subprocess.run(command, capture_output=True, text=True, check=True, timeout=600)
    assert done.stdout.strip() == "[] True"  # in seconds of a processor


def test_ctrl_o_opens_from_every_page(
    empty: Driver, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    pages: list[Any] = []

    def ask(*_: object, **__: object) -> tuple[str, str]:
        pages.append(empty.window.pages.currentWidget())
        return "", ""

    monkeypatch.setattr(QFileDialog, "getOpenFileName", ask)
    window = empty.window
    empty.keys("Ctrl+O")
    empty.press("open")
    empty.open(small_yard(tmp_path))
    empty.keys("Ctrl+O")
    window.show_text()
    assert window.text.editor.hasFocus()
    empty.keys("Ctrl+O")
    assert pages == [window.start, window.start, window.work, window.text]


def test_new_and_import_on_the_start_page(
    empty: Driver, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    source, target = tmp_path / "rig.wcrfx", tmp_path / "rig.yaml"
    source.write_text(wirex_robot(), encoding="utf-8")
    monkeypatch.setattr(QFileDialog, "getOpenFileName", lambda *_, **__: (str(source), ""))
    monkeypatch.setattr(QFileDialog, "getSaveFileName", lambda *_, **__: (str(target), ""))
    empty.press("import")
    assert empty.session.file == target
    empty.keys("Ctrl+W")
    empty.press("new study")
    assert empty.session.file is None
    assert not empty.session.faults


def test_new_study_has_no_file(empty: Driver) -> None:
    empty.keys("Ctrl+N")
    assert empty.session.file is None
    assert "# " in empty.session.text
    assert not empty.session.faults


def wirex_robot() -> str:
    """A rig of eight cables as WireX writes it, its frame twice and its platform 0.4 m high."""
    corners = [(x, y, z) for z in (1, -1) for x in (-1, 1) for y in (-1, 1)]
    chains = "".join(
        f'<chain><base x="{3 * x}" y="{2 * y}" z="{2 + 1.8 * z}" a33="1" radius="0.03"/>'
        f'<platform x="{0.2 * x}" y="{0.1 * y}" z="{0.2 * z}"/></chain>'
        for x, y, z in corners
    )
    body = '<platform mass="40"><centerofgravity x="0" y="0" z="0.1"/></platform>'
    robot = f'<robot name="Rig" motionpattern="3R3T"><geometry>{chains}</geometry>{body}</robot>'
    return f'<models version="0.32">{robot}</models>'


def test_imported_robot_shows_fields_to_fill_in(
    empty: Driver, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    source, target = tmp_path / "rig.wcrfx", tmp_path / "rig.yaml"
    source.write_text(wirex_robot(), encoding="utf-8")
    monkeypatch.setattr(QFileDialog, "getOpenFileName", lambda *_, **__: (str(source), ""))
    monkeypatch.setattr(QFileDialog, "getSaveFileName", lambda *_, **__: (str(target), ""))
    empty.keys("Ctrl+I")
    assert empty.session.file == target
    assert empty.window.pages.currentWidget() is empty.window.text
    assert "fill in" in empty.window.text.editor.toPlainText()
    assert empty.find(QListWidget, "faults").count() > 0


def test_file_of_no_robot_is_not_imported(
    empty: Driver, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    source, target = tmp_path / "note.xml", tmp_path / "note.yaml"
    source.write_text("<note/>", encoding="utf-8")
    monkeypatch.setattr(QFileDialog, "getOpenFileName", lambda *_, **__: (str(source), ""))
    monkeypatch.setattr(QFileDialog, "getSaveFileName", lambda *_, **__: (str(target), ""))
    texts = empty.answer(BUTTON.Ok)
    empty.keys("Ctrl+I")
    assert "note.xml" in texts[0]
    assert not target.exists()
    assert empty.window.live.session is None


def test_a_shipped_study_is_opened_by_a_click_and_has_no_file(empty: Driver) -> None:
    empty.click(empty.find(QPushButton, "example yard"))
    empty.rest()
    assert empty.session.name == "Yard crane on three masts"
    assert empty.session.file is None


def test_saving_keeps_comments(yard: Driver) -> None:
    yard.type_into("entry robot.platform.mass", "190 kg")
    yard.keys("Ctrl+S")
    text = yard.session.file.read_text(encoding="utf-8")
    assert "mass: 190 kg" in text
    assert "# sheaves near the mast tops" in text
    assert not yard.window.isWindowModified()
    yard.rest()


def test_saving_under_another_name_is_asked_for(
    yard: Driver, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    other = tmp_path / "other"
    monkeypatch.setattr(QFileDialog, "getSaveFileName", lambda *_, **__: (str(other), ""))
    yard.keys("Ctrl+Shift+S")
    assert yard.session.file == tmp_path / "other.yaml"
    assert yard.session.file.is_file()
    yard.rest()


def test_a_place_that_cannot_be_written_loses_nothing(
    yard: Driver, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    nowhere = tmp_path / "no" / "such" / "folder.yaml"
    yard.type_into("entry robot.platform.mass", "190 kg")
    monkeypatch.setattr(QFileDialog, "getSaveFileName", lambda *_, **__: (str(nowhere), ""))
    told = yard.answer(BUTTON.Ok)
    yard.keys("Ctrl+Shift+S")
    assert str(nowhere) in told[0]
    assert yard.session.is_modified
    yard.rest()


def test_leaving_with_changes_is_asked_about(yard: Driver) -> None:
    yard.type_into("entry robot.platform.mass", "190 kg")
    told = yard.answer(BUTTON.Cancel)
    yard.window.close()
    assert "not saved" in told[0]
    assert yard.window.isVisible()
    told = yard.answer(BUTTON.Save)
    yard.keys("Ctrl+W")
    assert told
    assert "mass: 190 kg" in (yard.settings.recent[0]).read_text(encoding="utf-8")
    assert yard.window.pages.currentWidget() is yard.window.start


def test_changes_can_be_dropped(yard: Driver) -> None:
    file = yard.session.file
    yard.type_into("entry robot.platform.mass", "190 kg")
    told = yard.answer(BUTTON.Discard)
    yard.keys("Ctrl+W")
    assert told
    assert "mass: 180 kg" in file.read_text(encoding="utf-8")


def test_a_faulty_study_is_shown_with_all_faults_and_mended(empty: Driver, tmp_path: Path) -> None:
    file = small_yard(tmp_path)
    text = file.read_text(encoding="utf-8")
    faulty = text.replace("180 kg\n", "180 apples\n").replace("samples: 600", "samples: -3")
    file.write_text(faulty, encoding="utf-8")
    empty.open(file)
    assert empty.window.pages.currentWidget() is empty.window.text
    told = empty.find(QListWidget, "faults")
    assert told.count() == 2
    assert told.item(0).text().startswith("line 9: robot.platform.mass: ")
    assert not empty.find(QPushButton, "leave text").isEnabled()
    file.write_text(text, encoding="utf-8")
    empty.press("reload text")
    assert told.count() == 0
    empty.press("leave text")
    empty.rest()
    assert empty.window.pages.currentWidget() is empty.window.work
    assert empty.scene.stage.slice.coloured.mesh.n_cells > 0


@pytest.mark.parametrize("content", [b"", b"\xff\xfe\x00", b"[1, 2", b"name: nothing\n", None])
def test_what_is_no_study_is_told(empty: Driver, tmp_path: Path, content: bytes | None) -> None:
    file = tmp_path / "odd.yaml"
    if content is not None:
        file.write_bytes(content)
    told: list[str] = []

    def accept() -> None:
        box: Any = QApplication.activeModalWidget()
        if box is not None:
            told.append(box.text())
            QTest.mouseClick(box.button(BUTTON.Ok), Qt.MouseButton.LeftButton)

    QTimer.singleShot(200, accept)
    empty.window.files.open(file)
    empty.bot.wait(250)
    has_faults = empty.find(QListWidget, "faults").count() > 0
    assert told or has_faults
    assert empty.window.isVisible()


def test_a_file_that_another_program_changes_is_told_of(yard: Driver) -> None:
    file = yard.session.file
    text = file.read_text(encoding="utf-8").replace("180 kg\n", "185 kg\n")
    file.write_text(text, encoding="utf-8")
    yard.bot.waitUntil(
        lambda: yard.window.findChild(QPushButton, "notice Reload") is not None, timeout=LONGEST_MS
    )
    yard.press("notice Reload")
    assert yard.session.study.robot.platform.mass_kg == 185.0
    assert not yard.session.is_modified
    yard.rest()


def test_a_file_that_is_gone_is_told_of_and_written_again(yard: Driver) -> None:
    file = yard.session.file
    file.unlink()
    yard.window.files.look_at_disk()
    yard.press("notice Save")
    assert "mass: 180 kg" in file.read_text(encoding="utf-8")


def test_closing_in_the_middle_of_work_does_not_hang(empty: Driver, tmp_path: Path) -> None:
    file = small_yard(tmp_path)
    text = file.read_text(encoding="utf-8").replace("samples: 600", "samples: 3000000")
    file.write_text(text, encoding="utf-8")
    empty.window.files.open(file)
    empty.bot.waitUntil(lambda: "worst" in empty.window.live.busy, timeout=LONGEST_MS)
    empty.press("full selection")
    start = time.monotonic()
    told = empty.answer(BUTTON.Yes)
    empty.window.close()
    assert told == ["The full selection is not finished. End it?"]
    assert not empty.window.isVisible()
    assert time.monotonic() - start < 120.0  # and not the minutes that the work would take


def test_leaving_during_an_export_is_asked_about(
    yard: Driver, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(QFileDialog, "getSaveFileName", lambda *_, **__: (str(tmp_path / "r"), ""))
    yard.keys("Ctrl+R")
    told = yard.answer(BUTTON.Cancel)
    yard.window.close()
    assert told == ["The export is not finished. End it?"]
    assert yard.window.isVisible()
    assert "export" in yard.window.live.busy
    told = yard.answer(BUTTON.Yes)
    yard.keys("Ctrl+W")
    assert told == ["The export is not finished. End it?"]
    assert yard.window.pages.currentWidget() is yard.window.start
    assert yard.window.live.is_at_rest
    yard.bot.waitUntil(lambda: not list(tmp_path.glob("r/*")), timeout=LONGEST_MS)


def test_a_value_that_makes_every_pose_impossible_is_shown(yard: Driver) -> None:
    yard.type_into("entry robot.platform.mass", "100000 t")
    yard.rest()
    assert yard.scene.stage.slice.hatched.mesh.n_cells > 1000
    assert "no rope serves" in yard.scene.colour_legend.texts
    yard.keys("Ctrl+Z")
    yard.rest()
    assert yard.scene.stage.slice.hatched.mesh.n_cells == 0


def test_a_failure_in_the_worker_is_shown(yard: Driver, monkeypatch: pytest.MonkeyPatch) -> None:
    def broken(*_: object, **__: object) -> None:
        raise RuntimeError("a plugin fell over")

    monkeypatch.setattr("designer.explore.worker.map_answer", broken)
    yard.type_into("entry robot.platform.mass", "200 kg")
    yard.rest()
    assert "the map: " in yard.window.messages.toPlainText()
    assert "a plugin fell over" in yard.window.messages.toPlainText()
    assert "a plugin fell over" in yard.window.statusBar().currentMessage()
    monkeypatch.undo()
    yard.keys("Ctrl+Z")
    yard.rest()


def test_layout_theme_and_recent_files_are_remembered(
    empty: Driver, tmp_path: Path, qtbot: Any
) -> None:
    empty.open(small_yard(tmp_path))
    empty.window.menus.actions["panel This pose"].trigger()
    empty.window.menus.themes["dark"].trigger()
    assert not empty.window.docks["This pose"].isVisible()
    dark = empty.picture(empty.scene)[5, 5].sum()
    empty.window.close()
    again = Driver(qtbot, tmp_path, theme="")
    again.open(tmp_path / "yard.yaml")
    assert again.settings.theme == "dark"
    assert not again.window.docks["This pose"].isVisible()
    assert again.picture(again.scene)[5, 5].sum() == dark < 200
    assert again.settings.recent == (tmp_path / "yard.yaml",)
    again.window.menus.themes["light"].trigger()
    again.close()


def test_another_theme_takes_no_more_room(yard: Driver) -> None:
    for theme in ("dark", "light"):
        yard.window.menus.themes[theme].trigger()
        yard.rest()
        assert yard.window.width() == 1280
        assert yard.window.docks["This pose"].geometry().right() < yard.window.width()
