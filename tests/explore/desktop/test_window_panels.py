"""The panels: the pose, requirements, ropes, what results are of, and the comparison with A."""

from __future__ import annotations

import math
import threading
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PySide6.QtCore import QPoint, Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QComboBox, QFileDialog, QLabel, QTableView
from window_driver import LONGEST_MS, Driver, built_yard

import designer
from designer.analysis.analyse import Analysis
from designer.explore import worker
from designer.explore.question import Rope
from designer.model.verdict import Answer, Requirement
from designer.report import format as fmt
from designer.report.design.sections import proof_statement
from designer.statics.inverse import solve_sagging
from designer.statics.modes import platform_modes


def test_the_same_numbers_as_the_command(yard: Driver) -> None:
    yard.press("no rope")  # the command sizes with the configured family
    yard.rest()
    sized = designer.size(designer.read_study(yard.session.path)).sizing
    table = yard.find(QTableView, "cables").model()
    for cable in range(3):
        row = [table.index(cable, column).data() for column in range(table.columnCount())]
        statics = sized.statics
        assert row[0] == str(cable + 1)
        assert row[1] == fmt.fixed(float(statics.length_m[cable]), 3)
        assert row[2] == fmt.number(float(statics.exit_tension_N[cable]) / 1e3, 4)
        assert row[3] == fmt.number(float(statics.platform_tension_N[cable]) / 1e3, 4)
    assert yard.find(QLabel, "pose diameter").text() == fmt.millimetres(float(sized.diameter_m))
    assert (
        yard.find(QLabel, "verdict").text() == "The cables hold the platform; both residuals "
        "are within tolerance."
    )


def test_every_head_says_what_it_is(yard: Driver) -> None:
    for name in ("cables", "candidates"):
        model = yard.find(QTableView, name).model()
        for column in range(model.columnCount()):
            tip = model.headerData(column, Qt.Orientation.Horizontal, Qt.ItemDataRole.ToolTipRole)
            assert tip
            assert len(tip) > len("<p></p>")


def test_modes_move_in_a_window_of_their_own(yard: Driver) -> None:
    """Frequencies are those of the rope at this pose; what nothing holds has none."""
    yard.press("modes")
    shown, live = yard.window.pose.modes, yard.window.live
    yard.bot.waitUntil(shown.isVisible)
    assert live.question is not None
    statics = solve_sagging(live.question.robot, live.question.pose, live.question.cable)
    density = live.question.cable.linear_density_kg_per_m
    modes = platform_modes(statics, live.question.robot.platform, density)
    assert [shown.chosen.itemText(k).split(": ")[1] for k in range(shown.chosen.count())] == [
        f"{fmt.number(mode.frequency_Hz, 3)} Hz" for mode in modes
    ]
    shown.chosen.setCurrentIndex(2)
    first = shown.view.grab().toImage()
    yard.bot.waitUntil(lambda: shown.view.grab().toImage() != first)
    still = shown.view.grab().toImage()
    yard.type_into("place z", "40")
    yard.rest()
    assert shown.chosen.count() == 0
    assert shown.words.text().startswith("No cables hold the platform here")
    assert shown.view.grab().toImage() != still
    shown.close()


def test_a_pose_that_nothing_holds_is_told(yard: Driver) -> None:
    yard.type_into("place z", "40")
    yard.rest()
    verdict = yard.find(QLabel, "verdict")
    assert verdict.text().startswith("No tensions of taut cables hold the platform")
    assert verdict.property("role") == "fault"
    assert yard.find(QTableView, "cables").model().rowCount() == 0
    assert "lies outside the region" in yard.find(QLabel, "cautions").text()
    chords = yard.scene.stage.cables.mesh.points
    assert len(chords) == 6  # straight lines


def test_small_robots_are_told_in_newtons(empty: Driver) -> None:
    empty.open("ipanema")
    model = empty.find(QTableView, "cables").model()
    assert model.headerData(2, Qt.Orientation.Horizontal).endswith("\nN")
    tension = float(model.index(0, 2).data().replace("\u202f", ""))
    assert tension == pytest.approx(
        empty.window.live.answers["pose"].cables[0].exit_tension_N, rel=1e-3
    )
    assert math.isfinite(tension)


def table(driver: Driver) -> QTableView:
    """The table of requirements, in front."""
    driver.window.docks["Requirements"].raise_()
    driver.bot.wait(50)
    return driver.find(QTableView, "all requirements")


def cells(view: QTableView) -> list[list[str]]:
    """What it shows, from the top."""
    model = view.model()
    columns = range(model.columnCount())
    return [[model.index(row, k).data() for k in columns] for row in range(model.rowCount())]


