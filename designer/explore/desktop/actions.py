"""The menus: every action with its name, its keys and what it does, in one table."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass

from PySide6.QtGui import QAction, QActionGroup, QKeySequence
from PySide6.QtWidgets import QMainWindow, QMenu


@dataclass(frozen=True, slots=True)
class Entry:
    """An entry of a menu; ``does`` is called when it is chosen."""

    name: str
    text: str
    keys: str
    tip: str
    does: Callable[[], object]


def fill(window: QMainWindow, menu: QMenu, entries: Iterable[Entry | None]) -> dict[str, QAction]:
    """Put entries into a menu and return their actions by name; None is a line between them."""
    found = {}
    menu.setToolTipsVisible(True)
    for entry in entries:
        if entry is None:
            menu.addSeparator()
            continue
        action = QAction(entry.text, window)
        action.setObjectName(entry.name)
        if entry.keys:
            action.setShortcut(QKeySequence(entry.keys))
        action.setToolTip(entry.tip)
        action.setStatusTip(entry.tip)
        action.triggered.connect(lambda _=False, does=entry.does: does())
        menu.addAction(action)
        found[entry.name] = action
    return found


def choices(
    window: QMainWindow,
    menu: QMenu,
    options: Iterable[tuple[str, str, str]],
    chosen: Callable[[str], object],
) -> dict[str, QAction]:
    """Put options (name, text, keys) into a menu, one of which is on."""
    group = QActionGroup(window)
    found = {}
    for name, text, keys in options:
        action = QAction(text, window, checkable=True)
        action.setObjectName(f"{menu.objectName()} {name}")
        if keys:
            action.setShortcut(QKeySequence(keys))
        action.triggered.connect(lambda _=False, name=name: chosen(name))
        group.addAction(action)
        menu.addAction(action)
        found[name] = action
    return found
