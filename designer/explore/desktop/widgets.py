"""Small parts of panels: an entry, a list, a notice, and how labels and layouts change."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from PySide6.QtCore import QEvent, Qt, Signal
from PySide6.QtGui import QAction, QKeyEvent, QKeySequence
from PySide6.QtWidgets import (
    QBoxLayout,
    QComboBox,
    QFrame,
    QHBoxLayout,
    QLabel,
    QLineEdit,
    QPushButton,
    QWidget,
)

if TYPE_CHECKING:
    from designer.explore.desktop.live_session import LiveSession


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
        if self.is_faulty != bool(fault):
            self.setProperty("faulty", bool(fault))
            self.style().polish(self)

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
        label = QLabel(text)
        label.setWordWrap(True)
        self._row.addWidget(label, 1)
        for name in buttons:
            button = QPushButton(name)
            button.setObjectName(f"notice {name}")
            button.clicked.connect(lambda _=False, name=name: self.answered.emit(name))
            self._row.addWidget(button)
        self.setVisible(bool(text))


def restyle(label: QLabel, role: str) -> None:
    """Give a label the colour of a role, see `designer.explore.desktop.theme`."""
    if label.property("role") != role:
        label.setProperty("role", role)
        label.style().polish(label)


def grey_when_old(live: LiveSession, aspects: set[str], *widgets: QWidget) -> None:
    """Have widgets grey while any of what they show is of an older state of the study."""

    def follow() -> None:
        is_old = not aspects.isdisjoint(live.outdated)
        for widget in widgets:
            if bool(widget.property("old")) != is_old:
                widget.setProperty("old", is_old)
                widget.style().polish(widget)
                widget.update()

    live.busy_changed.connect(follow)
