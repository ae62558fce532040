"""Where the panels stand around the scene."""

from __future__ import annotations

from collections.abc import Mapping

from PySide6.QtCore import Qt
from PySide6.QtWidgets import QDockWidget, QMainWindow, QWidget

_AREAS = {
    "Study": Qt.DockWidgetArea.LeftDockWidgetArea,
    "Here": Qt.DockWidgetArea.RightDockWidgetArea,
}
_BELOW = Qt.DockWidgetArea.BottomDockWidgetArea
_SIDES_PX = (252, 400)
_BELOW_PX = 215


def put_docks(window: QMainWindow, panels: Mapping[str, QWidget]) -> dict[str, QDockWidget]:
    """Put panels into the window by their titles; those below the scene share one place."""
    docks = {}
    for title, panel in panels.items():
        dock = QDockWidget(title, window)
        dock.setObjectName(f"dock {title}")
        dock.setFeatures(dock.features() & ~QDockWidget.DockWidgetFeature.DockWidgetClosable)
        dock.setWidget(panel)
        window.addDockWidget(_AREAS.get(title, _BELOW), dock)
        docks[title] = dock
    first, *others = (dock for title, dock in docks.items() if title not in _AREAS)
    for dock in others:
        window.tabifyDockWidget(first, dock)
    first.raise_()
    window.setCorner(Qt.Corner.BottomLeftCorner, _AREAS["Study"])
    window.setCorner(Qt.Corner.BottomRightCorner, _BELOW)  # tables are wide
    return docks


def size_docks(window: QMainWindow, docks: Mapping[str, QDockWidget]) -> None:
    """Give the panels the room that they have at first."""
    sides = [docks["Study"], docks["Here"]]
    window.resizeDocks(sides, list(_SIDES_PX), Qt.Orientation.Horizontal)
    window.resizeDocks([docks["Ropes"]], [_BELOW_PX], Qt.Orientation.Vertical)
