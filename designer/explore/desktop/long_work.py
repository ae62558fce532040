"""Long work in the status bar: what is being done, how far it is, and a button that ends it."""

from __future__ import annotations

from PySide6.QtCore import Signal
from PySide6.QtWidgets import QHBoxLayout, QLabel, QProgressBar, QToolButton, QWidget


class LongWork(QWidget):
    """One piece of long work at a time."""

    asks_to_cancel = Signal(str)
    """The work of this kind shall end."""

    def __init__(self) -> None:
        super().__init__()
        self.setObjectName("long work")
        self.kind = ""
        self._what = QLabel()
        self._bar = QProgressBar()
        self._bar.setFixedWidth(150)
        self._bar.setTextVisible(False)
        cancel = QToolButton()
        cancel.setObjectName("cancel")
        cancel.setText("Cancel")
        cancel.setShortcut("Ctrl+.")
        cancel.setToolTip("End this work (Ctrl+.)")
        cancel.clicked.connect(lambda: self.asks_to_cancel.emit(self.kind))
        row = QHBoxLayout(self)
        row.setContentsMargins(0, 0, 6, 0)
        for widget in (self._what, self._bar, cancel):
            row.addWidget(widget)
        self.hide()

    def begin(self, kind: str, what: str) -> None:
        """Show that work has begun."""
        self.kind = kind
        self._what.setText(what)
        self._bar.setRange(0, 0)
        self.show()

    def go_on(self, kind: str, task: str, done: int, total: int) -> None:
        """Show how far it is; a total of 0 is not known."""
        if kind == self.kind:
            self._what.setText(task)
            self._bar.setRange(0, max(total, 0))
            self._bar.setValue(done)

    def end(self, kind: str) -> None:
        """It has ended, one way or another."""
        if kind == self.kind:
            self.kind = ""
            self.hide()
