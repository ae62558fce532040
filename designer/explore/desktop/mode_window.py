"""The platform as it moves in each of its modes, at the pose that it is in."""

from __future__ import annotations

import math
import time

import numpy as np
from PySide6.QtCore import QLineF, Qt, QTimer, Signal
from PySide6.QtGui import QColor, QHideEvent, QPainter, QPaintEvent, QPen, QShowEvent
from PySide6.QtWidgets import QComboBox, QDialog, QVBoxLayout, QWidget

from designer.analysis.governing import PlatformModes
from designer.arrays import FloatArray
from designer.explore.desktop.live_session import LiveSession
from designer.explore.desktop.theme import current
from designer.explore.desktop.widgets import check_box, grey_when_old, named, result
from designer.explore.here import Here
from designer.report import format as fmt
from designer.report.figures.mode_shapes import HEIGHT, PERIOD_S, WIDTH, on_sheet

_FRAME_MS = 40
_NO_MOVES = np.empty((0, 0, 2, 2))


class ModeWindow(QDialog):
    """Modes of the platform at this pose: one is chosen, and moves."""

    moves_in_scene = Signal(object)
    """The shape (3,) or (6,) of the mode that is to move in the scene as well, or None."""

    def __init__(self, live: LiveSession, parent: QWidget) -> None:
        super().__init__(parent)
        self.setObjectName("mode window")
        self.setWindowTitle("Modes of the platform")
        self.resize(480, 420)
        self.chosen = named(QComboBox(), "mode", "Which mode moves, by its natural frequency.")
        self.words = result("mode words", "muted")
        self.words.setWordWrap(True)
        self.view = ModeView()
        self.in_scene = check_box(
            "mode in scene",
            "Move in the scene as well",
            self._move_scene,
            "Platform and cables move there, for as long as this window is open.",
        )
        column = QVBoxLayout(self)
        for part in (self.chosen, self.view, self.in_scene, self.words):
            column.addWidget(part, int(part is self.view))
        self.chosen.currentIndexChanged.connect(self._choose)
        self._answer: Here | None = None
        self._lines: FloatArray | None = None
        self._moves = _NO_MOVES
        live.listen(self._show_here, "here")
        grey_when_old(live, {"here"}, self.words)

    def showEvent(self, event: QShowEvent) -> None:
        """Show what was answered while it was not seen."""
        self._show_modes()
        super().showEvent(event)

    def hideEvent(self, event: QHideEvent) -> None:
        """Let the scene rest."""
        self.moves_in_scene.emit(None)
        super().hideEvent(event)

    def _move_scene(self) -> None:
        modes, number = (
            None if self._answer is None else self._answer.modes,
            self.chosen.currentIndex(),
        )
        is_moving = self.in_scene.isChecked() and modes is not None and number >= 0
        self.moves_in_scene.emit(modes.modes[number].shape if is_moving and modes else None)

    def _show_here(self, answer: Here | None) -> None:
        self._answer = answer
        if self.isVisible():
            self._show_modes()

    def _show_modes(self) -> None:
        modes = None if self._answer is None else self._answer.modes
        self._lines, self._moves = (None, _NO_MOVES) if modes is None else on_sheet(modes)
        number = max(self.chosen.currentIndex(), 0)
        self.chosen.blockSignals(True)
        self.chosen.clear()
        if modes is not None:
            self.chosen.addItems(_titles(modes))
            self.chosen.setCurrentIndex(min(number, len(modes.modes) - 1))
        self.chosen.blockSignals(False)
        self.words.setText(
            "No cables hold the platform here, or its inertia is not in the study."
            if modes is None
            else "Displacements are drawn far larger than they are, and all modes equally fast; "
            "winches are braked, and nothing damps."
        )
        self._choose()

    def _choose(self) -> None:
        number = self.chosen.currentIndex()
        move = self._moves[number] if 0 <= number < len(self._moves) else None
        self.view.show_motion(self._lines, move)
        self._move_scene()


class ModeView(QWidget):
    """Lines that move to and fro about their rest while they are seen."""

    def __init__(self) -> None:
        super().__init__()
        self.setMinimumSize(240, 180)
        self._rest: FloatArray | None = None
        self._move: FloatArray | None = None
        self._timer = QTimer(self)
        self._timer.setInterval(_FRAME_MS)
        self._timer.timeout.connect(self.update)

    def show_motion(self, rest: FloatArray | None, move: FloatArray | None) -> None:
        """Show lines (n, 2, 2) on the sheet and their largest displacement; none where None."""
        self._rest, self._move = rest, move
        self.update()

    def showEvent(self, event: QShowEvent) -> None:
        """Start to move."""
        self._timer.start()
        super().showEvent(event)

    def hideEvent(self, event: QHideEvent) -> None:
        """Stop."""
        self._timer.stop()
        super().hideEvent(event)

    def paintEvent(self, event: QPaintEvent) -> None:
        """Draw the lines at rest, and where they are now."""
        painter = QPainter(self)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        scale = min(self.width() / WIDTH, self.height() / HEIGHT)
        painter.translate(
            0.5 * (self.width() - scale * WIDTH), 0.5 * (self.height() - scale * HEIGHT)
        )
        painter.scale(scale, scale)
        if self._rest is None or self._move is None:
            return
        theme = current()
        phase = math.cos(2.0 * math.pi * time.monotonic() / PERIOD_S)
        for lines, colour, width in (
            (self._rest, theme.muted, 0.5),
            (self._rest + phase * self._move, theme.accent, 0.9),
        ):
            pen = QPen(QColor(colour), width)
            pen.setCapStyle(Qt.PenCapStyle.RoundCap)
            painter.setPen(pen)
            painter.drawLines([QLineF(*ends) for ends in lines.reshape(-1, 4).tolist()])


def _titles(modes: PlatformModes) -> list[str]:
    return [
        f"mode {number}: {fmt.number(mode.frequency_Hz, 3)} Hz"
        for number, mode in enumerate(modes.modes, start=1)
    ]
