"""The candidates: sorted, filtered, chosen, and the whole selection."""

from __future__ import annotations

from PySide6.QtCore import QPoint, Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QComboBox, QTableView
from window_driver import LONGEST_MS, Driver

from designer.explore.question import Rope
from designer.report.design.sections import proof_statement


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
