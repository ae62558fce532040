"""What mouse and keys do, what each quantity is, and which program this is."""

from __future__ import annotations

from PySide6.QtWidgets import (
    QDialog,
    QDialogButtonBox,
    QMessageBox,
    QTextBrowser,
    QVBoxLayout,
    QWidget,
)

from designer import __version__
from designer.explore.quantities import QUANTITIES

HINT = (
    "Drag the ring to move the platform, its arrow to lift it; click the map to go there; "
    "F1 for all keys"
)
KEYS = (
    ("Drag the ring around the platform", "moves it in its level (a planar robot in its plane)"),
    ("Drag the arrow above the ring", "lifts and lowers it"),
    ("Click on the map", "takes the platform there"),
    ("Arrow keys", "move it along the axis of the frame that is nearest to that direction"),
    ("Page Up, Page Down", "lift and lower it"),
    ("Ctrl + these keys", "turn a platform that can turn, by one degree"),
    ("Shift + these keys", "ten steps at once"),
    ("Drag elsewhere", "turns the view; with Shift or the right button shifts it"),
    ("Wheel", "zooms at the mouse"),
    ("Home", "looks at everything again"),
    ("Ctrl + 1 … 7", "choose what the map is coloured by"),
)


class Help(QDialog):
    """A page of keys and definitions."""

    def __init__(self, parent: QWidget) -> None:
        super().__init__(parent)
        self.setObjectName("help")
        self.setWindowTitle("Mouse, keys and quantities")
        self.resize(620, 560)
        page = QTextBrowser()
        rows = "".join(f"<tr><td><b>{k}</b></td><td>{effect}</td></tr>" for k, effect in KEYS)
        terms = "".join(
            f"<p><b>{q.title}{f' [{q.unit}]' if q.unit else ''}.</b> {q.definition}</p>"
            for q in QUANTITIES
        )
        page.setHtml(f"<table cellpadding='3'>{rows}</table><hr>{terms}")
        buttons = QDialogButtonBox(QDialogButtonBox.StandardButton.Close)
        buttons.rejected.connect(self.reject)
        column = QVBoxLayout(self)
        column.addWidget(page)
        column.addWidget(buttons)


def show_about(parent: QWidget) -> None:
    """Say which program and version this is."""
    text = f"cdpr-designer {__version__}\n\nCables of large cable-driven parallel robots."
    QMessageBox.about(parent, "About cdpr-designer", text)
