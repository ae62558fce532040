"""Small parts of panels, each made by one call; and how labels and layouts change."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from typing import TYPE_CHECKING, TypeVar

from PySide6.QtCore import QEvent, Qt, Signal
from PySide6.QtGui import QAction, QKeyEvent, QKeySequence
from PySide6.QtWidgets import (
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
    QVBoxLayout,
    QWidget,
)

if TYPE_CHECKING:
    from designer.explore.desktop.live_session import LiveSession

AnyWidget = TypeVar("AnyWidget", bound=QWidget)
Part = QWidget | QLayout | str | None
"""Of a layout: a widget, a layout, a text, or None for the room that is left."""


def named(widget: AnyWidget, name: str, tip: str = "") -> AnyWidget:
    """Give a widget the name by which it is found, and say what it is."""
    widget.setObjectName(name)
    widget.setToolTip(f"<p>{tip}</p>" if tip else "")
    return widget


def label(text: str, role: str = "", tip: str = "") -> QLabel:
    """Return a label in the colour of a role, see `designer.explore.desktop.theme`."""
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
    """Return a button that does something."""
    pushed = named(QPushButton(text), name, tip)
    pushed.clicked.connect(lambda _: run())  # whether it is checked is no matter
    return pushed


def check_box(name: str, text: str, run: Callable[..., object], tip: str = "") -> QCheckBox:
    """Return a box, and what follows where it is checked or not any more."""
    box = named(QCheckBox(text), name, tip)
    box.toggled.connect(run)
    return box


def beside(*parts: Part) -> QHBoxLayout:
    """Return parts beside each other."""
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
    """Put parts into a layout, one after the other."""
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

    meaning = ""
    """What its tip says where nothing is wrong with what is in it."""

    @property
    def is_faulty(self) -> bool:
        """Whether what is in it was refused."""
        return bool(self.property("faulty"))

    def mark(self, fault: str) -> None:
        """Show what is wrong with what is in it; nothing where nothing is."""
        self.setToolTip(fault or self.meaning)
        restyle(self, "faulty", bool(fault))

    def event(self, event: QEvent) -> bool:
        """Let the window have the keys that are its own."""
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
        """Open the list as wide as its longest entry."""
        self.view().setMinimumWidth(self.view().sizeHintForColumn(0) + 24)
        super().showPopup()


def emptied(layout: QBoxLayout) -> QBoxLayout:
    """Take everything out of a layout; what was in it is gone from sight at once."""
    while (item := layout.takeAt(0)) is not None:
        widget = item.widget()
        if widget is not None:
            widget.hide()
            widget.deleteLater()
    return layout


class Notice(QFrame):
    """One line that asks for attention without stopping anything."""

    answered = Signal(str)
    """The name of the button that was pressed."""

    def __init__(self) -> None:
        super().__init__()
        self.setObjectName("notice")
        self.setFrameShape(QFrame.Shape.StyledPanel)
        self._row = QHBoxLayout(self)
        self._row.setContentsMargins(10, 3, 10, 3)
        self.hide()

    def show_text(self, text: str, buttons: tuple[str, ...]) -> None:
        """Show a line with buttons by these names; nothing for no text."""
        emptied(self._row)
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
