"""What all panels are made of: colours of the themes, small parts, and tables of frozen rows."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from operator import attrgetter
from typing import TYPE_CHECKING, Any, Literal, TypeVar, get_args

from PySide6.QtCore import (
    QAbstractTableModel,
    QEvent,
    QModelIndex,
    QPersistentModelIndex,
    QRectF,
    QSortFilterProxyModel,
    Qt,
    Signal,
)
from PySide6.QtGui import (
    QAction,
    QBrush,
    QColor,
    QFont,
    QKeyEvent,
    QKeySequence,
    QPainter,
    QPalette,
)
from PySide6.QtWidgets import (
    QApplication,
    QBoxLayout,
    QCheckBox,
    QComboBox,
    QFrame,
    QHBoxLayout,
    QLabel,
    QLayout,
    QLineEdit,
    QPushButton,
    QSizePolicy,
    QStyledItemDelegate,
    QStyleOptionViewItem,
    QTableView,
    QVBoxLayout,
    QWidget,
)

from designer.report import format as fmt
from designer.report.figures import palette

if TYPE_CHECKING:
    from designer.explore.desktop.live_session import LiveSession

ThemeChoice = Literal["system", "light", "dark"]
THEME_CHOICES: tuple[ThemeChoice, ...] = get_args(ThemeChoice)


@dataclass(frozen=True, slots=True)
class Theme:
    """Colours by what they are for; accents are those of the report, brighter on dark ground."""

    name: Literal["light", "dark"]
    window: str
    base: str
    raised: str
    stripe: str
    border: str
    ink: str
    muted: str
    accent: str
    good: str
    amber: str
    warning: str
    cable: str
    left_out: str
    hatch: tuple[str, str]


LIGHT = Theme(
    name="light",
    window="#f3f4f6",
    base="#ffffff",
    raised="#fbfbfc",
    stripe="#f5f7f9",
    border="#cfd4da",
    ink=palette.INK,
    muted="#646c76",
    accent=palette.SAG,
    good="#00795c",
    amber="#7a5c00",
    warning="#b84f00",
    cable=palette.INK,
    left_out=palette.LEFT_OUT,
    hatch=(palette.WARNING_PALE, palette.WARNING),
)
DARK = Theme(
    name="dark",
    window="#2a2f36",
    base="#15181c",
    raised="#363c44",
    stripe="#1d2126",
    border="#4b535d",
    ink="#e7eaee",
    muted="#9ba5b1",
    accent="#56b4e9",
    good="#3fc79a",
    amber="#e5c04a",
    warning="#ff9548",
    cable="#f4f6f8",
    left_out="#4a515a",
    hatch=("#40230f", "#e8762c"),
)


def theme_named(choice: str) -> Theme:
    """Return the theme that was chosen; of any other word that of the system."""
    if choice in ("light", "dark"):
        return DARK if choice == "dark" else LIGHT
    is_dark = QApplication.styleHints().colorScheme() == Qt.ColorScheme.Dark
    return DARK if is_dark else LIGHT


def current_theme() -> Theme:
    app = QApplication.instance()
    return DARK if app is not None and app.property("theme") == DARK.name else LIGHT


def apply_theme(app: QApplication, theme: Theme) -> None:
    role, palette_of_theme = QPalette.ColorRole, QPalette()
    for colour, roles in (
        (theme.window, [role.Window]),
        (theme.base, [role.Base]),
        (theme.stripe, [role.AlternateBase]),
        (theme.raised, [role.Button, role.ToolTipBase, role.Light]),
        (theme.ink, [role.WindowText, role.Text, role.ButtonText, role.ToolTipText]),
        (theme.warning, [role.BrightText]),
        (theme.muted, [role.PlaceholderText]),
        (theme.border, [role.Mid, role.Dark, role.Midlight]),
        (theme.accent, [role.Highlight, role.Link, role.Accent]),
        ("#ffffff" if theme.name == "light" else "#10151a", [role.HighlightedText]),
    ):
        for which in roles:
            palette_of_theme.setColor(which, QColor(colour))
    for which in (role.WindowText, role.Text, role.ButtonText):
        palette_of_theme.setColor(QPalette.ColorGroup.Disabled, which, QColor(theme.muted))
    app.setProperty("theme", theme.name)
    app.setPalette(palette_of_theme)
    app.setStyleSheet(_sheet(theme))


def _sheet(theme: Theme) -> str:
    return f"""
QToolTip {{ color: {theme.ink}; background: {theme.raised}; border: 1px solid {theme.border};
    padding: 4px; }}
QDockWidget::title {{ padding: 4px 8px; background: {theme.window}; }}
QHeaderView::section {{ background: {theme.window}; color: {theme.muted}; border: none;
    border-bottom: 1px solid {theme.border}; padding: 3px 2px; }}
QTableView {{ border: none; gridline-color: {theme.border}; }}
QScrollArea {{ border: none; }}
QFrame#legend {{ background: #e1{theme.base[1:]}; border: 1px solid {theme.border};
    border-radius: 4px; }}
