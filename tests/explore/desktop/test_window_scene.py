"""The scene: what is seen, and what mouse and keys do in it."""

from __future__ import annotations

import numpy as np
import pytest
from PySide6.QtCore import QPoint
from PySide6.QtWidgets import QComboBox, QWidget
from window_driver import LONGEST_MS, Driver, n_colours

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
    assert empty.window.live.answers["here"].cables


def test_the_mouse_reads_the_map(yard: Driver) -> None:
    work = yard.window.work
    wanted = slice_point(yard)
    value = float(work.map.on("slice", "utilisation")[10, 20])
    from PySide6.QtTest import QTest

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

    true, sag_m = deviation(), yard.window.live.answers["here"].cables[0].sag_m
    box = yard.find(QComboBox, "sag exaggeration")
    box.setFocus()
    yard.keys("Down")
    yard.keys("Down")
    assert deviation() == pytest.approx(5.0 * true, rel=1e-6)
    assert yard.window.live.answers["here"].cables[0].sag_m == sag_m
    assert "sag drawn 5 times" in yard.scene.overlay.texts()


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
