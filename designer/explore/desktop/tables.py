"""Tables of frozen rows: one model for all of them, and bars for shares."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

from PySide6.QtCore import QAbstractTableModel, QModelIndex, QPersistentModelIndex, QRectF, Qt
from PySide6.QtGui import QBrush, QColor, QFont, QPainter
from PySide6.QtWidgets import (
    QStyledItemDelegate,
    QStyleOptionViewItem,
    QTableView,
    QWidget,
)

from designer.explore.desktop.theme import Theme

SORT = int(Qt.ItemDataRole.UserRole)
"""What a column is sorted by."""
SHARE = SORT + 1
"""A share of the whole, for a bar."""
Index = QModelIndex | QPersistentModelIndex


@dataclass(frozen=True, slots=True)
class Column:
    """A column: its head, what it shows of a row, what it is sorted by, and what it is."""

    title: str
    text: Callable[[Any], str]
    key: Callable[[Any], Any]
    definition: str
    is_number: bool = True
    share: Callable[[Any], float] | None = None


class RowsModel(QAbstractTableModel):
    """Rows of any frozen kind under fixed columns."""

    def __init__(self, columns: Sequence[Column]) -> None:
        super().__init__()
        self.columns = tuple(columns)
        self.rows: tuple[Any, ...] = ()
        self.bold: Callable[[Any], bool] = lambda _: False
        self.muted: Callable[[Any], bool] = lambda _: False
        self.hint: Callable[[Any], str] = lambda _: ""
        self.muted_colour = QColor("grey")

    def put_on(self, theme: Theme) -> None:
        """Take the colours of a theme."""
        self.muted_colour = QColor(theme.muted)
        self._tell_changed()

    def show(self, rows: Sequence[Any]) -> None:
        """Show other rows; where there are as many as before, selection and place are kept."""
        has_same_count = len(rows) == len(self.rows)
        if not has_same_count:
            self.beginResetModel()
        self.rows = tuple(rows)
        if has_same_count:
            self._tell_changed()
        else:
            self.endResetModel()

    def _tell_changed(self) -> None:
        if self.rows:
            corner = self.index(len(self.rows) - 1, len(self.columns) - 1)
            self.dataChanged.emit(self.index(0, 0), corner)

    def rename(self, columns: Sequence[Column]) -> None:
        """Show the same columns in other units."""
        if [column.title for column in columns] != [column.title for column in self.columns]:
            self.columns = tuple(columns)
            last = len(columns) - 1
            self.headerDataChanged.emit(Qt.Orientation.Horizontal, 0, last)

    def rowCount(self, parent: Index = QModelIndex()) -> int:  # noqa: B008  (Qt's own default)
        """How many rows."""
        return 0 if parent.isValid() else len(self.rows)

    def columnCount(self, parent: Index = QModelIndex()) -> int:  # noqa: B008
        """How many columns."""
        return 0 if parent.isValid() else len(self.columns)

    def headerData(
        self, section: int, orientation: Qt.Orientation, role: int = Qt.ItemDataRole.DisplayRole
    ) -> Any:
        """Heads of columns, with the definition as a tip."""
        if orientation != Qt.Orientation.Horizontal:
            return None
        column = self.columns[section]
        if role == Qt.ItemDataRole.DisplayRole:
            return column.title
        if role == Qt.ItemDataRole.ToolTipRole:
            return f"<p>{column.definition}</p>"
        return None

    def data(self, index: Index, role: int = Qt.ItemDataRole.DisplayRole) -> Any:
        """What a cell shows, and how."""
        if not index.isValid():
            return None
        row, column = self.rows[index.row()], self.columns[index.column()]
        role_of = Qt.ItemDataRole
        side = Qt.AlignmentFlag.AlignRight if column.is_number else Qt.AlignmentFlag.AlignLeft
        answers: dict[int, Callable[[], Any]] = {
            role_of.DisplayRole: lambda: column.text(row),
            SORT: lambda: column.key(row),
            SHARE: lambda: column.share(row) if column.share is not None else None,
            role_of.TextAlignmentRole: lambda: int(side | Qt.AlignmentFlag.AlignVCenter),
            role_of.ToolTipRole: lambda: self.hint(row) or None,
            role_of.FontRole: lambda: _bold() if self.bold(row) else None,
            role_of.ForegroundRole: lambda: QBrush(self.muted_colour) if self.muted(row) else None,
        }
        return answers[role]() if role in answers else None


def _bold() -> QFont:
    font = QFont()
    font.setBold(True)
    return font


class ShareBar(QStyledItemDelegate):
    """A bar behind the figure: full at what is allowed, in another colour beyond."""

    def __init__(self, parent: QWidget) -> None:
        super().__init__(parent)
        self._table = parent
        self.theme: Theme | None = None

    def paint(self, painter: QPainter, option: QStyleOptionViewItem, index: Index) -> None:
        """Draw the bar, then the figure."""
        share = index.data(SHARE)
        if self.theme is not None and isinstance(share, float) and not math.isnan(share):
            is_old = self._table.property("old")
            fresh = self.theme.accent if share <= 1.0 else self.theme.warning
            colour = QColor(self.theme.muted if is_old else fresh)
            colour.setAlpha(90)
            area = QRectF(option.rect).adjusted(1, 3, -1, -3)
            area.setWidth(area.width() * min(share, 1.0))
            painter.fillRect(area, colour)
        super().paint(painter, option, index)


def table_view(name: str) -> QTableView:
    """Return a view for a table that is read by rows."""
    view = QTableView()
    view.setObjectName(name)
    view.setAlternatingRowColors(True)
    view.setShowGrid(False)
    view.setWordWrap(False)
    view.setSelectionBehavior(QTableView.SelectionBehavior.SelectRows)
    view.setSelectionMode(QTableView.SelectionMode.SingleSelection)
    view.setEditTriggers(QTableView.EditTrigger.NoEditTriggers)
    view.verticalHeader().hide()
    view.verticalHeader().setDefaultSectionSize(view.fontMetrics().height() + 7)
    view.horizontalHeader().setHighlightSections(False)
    view.setTabKeyNavigation(False)
    return view
