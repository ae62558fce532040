"""The pose that the platform is in: where it is, every cable, and what follows."""

from __future__ import annotations

import math
from operator import attrgetter

import numpy as np
from PySide6.QtCore import Qt
from PySide6.QtWidgets import (
    QFormLayout,
    QGridLayout,
    QHeaderView,
    QLabel,
    QPushButton,
    QVBoxLayout,
    QWidget,
)

from designer.explore.desktop.live_session import LiveSession
from designer.explore.desktop.tables import Column, RowsModel, ShareBar, table_view
from designer.explore.desktop.theme import Theme
from designer.explore.desktop.widgets import LineEntry, grey_when_old, restyle
from designer.explore.here import Here
from designer.explore.question import cables_words
from designer.report import format as fmt


def _columns(unit: str, per_N: float) -> tuple[Column, ...]:
    """The columns, with tensions in a unit."""

    def scaled(title: str, name: str, scale: float, digits: int, definition: str) -> Column:
        read = attrgetter(name)
        return Column(title, lambda c: fmt.number(scale * read(c), digits), read, definition)

    return (
        Column(
            "#", lambda c: str(c.number), lambda c: c.number, "The cable, in the order of anchors."
        ),
        Column(
            "length\nm",
            lambda c: fmt.fixed(c.length_m, 3),
            lambda c: c.length_m,
            "Unstrained length from the exit point to the platform, as the winch pays it out.",
        ),
        scaled(
            f"T exit\n{unit}",
            "exit_tension_N",
            per_N,
            4,
            "Tension at the exit point, where the winch pulls.",
        ),
        scaled(f"T load\n{unit}", "platform_tension_N", per_N, 4, "Tension at the platform end."),
        Column(
            "angle\n°",
            lambda c: fmt.fixed(math.degrees(c.angle_rad), 1),
            lambda c: c.angle_rad,
            "How far below the horizontal the cable leaves its exit point.",
        ),
        scaled(
            "sag\nmm",
            "sag_m",
            1e3,
            3,
            "Largest distance of the cable from the straight line between its ends.",
        ),
        scaled(
            "stretch\nmm",
            "stretch_m",
            1e3,
            3,
            "How much longer the cable is under its load than unstrained.",
        ),
        Column(
            "used\n%",
            lambda c: fmt.fixed(100.0 * c.utilisation, 1),
            lambda c: c.utilisation,
            "Utilisation: largest tension anywhere in the cable over the allowable tension.",
            share=lambda c: float(c.utilisation),
        ),
    )


_COORDINATES = (
    ("x", "m", "Position of the platform along x of the frame"),
    ("y", "m", "Position of the platform along y of the frame"),
    ("z", "m", "Height of the platform in the frame"),
    ("rx", "°", "Rotation vector of the platform, x component"),
    ("ry", "°", "Rotation vector of the platform, y component"),
    ("rz", "°", "Rotation vector of the platform, z component"),
)


