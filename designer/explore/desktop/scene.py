"""The scene of the window: robot, cables, map and worst pose, to be turned and pulled.

It draws when something has changed, once a change: first without smoothing of edges, and with it
when nothing moves any more, since that is eight times the work where there is no graphics card.
Names, handles, marks and legend lie over it: Qt draws them, sharp at every pixel density, in the
colours of the window, and without a new frame of the scene.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np
from PySide6.QtCore import QPoint, QPointF, QRectF, Qt, QTimer, Signal
from PySide6.QtGui import (
    QBrush,
    QCloseEvent,
    QColor,
    QKeyEvent,
    QMouseEvent,
    QPainter,
    QPaintEvent,
    QPen,
    QPixmap,
    QResizeEvent,
    QWheelEvent,
)
from PySide6.QtWidgets import QFormLayout, QFrame, QLabel, QVBoxLayout, QWidget
from pyvistaqt import QtInteractor

from designer.arrays import BoolArray, FloatArray, IntArray
from designer.explore.desktop.stage import NEAR_PX, Painting, SceneActors
from designer.explore.desktop.widgets import current_theme, fill, label
from designer.report import format as fmt
from designer.report.figures.colours import Steps
from designer.report.figures.view import View

if TYPE_CHECKING:
    from designer.explore.answers import MapAnswer

HANDLE_PX = 13.0
ARROW_PX = 34.0


class Overlay(QWidget):
    """Lies over the scene and lets the mouse through."""

    def __init__(self, parent: QWidget, view: Callable[[], View]) -> None:
        super().__init__(parent)
        self.setAttribute(Qt.WidgetAttribute.WA_TransparentForMouseEvents)
        self._view = view
        self.names: list[tuple[str, FloatArray]] = []
        self.platform_m: FloatArray | None = None
        self.chosen_m: FloatArray | None = None  # The exit point that has a handle
        self.rule_m: list[FloatArray] = []
        self.worst: tuple[FloatArray, str] | None = None
        self.is_worst_old = False
        self.pointed: tuple[QPointF, str] | None = None
        self.note = ""
        self.legend_px = 0  # Width of what covers the right side

    def texts(self) -> list[str]:
        marked = [self.worst[1]] if self.worst else []
        pointed = [self.pointed[1]] if self.pointed else []
        said = filter(None, [self.note, self.rule_text()])
        return [*(name for name, _ in self.names), *marked, *pointed, *said]

    def rule_text(self) -> str:
        """Return the distance between the ends of the rule, along the axes as well."""
        if len(self.rule_m) < 2:
            return ""
        apart = self.rule_m[1] - self.rule_m[0]
        return f"{fmt.fixed(float(np.linalg.norm(apart)), 3)} m\nΔ {fmt.position(apart)}"

    def handle_px(self, place_m: FloatArray | None) -> tuple[FloatArray, FloatArray] | None:
        """Return where the handle of a place is, and the tip of its upward arrow [px]."""
        if place_m is None:
            return None
        centre = self._view().pixels(place_m)
        return centre, centre - np.array([0.0, ARROW_PX])

    def paintEvent(self, event: QPaintEvent) -> None:
        painter = QPainter(self)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        painter.setPen(QColor(current_theme().muted))
        names: list[QRectF] = []
        for name, position_m in self.names:
            x, y = self._view().pixels(position_m)
            width = painter.fontMetrics().horizontalAdvance(name)
            has_room = x + 6 + width < self.width() - self.legend_px
            corner = QPointF(x + 6 if has_room else x - 6 - width, y - 6)
            painter.drawText(corner, name)
            names.append(QRectF(corner.x(), corner.y() - 14, width, 18))
        for place_m in (self.platform_m, self.chosen_m):
            self._draw_handle(painter, place_m)
        self._draw_worst(painter, names)
        self._draw_rule(painter)
        if self.pointed is not None:
            place, text = self.pointed
            self._write_boxed(painter, place + QPointF(14, 18), text)
        if self.note:
            self._write_boxed(painter, QPointF(10, 10), self.note)

    def _draw_worst(self, painter: QPainter, names: Sequence[QRectF]) -> None:
        if self.worst is None:
            return
        place, text = self.worst
        x, y = self._view().pixels(place)
        marked = current_theme().muted if self.is_worst_old else current_theme().warning
        for width, colour in ((5.0, current_theme().base), (2.0, marked)):
            painter.setPen(QPen(QColor(colour), width))
            painter.drawEllipse(QPointF(x, y), 8, 8)
            painter.drawLine(QPointF(x - 13, y), QPointF(x - 4, y))
            painter.drawLine(QPointF(x + 4, y), QPointF(x + 13, y))
        painter.setPen(QColor(marked))
        box = QRectF(painter.boundingRect(QRectF(0, 0, 400, 200), 0, text))
        covers = any(
            box.translated(x + 16, y - 8 - box.height()).intersects(name) for name in names
        )
        self._write(painter, QPointF(x + 16, y + (8 + box.height() if covers else -8)), text)

    def _draw_rule(self, painter: QPainter) -> None:
        ends = [QPointF(*self._view().pixels(end)) for end in self.rule_m]
        for width, colour in ((4.5, current_theme().base), (1.8, current_theme().warning)):
            painter.setPen(QPen(QColor(colour), width))
            painter.setBrush(Qt.BrushStyle.NoBrush)
            painter.drawPolyline(ends)
            for end in ends:
                painter.drawEllipse(end, 4, 4)
        if len(ends) == 2:
            lower = max(ends, key=lambda end: end.y())
            self._write_boxed(painter, lower + QPointF(8, 8), self.rule_text())

    def _draw_handle(self, painter: QPainter, place_m: FloatArray | None) -> None:
        handle = self.handle_px(place_m)
        if handle is None:
            return
        centre, tip = QPointF(*handle[0]), QPointF(*handle[1])
        for width, colour in ((4.5, current_theme().base), (1.8, current_theme().accent)):
            painter.setPen(QPen(QColor(colour), width))
            painter.setBrush(Qt.BrushStyle.NoBrush)
            painter.drawEllipse(centre, HANDLE_PX, HANDLE_PX)
            painter.drawLine(QPointF(centre.x(), centre.y() - HANDLE_PX), tip)
            painter.drawPolyline([tip + QPointF(-5, 6), tip, tip + QPointF(5, 6)])

    def _write(self, painter: QPainter, place: QPointF, text: str) -> None:
        box = QRectF(painter.boundingRect(QRectF(0, 0, 400, 200), 0, text))
        left = min(place.x(), self.width() - box.width() - 6)
        ground = QColor(current_theme().base)
        ground.setAlpha(200)
        area = QRectF(max(left, 4), max(place.y() - box.height(), 4), box.width(), box.height())
        painter.fillRect(area.adjusted(-3, -1, 3, 1), ground)
        painter.drawText(area, 0, text)

    def _write_boxed(self, painter: QPainter, place: QPointF, text: str) -> None:
        box = QRectF(painter.boundingRect(QRectF(0, 0, 460, 400), 0, text))
        box.moveTo(place)
        box.adjust(0, 0, 16, 10)
        box.moveRight(min(box.right(), self.width() - self.legend_px - 4))
        box.moveLeft(max(box.left(), 4))
        box.moveBottom(min(box.bottom(), self.height() - 4))
        ground = QColor(current_theme().raised)
        ground.setAlpha(235)
        painter.setPen(QPen(QColor(current_theme().border)))
        painter.setBrush(ground)
        painter.drawRoundedRect(box, 4, 4)
        painter.setPen(QColor(current_theme().ink))
        painter.drawText(box.adjusted(8, 5, -8, -5), 0, text)


_WIDTH_PX, _BAR_PX, _MARGIN_PX = 136, 14, 8


class Legend(QFrame):
    """Stands over the scene and lets the mouse through."""

    def __init__(self, parent: QWidget) -> None:
        super().__init__(parent)
        self.setObjectName("legend")
        self.setAttribute(Qt.WidgetAttribute.WA_TransparentForMouseEvents)
        self.setFixedWidth(_WIDTH_PX)
        self.hide()
        self.steps: Steps | None = None
        self._is_old = False
        self._meanings: tuple[str, ...] = ()
        self._title, self._note = label("", "heading"), label("", "muted")
        self._bar, self._keys = ColourBar(), QFormLayout()
        self._keys.setVerticalSpacing(4)
        for text in (self._title, self._note):
            text.setWordWrap(True)
        rows = QVBoxLayout(self)
        rows.setContentsMargins(*[_MARGIN_PX] * 4)
        fill(rows, self._title, self._note, self._bar, self._keys)

    @property
    def texts(self) -> list[str]:
        labels = [] if self.steps is None else [fmt.trimmed(float(t), 6) for t in self.steps.ticks]
        return [self._title.text(), self._note.text(), *labels[::-1], *self._meanings]

    def show_painting(self, painting: Painting, answer: MapAnswer) -> None:
        """Show what colours mean: quantity, cables, scale if there is one, and other colours."""
        keys = painting.keys(answer)
        self.steps, self._meanings = painting.steps, tuple(key.meaning for key in keys)
        self._title.setText(painting.title)
        self._note.setText(painting.note(answer))
        self._is_old = painting.is_old
        while self._keys.rowCount():
            self._keys.removeRow(0)
        for key in keys:
            meaning = label(key.meaning)
            meaning.setWordWrap(True)
            picture = QPixmap(_BAR_PX, 11)
            picture.fill(_map_colour(QColor(key.colour), painting.is_old))
            if key.stripes:
                painter = QPainter(picture)
                stripes = QBrush(QColor(key.stripes), Qt.BrushStyle.BDiagPattern)
                painter.fillRect(picture.rect(), stripes)
                painter.end()
            swatch = QLabel()
            swatch.setPixmap(picture)
            self._keys.addRow(swatch, meaning)
        self.show()

    def fit(self, room_px: int) -> None:
        """Be no higher than this, if need be with every second or fourth tick alone."""
        for every in (1, 2, 4):
            self._bar.show_steps(self.steps, self._is_old, every)
            height = self.heightForWidth(_WIDTH_PX)
            if height <= room_px:
                break
        self.resize(_WIDTH_PX, height)


class ColourBar(QWidget):
    """The colours of a scale and its ticks, the largest value at the top."""

    def __init__(self) -> None:
        super().__init__()
        self._steps: Steps | None = None
        self._ticks: list[float] = []
        self._is_old = False

    def show_steps(self, steps: Steps | None, is_old: bool, every: int) -> None:
        """Show a scale with every so many of its ticks, 0 among them; nothing for None."""
        self._steps, self._is_old = steps, is_old
        ticks = [] if steps is None else [float(tick) for tick in steps.ticks]
        self._ticks = ticks[ticks.index(0.0) % every if 0.0 in ticks else 0 :: every]
        lines = 0.0 if steps is None else 1.25 * len(self._ticks) + 1.2
        self.setFixedHeight(round(lines * self.fontMetrics().height()))
        self.setVisible(steps is not None)
        self.update()

    def paintEvent(self, event: QPaintEvent) -> None:
        if self._steps is None:
            return
        painter, line = QPainter(self), self.fontMetrics().height()
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        colours, count = self._steps.colormap, self._steps.colormap.N
        height = self.height() - 1.2 * line

        def at(number: float) -> float:
            return 0.5 * line + height * (1.0 - number / count)

        painter.setPen(Qt.PenStyle.NoPen)
        for number in range(count):
            painter.setBrush(_map_colour(QColor.fromRgbF(*colours(number)), self._is_old))
            painter.drawRect(QRectF(0, at(number + 1), _BAR_PX, height / count + 0.5))
        painter.setPen(QColor(current_theme().ink))
        for number, edge in enumerate(self._steps.edges):
            if float(edge) in self._ticks:
                y = at(number)
                painter.drawLine(QPointF(_BAR_PX, y), QPointF(_BAR_PX + 4, y))
                place = QRectF(_BAR_PX + 8, y - 0.5 * line, _WIDTH_PX, line)
                painter.drawText(place, Qt.AlignmentFlag.AlignVCenter, fmt.trimmed(float(edge), 6))


def _map_colour(colour: QColor, is_old: bool) -> QColor:
    """Return a colour of the map; grey where that is of an older state."""
    grey = 0.2126 * colour.redF() + 0.7152 * colour.greenF() + 0.0722 * colour.blueF()
    return QColor.fromRgbF(grey, grey, grey) if is_old else colour


_REST_MS = 300  #: Longer than between two events of a drag, shorter than a look takes
_SMOOTH = 8  #: Samples a pixel once nothing moves
_QUICK_S = 0.05  #: A frame that takes no longer may be smoothed while something moves as well
_CLICK_PX = 4  #: A hand that clicks moves the mouse by no more
_STEPS = {
    Qt.Key.Key_Left: (-1, 0, 0),
    Qt.Key.Key_Right: (1, 0, 0),
    Qt.Key.Key_Up: (0, 1, 0),
    Qt.Key.Key_Down: (0, -1, 0),
    Qt.Key.Key_PageUp: (0, 0, 1),
    Qt.Key.Key_PageDown: (0, 0, -1),
}
"""To the right and away from the viewer, along the nearest axis of the frame, and upward."""
_TURN_RAD = float(np.radians(1.0))  #: How far a key turns the platform
_SNAP_PX = 8.0  #: As near an exit point takes the coordinate of another
_ALONG = 1e-9  #: Of a normal, along an axis that lies in its plane


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
    pointed_at = Signal(object)  #: What the mouse is over: a `Hit`, or None

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
        self.set_background(current_theme().base)
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
        for timer in (self._rest, self._hover):
            timer.stop()
        super().closeEvent(event)

    def resizeEvent(self, event: QResizeEvent) -> None:
        super().resizeEvent(event)
        self.view = replace(
            self.view, width_px=max(self.width(), 1), height_px=max(self.height(), 1)
        )
        self.overlay.setGeometry(self.rect())
        self.place_legend()
        self.resized.emit()

    def place_legend(self) -> None:
        if not self.colour_legend.isHidden():
            self.colour_legend.fit(self.height() - 24)
        self.colour_legend.move(self.width() - self.colour_legend.width() - 12, 12)
        self.overlay.legend_px = self.colour_legend.width() + 12

    # What is asked for by mouse and keys

    def mousePressEvent(self, event: QMouseEvent) -> None:
        self.setFocus()
        self._pressed = self._last = event.position().toPoint()
        self._grip, self._gripped = self._grip_at(event.position())
        self.overlay.pointed = None
        if self._grip:
            under = self._dragged_to(event.position())
            self._grip_offset = np.zeros(3) if under is None else self._gripped_m - under

    def mouseMoveEvent(self, event: QMouseEvent) -> None:
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
        factor = 1.0015 ** event.angleDelta().y()
        self._see(self.view.zoomed(factor, event.position().x(), event.position().y()))

    def _see(self, view: View) -> None:
        self.is_turned, self.view = True, view
        self.redraw()

    def leaveEvent(self, event: Any) -> None:
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
        self.overlay.pointed = (QPointF(self._last), text) if text else None
        self.overlay.update()