def click(view: QTableView, row: int) -> None:
    """Click on a row."""
    at = view.visualRect(view.model().index(row, 1)).center()
    QTest.mouseClick(view.viewport(), Qt.MouseButton.LeftButton, pos=QPoint(at))


def titled(driver: Driver, title: str) -> Requirement:
    """The requirement of this title."""
    requirements = driver.window.live.answers["ropes"].requirements
    return next(each for each in requirements if each.title == title)


@pytest.mark.slow
def test_every_requirement_is_shown_and_a_click_goes_to_its_pose(yard: Driver) -> None:
    yard.type_into("entry workspace.samples", "100")
    yard.type_into("entry workspace.proof", "0 s")
    yard.type_into("entry selection.limits.drum_capacity", "1 m")
    yard.rest()
    answer = yard.find(QLabel, "answer")
    view = table(yard)
    assert cells(view) == []
    assert answer.text().startswith("Not evaluated yet")
    yard.press("evaluate all")
    yard.rest()
    ropes, question = yard.window.live.answers["ropes"], yard.window.live.question
    analysis = Analysis.begin(question.study, question.catalogue)
    assert ropes.answer is analysis.answer is Answer.NO
    assert [each.words for each in ropes.requirements] == [
        each.words for each in analysis.requirements
    ]
    shown = cells(view)
    assert len(shown) == len(analysis.requirements) > 3
    assert shown[0][:2] == ["does not hold", "Drum"]
    assert shown[0][4].split() == ["1.00", "m"]
    assert {row[0] for row in shown[1:]} == {"holds"}
    told = answer.text().replace("\u00a0", " ")
    assert told == f"No: of {len(shown)} requirements 1 not met."
    assert answer.property("role") == "fault"
    assert yard.find(QLabel, "best rope").text().startswith("No: ")
    row = next(k for k, each in enumerate(shown) if each[1] == "Breaking load")
    place = titled(yard, "Breaking load").place
    assert not np.allclose(yard.place[:3], place[:3])
    click(view, row)
    yard.rest()
    assert yard.place[:3].tolist() == place[:3].tolist()
    click(view, 0)  # of no pose: the platform stays
    assert yard.place[:3].tolist() == place[:3].tolist()
    yard.keys("Ctrl+Z")
    yard.rest()
    assert not answer.property("old")
    yard.type_into("entry robot.platform.mass", "190 kg")
    yard.rest()
    assert answer.property("old")
    assert view.property("old")
    assert cells(view) == shown
    yard.keys("Ctrl+Z")
    yard.rest()
    assert not answer.property("old")
    assert not view.property("old")


@pytest.mark.slow
def test_a_study_of_a_pose_alone_has_an_answer_as_well(yard: Driver) -> None:
    text = yard.session.text
    bare = yard.session.file.with_name("bare.yaml")
    bare.write_text(text[: text.index("workspace:")], encoding="utf-8")
    yard.open(bare)
    view = table(yard)
    yard.press("evaluate all")
    yard.rest()
    assert cells(view)[0][:2] == ["holds", "Configured pose"]
    assert yard.find(QLabel, "answer").text().startswith("Yes, for one pose at rest: 1")
    assert yard.find(QLabel, "answer").property("role") == "good"
    click(view, 0)
    yard.rest()
    assert np.array_equal(yard.place, yard.session.study.pose.place)


def test_study_that_asks_for_no_rope_needs_no_selection(yard: Driver) -> None:
    text = yard.session.text
    bare = yard.session.file.with_name("bare.yaml")
    bare.write_text(text[: text.index("selection:")], encoding="utf-8")
    yard.open(bare)
    question = yard.window.live.question
    analysis = Analysis.begin(question.study, question.catalogue)
    view = table(yard)
    assert len(cells(view)) == len(analysis.requirements) > 3
    assert {row[1] for row in cells(view)} == {each.title for each in analysis.requirements}
    assert yard.find(QLabel, "answer").text().startswith("Yes, for one static case: 5")
    yard.type_into("entry workspace.sag", "0.001")
    yard.rest()
    assert yard.find(QLabel, "answer").text().startswith("No: ")
    assert cells(view)[0][:2] == ["does not hold", "Sag"]
    assert not yard.find(QLabel, "answer").property("old")


def shown(driver: Driver, column: int = 0) -> list[str]:
    """What a column shows, from the top."""
    model = driver.find(QTableView, "candidates").model()
    return [model.index(row, column).data() for row in range(model.rowCount())]


def test_the_best_stands_first_bold_and_colours_the_map(yard: Driver) -> None:
    ropes = yard.window.live.answers["ropes"]
    model = yard.find(QTableView, "candidates").model()
    first = model.index(0, 0)
    assert first.data() == ropes.best.size_id
    assert first.data(Qt.ItemDataRole.FontRole).bold()
    assert yard.session.state.rope == ropes.best
    assert not yard.session.is_modified


