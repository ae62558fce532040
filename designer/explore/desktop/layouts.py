"""Rows of widgets that are made anew."""

from __future__ import annotations

from PySide6.QtWidgets import QBoxLayout


def emptied(layout: QBoxLayout) -> QBoxLayout:
    """Take everything out of a layout; what was in it is gone from sight at once."""
    while (item := layout.takeAt(0)) is not None:
        widget = item.widget()
        if widget is not None:
            widget.hide()
            widget.deleteLater()
    return layout
