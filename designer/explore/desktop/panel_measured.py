"""Measured data beside the model: what is left of each reading, and the search for why."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from PySide6.QtCore import QPointF, QRectF, Qt, Signal
from PySide6.QtGui import QColor, QPainter, QPaintEvent, QPen
from PySide6.QtWidgets import QFrame, QHBoxLayout, QScrollArea, QVBoxLayout, QWidget

from designer.arrays import FloatArray
from designer.explore.desktop import theme
from designer.explore.desktop.live_session import LiveSession
from designer.explore.desktop.widgets import (
    DropDown,
    beside,
    button,
    check_box,
    grey_when_old,
    panel,
    result,
)
from designer.report import format as fmt
from designer.report.figures.parts import ticks_between

if TYPE_CHECKING:
    from designer.explore.measurements import DiagnosisAnswer, Residuals

_ALL = "all, in units of noise"


class PanelMeasured(QWidget):
    """Residuals over any covariate; the diagnosis, and taking over what it found."""

    rows_wanted = Signal(bool)
    """The measured rows shall be seen in the scene."""

    def __init__(self, live: LiveSession) -> None:
        super().__init__()
        self._live = live
        self._residuals: Residuals | None = None
        self._diagnosis: DiagnosisAnswer | None = None
        self.channel, self.over = DropDown("channel", 14), DropDown("covariate", 10)
        for box in (self.channel, self.over):
            box.currentIndexChanged.connect(self._draw)
        self.without = check_box(
            "without effects",
            "also without effects",
            self._draw,
            "Draws beside them, paler, what a model without the declared effects leaves.",
        )
        in_scene = check_box("rows in the scene", "in the scene", self.rows_wanted.emit)
        self.plot, self.summary = ScatterPlot(), result("diagnosis")
        self.summary.setTextFormat(Qt.TextFormat.RichText)
        self.summary.setAlignment(Qt.AlignmentFlag.AlignTop)
        self._take = button(
            "take over",
            "Take over what was found",
            self._take_over,
            "Writes the effects into the study as one step, with this state pinned as A: the "
            "comparison shows map and answer with and without them.",
        )
        above = beside("Residual of", self.channel, "over", self.over, self.without, in_scene, None)
        panel(self, "measured", above, self._plot_and_answer())
        live.listen(self._show_residuals, "residuals")
        live.listen(self._show_diagnosis, "diagnose")
        grey_when_old(live, {"residuals"}, self.plot)
        grey_when_old(live, {"diagnose"}, self.summary)
        self._show_diagnosis(None)

    def _plot_and_answer(self) -> QHBoxLayout:
        area = QScrollArea()  # beside the plot: a long answer shall not squeeze it
        area.setWidget(self.summary)
        area.setWidgetResizable(True)
        area.setFrameShape(QFrame.Shape.NoFrame)
        diagnose = button(
            "diagnose",
            "Diagnose",
            lambda: self._live.begin_long("diagnose"),
            "Searches for the physical effects that the model lacks; some minutes.",
        )
        answer, both = QVBoxLayout(), QHBoxLayout()
        answer.addWidget(area, 1)
        for part in (diagnose, self._take):
            answer.addWidget(part)
        both.addWidget(self.plot, 2)
        both.addLayout(answer, 1)
        return both

    def _show_residuals(self, residuals: Residuals | None) -> None:
        """Show what is left of the readings."""
        self._residuals = residuals
        if residuals is None:
            self.plot.show_points("", "", np.empty((0, 2)), np.empty((0, 2)), np.nan)
            return
        measured = [
            name
            for name, column in zip(residuals.channels, residuals.residual.T, strict=True)
            if np.isfinite(column).any()
        ]
        self.channel.refill([_ALL, *measured])
        self.over.refill(list(residuals.covariates))
        self._draw()

    def _show_diagnosis(self, diagnosis: DiagnosisAnswer | None) -> None:
        """Show what the search came to."""
        self._diagnosis = diagnosis
        self._take.setEnabled(diagnosis is not None and bool(diagnosis.effects))
        if diagnosis is None:
            self.summary.setText("No search has been made.")
            return
        answer = f"<b>{diagnosis.title}</b> {diagnosis.text}"
        self.summary.setText("<br>".join((answer, *diagnosis.effects, *diagnosis.errors)))

    def _take_over(self) -> None:
        if self._diagnosis is not None:
            self._live.take_over(self._diagnosis.diagnosed_text)

    def _draw(self) -> None:
        residuals = self._residuals
        if residuals is None or self.over.currentText() not in residuals.covariates:
            return
        over = residuals.covariates[self.over.currentText()]
        name = self.channel.currentText()
        if name == _ALL:
            values, before, label = residuals.size(), np.full(len(over), np.nan), "residual / noise"
            noise = 1.0
        else:
            column = residuals.channels.index(name)
            values, before = residuals.residual[:, column], residuals.without[:, column]
            label = f"{name} [{residuals.units[column]}]"
            noise = float(residuals.noise[column])
        without = before if self.without.isChecked() else np.full(len(over), np.nan)
        now, pale = (np.column_stack([over, column]) for column in (values, without))
        self.plot.show_points(self.over.currentText(), label, now, pale, noise)


class ScatterPlot(QWidget):
    """Points over an axis, paler ones behind them, and a band of twice the noise."""

    def __init__(self) -> None:
        super().__init__()
        self.setObjectName("residual plot")
        self.setMinimumHeight(90)
        self.points = np.empty((0, 2))
        self._pale = np.empty((0, 2))
        self._labels = ("", "")
        self._noise = np.nan

    def show_points(
        self, across: str, upward: str, points: FloatArray, pale: FloatArray, noise: float
    ) -> None:
        """Show points (n, 2) and paler ones (n, 2); rows with NaN are left out."""
        self.points = points[np.isfinite(points).all(axis=1)]
        self._pale = pale[np.isfinite(pale).all(axis=1)]
        self._labels, self._noise = (across, upward), noise
        self.update()

    def paintEvent(self, event: QPaintEvent) -> None:
        """Draw axes, band and points."""
        painter, colours = QPainter(self), theme.current()
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        everything = np.concatenate([self.points, self._pale])
        if len(everything) == 0:
            painter.setPen(QColor(colours.muted))
            painter.drawText(self.rect(), Qt.AlignmentFlag.AlignCenter, "no residuals")
            return
        low, high = everything.min(axis=0), everything.max(axis=0)
        reach = 2.0 * self._noise if np.isfinite(self._noise) else 0.0
        low[1], high[1] = min(low[1], -reach), max(high[1], reach)
        room = np.where(high > low, 0.04 * (high - low), 0.5)
        low, high = low - room, high + room
        area = QRectF(66, 6, self.width() - 76, self.height() - 42)

        def at(point: FloatArray) -> QPointF:
            share = (point - low) / (high - low)
            return QPointF(
                area.left() + share[0] * area.width(), area.bottom() - share[1] * area.height()
            )

        self._draw_axes(painter, area, low, high)
        painter.setClipRect(area)
        painter.setPen(Qt.PenStyle.NoPen)
        band = QColor(colours.good)
        band.setAlpha(40)
        bottom, top = at(np.array([low[0], -reach])), at(np.array([high[0], reach]))
        painter.fillRect(QRectF(bottom, top).normalized(), band)
        fresh = colours.muted if self.property("old") else colours.accent
        for points, colour in ((self._pale, colours.muted), (self.points, fresh)):
            ink = QColor(colour)
            ink.setAlpha(110 if points is self._pale else 200)
            painter.setBrush(ink)
            for point in points:
                painter.drawEllipse(at(point), 2.4, 2.4)

    def _draw_axes(
        self, painter: QPainter, area: QRectF, low: FloatArray, high: FloatArray
    ) -> None:
        colours = theme.current()
        painter.setPen(QPen(QColor(colours.border)))
        painter.drawRect(area)
        line = self.fontMetrics().height()
        for axis in (0, 1):
            for tick in ticks_between(float(low[axis]), float(high[axis])):
                share = (tick - low[axis]) / (high[axis] - low[axis])
                painter.setPen(QColor(colours.muted))
                text = fmt.trimmed(float(tick), 4)
                if axis == 0:
                    x = area.left() + share * area.width()
                    box = QRectF(x - 40, area.bottom() + 2, 80, line)
                    painter.drawText(box, Qt.AlignmentFlag.AlignHCenter, text)
                else:
                    y = area.bottom() - share * area.height()
                    box = QRectF(0, y - 0.5 * line, area.left() - 5, line)
                    painter.drawText(box, Qt.AlignmentFlag.AlignRight, text)
                    painter.setPen(QPen(QColor(colours.border), 0.5))
                    painter.drawLine(QPointF(area.left(), y), QPointF(area.right(), y))
        painter.setPen(QColor(colours.ink))
        below = QRectF(area.left(), area.bottom() + line, area.width(), line + 4)
        painter.drawText(below, Qt.AlignmentFlag.AlignHCenter, self._labels[0])
        painter.drawText(QPointF(area.left() + 6, area.top() + line), self._labels[1])
