"""Files of the window: opened, saved, imported, exported; plans; what goes wrong around them."""

from __future__ import annotations

import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import pytest
from PySide6.QtCore import Qt, QTimer
from PySide6.QtGui import QDesktopServices
from PySide6.QtTest import QTest
from PySide6.QtWidgets import (
    QApplication,
    QFileDialog,
    QLabel,
    QListWidget,
    QMenu,
    QMessageBox,
    QPushButton,
    QTableView,
)
from window_driver import LEFT, LONGEST_MS, Driver, built_yard, small_yard

from designer.explore.question import Long
from designer.sweeps.run import read_store

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
    driver = Driver(qtbot, tmp_path, with_plugins=True)
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
    assert yard.window.live.answers["pose"].cables
    assert yard.window.live.answers["ropes"] is None
    assert "over the workspace" in yard.window.ropes.answer.text()
    yard.window.live.begin_long("select")
    yard.rest()
    yard.type_into("entry robot.platform.mass", "240 kg")
    yard.rest()
    assert "over the workspace" in yard.window.ropes.answer.text()