class PanelHere(QWidget):
    """Where the platform is and what it asks of the cables."""

    def __init__(self, live: LiveSession) -> None:
        super().__init__()
        self._live = live
        self.setObjectName("here")
        self.setMinimumWidth(384)
        self._place = np.zeros(6)
        self._entries: list[LineEntry] = []
        self._turn_labels: list[QLabel] = []
        rows = QVBoxLayout(self)
        rows.setContentsMargins(8, 6, 8, 6)
        rows.addLayout(self._coordinates())
        self.verdict = _text("verdict")
        self.cautions = _text("cautions", "fault")
        rows.addWidget(self.verdict)
        rows.addWidget(self.cautions)
        self.model = RowsModel(_columns("kN", 1e-3))
        self.table = table_view("cables")
        self.table.setModel(self.model)
        small = self.table.font()
        small.setPointSizeF(0.9 * small.pointSizeF())
        self.table.setFont(small)
        self._bar = ShareBar(self.table)
        self.table.setItemDelegateForColumn(len(self.model.columns) - 1, self._bar)
        head = self.table.horizontalHeader()
        head.setMinimumSectionSize(18)
        head.setSectionResizeMode(QHeaderView.ResizeMode.ResizeToContents)
        head.setSectionResizeMode(len(self.model.columns) - 1, QHeaderView.ResizeMode.Stretch)
        rows.addLayout(self._facts())
        self.stability = _text("here stability")
        self.stability.setToolTip("<p>Whether the platform stays here with the winches held.</p>")
        rows.addWidget(self.stability)
        rows.addWidget(self.table, 1)
        keep = QPushButton("Keep as the study's pose")
        keep.setObjectName("keep pose")
        keep.setToolTip("<p>Writes this place under <b>pose:</b> of the study.</p>")
        keep.clicked.connect(live.keep_pose)
        rows.addWidget(keep)
        live.moved.connect(self._show_place)
        live.listen(self._show_here, "here")
        results = self.verdict, self.cautions, self.stability, self.table, *self.facts.values()
        grey_when_old(live, {"here"}, *results)

    def _coordinates(self) -> QGridLayout:
        grid = QGridLayout()
        grid.setHorizontalSpacing(4)
        for number, (name, unit, definition) in enumerate(_COORDINATES):
            entry = LineEntry()
            entry.setObjectName(f"place {name}")
            entry.meaning = f"<p>{definition} [{unit}]. Return takes the platform there.</p>"
            entry.mark("")
            entry.setAccessibleName(f"{name} [{unit}]")
            entry.returnPressed.connect(self._entered)
            label = QLabel(f"{name} [{unit}]")
            label.setProperty("role", "muted")
            row, column = divmod(number, 3)
            grid.addWidget(label, row, 2 * column)
            grid.addWidget(entry, row, 2 * column + 1)
            self._entries.append(entry)
            self._turn_labels += [label] if row else []
        return grid

    def _facts(self) -> QFormLayout:
        form = QFormLayout()
        form.setVerticalSpacing(2)
        self.facts: dict[str, QLabel] = {}
        for name, title, definition in (
            ("cables", "Cables", "What length, tension, sag and utilisation here are of; another "
             "rope is chosen by a click in its table."),
            ("diameter", "Diameter needed here", "The thinnest cable of the configured family that "
             "holds this pose with its own weight and stretch."),
            ("tension", "Largest tension", "Anywhere in any cable of this pose."),
            ("stiffness", "Stiffness", "Smallest force over displacement of the platform in any "
             "direction, winches held."),
        ):  # fmt: skip
            value, label = _text(f"here {name}"), QLabel(title)
            label.setProperty("role", "muted")
            for part in (value, label):
                part.setToolTip(f"<p>{definition}</p>")
            form.addRow(label, value)
            self.facts[name] = value
        return form

    def put_on(self, theme: Theme) -> None:
        """Take the colours of a theme."""
        self._bar.theme = theme
        self.table.viewport().update()

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
        for label in self._turn_labels:
            label.setVisible(can_turn)

    def _show_here(self, answer: Here | None) -> None:
        """Show what was answered for this place."""
        if answer is None:
            self.model.show(())
            return
        self.verdict.setText(answer.sentence)
        good = answer.is_solved and not answer.is_too_weak
        restyle(self.verdict, "good" if good else "fault")
        cautions = " ".join(filter(None, [answer.outside, answer.caution]))
        self.cautions.setText(cautions)
        self.cautions.setVisible(bool(cautions))
        unit, newtons = fmt.force_unit(answer.max_tension_N)
        self.model.rename(_columns(unit, 1.0 / newtons))
        self.model.show(answer.cables)
        self.facts["cables"].setText(cables_words(answer.rope))
        self.facts["diameter"].setText(fmt.millimetres(answer.diameter_m))
        self.facts["tension"].setText(fmt.newtons(answer.max_tension_N))
        self.facts["stiffness"].setText(_stiffness(answer.stiffness_N_per_m))
        self.stability.setText(answer.stability)
        restyle(self.stability, "fault" if answer.is_stable is False else "")

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


def _stiffness(value: float) -> str:
    if not math.isfinite(value):
        return fmt.MISSING
    unit, scale = ("kN/m", 1e-3) if value >= 1e3 else ("N/m", 1.0)
    return f"{fmt.number(scale * value, 3)} {unit}"


def _text(name: str, role: str = "") -> QLabel:
    label = QLabel()
    label.setObjectName(name)
    label.setWordWrap(True)
    label.setTextInteractionFlags(Qt.TextInteractionFlag.TextSelectableByMouse)
    if role:
        label.setProperty("role", role)
    return label
