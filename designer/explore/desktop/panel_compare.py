"""The present state beside one that was pinned as A: figures, values, candidates."""

from __future__ import annotations

import math
from dataclasses import dataclass

from PySide6.QtWidgets import (
    QCheckBox,
    QHBoxLayout,
    QLabel,
    QPushButton,
    QVBoxLayout,
    QWidget,
)

from designer.explore.compare import Differences
from designer.explore.desktop.live_session import LiveSession
from designer.explore.desktop.tables import Column, RowsModel, table_view
from designer.explore.desktop.widgets import grey_when_old
from designer.report import format as fmt


@dataclass(frozen=True, slots=True)
class _Row:
    """A figure or a value in both states."""

    title: str
    before: str
    after: str
    difference: str


_COLUMNS = (
    Column("", lambda r: r.title, lambda r: r.title, "Figure, or value of the study.", False),
    Column("A", lambda r: r.before, lambda r: r.before, "In the pinned state."),
    Column("now", lambda r: r.after, lambda r: r.after, "In the present state."),
    Column("difference", lambda r: r.difference, lambda r: r.difference, "Now less A."),
)


class PanelCompare(QWidget):
    """What has become otherwise since A was pinned."""

    def __init__(self, live: LiveSession) -> None:
        super().__init__()
        self._live = live
        self.setObjectName("compare")
        self._pin = QPushButton("Pin this state as A")
        self._pin.setObjectName("pin")
        self._pin.clicked.connect(live.pin)
        self._release = QPushButton("Release A")
        self._release.setObjectName("release")
        self._release.clicked.connect(live.release)
        self.in_map = QCheckBox("The map shows the difference to A")
        self.in_map.setObjectName("difference in the map")
        self.in_map.toggled.connect(live.compare_in_map)
        self._summary = QLabel()
        self._summary.setWordWrap(True)
        self._summary.setObjectName("ropes gained and lost")
        self.model = RowsModel(_COLUMNS)
        self.model.hint = lambda row: f"{row.title}: {row.before} → {row.after}"
        self.table = table_view("differences")
        self.table.setModel(self.model)
        for column, width in enumerate((190, 190, 190)):
            self.table.setColumnWidth(column, width)
        self.table.horizontalHeader().setStretchLastSection(True)
        above = QHBoxLayout()
        for widget in (self._pin, self._release, self.in_map):
            above.addWidget(widget)
        above.addStretch(1)
        rows = QVBoxLayout(self)
        rows.setContentsMargins(8, 4, 8, 4)
        rows.setSpacing(4)
        rows.addLayout(above)
        rows.addWidget(self._summary)
        rows.addWidget(self.table, 1)
        live.answered.connect(self._show_differences)
        live.changed.connect(self._show_differences)
        grey_when_old(live, {"here", "worst", "ropes"}, self._summary, self.table)
        self._show_differences()

    def _show_differences(self) -> None:
        differences = self._live.differences()
        is_pinned = differences is not None
        self._release.setEnabled(is_pinned)
        self.in_map.setEnabled(is_pinned)
        if differences is None:
            self.in_map.setChecked(False)
            self._summary.setText("Nothing is pinned: pin a state, go on, and see what changes.")
            self.model.show(())
            return
        self._summary.setText(_summary(differences))
        rows = [_Row(c.title, c.before or "–", c.after or "–", "") for c in differences.changes]
        for line in differences.lines:
            before, after = (_text(v, line.scale, line.unit) for v in (line.before, line.after))
            change = _signed(line.difference, line.scale, line.unit)
            rows.append(_Row(line.title, before, after, change))
        self.model.show(rows)


def _summary(differences: Differences) -> str:
    parts = []
    for word, ropes in (("gained", differences.gained), ("lost", differences.lost)):
        if ropes:
            first = "; ".join(rope.label for rope in ropes[:3])
            more = f" and {len(ropes) - 3} more" if len(ropes) > 3 else ""
            parts.append(f"{fmt.plural(len(ropes), 'rope')} {word}: {first}{more}.")
    if not differences.is_like_with_like:
        parts.append("The candidates of one state are at the samples, those of the other in full.")
    return " ".join(parts) or "The same ropes hold as in A."


def _text(value: float, scale: float, unit: str) -> str:
    return fmt.MISSING if math.isnan(value) else f"{fmt.number(scale * value, 4)} {unit}"


def _signed(value: float, scale: float, unit: str) -> str:
    if math.isnan(value):
        return fmt.MISSING
    text = fmt.number(scale * value, 3)
    return f"{'' if text.startswith('−') or value == 0.0 else '+'}{text} {unit}"