QStatusBar {{ border-top: 1px solid {theme.border}; }}
QToolBar {{ border: none; border-bottom: 1px solid {theme.border}; spacing: 6px; padding: 3px; }}
QLabel[role="muted"], QCheckBox[role="muted"] {{ color: {theme.muted}; }}
QLabel[role="fault"] {{ color: {theme.warning}; }}
QLabel[role="doubt"] {{ font-style: italic; color: {theme.amber}; }}
QLabel[role="good"] {{ color: {theme.good}; }}
QLabel[role="heading"] {{ font-weight: 600; }}
QLabel[role="title"] {{ font-size: 18pt; font-weight: 600; }}
QLabel[old="true"], QTableView[old="true"] {{ color: {theme.muted}; }}
QLineEdit[faulty="true"] {{ border: 1px solid {theme.warning}; }}
QToolButton[role="put-back"] {{ border: none; color: {theme.accent}; padding: 0 2px; }}
QToolButton[role="section"] {{ border: none; font-weight: 600; padding: 6px 0 2px 0; }}
QPushButton[role="study"] {{ text-align: left; padding: 8px; background: {theme.base};
    border: 1px solid {theme.border}; border-radius: 4px; }}
QPushButton[role="study"]:hover, QPushButton[role="study"]:focus {{
    border: 1px solid {theme.accent}; }}
