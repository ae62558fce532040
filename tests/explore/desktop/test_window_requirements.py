"""All that the study asks for, after the full selection: the answer, its table, and the poses."""

from __future__ import annotations

import numpy as np
import pytest
from PySide6.QtCore import QPoint, Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QLabel, QTableView
from window_driver import Driver

from designer.analysis.analyse import Analysis
from designer.model.verdict import Answer, Requirement


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
    assert answer.text().startswith("Not known yet")
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
