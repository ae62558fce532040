"""All candidates: which hold, which is best, and why one falls out; and the choice for groups."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from PySide6.QtCore import QModelIndex, QSortFilterProxyModel, Qt
from PySide6.QtWidgets import (
    QCheckBox,
    QHBoxLayout,
    QLabel,
    QPushButton,
    QSizePolicy,
    QVBoxLayout,
    QWidget,
)

from designer.explore.desktop.live_session import LiveSession
from designer.explore.desktop.panel_requirements import answer_words
from designer.explore.desktop.tables import SORT, Column, Index, RowsModel, ShareBar, table_view
from designer.explore.desktop.theme import Theme
from designer.explore.desktop.widgets import DropDown, grey_when_old
from designer.report import format as fmt
from designer.report.design.proof import proof_statement

if TYPE_CHECKING:
    from designer.explore.question import Rope, RopePerCable
    from designer.explore.ropes import Groups, RopeRow, Ropes

_ALL_MATERIALS, _ALL_MAKERS = "all materials", "all makers"
_NOTHING = "Nothing yet: ropes are compared over the workspace of the study."


def _number(title: str, name: str, scale: float, digits: int, definition: str) -> Column:
    def text(row: RopeRow) -> str:
        value = getattr(row, name)
        return fmt.MISSING if value is None else fmt.number(scale * value, digits)

    return Column(title, text, _key(name), definition)


def _key(name: str) -> Callable[[Any], Any]:
    def key(row: Any) -> float:
        value = getattr(row, name)
        return math.inf if value is None or math.isnan(value) else float(value)

    return key


_STANDINGS = (
    *("chosen", "undominated", "dominated", "not_comparable"),
    *("rejected", "too_thin", "not_held"),
)


def _rank(row: RopeRow) -> float:
    """What became of it, then its mass; of what does not hold, how far it is from that."""
    known = row.standing in _STANDINGS
    standing = _STANDINGS.index(row.standing) if known else len(_STANDINGS)
    then = row.total_mass_kg if row.holds else row.utilisation
    return 1e9 * standing + (5e8 if math.isnan(then) else min(then, 1e8))


COLUMNS = (
    Column("rope", lambda r: r.rope.size_id, lambda r: r.diameter_m, "Size of the grade.", False),
    Column(
        "grade",
        lambda r: r.rope.grade_id,
        lambda r: r.rope.grade_id,
        "Grade of the catalogue.",
        False,
    ),
    Column("maker", lambda r: r.maker, lambda r: r.maker, "Who sells it, or its standard.", False),
    Column("material", lambda r: r.material, lambda r: r.material, "What it is made of.", False),
    _number("d [mm]", "diameter_m", 1e3, 3, "Nominal diameter."),
    Column(
        "utilisation",
        lambda r: fmt.utilisation(r.utilisation),
        _key("utilisation"),
        "Largest tension at any pose of the workspace over the allowable tension; over 100 % it is "
        "too weak.",
        share=lambda r: float(r.utilisation),
    ),
    _number("mass [kg]", "total_mass_kg", 1.0, 4, "All cables at the longest length each needs."),
    _number("kg/m", "linear_mass_kg_per_m", 1.0, 3, "Mass per length."),
    _number("MBL [kN]", "breaking_load_N", 1e-3, 4, "Minimum breaking load."),
    _number("largest T [kN]", "max_tension_N", 1e-3, 4, "Largest tension anywhere in any cable."),
    _number("drum [mm]", "drum_diameter_m", 1e3, 4, "Least diameter of drums and sheaves."),
    _number("stiffness [kN/m]", "stiffness_N_per_m", 1e-3, 3, "Least stiffness of the platform."),
    _number("cost", "cost", 1.0, 4, "Of all cables, where the grade has a price."),
    Column(
        "what became of it",
        lambda r: r.reason,
        _rank,
        "Why it is in or out; the best by the objectives of the study first.",
        is_number=False,
    ),
)


class PanelRopes(QWidget):
    """The table of candidates with its filters."""

    def __init__(self, live: LiveSession) -> None:
        super().__init__()
        self._live = live
        self.setObjectName("ropes")
        self._ropes: Ropes | None = None
        self._rope: Rope | RopePerCable | None = None
        self.model = RowsModel(COLUMNS)
        self.model.bold = lambda row: self._ropes is not None and row.rope == self._ropes.best
        self.model.muted = lambda row: not row.holds
        self.model.hint = lambda row: row.reason
        self.filtered = _Filter(self.model)
        self.table = table_view("candidates")
        self.table.setModel(self.filtered)
        self.table.setSortingEnabled(True)
        self.table.sortByColumn(len(COLUMNS) - 1, Qt.SortOrder.AscendingOrder)
        self.table.horizontalHeader().setStretchLastSection(True)
        self._bar = ShareBar(self.table)
        self.table.setItemDelegateForColumn(5, self._bar)
        self.table.selectionModel().currentRowChanged.connect(self._current_changed)
        for column, width in enumerate((72, 180, 116, 72, 60, 84, 78, 56, 80, 104, 84, 116, 60)):
            self.table.setColumnWidth(column, width)
        rows = QVBoxLayout(self)
        rows.setContentsMargins(8, 4, 8, 4)
        rows.setSpacing(4)
        rows.addLayout(self._above())
        rows.addWidget(self.answer)
        rows.addLayout(self._groups_row())
        rows.addWidget(self.table, 1)
        live.listen(self._show_ropes, "ropes", "select")
        live.changed.connect(self._follow_rope)
        grey_when_old(live, {"ropes"}, self.answer, self.groups, self.table)

    def _above(self) -> QHBoxLayout:
        self.material = DropDown("material", 9, _ALL_MATERIALS)
        self.maker = DropDown("maker", 9, _ALL_MAKERS)
        self.material.currentTextChanged.connect(self._filter)
        self.maker.currentTextChanged.connect(self._filter)
        self.only_holding = QCheckBox("only what holds")
        self.only_holding.setObjectName("only what holds")
        self.only_holding.toggled.connect(self._filter)
        self.answer = QLabel()
        self.answer.setObjectName("best rope")
        self.answer.setTextFormat(Qt.TextFormat.PlainText)
        self.answer.setWordWrap(True)
        self.answer.setSizePolicy(QSizePolicy.Policy.Ignored, QSizePolicy.Policy.Preferred)
        family = QPushButton("No rope: the family")
        family.setObjectName("no rope")
        family.setToolTip(
            "<p>Colours the map for the thinnest cable of the configured family at each pose.</p>"
        )
        family.clicked.connect(lambda: self._live.choose(None))
        self.select = QPushButton("Full selection")
        self.select.setObjectName("full selection")
        self.select.setToolTip(
            "<p>Chooses as the report does, between the samples as well, and for groups of cables "
            "where the study has some; then proves that the best holds in all poses, as far as "
            "the study gives it time. Until then the table holds at the samples.</p>"
        )
        self.select.clicked.connect(lambda: self._live.begin_long("select"))
        above = QHBoxLayout()
        for widget in (self.material, self.maker, self.only_holding):
            above.addWidget(widget)
        above.addStretch(1)
        above.addWidget(family)
        above.addWidget(self.select)
        return above

    def _groups_row(self) -> QHBoxLayout:
        self.groups = QLabel()
        self.groups.setObjectName("groups")
        self.groups.setWordWrap(True)
        self.look_at_groups = QPushButton("Look at the groups")
        self.look_at_groups.setObjectName("look at groups")
        self.look_at_groups.setToolTip("<p>Colours the map with each group's own rope.</p>")
        self.look_at_groups.clicked.connect(self._choose_groups)
        row = QHBoxLayout()
        row.addWidget(self.groups, 1)
        row.addWidget(self.look_at_groups)
        return row

    def _choose_groups(self) -> None:
        if self._ropes is not None and self._ropes.groups is not None:
            self._live.choose(self._ropes.groups.assignment)

    def put_on(self, theme: Theme) -> None:
        """Take the colours of a theme."""
        self._bar.theme = theme
        self.model.put_on(theme)

    def _follow_rope(self) -> None:
        """Mark the rope that colours the map."""
        if self._live.rope != self._rope:
            self._rope = self._live.rope
            self._mark_current()

    def _show_ropes(self, ropes: Ropes | None) -> None:
        """Show the candidates, and which of them colours the map."""
        self._ropes, self._rope = ropes, self._live.rope
        self.model.show(() if ropes is None else ropes.rows)
        if ropes is not None:
            self.material.refill([_ALL_MATERIALS, *ropes.materials])
            self.maker.refill([_ALL_MAKERS, *ropes.makers])
        self.answer.setText(_NOTHING if ropes is None else _answer(ropes))
        self.answer.setToolTip(self.answer.text())
        groups = None if ropes is None else ropes.groups
        self.groups.setText("" if groups is None else _groups_text(groups))
        self.groups.setVisible(groups is not None)
        self.look_at_groups.setVisible(groups is not None and bool(groups.rows))
        self._mark_current()

    def _mark_current(self) -> None:
        rows = [row.rope for row in self.model.rows]
        selection = self.table.selectionModel()
        selection.blockSignals(True)
        if self._rope in rows:
            source = self.model.index(rows.index(self._rope), 0)
            self.table.setCurrentIndex(self.filtered.mapFromSource(source))
        else:
            self.table.clearSelection()
            self.table.setCurrentIndex(QModelIndex())
        selection.blockSignals(False)
        self.table.viewport().update()

    def _current_changed(self, current: QModelIndex, _: QModelIndex) -> None:
        if current.isValid():
            rope = self.model.rows[self.filtered.mapToSource(current).row()].rope
            if rope != self._rope:
                self._rope = rope
                self._live.choose(rope)

    def _filter(self) -> None:
        self.filtered.narrow(
            "" if self.material.currentText() == _ALL_MATERIALS else self.material.currentText(),
            "" if self.maker.currentText() == _ALL_MAKERS else self.maker.currentText(),
            self.only_holding.isChecked(),
        )
        self._mark_current()


class _Filter(QSortFilterProxyModel):
    """Rows of some material and maker."""

    def __init__(self, source: RowsModel) -> None:
        super().__init__()
        self.setSourceModel(source)
        self.setSortRole(SORT)
        self._source = source
        self._material = self._maker = ""
        self._only_holding = False

    def narrow(self, material: str, maker: str, only_holding: bool) -> None:
        """Show rows of this material and maker alone; of all where empty."""
        self._material, self._maker, self._only_holding = material, maker, only_holding
        self.invalidate()

    def filterAcceptsRow(self, row: int, _: Index) -> bool:
        """Whether a row is shown."""
        one = self._source.rows[row]
        return (
            self._material in ("", one.material)
            and self._maker in ("", one.maker)
            and (one.holds or not self._only_holding)
        )


def _answer(ropes: Ropes) -> str:
    """The best rope, and how far to trust it."""
    lines = [] if ropes.answer is None else [answer_words(ropes)]
    if ropes.best is None:
        return "\n".join([*lines, fmt.capital(ropes.reason) or _NOTHING])
    sure = "between the samples as well" if ropes.is_final else "at the samples, not proved"
    lines.append(f"Best: {ropes.best.label} ({sure})")
    if ropes.proof is not None:
        proof = proof_statement(ropes.proof)
        lines.append(f"{proof.title}. {proof.text}")
    return "\n".join(lines)


def _groups_text(groups: Groups) -> str:
    """Which rope each group gets, and how sure that is."""
    each = [
        f"{row.name}: {row.rope.label} ({fmt.utilisation(row.utilisation)})" for row in groups.rows
    ]
    if not each:
        return f"Groups: none was found. {groups.proof}"
    masses = f"{fmt.kilograms(groups.total_mass_kg)}, one rope for all "
    masses += fmt.kilograms(groups.single_mass_kg)
    return f"Groups: {'; '.join(each)}. All cables {masses}. {groups.proof}"
