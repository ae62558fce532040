"""Tables of frozen rows: one model and one view for all of them, and bars for shares."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from operator import attrgetter
from typing import Any

from PySide6.QtCore import (
    QAbstractTableModel,
    QModelIndex,
    QPersistentModelIndex,
    QRectF,
    QSortFilterProxyModel,
    Qt,
)
from PySide6.QtGui import QBrush, QColor, QFont, QPainter
from PySide6.QtWidgets import QStyledItemDelegate, QStyleOptionViewItem, QTableView

from designer.explore.desktop import theme
from designer.report import format as fmt

_SORT = int(Qt.ItemDataRole.UserRole)
"""What a column is sorted by."""
_SHARE = _SORT + 1
"""A share of the whole, for a bar."""
Index = QModelIndex | QPersistentModelIndex


@dataclass(frozen=True, slots=True)
class Column:
    """A column: its head, what it shows of a row, and what it is.

    It is sorted by ``key``, without one by its text; ``share`` of the whole is drawn as a bar.
    """

    title: str
    text: Callable[[Any], str]
    definition: str
    key: Callable[[Any], Any] | None = None
    is_number: bool = False
    share: Callable[[Any], float] | None = None


def number_column(
    title: str,
    name: str,
    definition: str,
    text: Callable[[float], str],
    share: Callable[[Any], float] | None = None,
) -> Column:
    """Return a column of numbers: an attribute of the row, and how it is written."""
    value = attrgetter(name)

    def shown(row: Any) -> str:
        return fmt.MISSING if value(row) is None else text(value(row))

    return Column(title, shown, definition, value, is_number=True, share=share)


class RowsModel(QAbstractTableModel):
    """Rows of any frozen kind under columns; how they look is asked of each row."""

    def __init__(self, columns: Sequence[Column]) -> None:
        super().__init__()
        self.columns = tuple(columns)
        self.rows: tuple[Any, ...] = ()
        self.bold: Callable[[Any], bool] = lambda _: False
        self.muted: Callable[[Any], bool] = lambda _: False
        self.hint: Callable[[Any], str] = lambda _: ""

    def show(self, rows: Sequence[Any]) -> None:
        """Show other rows; where there are as many as before, selection and place are kept."""
        if len(rows) != len(self.rows):
            self.beginResetModel()
            self.rows = tuple(rows)
            self.endResetModel()
            return
        self.rows = tuple(rows)
        if rows:
            corner = self.index(len(rows) - 1, len(self.columns) - 1)
            self.dataChanged.emit(self.index(0, 0), corner)

    def rename(self, columns: Sequence[Column]) -> None:
        """Show the same columns in other units."""
        if [column.title for column in columns] != [column.title for column in self.columns]:
            self.columns = tuple(columns)
            self.headerDataChanged.emit(Qt.Orientation.Horizontal, 0, len(columns) - 1)

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
        column, roles = self.columns[section], Qt.ItemDataRole
        heads = {roles.DisplayRole: column.title, roles.ToolTipRole: f"<p>{column.definition}</p>"}
        return heads.get(roles(role))

    def data(self, index: Index, role: int = Qt.ItemDataRole.DisplayRole) -> Any:
        """What a cell shows, and how."""
        if not index.isValid():
            return None
        row, column = self.rows[index.row()], self.columns[index.column()]
        roles = Qt.ItemDataRole
        side = Qt.AlignmentFlag.AlignRight if column.is_number else Qt.AlignmentFlag.AlignLeft
        answers: dict[int, Callable[[], Any]] = {
            roles.DisplayRole: lambda: column.text(row),
            _SORT: lambda: _sortable((column.key or column.text)(row)),
            _SHARE: lambda: float(column.share(row)) if column.share is not None else None,
            roles.TextAlignmentRole: lambda: int(side | Qt.AlignmentFlag.AlignVCenter),
            roles.ToolTipRole: lambda: self.hint(row) or None,
            roles.FontRole: lambda: bold(QFont()) if self.bold(row) else None,
            roles.ForegroundRole: lambda: (
                QBrush(QColor(theme.current().muted)) if self.muted(row) else None
            ),
        }
        return answers[role]() if role in answers else None


def bold(font: QFont) -> QFont:
    """Return a font as a bold one."""
    heavy = QFont(font)
    heavy.setBold(True)
    return heavy


def _sortable(value: Any) -> Any:
    """What is not known comes last."""
    is_unknown = value is None or (isinstance(value, float) and math.isnan(value))
    return math.inf if is_unknown else value


class Table(QTableView):
    """Rows to be read, in the order of a column where it is ``sorted_by`` one, narrowed at will."""

    def __init__(
        self,
        name: str,
        columns: Sequence[Column],
        widths: Sequence[int] = (),
        sorted_by: int | None = None,
    ) -> None:
        super().__init__()
        self.rows, self._filter = RowsModel(columns), _Filter()
        self._filter.setSourceModel(self.rows)
        self._filter.setSortRole(_SORT)
        self._filter.source = self.rows
        self.setModel(self._filter)
        self.setObjectName(name)
        self.setAlternatingRowColors(True)
        self.setShowGrid(False)
        self.setWordWrap(False)
        self.setSelectionBehavior(QTableView.SelectionBehavior.SelectRows)
        self.setSelectionMode(QTableView.SelectionMode.SingleSelection)
        self.setEditTriggers(QTableView.EditTrigger.NoEditTriggers)
        self.verticalHeader().hide()
        self.verticalHeader().setDefaultSectionSize(self.fontMetrics().height() + 7)
        self.horizontalHeader().setHighlightSections(False)
        self.horizontalHeader().setStretchLastSection(True)
        self.setTabKeyNavigation(False)
        if sorted_by is not None:
            self.setSortingEnabled(True)
            self.sortByColumn(sorted_by, Qt.SortOrder.AscendingOrder)
        for number, width in enumerate(widths):
            self.setColumnWidth(number, width)
        for number, column in enumerate(columns):
            if column.share is not None:
                self.setItemDelegateForColumn(number, _ShareBar(self))

    def narrow(self, accepts: Callable[[Any], bool]) -> None:
        """Show those rows alone that are accepted."""
        self._filter.accepts = accepts
        self._filter.invalidate()

    def row_at(self, index: QModelIndex) -> Any:
        """Return the row that is seen there."""
        return self.rows.rows[self._filter.mapToSource(index).row()]

    def mark(self, is_marked: Callable[[Any], bool]) -> None:
        """Select the row of which this is true, if there is one; nobody is told of it."""
        numbers = [number for number, row in enumerate(self.rows.rows) if is_marked(row)]
        self.selectionModel().blockSignals(True)
        if numbers:
            self.setCurrentIndex(self._filter.mapFromSource(self.rows.index(numbers[0], 0)))
        else:
            self.clearSelection()
            self.setCurrentIndex(QModelIndex())
        self.selectionModel().blockSignals(False)
        self.viewport().update()


class _Filter(QSortFilterProxyModel):
    """Rows that are accepted, sorted."""

    source: RowsModel
    accepts: Callable[[Any], bool] = staticmethod(lambda _: True)

    def filterAcceptsRow(self, row: int, _: Index) -> bool:
        """Whether a row is shown."""
        return self.accepts(self.source.rows[row])


class _ShareBar(QStyledItemDelegate):
    """A bar behind the figure: full at what is allowed, in another colour beyond."""

    def __init__(self, table: Table) -> None:
        super().__init__(table)
        self._table = table

    def paint(self, painter: QPainter, option: QStyleOptionViewItem, index: Index) -> None:
        """Draw the bar, then the figure."""
        share, colours = index.data(_SHARE), theme.current()
        if isinstance(share, float) and not math.isnan(share):
            fresh = colours.accent if share <= 1.0 else colours.warning
            colour = QColor(colours.muted if self._table.property("old") else fresh)
            colour.setAlpha(90)
            area = QRectF(option.rect).adjusted(1, 3, -1, -3)
            area.setWidth(area.width() * min(share, 1.0))
            painter.fillRect(area, colour)
        super().paint(painter, option, index)
