"""An entry of one line that leaves to the window what is the window's to do."""

from __future__ import annotations

from PySide6.QtCore import QEvent, Qt
from PySide6.QtGui import QAction, QKeyEvent, QKeySequence
from PySide6.QtWidgets import QLineEdit


class Entry(QLineEdit):
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
        return any(one.shortcut() == pressed for one in self.window().findChildren(QAction))
