"""An entry of one line that leaves undo to the window once what was typed is taken."""

from __future__ import annotations

from PySide6.QtCore import QEvent
from PySide6.QtGui import QKeyEvent, QKeySequence
from PySide6.QtWidgets import QLineEdit


class Entry(QLineEdit):
    """Undo and redo are of the letters while something is being typed, else of the study."""

    meaning = ""
    """What its tip says where nothing is wrong with what is in it."""

    def mark(self, fault: str) -> None:
        """Show what is wrong with what is in it; nothing where nothing is."""
        self.setToolTip(fault or self.meaning)
        if bool(self.property("faulty")) != bool(fault):
            self.setProperty("faulty", bool(fault))
            self.style().polish(self)

    def event(self, event: QEvent) -> bool:
        """Let the window have the keys for undo and redo."""
        is_claim = event.type() == QEvent.Type.ShortcutOverride
        if is_claim and isinstance(event, QKeyEvent) and not self.isModified():
            keys = QKeySequence.StandardKey
            if event.matches(keys.Undo) or event.matches(keys.Redo):
                event.ignore()
                return False
        return super().event(event)
