"""The scene of the window: robot, cables, map and worst pose, to be turned and pulled.

It draws when something has changed, once a change: first without smoothing of edges, and with it
when nothing moves any more, since that is eight times the work where there is no graphics card.
"""

from __future__ import annotations

import time
from dataclasses import replace
from typing import Any

import numpy as np
from PySide6.QtCore import QPoint, QPointF, Qt, QTimer, Signal
from PySide6.QtGui import QCloseEvent, QKeyEvent, QMouseEvent, QResizeEvent, QWheelEvent
from PySide6.QtWidgets import QWidget
from pyvistaqt import QtInteractor

from designer.arrays import BoolArray, FloatArray, IntArray
from designer.explore.desktop import theme
from designer.explore.desktop.overlay import ARROW_PX, HANDLE_PX, Legend, Overlay
from designer.explore.desktop.scene_actors import NEAR_PX, SceneActors
from designer.report import format as fmt
from designer.report.figures.view import View

_REST_MS = 300
"""Longer than between two events of a drag, shorter than a look takes."""
_SMOOTH = 8
"""Samples a pixel once nothing moves."""
_QUICK_S = 0.05
"""A frame that takes no longer may be smoothed while something moves as well."""
_CLICK_PX = 4
"""A hand that clicks moves the mouse by no more."""
_STEPS = {
    Qt.Key.Key_Left: (-1, 0, 0),
    Qt.Key.Key_Right: (1, 0, 0),
    Qt.Key.Key_Up: (0, 1, 0),
    Qt.Key.Key_Down: (0, -1, 0),
    Qt.Key.Key_PageUp: (0, 0, 1),
    Qt.Key.Key_PageDown: (0, 0, -1),
}
"""To the right and away from the viewer, along the nearest axis of the frame, and upward."""
_TURN_RAD = float(np.radians(1.0))
"""How far a key turns the platform."""
_SNAP_PX = 8.0
"""As near an exit point takes the coordinate of another."""
_ALONG = 1e-9
"""Of a normal, along an axis that lies in its plane."""


def snapped(
    position_m: FloatArray,
    others_m: FloatArray,
    step_m: float,
    reach_m: float,
    is_free: BoolArray,
) -> tuple[FloatArray, IntArray]:
    """Return a position (3,) as others (n, 3) have it, and which of them in each coordinate.

    Those coordinates that are free (3,) become the nearest of the others within reach, else the
    next on a grid of this step; -1 for no other [m].
    """
    away_m = np.abs(others_m - position_m)
    nearest = away_m.argmin(axis=0)
    is_alike = is_free & (away_m.min(axis=0) <= reach_m)
    on_grid_m = np.where(is_free, step_m * np.round(position_m / step_m), position_m)
    alike_m = others_m[nearest, np.arange(3)]
    return np.where(is_alike, alike_m, on_grid_m), np.where(is_alike, nearest, -1)