"""


AnyWidget = TypeVar("AnyWidget", bound=QWidget)
Part = QWidget | QLayout | str | None
"""Of a layout: a widget, a layout, a text, or None for the room that is left."""


def named(widget: AnyWidget, name: str, tip: str = "") -> AnyWidget:
    """Give a widget the name by which it is found, and say what it is."""
    widget.setObjectName(name)
    widget.setToolTip(f"<p>{tip}</p>" if tip else "")
    return widget


def label(text: str, role: str = "", tip: str = "") -> QLabel:
    """Return a label in the colour of a role, see `designer.explore.desktop.widgets`."""
    title = named(QLabel(text), "", tip)
    title.setProperty("role", role)
    return title


def result(name: str, role: str = "", tip: str = "") -> QLabel:
    """Return a label for a result: wrapped, as wide as there is room, to be copied from."""
    text = named(label("", role), name, tip)
    text.setWordWrap(True)
    text.setTextFormat(Qt.TextFormat.PlainText)
    text.setTextInteractionFlags(Qt.TextInteractionFlag.TextSelectableByMouse)
    text.setSizePolicy(QSizePolicy.Policy.Ignored, QSizePolicy.Policy.Preferred)
    return text


def button(name: str, text: str, run: Callable[[], object], tip: str = "") -> QPushButton:
    pushed = named(QPushButton(text), name, tip)
    pushed.clicked.connect(lambda _: run())  # whether it is checked is no matter
    return pushed


def check_box(name: str, text: str, run: Callable[..., object], tip: str = "") -> QCheckBox:
    """Return a box, and what follows where it is checked or not any more."""
    box = named(QCheckBox(text), name, tip)
    box.toggled.connect(run)
    return box


def row_of(*parts: Part) -> QHBoxLayout:
    line = QHBoxLayout()
    fill(line, *parts)
    return line


def panel(inside: QWidget, name: str, *parts: Part) -> None:
    """Lay the parts of a panel below each other; the last one has the room that is left."""
    inside.setObjectName(name)
    rows = QVBoxLayout(inside)
    rows.setContentsMargins(8, 4, 8, 4)
    rows.setSpacing(4)
    fill(rows, *parts)
    rows.setStretch(rows.count() - 1, 1)


def fill(layout: QBoxLayout, *parts: Part) -> None:
    for part in parts:
        if part is None:
            layout.addStretch(1)
        elif isinstance(part, QLayout):
            layout.addLayout(part)
        else:
            layout.addWidget(QLabel(part) if isinstance(part, str) else part)


class LineEntry(QLineEdit):
    """Keys of menus work from here as well; Qt edits with some of them, as Emacs does.

    Undo and redo are of the letters while something is being typed, else of the study.
    """

    meaning = ""  #: What its tip says where nothing is wrong with what is in it

    @property
    def is_faulty(self) -> bool:
        return bool(self.property("faulty"))

    def mark(self, fault: str) -> None:
        """Show what is wrong with what is in it; nothing where nothing is."""
        self.setToolTip(fault or self.meaning)
        restyle(self, "faulty", bool(fault))

    def event(self, event: QEvent) -> bool:
        is_claim = event.type() == QEvent.Type.ShortcutOverride
        if is_claim and isinstance(event, QKeyEvent) and self._is_of_window(event):
            event.ignore()
            return False
        return super().event(event)

    def _is_of_window(self, event: QKeyEvent) -> bool:
        keys = QKeySequence.StandardKey
        if event.matches(keys.Undo) or event.matches(keys.Redo):
            return not self.isModified()
        if not event.modifiers() & Qt.KeyboardModifier.ControlModifier:
            return False  # such as Home
        pressed = QKeySequence(event.keyCombination())
        return any(pressed in action.shortcuts() for action in self.window().findChildren(QAction))


class DropDown(QComboBox):
    """As wide as so many letters; its entries are read in full where it is opened."""

    def __init__(self, name: str, letters: int, *texts: str) -> None:
        super().__init__()
        self.setObjectName(name)
        self.setSizeAdjustPolicy(QComboBox.SizeAdjustPolicy.AdjustToMinimumContentsLengthWithIcon)
        self.setMinimumContentsLength(letters)
        self.addItems(texts)

    def refill(self, texts: Sequence[str]) -> None:
        """Offer these texts; the present one stays where it still is among them."""
        if [self.itemText(k) for k in range(self.count())] == list(texts):
            return
        present = self.currentText()
        self.blockSignals(True)
        self.clear()
        self.addItems(texts)
        self.setCurrentText(present)  # of another text nothing happens: the first one stays
        self.blockSignals(False)

    def showPopup(self) -> None:
        self.view().setMinimumWidth(self.view().sizeHintForColumn(0) + 24)
        super().showPopup()


def clear_layout(layout: QBoxLayout) -> QBoxLayout:
    """Take everything out of a layout; what was in it is gone from sight at once."""
    while (item := layout.takeAt(0)) is not None:
        widget = item.widget()
        if widget is not None:
            widget.hide()
            widget.deleteLater()
    return layout


class Notice(QFrame):
    """One line that asks for attention without stopping anything."""

    answered = Signal(str)  #: The name of the button that was pressed

    def __init__(self) -> None:
        super().__init__()
        self.setObjectName("notice")
        self.setFrameShape(QFrame.Shape.StyledPanel)
        self._row = QHBoxLayout(self)
        self._row.setContentsMargins(10, 3, 10, 3)
        self.hide()

    def show_text(self, text: str, buttons: tuple[str, ...]) -> None:
        """Show a line with buttons by these names; nothing for no text."""
        clear_layout(self._row)
        line = QLabel(text)
        line.setWordWrap(True)
        self._row.addWidget(line, 1)
        for name in buttons:
            self._row.addWidget(button(f"notice {name}", name, partial(self.answered.emit, name)))
        self.setVisible(bool(text))


def restyle(widget: QWidget, name: str, value: object) -> None:
    """Set a property that the look depends on, such as the role of a label."""
    if (widget.property(name) or False) != value:
        widget.setProperty(name, value)
        widget.style().polish(widget)
        widget.update()


def grey_when_old(live: LiveSession, aspects: set[str], *widgets: QWidget) -> None:
    """Have widgets grey while any of what they show is of an older state of the study."""

    def follow() -> None:
        for widget in widgets:
            restyle(widget, "old", not aspects.isdisjoint(live.outdated))

    live.busy_changed.connect(follow)


_SORT = int(Qt.ItemDataRole.UserRole)  #: What a column is sorted by
_SHARE = _SORT + 1  #: A share of the whole, for a bar
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
        return 0 if parent.isValid() else len(self.rows)

    def columnCount(self, parent: Index = QModelIndex()) -> int:  # noqa: B008
        return 0 if parent.isValid() else len(self.columns)

    def headerData(
        self, section: int, orientation: Qt.Orientation, role: int = Qt.ItemDataRole.DisplayRole
    ) -> Any:
        if orientation != Qt.Orientation.Horizontal:
            return None
        column, roles = self.columns[section], Qt.ItemDataRole
        heads = {roles.DisplayRole: column.title, roles.ToolTipRole: f"<p>{column.definition}</p>"}
        return heads.get(roles(role))

    def data(self, index: Index, role: int = Qt.ItemDataRole.DisplayRole) -> Any:
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
                QBrush(QColor(current_theme().muted)) if self.muted(row) else None
            ),
        }
        return answers[role]() if role in answers else None


def bold(font: QFont) -> QFont:
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
        self._filter.accepts = accepts
        self._filter.invalidate()

    def row_at(self, index: QModelIndex) -> Any:
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
        return self.accepts(self.source.rows[row])


class _ShareBar(QStyledItemDelegate):
    """A bar behind the figure: full at what is allowed, in another colour beyond."""

    def __init__(self, table: Table) -> None:
        super().__init__(table)
        self._table = table

    def paint(self, painter: QPainter, option: QStyleOptionViewItem, index: Index) -> None:
        share, colours = index.data(_SHARE), current_theme()
        if isinstance(share, float) and not math.isnan(share):
            fresh = colours.accent if share <= 1.0 else colours.warning
            colour = QColor(colours.muted if self._table.property("old") else fresh)
            colour.setAlpha(90)
            area = QRectF(option.rect).adjusted(1, 3, -1, -3)
            area.setWidth(area.width() * min(share, 1.0))
            painter.fillRect(area, colour)
        super().paint(painter, option, index)
