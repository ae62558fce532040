"""What is drawn over the scene: names of exit points, the handle, the value pointed at, the legend.

Qt draws it, not VTK: sharp at every pixel density, in the colours of the window, and without a new
frame of the scene.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from PySide6.QtCore import QPointF, QRectF, QSize, Qt
from PySide6.QtGui import QColor, QFont, QFontMetricsF, QPainter, QPaintEvent, QPen
from PySide6.QtWidgets import QWidget

from designer.arrays import FloatArray
from designer.explore.desktop import theme
from designer.explore.desktop.painting import Key
from designer.report import format as fmt
from designer.report.figures.colours import Steps
from designer.report.figures.view import View

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
        centre = self._view().pixels(self.platform_m)
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

    def _draw_handle(self, painter: QPainter) -> None:
        handle = self.handle_px()
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
        box.moveRight(min(box.right(), self.width() - 4))
        box.moveBottom(min(box.bottom(), self.height() - 4))
        ground = QColor(theme.current().raised)
        ground.setAlpha(235)
        painter.setPen(QPen(QColor(theme.current().border)))
        painter.setBrush(ground)
        painter.drawRoundedRect(box, 4, 4)
        painter.setPen(QColor(theme.current().ink))
        painter.drawText(box.adjusted(8, 5, -8, -5), 0, text)


_WIDTH, _BAR, _MARGIN = 136, 14, 8


class Legend(QWidget):
    """Stands over the scene and lets the mouse through."""

    def __init__(self, parent: QWidget) -> None:
        super().__init__(parent)
        self.setObjectName("legend")
        self.setAttribute(Qt.WidgetAttribute.WA_TransparentForMouseEvents)
        self.title = self.note = ""
        self.is_old = False
        self.steps: Steps | None = None
        self.keys: tuple[Key, ...] = ()

    @property
    def texts(self) -> list[str]:
        """All that is written, from the top."""
        labels = [] if self.steps is None else [fmt.trimmed(float(t), 6) for t in self.steps.ticks]
        notes = filter(None, [self.note])
        return [self.title, *notes, *labels[::-1], *(key.meaning for key in self.keys)]

    def show_meaning(
        self,
        title: str,
        steps: Steps | None,
        keys: Sequence[Key],
        note: str = "",
        *,
        is_old: bool = False,
    ) -> None:
        """Show the title with its unit, a note, a scale if there is one, and other colours."""
        self.title, self.steps, self.keys = title, steps, tuple(keys)
        self.note, self.is_old = note, is_old
        self.setVisible(bool(title))
        self.resize(self.sizeHint())
        self.update()

    def sizeHint(self) -> QSize:
        """As high as what is written."""
        line = self.fontMetrics().height()
        title = self._note_box().bottom() - _MARGIN
        bar = 0.0 if self.steps is None else self._bar_height() + 1.2 * line
        keys = sum(self._key_height(key) for key in self.keys)
        return QSize(_WIDTH, round(2 * _MARGIN + title + bar + keys + 8))

    def paintEvent(self, event: QPaintEvent) -> None:
        """Draw the legend."""
        painter = QPainter(self)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        ground = QColor(theme.current().base)
        ground.setAlpha(225)
        painter.setPen(QPen(QColor(theme.current().border)))
        painter.setBrush(ground)
        painter.drawRoundedRect(QRectF(self.rect()).adjusted(0.5, 0.5, -0.5, -0.5), 4, 4)
        painter.setPen(QColor(theme.current().ink))
        box = self._title_box()
        painter.setFont(self._bold())
        painter.drawText(box, Qt.TextFlag.TextWordWrap, self.title)
        painter.setFont(self.font())
        box = self._note_box()
        painter.setPen(QColor(theme.current().muted))
        painter.drawText(box, Qt.TextFlag.TextWordWrap, self.note)
        top = box.bottom() + 8
        if self.steps is not None:
            top = self._draw_bar(painter, self.steps, top + 0.5 * self.fontMetrics().height())
        for key in self.keys:
            top = self._draw_key(painter, key, top)

    def _draw_bar(self, painter: QPainter, steps: Steps, top: float) -> float:
        """From the largest value at the top downward; returns where it ends."""
        height = self._bar_height()
        colours, count = steps.colormap, steps.colormap.N

        def at(number: float) -> float:
            return top + height * (1.0 - number / count)

        for number in range(count):
            red, green, blue, _ = colours(number)
            painter.setPen(Qt.PenStyle.NoPen)
            painter.setBrush(self._tint(QColor.fromRgbF(red, green, blue)))
            painter.drawRect(QRectF(_MARGIN, at(number + 1), _BAR, height / count + 0.5))
        painter.setPen(QColor(theme.current().ink))
        ticks = set(steps.ticks.tolist())
        for number, edge in enumerate(steps.edges):
            if edge in ticks:
                y = at(number)
                painter.drawLine(QPointF(_MARGIN + _BAR, y), QPointF(_MARGIN + _BAR + 4, y))
                line = self.fontMetrics().height()
                place = QRectF(_MARGIN + _BAR + 8, y - 0.5 * line, _WIDTH, line)
                painter.drawText(place, Qt.AlignmentFlag.AlignVCenter, fmt.trimmed(float(edge), 6))
        return top + height + 0.7 * self.fontMetrics().height()

    def _draw_key(self, painter: QPainter, key: Key, top: float) -> float:
        swatch = QRectF(_MARGIN, top + 3, _BAR, 11)
        painter.fillRect(swatch, self._tint(QColor(key.colour)))
        if key.stripes:
            painter.setBrush(Qt.BrushStyle.BDiagPattern)
            painter.fillRect(swatch, self._tint(QColor(key.colour)))
            stripes = painter.brush()
            stripes.setColor(QColor(key.stripes))
            painter.fillRect(swatch, stripes)
        painter.setPen(QColor(theme.current().ink))
        height = self._key_height(key)
        painter.drawText(
            QRectF(_MARGIN + _BAR + 8, top, _WIDTH - 2 * _MARGIN - _BAR - 8, height),
            Qt.TextFlag.TextWordWrap,
            key.meaning,
        )
        return top + height

    def _tint(self, colour: QColor) -> QColor:
        """Return a colour of the map; grey where that is of an older state."""
        grey = 0.2126 * colour.redF() + 0.7152 * colour.greenF() + 0.0722 * colour.blueF()
        return QColor.fromRgbF(grey, grey, grey) if self.is_old else colour

    def _bar_height(self) -> float:
        lines = 0 if self.steps is None else len(self.steps.ticks)
        return float(lines * 1.25 * self.fontMetrics().height())

    def _key_height(self, key: Key) -> float:
        room = QRectF(0, 0, _WIDTH - 2 * _MARGIN - _BAR - 8, 1000).toRect()
        return (
            self.fontMetrics().boundingRect(room, Qt.TextFlag.TextWordWrap, key.meaning).height()
            + 4
        )

    def _title_box(self) -> QRectF:
        room = QRectF(_MARGIN, _MARGIN, _WIDTH - 2 * _MARGIN, 1000)
        return QFontMetricsF(self._bold()).boundingRect(room, Qt.TextFlag.TextWordWrap, self.title)

    def _note_box(self) -> QRectF:
        title = self._title_box()
        room = QRectF(_MARGIN, title.bottom() + 2, _WIDTH - 2 * _MARGIN, 1000)
        flags = Qt.TextFlag.TextWordWrap
        box = QFontMetricsF(self.font()).boundingRect(room, flags, self.note)
        return box if self.note else QRectF(title.bottomLeft(), title.bottomLeft())

    def _bold(self) -> QFont:
        font = QFont(self.font())
        font.setBold(True)
        return font