def test_a_click_on_a_row_colours_the_map_by_it(yard: Driver) -> None:
    table = yard.find(QTableView, "candidates")
    before = yard.window.work.map.on("slice", "utilisation").copy()
    QTest.mouseClick(
        table.viewport(), Qt.MouseButton.LeftButton, Qt.KeyboardModifier.NoModifier,
        table.visualRect(table.model().index(3, 0)).center(),
    )  # fmt: skip
    yard.rest()
    assert yard.session.state.rope.size_id == shown(yard)[3]
    after = yard.window.work.map.on("slice", "utilisation")
    assert abs(after - before).max() > 0.001


def test_a_click_on_a_head_sorts(yard: Driver) -> None:
    head = yard.find(QTableView, "candidates").horizontalHeader()
    at = QPoint(head.sectionViewportPosition(4) + 20, head.height() // 2)
    yard.click(head.viewport(), at)
    sizes = [float(text) for text in shown(yard, 4)]
    assert sizes in (sorted(sizes), sorted(sizes, reverse=True))
    yard.click(head.viewport(), at)
    assert [float(text) for text in shown(yard, 4)] == sizes[::-1]


def test_filters_narrow_the_list(yard: Driver) -> None:
    every = len(shown(yard))
    yard.press("only what holds")
    assert 0 < len(shown(yard)) < every
    yard.press("only what holds")
    box = yard.find(QComboBox, "maker")
    box.setFocus()
    QTest.keyClick(box, Qt.Key.Key_Down)
    assert set(shown(yard, 2)) == {box.currentText()}
    QTest.keyClick(box, Qt.Key.Key_Up)
    assert len(shown(yard)) == every


def test_the_best_follows_the_study_and_the_choice_stays(yard: Driver) -> None:
    chosen = yard.session.state.rope
    yard.type_into("entry robot.platform.mass", "260 kg")
    yard.rest()
    ropes = yard.window.live.answers["ropes"]
    assert ropes.best != chosen
    assert yard.session.state.rope == chosen
    assert shown(yard)[0] == ropes.best.size_id
    reasons = dict(zip(shown(yard), shown(yard, 13), strict=True))
    assert "allowable tension" in reasons[chosen.size_id]


def test_the_whole_selection_is_made_with_progress(yard: Driver) -> None:
    told: list[str] = []
    yard.window.live.progressed.connect(lambda kind, *_: told.append(kind))
    answer = yard.window.ropes.answer
    assert answer.text().endswith("(at the samples, not proved)")
    yard.press("full selection")
    assert yard.window.status.long.isVisible()
    yard.rest()
    assert not yard.window.status.long.isVisible()
    proof = proof_statement(yard.window.live.answers["ropes"].proof)
    assert proof.title.startswith("Proved for all poses: at most")
    assert answer.text().endswith(f"as well)\n{proof.title}. {proof.text}")
    assert "select" in told
    assert yard.window.live.answers["ropes"].is_final
    assert isinstance(yard.window.live.answers["ropes"].best, Rope)


def test_the_whole_selection_can_be_cancelled(yard: Driver) -> None:
    yard.type_into("entry workspace.samples", "2000000")
    yard.press("full selection")
    yard.press("cancel")
    yard.bot.waitUntil(lambda: "select" not in yard.window.live.busy, timeout=LONGEST_MS)
    assert not yard.window.status.long.isVisible()
    assert not yard.window.live.answers["ropes"].is_final
    yard.keys("Ctrl+Z")
    yard.rest()


def test_the_whole_selection_is_given_up_when_the_study_changes(yard: Driver) -> None:
    yard.type_into("entry workspace.samples", "2000000")
    yard.press("full selection")
    yard.type_into("entry workspace.samples", "100")
    assert "select" not in yard.window.live.busy
    assert not yard.window.status.long.isVisible()
    assert "given up, since the study has changed" in yard.window.messages.toPlainText()
    yard.rest()
    assert not yard.window.live.answers["ropes"].is_final
    assert "not proved" in yard.window.ropes.answer.text()


FAMILY = "Thinnest cable of the family"


def test_map_and_pose_name_the_rope_that_they_are_of(yard: Driver) -> None:
    legend, here = yard.scene.colour_legend, yard.find(QLabel, "pose cables")
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
    names = ("verdict", "pose tension", "best rope")
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

    for name in ("pose_answer", "map_answer"):
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


def differences(driver: Driver) -> dict[str, list[str]]:
    """What the table of differences shows."""
    model = driver.find(QTableView, "differences").model()
    rows = [[model.index(r, c).data() for c in range(4)] for r in range(model.rowCount())]
    return {row[0]: row[1:] for row in rows}


def test_differences_follow_the_study(yard: Driver) -> None:
    yard.keys("Ctrl+D")
    assert all(row[2].startswith("0 ") for row in differences(yard).values())
    yard.type_into("entry robot.platform.mass", "230 kg")
    yard.rest()
    found = differences(yard)
    assert found["Platform with payload"] == ["180 kg", "230 kg", ""]
    here = yard.window.live.answers["pose"]
    assert found["Diameter needed here"][1] == f"{1e3 * here.diameter_m:.3f} mm"
    assert found["Diameter needed here"][2].startswith("+")
    yard.window.docks["Compare"].raise_()
    assert " lost: " in yard.find(QLabel, "ropes gained and lost").text()
    yard.keys("Ctrl+Z")
    yard.rest()
    assert "Platform with payload" not in differences(yard)


def test_the_map_shows_the_difference_to_a(yard: Driver) -> None:
    yard.keys("Ctrl+D")
    yard.type_into("entry robot.platform.mass", "230 kg")
    yard.rest()
    yard.window.docks["Compare"].raise_()
    before = yard.picture(yard.scene)
    yard.press("difference in the map")
    yard.rest()
    levels = yard.scene.colour_legend.steps.levels
    assert yard.scene.colour_legend.texts[0].endswith("now less A")
    assert levels[0] == -levels[-1]
    assert (yard.picture(yard.scene) != before).any(axis=2).mean() > 0.02
    yard.press("release")
    yard.rest()
    assert yard.scene.colour_legend.texts[0] == "Utilisation of the rope [%]"


def test_picture_tables_and_map_are_written(
    yard: Driver, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def ask(name: str) -> None:
        monkeypatch.setattr(
            QFileDialog, "getSaveFileName", lambda *_, **__: (str(tmp_path / name), "")
        )

    ask("scene")
    yard.keys("Ctrl+Shift+P")
    assert (tmp_path / "scene.png").stat().st_size > 5000
    ask("tables")
    yard.keys("Ctrl+Shift+T")
    yard.rest()
    assert {one.name for one in (tmp_path / "tables").iterdir()} == {
        "cables.csv", "map.csv", "ropes.csv",
    }  # fmt: skip
    ask("map.vtu")
    yard.keys("Ctrl+Shift+M")
    yard.rest()
    assert (tmp_path / "map.vtu").is_file()
    assert "map.vtu" in yard.window.messages.toPlainText()


@pytest.mark.slow
def test_the_report_is_written_as_by_the_command(
    yard: Driver, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    folder = tmp_path / "out"
    monkeypatch.setattr(QFileDialog, "getSaveFileName", lambda *_, **__: (str(folder), ""))
    yard.keys("Ctrl+R")
    assert yard.window.status.long.isVisible()
    yard.rest()
    names = {one.name for one in folder.iterdir()}
    assert {"report.html", "report.pdf", "result.json", "workspace.nc"} <= names
    assert yard.window.findChild(QLabel) is not None


def test_residuals_are_drawn_and_seen_in_the_scene(empty: Driver, tmp_path: Path) -> None:
    empty.open(built_yard(tmp_path, empty))
    assert empty.window.docks["Measured data"].isVisible() or empty.window.isVisible()
    empty.window.docks["Measured data"].raise_()
    empty.bot.wait(50)
    channel = empty.find(QComboBox, "channel")
    channel.setFocus()
    empty.keys("Down")
    assert channel.currentText() == "length 1"
    points = empty.window.measured.plot.points
    assert points.shape == (40, 2)
    assert points[:, 1] == pytest.approx(np.full(40, 0.05), abs=2e-5)
    over = empty.find(QComboBox, "covariate")
    over.setFocus()
    empty.keys("Down")
    assert not np.array_equal(points[:, 0], empty.window.measured.plot.points[:, 0])
    empty.press("rows in the scene")
    assert empty.scene.stage.rows.mesh.n_points == 40
    assert any("measured rows" in text for text in empty.scene.overlay.texts())


@pytest.mark.slow
def test_a_diagnosis_is_made_and_taken_over(empty: Driver, tmp_path: Path) -> None:
    empty.open(built_yard(tmp_path, empty))
    empty.window.docks["Measured data"].raise_()
    empty.bot.wait(50)
    empty.press("diagnose")
    assert empty.window.status.long.isVisible()
    empty.rest()
    told = empty.find(QLabel, "diagnosis").text()
    assert "winch of cable 1 was homed at the wrong length" in told
    empty.press("take over")
    empty.rest()
    assert "winch_zero" in empty.session.text
    assert np.nanmax(np.abs(empty.window.live.answers["residuals"].residual[:, 0])) < 0.005
    empty.keys("Ctrl+Z")
    assert "winch_zero" not in empty.session.text
    empty.rest()
