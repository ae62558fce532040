"""The panel of the present pose tells what the command and the report tell."""

from __future__ import annotations

import math

import pytest
from PySide6.QtCore import Qt
from PySide6.QtWidgets import QLabel, QTableView
from window_driver import Driver

import designer
from designer.report import format as fmt
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
    assert yard.find(QLabel, "here diameter").text() == fmt.millimetres(float(sized.diameter_m))
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
        empty.window.live.answers["here"].cables[0].exit_tension_N, rel=1e-3
    )
    assert math.isfinite(tension)
