"""The scene with what is set above and beside it: quantity, surface, slice, exaggeration."""

from __future__ import annotations

import math
import time
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from PySide6.QtCore import Qt, QTimer, Signal
from PySide6.QtGui import QResizeEvent, QStandardItemModel
from PySide6.QtWidgets import QBoxLayout, QComboBox, QHBoxLayout, QSlider, QVBoxLayout, QWidget

from designer.explore.desktop.live_session import LiveSession
from designer.explore.desktop.scene import SceneView
from designer.explore.desktop.stage import Hit, Painting
from designer.explore.desktop.widgets import DropDown, Notice, check_box, fill, named, row_of
from designer.explore.quantities import BY_KEY, QUANTITIES, category_labels
from designer.model.verdict import Verdict
from designer.report import format as fmt
from designer.report.figures import canvas
from designer.report.figures.colours import Steps
from designer.report.figures.mode_shapes import PERIOD_S
from designer.report.figures.view import clear_azimuth_rad, facing_azimuth_rad, fitting

if TYPE_CHECKING:
    from designer.arrays import FloatArray
    from designer.explore.answers import MapAnswer, PoseAnswer, WorstAnswer
    from designer.explore.measurements import Residuals
    from designer.study import Study

FACTORS = (1, 2, 5, 10, 20, 50)
_ELEVATION_RAD = float(np.radians(28.0))
"""Floor, walls and top of a region are all seen from there."""
_FRAME_MS = 40
_LONGEST_PATH_S = 20.0  #: A path that takes longer is played faster
_MODE_SHARE, _MODE_RAD = 0.04, 0.25
"""How far a mode is drawn to move, over the size of the scene, and how far to turn."""
_BAR_PX, _ONE_ROW_PX = 372, 700  #: The narrowest bar, and how narrow it is in two rows
_BRIGHTEST = 5.0  #: Residual of the brightest rows, in units of noise: by chance none is as large


