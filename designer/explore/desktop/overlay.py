"""What is drawn over the scene: names of exit points, the handle, the value pointed at, the legend.

Qt draws it, not VTK: sharp at every pixel density, in the colours of the window, and without a new
frame of the scene.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np
from PySide6.QtCore import QPointF, QRectF, Qt
from PySide6.QtGui import QBrush, QColor, QPainter, QPaintEvent, QPen, QPixmap
from PySide6.QtWidgets import QFormLayout, QFrame, QLabel, QVBoxLayout, QWidget

from designer.arrays import FloatArray
from designer.explore.desktop import theme
from designer.explore.desktop.painting import Key, Painting
from designer.explore.desktop.widgets import fill, label
from designer.report import format as fmt
from designer.report.figures.colours import Steps
from designer.report.figures.view import View

if TYPE_CHECKING:
    from designer.explore.map import MapAnswer

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
        """All that is written."""
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
        """Draw it all."""
        painter = QPainter(self)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        self._draw_names(painter)
        self._draw_worst(painter)
        for place_m in (self.platform_m, self.chosen_m):
            self._draw_handle(painter, place_m)
        self._draw_rule(painter)
        if self.pointed is not None:
            place, text = self.pointed
            self._write_boxed(painter, place + QPointF(14, 18), text)
        if self.note:
            self._write_boxed(painter, QPointF(10, 10), self.note)

    def _draw_names(self, painter: QPainter) -> None:
        painter.setPen(QColor(theme.current().muted))
        for name, place in self.names:
            x, y = self._view().pixels(place)
            width = painter.fontMetrics().horizontalAdvance(name)
            has_room = x + 6 + width < self.width() - self.legend_px
            painter.drawText(QPointF(x + 6 if has_room else x - 6 - width, y - 6), name)

    def _draw_worst(self, painter: QPainter) -> None:
        if self.worst is None:
            return
        place, text = self.worst
        x, y = self._view().pixels(place)
        marked = theme.current().muted if self.is_worst_old else theme.current().warning
        for width, colour in ((5.0, theme.current().base), (2.0, marked)):
            painter.setPen(QPen(QColor(colour), width))
            painter.drawEllipse(QPointF(x, y), 8, 8)
            painter.drawLine(QPointF(x - 13, y), QPointF(x - 4, y))
            painter.drawLine(QPointF(x + 4, y), QPointF(x + 13, y))
        painter.setPen(QColor(marked))
        self._write(painter, QPointF(x + 16, y - 8), text)

    def _draw_rule(self, painter: QPainter) -> None:
        ends = [QPointF(*self._view().pixels(end)) for end in self.rule_m]
        for width, colour in ((4.5, theme.current().base), (1.8, theme.current().warning)):
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
        for width, colour in ((4.5, theme.current().base), (1.8, theme.current().accent)):
            painter.setPen(QPen(QColor(colour), width))
            painter.setBrush(Qt.BrushStyle.NoBrush)
            painter.drawEllipse(centre, HANDLE_PX, HANDLE_PX)
            painter.drawLine(QPointF(centre.x(), centre.y() - HANDLE_PX), tip)
            painter.drawPolyline([tip + QPointF(-5, 6), tip, tip + QPointF(5, 6)])

    def _write(self, painter: QPainter, place: QPointF, text: str) -> None:
        """Write on a ground that keeps it readable, inside the picture."""
        box = QRectF(painter.boundingRect(QRectF(0, 0, 400, 200), 0, text))
        left = min(place.x(), self.width() - box.width() - 6)
        ground = QColor(theme.current().base)
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
        ground = QColor(theme.current().raised)
        ground.setAlpha(235)
        painter.setPen(QPen(QColor(theme.current().border)))
        painter.setBrush(ground)
        painter.drawRoundedRect(box, 4, 4)
        painter.setPen(QColor(theme.current().ink))
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
        """All that is written, from the top."""
        labels = [] if self.steps is None else [fmt.trimmed(float(t), 6) for t in self.steps.ticks]
        return [self._title.text(), self._note.text(), *labels[::-1], *self._meanings]

    def show_painting(self, painting: Painting, answer: MapAnswer) -> None:
        """Show what colours mean: quantity, cables, scale if there is one, and other colours."""
        keys = painting.keys(answer)
        self.steps, self._meanings = painting.steps, tuple(key.meaning for key in keys)
        self._title.setText(painting.title)
        self._note.setText(painting.note(answer))
        self._bar.show_steps(painting.steps, painting.is_old)
        while self._keys.rowCount():
            self._keys.removeRow(0)
        for key in keys:
            meaning = label(key.meaning)
            meaning.setWordWrap(True)
            self._keys.addRow(_swatch(key, painting.is_old), meaning)
        self.show()
        self.resize(_WIDTH_PX, self.heightForWidth(_WIDTH_PX))


class ColourBar(QWidget):
    """The colours of a scale and its ticks, the largest value at the top."""

    def __init__(self) -> None:
        super().__init__()
        self._steps: Steps | None = None
        self._is_old = False

    def show_steps(self, steps: Steps | None, is_old: bool) -> None:
        """Show a scale, grey where it is of an older state; nothing for None."""
        self._steps, self._is_old = steps, is_old
        lines = 0.0 if steps is None else 1.25 * len(steps.ticks) + 1.2
        self.setFixedHeight(round(lines * self.fontMetrics().height()))
        self.setVisible(steps is not None)
        self.update()

    def paintEvent(self, event: QPaintEvent) -> None:
        """Draw the colours, and beside them their limits."""
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
            painter.setBrush(_tinted(QColor.fromRgbF(*colours(number)), self._is_old))
            painter.drawRect(QRectF(0, at(number + 1), _BAR_PX, height / count + 0.5))
        painter.setPen(QColor(theme.current().ink))
        for number, edge in enumerate(self._steps.edges):
            if edge in self._steps.ticks:
                y = at(number)
                painter.drawLine(QPointF(_BAR_PX, y), QPointF(_BAR_PX + 4, y))
                place = QRectF(_BAR_PX + 8, y - 0.5 * line, _WIDTH_PX, line)
                painter.drawText(place, Qt.AlignmentFlag.AlignVCenter, fmt.trimmed(float(edge), 6))


def _swatch(key: Key, is_old: bool) -> QLabel:
    """Return the colour of a key, hatched where it has stripes."""
    picture = QPixmap(_BAR_PX, 11)
    picture.fill(_tinted(QColor(key.colour), is_old))
    if key.stripes:
        stripes = QBrush(QColor(key.stripes), Qt.BrushStyle.BDiagPattern)
        painter = QPainter(picture)
        painter.fillRect(picture.rect(), stripes)
        painter.end()
    swatch = QLabel()
    swatch.setPixmap(picture)
    return swatch


def _tinted(colour: QColor, is_old: bool) -> QColor:
    """Return a colour of the map; grey where that is of an older state."""
    grey = 0.2126 * colour.redF() + 0.7152 * colour.greenF() + 0.0722 * colour.blueF()
    return QColor.fromRgbF(grey, grey, grey) if is_old else colour
