"""The status bar: what is being solved, how far long work is, and a button that ends it."""

from __future__ import annotations

from PySide6.QtWidgets import QHBoxLayout, QLabel, QProgressBar, QStatusBar, QToolButton, QWidget

from designer.explore.desktop.live_session import LONG, NAMES, LiveSession
from designer.explore.desktop.widgets import fill, named
from designer.explore.requests import Long

_MESSAGE_MS = 15_000
"""Long enough to be read twice; what matters stays among the messages."""


class StatusBar(QStatusBar):
    """Follows the work on the open study."""

    def __init__(self, live: LiveSession) -> None:
        super().__init__()
        self._live = live
        self._busy, self.long = named(QLabel(), "busy"), LongWork(live)
        self.addPermanentWidget(self._busy)
        self.addPermanentWidget(self.long)
        live.busy_changed.connect(self._show_busy)
        live.message.connect(self._show_message)

    def _show_busy(self) -> None:
        short = sorted({NAMES[kind] for kind in self._live.busy if kind not in LONG})
        self._busy.setText(f"solving {', '.join(short)} …" if short else "")

    def _show_message(self, text: str) -> None:
        self.showMessage(text.splitlines()[0] if text else "", _MESSAGE_MS)


class LongWork(QWidget):
    """The long work that was begun last, of all that goes on."""

    def __init__(self, live: LiveSession) -> None:
        super().__init__()
        self.setObjectName("long work")
        self._live = live
        self._kind: Long | None = None
        self._task = QLabel()
        self._bar = QProgressBar()
        self._bar.setFixedWidth(150)
        self._bar.setTextVisible(False)
        cancel = named(QToolButton(), "cancel", "End this work (Ctrl+.)")
        cancel.setText("Cancel")
        cancel.setShortcut("Ctrl+.")
        cancel.clicked.connect(self._cancel)
        row = QHBoxLayout(self)
        row.setContentsMargins(0, 0, 6, 0)
        fill(row, self._task, self._bar, cancel)
        self.hide()
        live.begun.connect(self._begin)
        live.progressed.connect(self._progress)
        live.busy_changed.connect(self._end)

    def _begin(self, kind: Long) -> None:
        self._kind = kind
        self._task.setText(NAMES[kind])
        self._bar.setRange(0, 0)
        self.show()

    def _cancel(self) -> None:
        if self._kind is not None:
            self._live.cancel(self._kind)

    def _progress(self, kind: str, task: str, steps: int, total: int) -> None:
        """Show how far it is; a total of 0 is not known."""
        if kind == self._kind:
            self._task.setText(task)
            self._bar.setRange(0, max(total, 0))
            self._bar.setValue(steps)

    def _end(self) -> None:
        if self._kind is None or self._kind in self._live.busy:
            return
        others = [kind for kind in LONG if kind in self._live.busy]
        if others:
            self._begin(others[0])
        else:
            self._kind = None
            self.hide()
