"""The scene: what is seen, and what mouse and keys do in it."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from PySide6.QtCore import QPoint, Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QCheckBox, QComboBox, QLabel, QPushButton, QWidget
from window_driver import LEFT, LONGEST_MS, Driver, n_colours, small_yard

from designer.explore.desktop.scene import snapped
from designer.report import format as fmt


def slice_point(driver: Driver, ring: int = 10, spoke: int = 20) -> np.ndarray:
    """A point of the slice in view."""
    return np.asarray(driver.window.work.map.grids["slice"][ring, spoke])


def test_map_and_legend_are_seen(yard: Driver) -> None:
    assert n_colours(yard.picture(yard.scene)) > 10
    legend = yard.scene.colour_legend
    assert legend.isVisible()
    assert legend.texts[0] == "Utilisation of the rope [%]"
    assert len(legend.texts) > 4
    assert n_colours(yard.picture(legend)) >= legend.steps.colormap.N


def test_another_quantity_changes_map_and_legend(yard: Driver) -> None:
    before = yard.picture(yard.scene)
    yard.keys("Ctrl+2")
    yard.rest()
    assert yard.find(QComboBox, "quantity").currentText() == "Needed diameter"
    assert yard.scene.colour_legend.texts[0] == "Needed diameter [mm]"
    assert (yard.picture(yard.scene) != before).any(axis=2).mean() > 0.02


@pytest.mark.parametrize("number", range(1, 8))
def test_every_quantity_is_drawn(yard: Driver, number: int) -> None:
    yard.keys(f"Ctrl+{number}")
    yard.rest()
    painting = yard.window.work.painting
    assert painting is not None
    assert painting.quantity.key == yard.window.work.quantity.currentData()
    assert yard.scene.stage.slice.coloured.mesh.n_cells > 1000


def test_a_click_takes_the_platform_there(yard: Driver) -> None:
    wanted = slice_point(yard)
    yard.click(yard.scene, yard.pixel(wanted))
    yard.rest()
    assert np.linalg.norm(yard.place[:3] - wanted) < 0.3
    ends = np.asarray(yard.scene.stage.cables.mesh.points).reshape(3, -1, 3)[:, -1]
    assert ends == pytest.approx(np.tile(yard.place[:3], (3, 1)), abs=1e-6)


def test_dragging_the_ring_keeps_the_height(yard: Driver) -> None:
    before = yard.place.copy()
    start = yard.pixel(before[:3])
    yard.drag(yard.scene, start, *(start + QPoint(k * 8, k * 3) for k in range(1, 9)))
    yard.rest()
    assert np.linalg.norm(yard.place[:2] - before[:2]) > 1.0
    assert yard.place[2] == pytest.approx(before[2])
    yard.keys("Ctrl+Z")
    assert yard.place == pytest.approx(before)  # one drag is one step


def test_dragging_the_arrow_lifts(yard: Driver) -> None:
    before = yard.place.copy()
    start = yard.pixel(before[:3]) - QPoint(0, 28)
    yard.drag(yard.scene, start, *(start - QPoint(0, k * 5) for k in range(1, 7)))
    yard.rest()
    assert yard.place[:2] == pytest.approx(before[:2])
    assert yard.place[2] > before[2] + 0.5


def test_keys_move_by_steps_along_the_axes(yard: Driver) -> None:
    step, start = yard.window.work.scene.step_m, yard.place.copy()
    yard.scene.setFocus()
    yard.keys("Right")
    right = yard.place - start
    assert sorted(np.abs(right)) == pytest.approx([0, 0, 0, 0, 0, step])
    assert yard.pixel(yard.place[:3]).x() > yard.pixel(start[:3]).x()
    yard.keys("Shift+Left")
    assert yard.place - start == pytest.approx(-9.0 * right)
    yard.keys("PgUp")
    assert yard.place[2] - start[2] == pytest.approx(step)
    yard.keys("Shift+PgDown")
    assert yard.place[2] - start[2] == pytest.approx(-9.0 * step)
    yard.keys("Ctrl+PgUp")
    assert not yard.place[3:].any()  # a point mass does not turn
    yard.rest()


def test_keys_turn_a_platform(empty: Driver) -> None:
    empty.open("ipanema")
    empty.scene.setFocus()
    empty.keys("Ctrl+Right")
    assert np.degrees(np.linalg.norm(empty.place[3:])) == pytest.approx(1.0)
    empty.keys("Ctrl+Shift+Up")
    assert np.degrees(np.linalg.norm(empty.place[3:])) == pytest.approx(10.05, abs=0.1)
    empty.rest()
    assert empty.window.live.answers["pose"].cables


def test_the_mouse_reads_the_map(yard: Driver) -> None:
    work = yard.window.work
    wanted = slice_point(yard)
    value = float(work.map.on("slice", "utilisation")[10, 20])
    QTest.mouseMove(yard.scene, yard.pixel(wanted))
    yard.bot.waitUntil(lambda: yard.scene.overlay.pointed is not None, timeout=LONGEST_MS)
    text = yard.scene.overlay.pointed[1]
    assert text.startswith("Utilisation of the rope: ")
    assert f"{fmt.number(100.0 * value, 4)} %" in text
    assert fmt.position(wanted) in text


def test_dragging_elsewhere_turns_the_view_alone(yard: Driver) -> None:
    place, view = yard.place.copy(), yard.scene.view
    yard.drag(yard.scene, QPoint(30, 400), QPoint(60, 420), QPoint(120, 440))
    assert yard.scene.view.azimuth_rad != view.azimuth_rad
    assert yard.place == pytest.approx(place)
    yard.keys("Home")
    assert yard.scene.view.azimuth_rad == pytest.approx(view.azimuth_rad)


def test_the_wheel_zooms_at_the_mouse(yard: Driver) -> None:
    from PySide6.QtCore import QPointF, Qt
    from PySide6.QtGui import QWheelEvent
    from PySide6.QtWidgets import QApplication

    point = slice_point(yard)
    at, before = QPointF(yard.pixel(point)), yard.scene.view.pixels_per_m
    where = yard.scene.mapToGlobal(at)
    none = Qt.MouseButton.NoButton
    event = QWheelEvent(
        at, where, QPoint(), QPoint(0, 240), none, Qt.KeyboardModifier.NoModifier,
        Qt.ScrollPhase.NoScrollPhase, False,
    )  # fmt: skip
    QApplication.sendEvent(yard.scene, event)
    assert yard.scene.view.pixels_per_m > 1.2 * before
    assert (yard.pixel(point) - at.toPoint()).manhattanLength() <= 2


def test_the_slice_follows_its_slider(yard: Driver) -> None:
    low = slice_point(yard)[2]
    slider = yard.find(QWidget, "slice height")
    middle, top = QPoint(slider.width() // 2, slider.height() // 2), QPoint(8, 10)
    yard.drag(slider, middle, QPoint(8, slider.height() // 4), top)
    yard.rest()
    assert slice_point(yard)[2] > low + 2.0
    heights = np.asarray(yard.scene.stage.slice.coloured.mesh.points)[:, 2]
    assert np.unique(heights) == pytest.approx([slice_point(yard)[2]])


def test_surface_and_slice_come_and_go(yard: Driver) -> None:
    both = yard.picture(yard.scene)
    yard.press("show surface")
    yard.press("show slice")
    yard.rest()
    assert not yard.scene.stage.shell.is_visible
    assert not yard.find(QWidget, "slice height").isVisible()
    assert n_colours(yard.picture(yard.scene)) < n_colours(both)


def test_sag_is_exaggerated_for_the_eye_alone(yard: Driver) -> None:
    def deviation() -> float:
        curves = np.asarray(yard.scene.stage.cables.mesh.points).reshape(3, -1, 3)
        share = np.linspace(0.0, 1.0, curves.shape[1])[:, None]
        straight = curves[:, :1] + share * (curves[:, -1:] - curves[:, :1])
        return float(np.abs(curves - straight).max())

    true, sag_m = deviation(), yard.window.live.answers["pose"].cables[0].sag_m
    box = yard.find(QComboBox, "sag exaggeration")
    box.setFocus()
    yard.keys("Down")
    yard.keys("Down")
    assert deviation() == pytest.approx(5.0 * true, rel=1e-6)
    assert yard.window.live.answers["pose"].cables[0].sag_m == sag_m
    assert "sag exaggerated 5 times" in yard.scene.overlay.texts()


def test_what_no_rope_serves_is_hatched(yard: Driver) -> None:
    assert yard.scene.stage.slice.hatched.mesh.n_cells == 0
    yard.type_into("entry robot.platform.mass", "2 t")
    yard.rest()
    assert yard.scene.stage.slice.hatched.mesh.n_cells > 100
    assert "no rope serves" in yard.scene.colour_legend.texts


def test_the_worst_pose_is_marked_and_can_be_visited(yard: Driver) -> None:
    worst = yard.window.live.answers["worst"].place
    assert yard.scene.overlay.worst[0] == pytest.approx(worst[:3])
    assert "worst pose" in yard.scene.overlay.texts()
    yard.keys("Ctrl+G")
    assert yard.place == pytest.approx(worst)
    yard.rest()


def test_a_held_scale_keeps_its_steps(yard: Driver) -> None:
    steps = yard.scene.colour_legend.steps.levels.copy()
    yard.press("hold scale")
    yard.type_into("entry robot.platform.mass", "230 kg")
    yard.rest()
    assert yard.scene.colour_legend.steps.levels == pytest.approx(steps)
    yard.press("hold scale")
    assert yard.scene.colour_legend.steps.levels[-1] > steps[-1]


# Exit points, the rule, and what moves


def test_positions_snap_to_other_points_then_to_the_grid() -> None:
    others = np.array([[0.0, 0.0, 11.5], [26.0, 15.0, 12.0]])
    free = np.array([True, True, False])
    at, alike = snapped(np.array([25.9, 7.38, 9.87]), others, 0.5, 0.2, free)
    assert at.tolist() == [26.0, 7.5, 9.87]
    assert alike.tolist() == [1, -1, -1]
    at, alike = snapped(np.array([25.7, 0.1, 11.4]), others, 0.5, 0.2, np.full(3, True))
    assert at.tolist() == [25.5, 0.0, 11.5]
    assert alike.tolist() == [-1, 0, 0]


def drag_exit_point(driver: Driver, number: int, *steps: QPoint, keys: Qt.KeyboardModifier) -> None:
    """Drag an exit point over these steps from where it is."""
    scene, start = driver.scene, driver.pixel(driver.scene.exit_points_m[number])
    QTest.mousePress(scene, LEFT, keys, start)
    for step in steps:
        event_at = start + step
        QTest.mouseMove(scene, event_at)
        QTest.qWait(5)
    QTest.mouseRelease(scene, LEFT, keys, start + steps[-1])


def test_dragging_an_exit_point_edits_the_study(yard: Driver) -> None:
    before, text = yard.session.study.robot.exit_points_m.copy(), yard.session.text
    place, step = yard.place.copy(), yard.scene.step_m
    steps = [QPoint(4 * k, -2 * k) for k in range(1, 9)]
    drag_exit_point(yard, 0, *steps, keys=Qt.KeyboardModifier.NoModifier)
    yard.rest()
    after = yard.session.study.robot.exit_points_m
    assert (after[1:] == before[1:]).all()
    assert after[0, 2] == before[0, 2]
    assert np.linalg.norm(after[0] - before[0]) > step
    for value, others in zip(after[0, :2], before[1:, :2].T, strict=True):
        assert value in others or value == pytest.approx(step * round(value / step))
    assert yard.place == pytest.approx(place)
    assert "# sheaves near the mast tops" in yard.session.text
    assert yard.scene.overlay.chosen_m == pytest.approx(after[0])
    yard.keys("Ctrl+Z")
    yard.rest()
    assert yard.session.text == text  # one drag is one step


def test_an_exit_point_takes_the_coordinate_of_another(yard: Driver) -> None:
    points = yard.session.study.robot.exit_points_m
    start, row_of = yard.pixel(points[2]), points[2].copy()
    row_of[0] = points[1][0] + 2.0 / yard.scene.view.pixels_per_m
    step = yard.pixel(row_of) - start
    drag_exit_point(yard, 2, step / 2, step, keys=Qt.KeyboardModifier.NoModifier)
    yard.rest()
    assert yard.session.study.robot.exit_points_m[2, 0] == points[1, 0]
    yard.keys("Ctrl+Z")
    yard.rest()


def test_ctrl_leaves_an_exit_point_between_the_lines_of_the_grid(yard: Driver) -> None:
    step = yard.scene.step_m
    drag_exit_point(yard, 0, QPoint(11, -7), keys=Qt.KeyboardModifier.ControlModifier)
    yard.rest()
    x, y, _ = yard.session.study.robot.exit_points_m[0] / step
    assert abs(x - round(x)) > 0.01 or abs(y - round(y)) > 0.01
    yard.keys("Ctrl+Z")
    yard.rest()


def test_the_arrow_of_an_exit_point_lifts_it(yard: Driver) -> None:
    before = yard.session.study.robot.exit_points_m.copy()
    at = yard.pixel(before[2])
    yard.click(yard.scene, at)
    assert yard.scene.chosen == 2
    assert yard.session.study.robot.exit_points_m == pytest.approx(before)
    yard.drag(yard.scene, at - QPoint(0, 28), *(at - QPoint(0, 28 + 5 * k) for k in range(1, 7)))
    yard.rest()
    after = yard.session.study.robot.exit_points_m
    assert after[2, :2] == pytest.approx(before[2, :2])
    assert after[2, 2] > before[2, 2]
    yard.click(yard.scene, QPoint(12, yard.scene.height() - 12))
    assert yard.scene.chosen is None


def test_an_exit_point_that_is_refused_is_told(yard: Driver) -> None:
    points = yard.session.study.robot.exit_points_m
    yard.window.live.move_exit_point(0, points[1], False)
    assert "is the same point as" in yard.window.messages.toPlainText()
    assert (yard.session.study.robot.exit_points_m == points).all()
    yard.rest()


def test_the_rule_measures_between_two_points(yard: Driver) -> None:
    points, place = yard.session.study.robot.exit_points_m, yard.place.copy()
    yard.keys("Ctrl+M")
    rule = yard.find(QCheckBox, "rule")
    yard.bot.waitUntil(rule.isChecked, timeout=LONGEST_MS)
    for point in (points[0], points[2]):
        yard.click(yard.scene, yard.pixel(point))
    apart = points[2] - points[0]
    text = yard.scene.overlay.rule_text()
    assert text.startswith(f"{np.linalg.norm(apart):.3f} m")
    assert fmt.position(apart) in text
    assert text in yard.scene.overlay.texts()
    wanted = slice_point(yard)
    yard.click(yard.scene, yard.pixel(wanted))  # begins anew, on the map
    assert len(yard.scene.overlay.rule_m) == 1
    assert yard.scene.overlay.rule_m[0] == pytest.approx(wanted, abs=0.3)
    assert yard.place == pytest.approx(place)
    assert yard.scene.chosen is None
    yard.keys("Ctrl+M")
    yard.bot.waitUntil(lambda: not rule.isChecked(), timeout=LONGEST_MS)
    assert not yard.scene.overlay.rule_m


def test_a_path_is_played(yard: Driver) -> None:
    file = yard.session.file
    file.with_name("path.csv").write_text(
        "time_s,x_m,y_m,z_m\n0,12,9,4\n1,15,9,5\n2,18,9,4\n", encoding="utf-8"
    )
    text = yard.session.text
    region = text[text.index("  region:") : text.index("  samples:")]
    file.write_text(text.replace(region, "  path: path.csv\n"), encoding="utf-8")
    player = yard.find(QCheckBox, "play path")
    assert not player.isVisible()
    yard.open(file)
    assert player.isVisible()
    before, seen = yard.place.copy(), []
    yard.window.live.listen(lambda answer: answer and seen.append(answer.statics.poses), "pose")
    yard.keys("Ctrl+P")
    yard.bot.waitUntil(lambda: yard.scene.overlay.note.startswith("path: "), timeout=LONGEST_MS)
    yard.bot.waitUntil(lambda: not player.isChecked(), timeout=LONGEST_MS)
    yard.rest()
    assert yard.place[:3].tolist() == [18.0, 9.0, 4.0]
    assert len({tuple(pose.position_m) for pose in seen}) > 2
    assert not yard.scene.overlay.note
    yard.keys("Ctrl+Z")
    assert yard.place == pytest.approx(before)
    yard.rest()


def test_a_mode_moves_in_the_scene(yard: Driver) -> None:
    yard.press("modes")
    modes, stage = yard.window.pose.modes, yard.scene.stage
    modes.in_scene.click()
    ends = []

    def look() -> bool:
        points = np.array(stage.cables.mesh.points).reshape(3, -1, 3)
        assert points[:, 0] == pytest.approx(yard.scene.exit_points_m)
        assert points[:, -1] == pytest.approx(stage.attachments_m)
        ends.append(points[0, -1])
        return bool(np.ptp(ends, axis=0).max() > 0.1)

    yard.bot.waitUntil(look, timeout=LONGEST_MS)
    shape = yard.window.live.answers["pose"].modes.modes[0].shape
    away = np.array(ends) - yard.place[:3]
    assert np.cross(away, shape[:3]) == pytest.approx(np.zeros_like(away), abs=1e-3)
    modes.hide()
    assert np.array(stage.attachments_m) == pytest.approx(np.tile(yard.place[:3], (3, 1)))


@pytest.mark.parametrize("size", [(1024, 700), (1280, 800), (2560, 1440)])
@pytest.mark.parametrize("study", ["yard", "ipanema"])
def test_nothing_is_cut_off(
    empty: Driver, tmp_path: Path, size: tuple[int, int], study: str
) -> None:
    window = empty.window
    window.resize(*size)
    empty.open(small_yard(tmp_path) if study == "yard" else study)
    assert (window.width(), window.height()) == size
    parts = [*window.findChildren(QLabel), *window.findChildren(QPushButton)]
    cut = [
        part.text()
        for part in [*parts, *window.findChildren(QCheckBox)]
        if part.isVisible() and part.text() and not part.visibleRegion().isEmpty()
        and not getattr(part, "wordWrap", bool)() and part.width() < part.minimumSizeHint().width()
    ]  # fmt: skip
    assert cut == []
    bar = empty.find(QCheckBox, "rule").parentWidget()
    for box in bar.findChildren(QWidget):
        assert not box.isVisible() or bar.rect().contains(box.geometry()), box.objectName()


def test_legend_fits_into_a_low_scene(empty: Driver, tmp_path: Path) -> None:
    empty.window.resize(1024, 700)
    empty.open(small_yard(tmp_path))
    empty.window.live.pin()
    empty.type_into("entry robot.platform.mass", "190 kg")
    empty.rest()
    empty.window.compare.in_map.setChecked(True)
    empty.rest()
    legend = empty.scene.colour_legend
    assert len(legend.steps.ticks) > 10
    assert 0.0 in legend._bar._ticks
    assert empty.scene.rect().contains(legend.geometry())


def test_worst_pose_covers_no_name_of_an_exit_point(yard: Driver) -> None:
    overlay = yard.scene.overlay
    overlay.worst = (yard.session.study.robot.exit_points_m[0] - [0.3, 0.0, 0.0], "worst pose")
    written: list[float] = []
    write = overlay._write
    overlay._write = lambda painter, place, text: (
        written.append(place.y()) or write(painter, place, text)
    )
    overlay.repaint()
    del overlay._write
    assert written
    assert written[-1] > yard.scene.view.pixels(overlay.worst[0])[1]
