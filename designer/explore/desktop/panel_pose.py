"""The pose that the platform is in: where it is, every cable, what follows, how it oscillates."""

from __future__ import annotations

import math
import time

import numpy as np
from PySide6.QtCore import QLineF, Qt, QTimer, Signal
from PySide6.QtGui import QColor, QHideEvent, QPainter, QPaintEvent, QPen, QShowEvent
from PySide6.QtWidgets import (
    QComboBox,
    QDialog,
    QFormLayout,
    QGridLayout,
    QHeaderView,
    QLabel,
    QVBoxLayout,
    QWidget,
)

from designer.arrays import FloatArray
from designer.explore.answers import PoseAnswer
from designer.explore.desktop.live_session import LiveSession
from designer.explore.desktop.widgets import (
    Column,
    LineEntry,
    Table,
    button,
    check_box,
    current_theme,
    fill,
    grey_when_old,
    label,
    named,
    number_column,
    restyle,
    result,
    row_of,
)
from designer.explore.question import cables_words
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
        tip = "Platform and cables move there, for as long as this window is open."
        text = "Move in the scene as well"
        self.in_scene = check_box("mode in scene", text, self._move_scene, tip)
        column = QVBoxLayout(self)
        for part in (self.chosen, self.view, self.in_scene, self.words):
            column.addWidget(part, int(part is self.view))
        self.chosen.currentIndexChanged.connect(self._choose)
        self._answer: PoseAnswer | None = None
        self._lines: FloatArray | None = None
        self._moves = _NO_MOVES
        live.listen(self._show_answer, "pose")
        grey_when_old(live, {"pose"}, self.words)

    def showEvent(self, event: QShowEvent) -> None:
        self._show_modes()
        super().showEvent(event)

    def hideEvent(self, event: QHideEvent) -> None:
        self.moves_in_scene.emit(None)
        super().hideEvent(event)

    def _move_scene(self) -> None:
        modes = (
            self._answer.modes if self._answer is not None and self.in_scene.isChecked() else None
        )
        number = self.chosen.currentIndex()
        self.moves_in_scene.emit(None if modes is None or number < 0 else modes.modes[number].shape)

    def _show_answer(self, answer: PoseAnswer | None) -> None:
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
            for k, mode in enumerate(modes.modes, start=1):
                self.chosen.addItem(f"mode {k}: {fmt.number(mode.frequency_Hz, 3)} Hz")
            self.chosen.setCurrentIndex(min(number, len(modes.modes) - 1))
        self.chosen.blockSignals(False)
        self.words.setText(
            "No cables hold the platform here, or its inertia is not in the study."
            if modes is None
            else "Displacements are exaggerated, and all modes shown at one speed; winches braked, "
            "no damping."
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
        self._timer.start()
        super().showEvent(event)

    def hideEvent(self, event: QHideEvent) -> None:
        self._timer.stop()
        super().hideEvent(event)

    def paintEvent(self, event: QPaintEvent) -> None:
        painter = QPainter(self)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        scale = min(self.width() / WIDTH, self.height() / HEIGHT)
        painter.translate(
            0.5 * (self.width() - scale * WIDTH), 0.5 * (self.height() - scale * HEIGHT)
        )
        painter.scale(scale, scale)
        if self._rest is None or self._move is None:
            return
        theme = current_theme()
        phase = math.cos(2.0 * math.pi * time.monotonic() / PERIOD_S)
        for lines, colour, width in (
            (self._rest, theme.muted, 0.5),
            (self._rest + phase * self._move, theme.accent, 0.9),
        ):
            pen = QPen(QColor(colour), width)
            pen.setCapStyle(Qt.PenCapStyle.RoundCap)
            painter.setPen(pen)
            painter.drawLines([QLineF(*ends) for ends in lines.reshape(-1, 4).tolist()])


def _columns(unit: str, per_N: float) -> tuple[Column, ...]:

    def tension(value: float) -> str:
        return fmt.number(per_N * value, 4)

    def millimetres(value: float) -> str:
        return fmt.number(1e3 * value, 3)

    return tuple(
        number_column(f"{title}\n{unit_text}".strip(), name, definition, text, share)
        for title, unit_text, name, definition, text, share in (
            ("#", "", "number", "The cable, in the order of anchors.", str, None),
            ("length", "m", "length_m", "Unstrained length from the exit point to the platform, as "
             "the winch pays it out.", lambda value: fmt.fixed(value, 3), None),
            ("T exit", unit, "exit_tension_N", "Tension at the exit point, where the winch pulls.",
             tension, None),
            ("T load", unit, "platform_tension_N", "Tension at the platform end.", tension, None),
            ("angle", "°", "angle_rad", "How far below the horizontal the cable leaves its exit "
             "point.", lambda value: fmt.fixed(math.degrees(value), 1), None),
            ("sag", "mm", "sag_m", "Largest distance of the cable from the straight line between "
             "its ends.", millimetres, None),
            ("stretch", "mm", "stretch_m", "How much longer the cable is under its load than "
             "unstrained.", millimetres, None),
            ("util.", "%", "utilisation", "Utilisation: largest tension anywhere in the cable over "
             "the allowable tension.", lambda value: fmt.fixed(100.0 * value, 1),
             lambda cable: cable.utilisation),
        )
    )  # fmt: skip


_COORDINATES = (
    ("x", "m", "Position of the platform along x of the frame"),
    ("y", "m", "Position of the platform along y of the frame"),
    ("z", "m", "Height of the platform in the frame"),
    ("rx", "°", "Rotation vector of the platform, x component"),
    ("ry", "°", "Rotation vector of the platform, y component"),
    ("rz", "°", "Rotation vector of the platform, z component"),
)
_FACTS = (
    ("cables", "Cables", "What length, tension, sag and utilisation here are of; another rope is "
     "chosen by a click in its table."),
    ("diameter", "Diameter needed here", "The thinnest cable of the configured family that holds "
     "this pose with its own weight and stretch."),
    ("tension", "Largest tension", "Anywhere in any cable of this pose."),
    ("stiffness", "Stiffness", "Smallest force over displacement of the platform in any direction, "
     "winches held."),
)  # fmt: skip


class PanelPose(QWidget):
    """Where the platform is and what it asks of the cables."""

    def __init__(self, live: LiveSession) -> None:
        super().__init__()
        self._live = live
        self.setObjectName("pose")
        self.setMinimumWidth(384)
        self._place = np.zeros(6)
        self._entries: list[LineEntry] = []
        self._turn_labels: list[QLabel] = []
        self.verdict, self.cautions = result("verdict"), result("cautions", "fault")
        self.facts = {name: result(f"pose {name}", tip=tip) for name, _, tip in _FACTS}
        self.stability = result(
            "pose stability", tip="Whether the platform stays here with the winches held."
        )
        self.table = Table("cables", _columns("kN", 1e-3))
        small = self.table.font()
        small.setPointSizeF(0.9 * small.pointSizeF())
        self.table.setFont(small)
        head = self.table.horizontalHeader()
        head.setMinimumSectionSize(18)
        head.setStretchLastSection(False)
        head.setSectionResizeMode(QHeaderView.ResizeMode.ResizeToContents)
        head.setSectionResizeMode(head.count() - 1, QHeaderView.ResizeMode.Stretch)
        tip = "Writes this place under <b>pose:</b> of the study."
        keep = button("keep pose", "Keep as the study's pose", live.keep_pose, tip)
        self.modes, tip = ModeWindow(live, self), "How the platform oscillates in this pose."
        modes = button("modes", "Modes…", self.modes.show, tip)
        form = QFormLayout()
        form.setVerticalSpacing(2)
        for fact, text, tip in _FACTS:
            form.addRow(label(text, "muted", tip), self.facts[fact])
        rows = QVBoxLayout(self)
        rows.setContentsMargins(8, 6, 8, 6)
        grid = QGridLayout()
        grid.setHorizontalSpacing(4)
        for number, (name, unit, definition) in enumerate(_COORDINATES):
            entry = named(LineEntry(), f"place {name}")
            entry.meaning = f"<p>{definition} [{unit}]. Return takes the platform there.</p>"
            entry.mark("")
            entry.setAccessibleName(f"{name} [{unit}]")
            entry.returnPressed.connect(self._entered)
            title = label(f"{name} [{unit}]", "muted")
            row, column = divmod(number, 3)
            grid.addWidget(title, row, 2 * column)
            grid.addWidget(entry, row, 2 * column + 1)
            self._entries.append(entry)
            self._turn_labels += [title] if row else []
        fill(rows, grid, self.verdict, self.cautions, form, self.stability)
        rows.addWidget(self.table, 1)
        rows.addLayout(row_of(keep, modes))
        live.moved.connect(self._show_place)
        live.listen(self._show_answer, "pose")
        results = self.verdict, self.cautions, self.stability, self.table, *self.facts.values()
        grey_when_old(live, {"pose"}, *results)

    def _show_place(self) -> None:
        """Show where the platform is; an entry that is being written in is left alone."""
        study, session = self._live.study, self._live.session
        if study is None or session is None:
            return
        place, can_turn = session.state.place, not study.robot.is_point_mass
        is_elsewhere = not np.array_equal(place, self._place)
        self._place = np.array(place, dtype=np.float64)
        coordinates = [*place[:3], *np.degrees(place[3:])]
        for number, (entry, value) in enumerate(zip(self._entries, coordinates, strict=True)):
            is_written = entry.hasFocus() and entry.isModified()
            if not is_written and (is_elsewhere or not entry.is_faulty):
                entry.setText(f"{round(float(value), 4) + 0.0:g}")
                entry.mark("")
            entry.setVisible(can_turn or number < 3)
        for title in self._turn_labels:
            title.setVisible(can_turn)

    def _show_answer(self, answer: PoseAnswer | None) -> None:
        if answer is None:
            self.table.rows.show(())
            return
        self.verdict.setText(answer.sentence)
        good = answer.is_solved and not answer.is_too_weak
        restyle(self.verdict, "role", "good" if good else "fault")
        cautions = " ".join(filter(None, [answer.outside, answer.caution]))
        self.cautions.setText(cautions)
        self.cautions.setVisible(bool(cautions))
        unit, newtons = fmt.force_unit(answer.max_tension_N)
        self.table.rows.rename(_columns(unit, 1.0 / newtons))
        self.table.rows.show(answer.cables)
        self.facts["cables"].setText(cables_words(answer.rope))
        self.facts["diameter"].setText(fmt.millimetres(answer.diameter_m))
        self.facts["tension"].setText(fmt.newtons(answer.max_tension_N))
        stiffness = answer.stiffness_N_per_m
        unit, scale = ("kN/m", 1e-3) if stiffness >= 1e3 else ("N/m", 1.0)
        text = (
            f"{fmt.number(scale * stiffness, 3)} {unit}"
            if math.isfinite(stiffness)
            else fmt.MISSING
        )
        self.facts["stiffness"].setText(text)
        self.stability.setText(answer.stability)
        restyle(self.stability, "role", "fault" if answer.is_stable is False else "")

    def _entered(self) -> None:
        place = self._place.copy()
        for number, entry in enumerate(self._entries):
            try:
                value = float(entry.text().replace(",", ".").replace("−", "-"))
            except ValueError:
                value = math.nan
            entry.mark("" if math.isfinite(value) else "a number is expected")
            if not math.isfinite(value):
                return
            if entry.isModified():  # what was not touched keeps all its digits
                place[number] = value if number < 3 else math.radians(value)
        for entry in self._entries:
            entry.setModified(False)
        self._live.move(place)