class SceneView(QtInteractor):
    """The stage with its camera, overlay and legend, and what mouse and keys do in it."""

    asks_for_position = Signal(object, bool)
    """A position (3,) [m] that the platform is to take, and whether it is still on its way."""
    asks_for_exit_point = Signal(int, object, bool)
    """Which exit point, counted from 0, is to be where (3,) [m], and whether it is on its way."""
    asks_for_shift = Signal(object)
    """How far (3,) the platform is to be moved along the axes of the frame [m]."""
    asks_for_turn = Signal(object)
    """The rotation vector (3,) that the platform is to be turned by [rad]."""
    resized = Signal()
    pointed_at = Signal(object)
    """What the mouse is over: a `Hit`, or None."""

    def __init__(self, parent: QWidget) -> None:
        super().__init__(parent, auto_update=False, lighting="none")
        self.setObjectName("scene")
        self.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        self.setAccessibleName("Robot and workspace")
        self._Iren.EnableRenderOff()  # a frame is drawn where Qt asks for a picture, not before
        self.frames = 0
        self.frame_s = 0.0
        self.view = View(-1.0, 0.5, np.zeros(3), 1.0)
        self.stage = SceneActors(self)
        self.overlay = Overlay(self, lambda: self.view)
        self.colour_legend = Legend(self)
        self.can_turn = False
        self.is_turned = False  # Whether the user has chosen where to look from
        self.is_measuring = False
        self.chosen: int | None = None  # The exit point that has a handle
        self.exit_points_m = np.empty((0, 3))
        self._pressed: QPoint | None = None
        self._last = QPoint()
        self._grip = ""
        self._gripped: int | None = None  # The exit point that is dragged; None for the platform
        self._grip_offset = np.zeros(3)
        self._rest = QTimer(self, singleShot=True, interval=_REST_MS)
        self._rest.timeout.connect(self._draw_smooth)
        self._hover = QTimer(self, singleShot=True, interval=30)
        self._hover.timeout.connect(self._point)

    def follow_theme(self) -> None:
        """Take the colours of the theme."""
        self.set_background(theme.current().base)
        self.stage.follow_theme()
        self.redraw()

    # Drawing

    def redraw(self) -> None:
        """Have the next frame drawn, soon, and a smooth one when nothing follows it."""
        if self.ren_win.GetMultiSamples() and self.frame_s > _QUICK_S:
            self.ren_win.SetMultiSamples(0)
        self._rest.start()
        self.update()
        self.overlay.update()

    def paintGL(self) -> None:
        """Draw one frame."""
        start = time.perf_counter()
        self.view.aim(self.renderer)
        self._Iren.EnableRenderOn()
        super().paintGL()  # type: ignore[no-untyped-call]
        self._Iren.EnableRenderOff()
        self.frames += 1
        self.frame_s = time.perf_counter() - start

    def _draw_smooth(self) -> None:
        if self._pressed is None and not self.ren_win.GetMultiSamples():
            self.ren_win.SetMultiSamples(_SMOOTH)
            self.update()

    def closeEvent(self, event: QCloseEvent) -> None:
        """Draw nothing any more."""
        for timer in (self._rest, self._hover):
            timer.stop()
        super().closeEvent(event)

    def resizeEvent(self, event: QResizeEvent) -> None:
        """Keep overlay, legend and camera at the size of the scene."""
        super().resizeEvent(event)
        self.view = replace(
            self.view, width_px=max(self.width(), 1), height_px=max(self.height(), 1)
        )
        self.overlay.setGeometry(self.rect())
        self.place_legend()
        self.resized.emit()

    def place_legend(self) -> None:
        """Put the legend into its corner."""
        self.colour_legend.move(self.width() - self.colour_legend.width() - 12, 12)
        self.overlay.legend_px = self.colour_legend.width() + 12

    # What is asked for by mouse and keys

    def mousePressEvent(self, event: QMouseEvent) -> None:
        """Begin a drag of the platform or of the picture, or a click."""
        self.setFocus()
        self._pressed = self._last = event.position().toPoint()
        self._grip, self._gripped = self._grip_at(event.position())
        self.overlay.pointed = None
        if self._grip:
            under = self._dragged_to(event.position())
            self._grip_offset = np.zeros(3) if under is None else self._gripped_m - under

    def mouseMoveEvent(self, event: QMouseEvent) -> None:
        """Drag, or tell what the mouse is over."""
        pixel = event.position().toPoint()
        if self._pressed is None:
            self._last = pixel
            over = self._grip_at(event.position())[0]
            if len(self.overlay.rule_m) and self.is_measuring and not self._has_measured:
                self._measure(event.position(), is_end=False)
            self.setCursor(Qt.CursorShape.OpenHandCursor if over else Qt.CursorShape.CrossCursor)
            self._hover.start()
            return
        step, self._last = pixel - self._last, pixel
        buttons, modifiers = event.buttons(), event.modifiers()
        if self._grip:
            self._drag(event, True)
        elif (
            buttons & Qt.MouseButton.LeftButton
            and not modifiers & Qt.KeyboardModifier.ShiftModifier
        ):
            self._see(self.view.turned(step.x(), step.y()))
        else:
            self._see(self.view.shifted(step.x(), step.y()))

    def mouseReleaseEvent(self, event: QMouseEvent) -> None:
        """End a drag; where the mouse has hardly moved, take the platform to what is under it."""
        pressed, self._pressed = self._pressed, None
        if pressed is None:
            return
        moved = (event.position().toPoint() - pressed).manhattanLength()
        if moved > _CLICK_PX:
            if self._grip:
                self._drag(event, False)
        elif event.button() == Qt.MouseButton.LeftButton:
            self._click(event.position())
        self._grip = ""
        self._rest.start()

    def _click(self, place: QPointF) -> None:
        """Measure, choose an exit point, or take the platform to what is there."""
        if self.is_measuring:
            self._measure(place, is_end=True)
        elif self._grip:
            self.choose_exit_point(self._gripped)
        else:
            self.choose_exit_point(None)
            hit = self._hit(place)
            if hit is not None:
                self.asks_for_position.emit(hit.position_m, False)

    # Exit points and distances

    def show_exit_points(self, exit_points_m: FloatArray) -> None:
        """Take where the exit points are (n_cables, 3) [m]."""
        is_same_robot = len(exit_points_m) == len(self.exit_points_m)
        self.exit_points_m = exit_points_m
        self.choose_exit_point(self.chosen if is_same_robot else None)

    def choose_exit_point(self, number: int | None) -> None:
        """Give an exit point, counted from 0, a handle with an arrow; no point for None."""
        self.chosen = number
        self.overlay.chosen_m = None if number is None else self.exit_points_m[number]
        self.overlay.update()

    def measure(self, is_measuring: bool) -> None:
        """Have clicks measure the distance between two points, or not any more."""
        self.is_measuring, self._has_measured, self.overlay.rule_m = is_measuring, False, []
        self.overlay.update()

    def _measure(self, place: QPointF, *, is_end: bool) -> None:
        """Lay an end of the rule onto a point of robot or map; it follows the mouse until then."""
        platform = [] if self.overlay.platform_m is None else [self.overlay.platform_m]
        points = np.array([*self.exit_points_m, *self.stage.attachments_m, *platform])
        away = np.linalg.norm(self.view.pixels(points) - [place.x(), place.y()], axis=1)
        is_point = bool(away.min() <= NEAR_PX)
        hit = None if is_point else self._hit(place)
        if hit is not None or is_point:
            end_m = points[away.argmin()] if hit is None else hit.position_m
            start = [] if self._has_measured else self.overlay.rule_m[:1]
            self.overlay.rule_m = [*start, np.array(end_m)]
            self._has_measured = is_end and bool(start)
            self.overlay.update()

    def wheelEvent(self, event: QWheelEvent) -> None:
        """Zoom at the mouse."""
        factor = 1.0015 ** event.angleDelta().y()
        self._see(self.view.zoomed(factor, event.position().x(), event.position().y()))

    def _see(self, view: View) -> None:
        """Look from where the user wants to."""
        self.is_turned, self.view = True, view
        self.redraw()

    def leaveEvent(self, event: Any) -> None:
        """Forget what the mouse was over."""
        self._hover.stop()
        self._tell(None)

    def enterEvent(self, event: Any) -> None:
        """Nothing; the scene of the base class would take the keys here."""

    def keyPressEvent(self, event: QKeyEvent) -> None:
        """Move or turn the platform by a step; ten with Shift, turned with Ctrl."""
        step = _STEPS.get(Qt.Key(event.key()))
        if step is None:
            QWidget.keyPressEvent(self, event)
            return
        times = 10.0 if event.modifiers() & Qt.KeyboardModifier.ShiftModifier else 1.0
        if not event.modifiers() & Qt.KeyboardModifier.ControlModifier:
            self.asks_for_shift.emit(times * self.step_m * self._along_axes(np.array(step)))
        elif self.can_turn:
            right, away, up = step
            self.asks_for_turn.emit(times * _TURN_RAD * np.array([-away, up, -right]))

    @property
    def step_m(self) -> float:
        """How far a key moves the platform: a round length, about a hundredth of what is shown."""
        size = float(np.ptp(self.stage.bounds_m, axis=0).max())
        power = 10.0 ** np.floor(np.log10(size / 100.0))
        return float(power * max(k for k in (1.0, 2.0, 5.0) if k * power <= size / 100.0))

    def keyReleaseEvent(self, event: QKeyEvent) -> None:
        """Nothing; the base class has keys of its own."""
        QWidget.keyReleaseEvent(self, event)

    def _along_axes(self, step: FloatArray) -> FloatArray:
        """A step to the right, away and up, along the nearest axes of the frame."""
        right, away, up = step
        view = self.view
        level_step = right * view.right[:2] - away * view.toward_camera[:2] / max(
            float(np.linalg.norm(view.toward_camera[:2])), 1e-9
        )
        level = np.zeros(3)
        if right or away:
            main = int(np.argmax(np.abs(level_step)))
            level[main] = np.sign(level_step[main])
        level[2] = up
        return level

    def _grip_at(self, place: QPointF) -> tuple[str, int | None]:
        """Return what is gripped there, and of which exit point; None for the platform.

        Of a handle ``level`` or ``upright``, of an exit point without one ``level``, else nothing.
        """
        pixel, overlay = np.array([place.x(), place.y()]), self.overlay
        if self.is_measuring:
            return "", None
        for number, place_m in ((None, overlay.platform_m), (self.chosen, overlay.chosen_m)):
            handle = overlay.handle_px(place_m)
            if handle is None:
                continue
            if np.linalg.norm(pixel - handle[0]) <= HANDLE_PX:
                return "level", number
            across, down = pixel - handle[1]
            if abs(across) <= 8 and -6 <= down <= ARROW_PX - HANDLE_PX:
                return "upright", number
        away = np.linalg.norm(self.view.pixels(self.exit_points_m) - pixel, axis=-1)
        is_near = len(away) > 0 and away.min() <= NEAR_PX
        return ("level", int(away.argmin())) if is_near else ("", None)

    @property
    def _gripped_m(self) -> FloatArray:
        """Where what is gripped is (3,) [m]."""
        if self._gripped is not None:
            return np.asarray(self.exit_points_m[self._gripped])
        assert self.overlay.platform_m is not None
        return self.overlay.platform_m

    def _dragged_to(self, place: QPointF) -> FloatArray | None:
        """Where in the level of what is gripped, or on the vertical through it, the mouse is."""
        platform, view = self._gripped_m, self.view
        if self._grip == "level":
            return view.on_plane(place.x(), place.y(), platform, self.stage.level_normal)
        facing = np.append(view.toward_camera[:2], 0.0)
        facing = facing / max(float(np.linalg.norm(facing)), 1e-9)
        under = view.on_plane(place.x(), place.y(), platform, facing)
        return None if under is None else np.array([*platform[:2], under[2]])

    def _drag(self, event: QMouseEvent, moving: bool) -> None:
        """Take what is gripped along; an exit point snaps, unless Ctrl is held."""
        under, number = self._dragged_to(event.position()), self._gripped
        if under is None:
            return
        target_m = under + self._grip_offset
        if number is None:
            self.asks_for_position.emit(target_m, moving)
            return
        text = f"A{number + 1}"
        if not event.modifiers() & Qt.KeyboardModifier.ControlModifier:
            others_m = np.delete(self.exit_points_m, number, axis=0)
            is_free = np.array([False, False, True])
            if self._grip == "level":
                is_free = np.abs(self.stage.level_normal) < _ALONG
            reach_m = _SNAP_PX / self.view.pixels_per_m
            target_m, alike = snapped(target_m, others_m, self.step_m, reach_m, is_free)
            names = (
                f"{'xyz'[k]} as A{n + 1 + (n >= number)}" for k, n in enumerate(alike) if n >= 0
            )
            text = ", ".join([text, *names])
        if self.chosen != number:
            self.choose_exit_point(number)
        self.asks_for_exit_point.emit(number, target_m, moving)
        self.write_pointed(f"{text}\n{fmt.position(self.exit_points_m[number])}" if moving else "")

    # What the mouse is over

    def _hit(self, place: QPointF) -> Any:
        centre, far = self.view.point(place.x(), place.y()), self.view.to_camera_m
        pixel = np.array([place.x(), place.y()])
        return self.stage.hit(centre + far, centre - far, pixel, self.view)

    def _point(self) -> None:
        if self._pressed is None:
            self._tell(self._hit(QPointF(self._last)))

    def _tell(self, hit: Any) -> None:
        if hit is None:
            self.overlay.pointed = None
            self.overlay.update()
        self.pointed_at.emit(hit)

    def write_pointed(self, text: str) -> None:
        """Write beside the mouse what it is over."""
        self.overlay.pointed = (QPointF(self._last), text) if text else None
        self.overlay.update()
