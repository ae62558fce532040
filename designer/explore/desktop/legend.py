"""What the colours of the map mean: a bar of steps with its unit, a list, and what is hatched."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from PySide6.QtCore import QPointF, QRectF, QSize, Qt
from PySide6.QtGui import QColor, QFont, QFontMetricsF, QPainter, QPaintEvent, QPen
from PySide6.QtWidgets import QWidget

from designer.explore.desktop.theme import LIGHT, Theme
from designer.report import format as fmt
from designer.report.figures.colours import Steps

_WIDTH, _BAR, _MARGIN = 136, 14, 8


@dataclass(frozen=True, slots=True)
class Key:
    """A colour and what it means; hatched where there is a second colour."""

    colour: str
    meaning: str
    stripes: str = ""


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
        self._theme = LIGHT

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
        theme: Theme,
        note: str = "",
        *,
        is_old: bool = False,
    ) -> None:
        """Show the title with its unit, a note, a scale if there is one, and other colours."""
        self.title, self.steps, self.keys, self._theme = title, steps, tuple(keys), theme
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
        ground = QColor(self._theme.base)
        ground.setAlpha(225)
        painter.setPen(QPen(QColor(self._theme.border)))
        painter.setBrush(ground)
        painter.drawRoundedRect(QRectF(self.rect()).adjusted(0.5, 0.5, -0.5, -0.5), 4, 4)
        painter.setPen(QColor(self._theme.ink))
        box = self._title_box()
        painter.setFont(self._bold())
        painter.drawText(box, Qt.TextFlag.TextWordWrap, self.title)
        painter.setFont(self.font())
        box = self._note_box()
        painter.setPen(QColor(self._theme.muted))
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
        painter.setPen(QColor(self._theme.ink))
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
        painter.setPen(QColor(self._theme.ink))
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