class WorkPage(QWidget):
    """Scene, the bar above it, the slider of the slice, and a notice when there is one."""

    notice_answered = Signal(str)  #: The name of the button of the notice that was pressed

    def __init__(self, live: LiveSession) -> None:
        super().__init__()
        self._live = live
        self.scene = SceneView(self)
        self.map: MapAnswer | None = None
        self.painting: Painting | None = None
        self._pose_answer: PoseAnswer | None = None
        self._study: Study | None = None
        self._place = np.zeros(6)
        self._fixed_steps: Steps | None = None
        self._residuals: Residuals | None = None
        self._shows_rows = self._is_old = False
        self._view = "home"
        self._mode: FloatArray | None = None
        self._play_start_s, self._path_note = 0.0, ""
        self._frames = QTimer(self, interval=_FRAME_MS)
        self._frames.timeout.connect(self._next_frame)
        self._notice = Notice()
        self._notice.answered.connect(self.notice_answered)
        rows = QVBoxLayout(self)
        rows.setContentsMargins(0, 0, 0, 0)
        rows.setSpacing(0)
        self.height_slider = named(
            QSlider(Qt.Orientation.Vertical), "slice height", "Height of the slice."
        )
        self.height_slider.setAccessibleName("Height of the slice")
        self.height_slider.setRange(0, 100)
        self.height_slider.setValue(50)
        fill(rows, self._bar(), self._notice)
        middle = QHBoxLayout()
        middle.setSpacing(0)
        middle.addWidget(self.scene, 1)
        middle.addWidget(self.height_slider)
        rows.addLayout(middle, 1)
        for box in (self.surface, self.slice):
            box.setChecked(True)
        slider, scene = self.height_slider, self.scene
        slider.valueChanged.connect(lambda: self._move_slice(slider.isSliderDown()))
        slider.sliderReleased.connect(lambda: self._move_slice(False))
        scene.pointed_at.connect(lambda hit: scene.write_pointed(self.read(hit) if hit else ""))
        scene.resized.connect(lambda: None if scene.is_turned else self.look(self._view))
        scene.asks_for_position.connect(live.move)
        scene.asks_for_position.connect(lambda: self.plays_path.setChecked(False))
        scene.asks_for_exit_point.connect(live.move_exit_point)
        scene.asks_for_shift.connect(live.shift)
        scene.asks_for_turn.connect(live.turn)
        live.changed.connect(self._follow_study)
        live.moved.connect(self._follow_place)
        live.busy_changed.connect(self._show_age)
        live.quantity_changed.connect(
            lambda key: self.quantity.setCurrentIndex(self.quantity.findData(key))
        )
        live.listen(self._show_answer, "pose")
        live.listen(self.show_map, "coarse", "fine")
        live.listen(self._show_worst, "worst")
        live.listen(self._take_residuals, "residuals")

    def _bar(self) -> QWidget:
        self.quantity = DropDown("quantity", 14)
        self.quantity.setAccessibleName("What the map is coloured by")
        for number, quantity in enumerate(QUANTITIES):
            self.quantity.addItem(quantity.title, quantity.key)
            self.quantity.setItemData(number, quantity.definition, Qt.ItemDataRole.ToolTipRole)
        self.quantity.currentIndexChanged.connect(self._quantity_chosen)
        show, tip = self._show_surfaces, "The outside of the region, seen from within."
        self.surface = check_box("show surface", "Surface", show, tip)
        tip = "A level slice through the region; the slider moves it."
        self.slice = check_box("show slice", "Slice", show, tip)
        self.exaggeration = named(
            QComboBox(),
            "sag exaggeration",
            "Draws the cables as many times farther from the straight line between their ends as "
            "they are; numbers stay what they are.",
        )
        for factor in FACTORS:
            self.exaggeration.addItem("true sag" if factor == 1 else f"sag × {factor}", factor)
        self.exaggeration.currentIndexChanged.connect(self._show_place)
        tip = "The colours keep their meaning while the study changes."
        self.holds_scale = check_box("hold scale", "Lock colour scale", self._lock_scale, tip)
        tip = "Click two points of robot or map: the distance, also along the axes (Ctrl+M)."
        self.rule = check_box("rule", "Measure", self.scene.measure, tip)
        tip = "Moves the platform along the path of the study (Ctrl+P)."
        self.plays_path = check_box("play path", "Play", self._play, tip)
        self.rule.setShortcut("Ctrl+M")
        self.plays_path.setShortcut("Ctrl+P")
        colours = row_of("Colour by", self.quantity, self.holds_scale, None)
        boxes = self.surface, self.slice, self.exaggeration, self.rule, self.plays_path
        bar = QWidget()
        bar.setMinimumWidth(_BAR_PX)
        self._rows = QBoxLayout(QBoxLayout.Direction.LeftToRight, bar)
        self._rows.setSizeConstraint(QBoxLayout.SizeConstraint.SetNoConstraint)
        self._rows.setContentsMargins(8, 4, 8, 4)
        fill(self._rows, colours, row_of(*boxes, None))
        self._rows.setStretch(1, 1)
        return bar

    def resizeEvent(self, event: QResizeEvent) -> None:
        direction = QBoxLayout.Direction
        is_wide = self.width() >= _ONE_ROW_PX
        self._rows.setDirection(direction.LeftToRight if is_wide else direction.TopToBottom)
        super().resizeEvent(event)

    def _move_slice(self, moving: bool) -> None:
        self._live.move_slice(self.height_slider.value() / 100.0, moving)

    def follow_theme(self) -> None:
        self.scene.follow_theme()
        self._show_map()

    # What is shown

    def _follow_study(self) -> None:
        study, is_first = self._live.study, self._live.question is None
        if study is not None and (study is not self._study or is_first):
            self._show_study(study, afresh=is_first)
        model = self.quantity.model()
        assert isinstance(model, QStandardItemModel)
        has_rope = self._live.rope is not None
        model.item(self.quantity.findData("utilisation")).setEnabled(has_rope)

    def _show_study(self, study: Study, *, afresh: bool) -> None:
        """Show base and region; look at all of it where the study was opened ``afresh``."""
        self._study = study
        stage = self.scene.stage
        stage.put_study(study)
        together = 0.04 * float(np.linalg.norm(np.ptp(stage.bounds_m, axis=0)))
        self.scene.overlay.names = canvas.names_of(study.robot.exit_points_m, together)
        self.scene.can_turn = not study.robot.is_point_mass
        self.scene.show_exit_points(study.robot.exit_points_m)
        self.plays_path.setVisible(study.robot.platform.motion is not None)
        if afresh:
            self.plays_path.setChecked(False)
            self.rule.setChecked(False)
            self.scene.choose_exit_point(None)
            self.look("home")
        self.scene.redraw()

    def _follow_place(self) -> None:
        """Show the platform where it is; its cables are straight until they are answered."""
        if self._live.session is not None:
            place = self._live.session.state.place
            if not np.array_equal(place, self._place):
                self._pose_answer = None
            self._place = np.array(place)
            if not self.plays_path.isChecked():  # else with its cables, once they are answered
                self._show_place()

    def _show_answer(self, answer: PoseAnswer | None) -> None:
        self._pose_answer = answer
        self._show_place()

    def _show_place(self) -> None:
        if self._study is None:
            return
        factor = float(self.exaggeration.currentData())
        place = self._place if self._mode is None else self._deflected(self._mode)
        self.scene.stage.put_place(self._study, place, self._pose_answer, factor)
        self.scene.overlay.platform_m = self._place[:3].copy()
        self._write_note()
        self.scene.redraw()

    # What moves

    def _play(self, is_playing: bool) -> None:
        """Move the platform along the path from its start, or leave it where it is."""
        self._play_start_s, self._path_note = time.monotonic(), ""
        self._follow_motion()
        if not is_playing and self._live.session is not None:
            self._live.move(self._live.session.state.place)  # it rests there
            self._show_place()

    def play_mode(self, shape: FloatArray | None) -> None:
        """Move the platform in a mode (3,) or (6,) about where it is; rest for None."""
        self._mode = shape
        self._follow_motion()
        self._show_place()

    def _follow_motion(self) -> None:
        is_moving = self.plays_path.isChecked() or self._mode is not None
        (self._frames.start if is_moving else self._frames.stop)()

    def _next_frame(self) -> None:
        """Go to the instant of the path whose time it is, once the last one is answered."""
        if not self.plays_path.isChecked():
            self._show_place()
            return
        motion = None if self._study is None else self._study.robot.platform.motion
        if motion is None or not self.isVisible():
            self.plays_path.setChecked(False)
        elif "pose" not in self._live.busy:
            time_s = motion.time_s - motion.time_s[0]
            pace = max(float(time_s[-1]) / _LONGEST_PATH_S, 1.0)
            number = int(np.searchsorted(time_s, (time.monotonic() - self._play_start_s) * pace))
            is_over, number = number >= len(time_s) - 1, min(number, len(time_s) - 1)
            faster = f", {fmt.number(pace, 2)} times as fast" if pace > 1.0 else ""
            self._path_note = f"path: {time_s[number]:.1f} s of {time_s[-1]:.1f} s{faster}"
            self._live.move(motion.places[number], True)
            self.plays_path.setChecked(not is_over)

    def _deflected(self, mode: FloatArray) -> FloatArray:
        """Where the platform is in a mode at this time, drawn far larger than it is."""
        from scipy.spatial.transform import Rotation

        size_m = float(np.linalg.norm(np.ptp(self.scene.stage.bounds_m, axis=0)))
        shift, turn = mode[:3], mode[3:]
        farthest = max(
            float(np.linalg.norm(shift)) / (_MODE_SHARE * size_m),
            float(np.linalg.norm(turn)) / _MODE_RAD,
        )
        scale = math.cos(2.0 * math.pi * time.monotonic() / PERIOD_S) / farthest
        place = self._place.copy()
        place[:3] += scale * shift
        if len(turn):
            turned = Rotation.from_rotvec(scale * turn) * Rotation.from_rotvec(place[3:])
            place[3:] = turned.as_rotvec()
        return place

    def show_map(self, answer: MapAnswer | None) -> None:
        """Show the map; nothing where nothing is known of it any more."""
        self.map = answer
        if answer is None:
            self.painting = None
            self.holds_scale.setChecked(False)
            self.scene.stage.put_map(None, None)
            self.scene.colour_legend.hide()
        self._show_map()

    def _show_age(self) -> None:
        outdated, overlay = self._live.outdated, self.scene.overlay
        if ("map" in outdated) != self._is_old:
            self._is_old = "map" in outdated
            self._show_map()
        if ("worst" in outdated) != overlay.is_worst_old:
            overlay.is_worst_old = "worst" in outdated
            overlay.update()

    def _show_worst(self, worst: WorstAnswer | None) -> None:
        marked = None
        if worst is not None and worst.place is not None:
            marked = (worst.place[:3], "worst pose")
        self.scene.overlay.worst = marked
        self.scene.overlay.setToolTip(worst.sentence if worst else "")
        self.scene.overlay.update()

    def want_rows(self, is_wanted: bool) -> None:
        """Show where was measured, by the size of the residuals, or not."""
        self._shows_rows = is_wanted
        self._show_rows()

    def _take_residuals(self, residuals: Residuals | None) -> None:
        self._residuals = residuals
        self._show_rows()

    def _show_rows(self) -> None:
        rows = self._residuals if self._shows_rows else None
        position_m, size = np.empty((0, 3)), np.empty(0)
        if rows is not None:
            position_m, size = rows.position_m, rows.size()
        self.scene.stage.put_rows(position_m, size, _BRIGHTEST)
        self._write_note()
        self.scene.redraw()

    def _write_note(self) -> None:
        factor = self.exaggeration.currentData()
        sag = f"sag exaggerated {factor} times" if factor != 1 else ""
        has_rows = self._shows_rows and self._residuals is not None
        scale = f"residual from 0 (dark) to {_BRIGHTEST:g} times the noise (bright)"
        rows = f"measured rows: {scale}" if has_rows else ""
        mode = "mode exaggerated" if self._mode is not None else ""
        lines = filter(None, [sag, rows, mode, self._path_note])
        self.scene.overlay.note = "\n".join(lines)
        self.scene.overlay.update()

    def _show_map(self) -> None:
        answer = self.map
        if answer is None or not answer.grids:
            return
        quantity = BY_KEY[str(self.quantity.currentData())]
        if quantity.key not in answer.values:
            return  # it was asked for, and comes with the next answer
        if quantity.key == "utilisation" and answer.rope is None:
            return  # of the thinnest cable it is 100 % everywhere; that of the rope comes
        painting = Painting.over(answer, quantity, self._fixed_steps)
        self.painting = replace(painting, is_old=self._is_old)
        self.scene.stage.put_map(answer, self.painting)
        self.scene.colour_legend.show_painting(self.painting, answer)
        self.scene.place_legend()
        has_slice = "slice" in answer.grids
        self.slice.setVisible(has_slice)
        self.height_slider.setVisible(has_slice and self.slice.isChecked())
        self.surface.setVisible("points" not in answer.grids)
        self._show_surfaces()

    def _show_surfaces(self) -> None:
        self.scene.stage.shell.show(self.surface.isChecked())
        self.scene.stage.slice.show(self.slice.isChecked())
        self.scene.stage.rim.show(self.slice.isChecked())
        has_slice = self.map is not None and "slice" in self.map.grids
        self.height_slider.setVisible(has_slice and self.slice.isChecked())
        self.scene.redraw()

    def _quantity_chosen(self) -> None:
        self.holds_scale.setChecked(False)
        self.quantity.setToolTip(f"<p>{BY_KEY[self.quantity.currentData()].definition}</p>")
        self._show_map()
        self._live.colour_by(str(self.quantity.currentData()))

    def _lock_scale(self, is_locked: bool) -> None:
        self._fixed_steps = self.painting.steps if is_locked and self.painting is not None else None
        self._show_map()

    # Where one looks from

    def look(self, view: str) -> None:
        """Look from ``home``, ``top``, ``front`` or ``side`` at all that there is."""
        stage, study = self.scene.stage, self._study
        self._view, self.scene.is_turned = view, False
        if study is None:
            return
        sides = {"top": (-90.0, 89.0), "front": (-90.0, 0.0), "side": (0.0, 0.0)}
        robot, elevation = study.robot, _ELEVATION_RAD
        if view in sides:
            azimuth, elevation = (float(angle) for angle in np.radians(sides[view]))
        elif robot.is_planar:
            azimuth = facing_azimuth_rad(robot.upright[0, :2])
        else:
            centre = np.broadcast_to(stage.bounds_m.mean(axis=0), robot.exit_points_m.shape)
            lines = np.stack([robot.exit_points_m, centre], axis=1)
            azimuth = clear_azimuth_rad(lines, elevation)
        # clear of the legend at the right
        width, height = max(self.scene.width(), 1), max(self.scene.height(), 1)
        right = 0.95 - self.scene.overlay.legend_px / width
        frame = (0.05, right, 0.08, 0.92)
        corners = stage.everything_m()
        self.scene.view = fitting(corners, azimuth, elevation, frame, (width, height))
        self.scene.redraw()

    # What the mouse is over

    def read(self, hit: Hit) -> str:
        """Return what the map says at the grid point next to a place, and where that is."""
        if self.map is None or self.painting is None or hit.grid not in self.map.grids:
            return ""
        number = self.map.points_of([hit.grid])[hit.number]
        values = {key: column[number] for key, column in self.map.values.items()}
        position = fmt.position(self.map.positions_m[number])
        quantity = self.painting.quantity
        value = float(values[quantity.key])
        if values["left_out"]:
            text = "excluded: a cable hangs below"
        elif quantity.is_category:
            assert self._study is not None
            labels = category_labels(quantity.key, self._study.robot.n_cables)
            text = labels.get(int(value), fmt.MISSING) if math.isfinite(value) else fmt.MISSING
        else:
            text = f"{fmt.number(value * quantity.scale, 4)} {quantity.unit}".strip()
        lines = [f"{quantity.title}: {text}", position]
        change = self.map.difference(quantity.key)
        if change is not None and not quantity.is_category:
            less = fmt.number(float(change[number]) * quantity.scale, 3)
            lines.insert(1, f"now less A: {less} {quantity.unit}".strip())
        verdict = Verdict(int(values["verdict"]))
        if verdict is not Verdict.SOLVED:
            lines.append(verdict.reason)
        elif values.get("unserved"):
            lines.append("no rope serves")
        return "\n".join(lines)

    def show_notice(self, text: str, buttons: tuple[str, ...] = ()) -> None:
        """Show a notice above the scene, with buttons; nothing for no text."""
        self._notice.show_text(text, buttons)
