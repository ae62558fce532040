"""A pinned state beside the present one, exports, and measured data."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from PySide6.QtWidgets import QComboBox, QFileDialog, QLabel, QTableView
from window_driver import Driver, small_yard

from designer.model.cable import Cable
from designer.model.robot import Poses
from designer.statics.inverse import solve_sagging


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
    here = yard.window.live.answers["here"]
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


def built_yard(folder: Path, driver: Driver) -> Path:
    """Write the yard crane with forty measured poses, its first winch homed 50 mm wrong."""
    file = small_yard(folder)
    driver.open(file)
    robot, region = driver.session.study.robot, driver.session.study.workspace.region
    position = region.inside_m(np.random.default_rng(5), 40)
    statics = solve_sagging(robot, Poses.at(position), Cable(0.006, 0.142, 1.6e6, 5e3))
    length = statics.length_m + np.array([0.05, 0.0, 0.0])
    names = "x_m,y_m,z_m,length_1_m,length_2_m,length_3_m"
    np.savetxt(
        folder / "log.csv", np.column_stack([position, length]), "%.6f", ",", header=names,
        comments="",
    )  # fmt: skip
    built = folder / "built.yaml"
    built.write_text(
        file.read_text(encoding="utf-8") + "measurements:\n  file: log.csv\n"
        "  cable: {linear_mass: 0.142 kg/m, axial_stiffness: 1.6 MN}\n"
        "  noise: {length: 1 mm}\n",
        encoding="utf-8",
    )
    return built


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
