"""All that the study asks for, whether it holds, and the answer; as in the report."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from PySide6.QtCore import QModelIndex, QSortFilterProxyModel, Qt
from PySide6.QtWidgets import QHBoxLayout, QLabel, QPushButton, QSizePolicy, QVBoxLayout, QWidget

from designer.explore.desktop.live_session import LiveSession
from designer.explore.desktop.tables import (
    SORT,
    Column,
    RowsModel,
    ShareBar,
    table_view,
)
from designer.explore.desktop.theme import Theme
from designer.explore.desktop.widgets import grey_when_old, restyle
from designer.model.requirement import Answer, Requirement, State
from designer.report import format as fmt
from designer.report.phrases import STATES, with_unit

if TYPE_CHECKING:
    from designer.explore.ropes import Ropes

_NOTHING = "Not known yet: the full selection evaluates all that the study asks for."
_UNMET_FIRST = (State.FAILS, State.OPEN, State.HOLDS)
_ROLES = {Answer.YES: "good", Answer.NO: "fault", Answer.OPEN: "doubt"}


def _rank(requirement: Requirement) -> float:
    """What fails first, then what is not known; of each the nearest to its limit first."""
    used = requirement.utilisation
    nearest = 0.0 if math.isnan(used) else 1.0 - 1.0 / (1.0 + max(used, 0.0))
    return _UNMET_FIRST.index(requirement.state) - 0.9 * nearest


def _used(requirement: Requirement) -> str:
    used = requirement.utilisation
    return fmt.MISSING if math.isnan(used) else fmt.utilisation(used)


def _key(value: float) -> float:
    return -math.inf if math.isnan(value) else value


def _place_words(requirement: Requirement) -> str:
    place = "" if requirement.place is None else fmt.position(requirement.place[:3])
    return ", ".join(filter(None, [place, fmt.printed(requirement.direction)]))


COLUMNS = (
    Column("state", lambda r: STATES[r.state], _rank, "Whether it holds; what does not, first.",
           False),
    Column("requirement", lambda r: r.title, lambda r: r.title, "What the study asks for.", False),
    Column("load case", lambda r: r.load_case, lambda r: r.load_case,
           "The load case; 'all' for what no load case changes.", False),
    Column("demand", lambda r: with_unit(r.demand, r.unit), lambda r: _key(r.demand),
           "What is required, where it comes nearest to failing."),
    Column("capacity", lambda r: with_unit(r.capacity, r.unit), lambda r: _key(r.capacity),
           "What there is."),
    Column("utilisation", _used, lambda r: _key(r.utilisation),
           "Up to 100 % where it holds.", share=lambda r: float(r.utilisation)),
    Column("cable", lambda r: fmt.MISSING if r.cable is None else str(r.cable),
           lambda r: r.cable or 0, "The cable that comes nearest to failing."),
    Column("where", _place_words, _place_words,
           "Where the platform is; a click takes it there. Then the direction of wind and inertia, "
           "or the lost cable.", False),
    Column("what it is", lambda r: fmt.capital(r.remark or r.formula), lambda r: r.formula,
           "What must be known beside the figures; else how it is evaluated.", False),
)  # fmt: skip


class PanelRequirements(QWidget):
    """The answer, and the table of what it follows from."""

    def __init__(self, live: LiveSession) -> None:
        super().__init__()
        self._live = live
        self.setObjectName("requirements")
        self.model = RowsModel(COLUMNS)
        self.model.bold = lambda requirement: not requirement.holds
        self.model.hint = _hint
        self._sorted = QSortFilterProxyModel()
        self._sorted.setSourceModel(self.model)
        self._sorted.setSortRole(SORT)
        self.table = table_view("all requirements")
        self.table.setModel(self._sorted)
        self.table.setSortingEnabled(True)
        self.table.sortByColumn(0, Qt.SortOrder.AscendingOrder)
        self.table.horizontalHeader().setStretchLastSection(True)
        self.table.clicked.connect(self._go)
        self.table.activated.connect(self._go)
        self._bar = ShareBar(self.table)
        self.table.setItemDelegateForColumn(5, self._bar)
        for column, width in enumerate((104, 150, 120, 90, 90, 84, 48, 220)):
            self.table.setColumnWidth(column, width)
        self.answer = QLabel(_NOTHING)
        self.answer.setObjectName("answer")
        self.answer.setWordWrap(True)
        self.answer.setSizePolicy(QSizePolicy.Policy.Ignored, QSizePolicy.Policy.Preferred)
        self.evaluate = QPushButton("Full selection")
        self.evaluate.setObjectName("evaluate all")
        self.evaluate.setToolTip("<p>Evaluates all that the study asks for, as in the report.</p>")
        self.evaluate.clicked.connect(lambda: live.begin_long("select"))
        above = QHBoxLayout()
        above.addWidget(self.answer, 1)
        above.addWidget(self.evaluate)
        rows = QVBoxLayout(self)
        rows.setContentsMargins(8, 4, 8, 4)
        rows.setSpacing(4)
        rows.addLayout(above)
        rows.addWidget(self.table, 1)
        live.listen(self._show_requirements, "select")
        grey_when_old(live, {"select"}, self.answer, self.table)

    def put_on(self, theme: Theme) -> None:
        """Take the colours of a theme."""
        self._bar.theme = theme
        self.model.put_on(theme)

    def _show_requirements(self, ropes: Ropes | None) -> None:
        """Show what a full selection has evaluated; that nothing is known for None."""
        self.model.show(() if ropes is None else ropes.requirements)
        answer = None if ropes is None else ropes.answer
        self.answer.setText(_NOTHING if ropes is None else answer_words(ropes))
        restyle(self.answer, "muted" if answer is None else _ROLES[answer])

    def _go(self, index: QModelIndex) -> None:
        place = self.model.rows[self._sorted.mapToSource(index).row()].place
        if place is not None:
            self._live.move(place)


def answer_words(ropes: Ropes) -> str:
    """Return the answer to the study with how many requirements it follows from."""
    count = fmt.plural(len(ropes.requirements), "requirement")
    if ropes.answer is Answer.YES:
        return f"Yes: {count}, all met."
    n_failing, n_open = (
        sum(requirement.state is state for requirement in ropes.requirements)
        for state in (State.FAILS, State.OPEN)
    )
    unknown = f"{n_open} not known"
    if ropes.answer is Answer.OPEN:
        return f"Open: of {count} {unknown}, the others met."
    return f"No: of {count} {n_failing} not met{f', {unknown}' if n_open else ''}."


def _hint(requirement: Requirement) -> str:
    said = f"{fmt.capital(requirement.formula)} ({requirement.source})."
    return " ".join(filter(None, [said, fmt.capital(requirement.remark)]))
