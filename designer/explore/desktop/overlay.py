"""What is written and drawn over the scene: names of exit points, the handle, the value pointed at.

Qt draws it, not VTK: sharp at every pixel density, in the colours of the window, and without a new
frame of the scene.
"""

from __future__ import annotations

import numpy as np
from PySide6.QtCore import QPointF, QRectF, Qt
from PySide6.QtGui import QColor, QPainter, QPaintEvent, QPen
from PySide6.QtWidgets import QWidget

from designer.arrays import FloatArray
from designer.explore.desktop.camera import Camera
from designer.explore.desktop.theme import LIGHT, Theme

HANDLE_PX = 13.0
ARROW_PX = 34.0


class Overlay(QWidget):
    """Lies over the scene and lets the mouse through."""

    def __init__(self, parent: QWidget, camera: Camera) -> None:
        super().__init__(parent)
        self.setAttribute(Qt.WidgetAttribute.WA_TransparentForMouseEvents)
        self._camera = camera
        self.theme: Theme = LIGHT
        self.names: list[tuple[str, FloatArray]] = []
        self.platform_m: FloatArray | None = None
        self.worst: tuple[FloatArray, str] | None = None
        self.is_worst_old = False
        self.pointed: tuple[QPointF, str] | None = None
        self.note = ""
        self.legend_px = 0  # Width of what covers the right side

    def texts(self) -> list[str]:
        """All that is written."""
        marked = [self.worst[1]] if self.worst else []
        pointed = [self.pointed[1]] if self.pointed else []
        return [*(name for name, _ in self.names), *marked, *pointed, *filter(None, [self.note])]

    def handle_px(self) -> tuple[FloatArray, FloatArray] | None:
        """Return where the handle of the platform is, and the tip of its upward arrow [px]."""
        if self.platform_m is None:
            return None
        centre = self._camera.pixels(self.platform_m)
        return centre, centre - np.array([0.0, ARROW_PX])

    def paintEvent(self, event: QPaintEvent) -> None:
        """Draw it all."""
        painter = QPainter(self)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        self._draw_names(painter)
        self._draw_worst(painter)
        self._draw_handle(painter)
        if self.pointed is not None:
            place, text = self.pointed
            self._write_boxed(painter, place + QPointF(14, 18), text)
        if self.note:
            self._write_boxed(painter, QPointF(10, 10), self.note)

    def _draw_names(self, painter: QPainter) -> None:
        painter.setPen(QColor(self.theme.muted))
        for name, place in self.names:
            x, y = self._camera.pixels(place)
            width = painter.fontMetrics().horizontalAdvance(name)
            has_room = x + 6 + width < self.width() - self.legend_px
            painter.drawText(QPointF(x + 6 if has_room else x - 6 - width, y - 6), name)

    def _draw_worst(self, painter: QPainter) -> None:
        if self.worst is None:
            return
        place, text = self.worst
        x, y = self._camera.pixels(place)
        marked = self.theme.muted if self.is_worst_old else self.theme.warning
        for width, colour in ((5.0, self.theme.base), (2.0, marked)):
            painter.setPen(QPen(QColor(colour), width))
            painter.drawEllipse(QPointF(x, y), 8, 8)
            painter.drawLine(QPointF(x - 13, y), QPointF(x - 4, y))
            painter.drawLine(QPointF(x + 4, y), QPointF(x + 13, y))
        painter.setPen(QColor(marked))
        self._write(painter, QPointF(x + 16, y - 8), text)

    def _draw_handle(self, painter: QPainter) -> None:
        handle = self.handle_px()
        if handle is None:
            return
        centre, tip = QPointF(*handle[0]), QPointF(*handle[1])
        for width, colour in ((4.5, self.theme.base), (1.8, self.theme.accent)):
            painter.setPen(QPen(QColor(colour), width))
            painter.setBrush(Qt.BrushStyle.NoBrush)
            painter.drawEllipse(centre, HANDLE_PX, HANDLE_PX)
            painter.drawLine(QPointF(centre.x(), centre.y() - HANDLE_PX), tip)
            painter.drawPolyline([tip + QPointF(-5, 6), tip, tip + QPointF(5, 6)])

    def _write(self, painter: QPainter, place: QPointF, text: str) -> None:
        """Write on a ground that keeps it readable, inside the picture."""
        box = QRectF(painter.boundingRect(QRectF(0, 0, 400, 200), 0, text))
        left = min(place.x(), self.width() - box.width() - 6)
        ground = QColor(self.theme.base)
        ground.setAlpha(200)
        area = QRectF(max(left, 4), max(place.y() - box.height(), 4), box.width(), box.height())
        painter.fillRect(area.adjusted(-3, -1, 3, 1), ground)
        painter.drawText(area, 0, text)

    def _write_boxed(self, painter: QPainter, place: QPointF, text: str) -> None:
        box = QRectF(painter.boundingRect(QRectF(0, 0, 460, 400), 0, text))
        box.moveTo(place)
        box.adjust(0, 0, 16, 10)
        box.moveRight(min(box.right(), self.width() - 4))
        box.moveBottom(min(box.bottom(), self.height() - 4))
        ground = QColor(self.theme.raised)
        ground.setAlpha(235)
        painter.setPen(QPen(QColor(self.theme.border)))
        painter.setBrush(ground)
        painter.drawRoundedRect(box, 4, 4)
        painter.setPen(QColor(self.theme.ink))
        painter.drawText(box.adjusted(8, 5, -8, -5), 0, text)
