"""What is remembered from one time to the next: layout, theme, recent studies."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import cast

from PySide6.QtCore import QByteArray, QSettings

MOST_RECENT = 8


class Settings:
    """What is remembered, by name; in the user's own settings, or in a file (of a test)."""

    def __init__(self, file: Path | None = None) -> None:
        if file is None:
            self._store = QSettings("cdpr-designer", "explore")
        else:
            self._store = QSettings(str(file), QSettings.Format.IniFormat)

    @property
    def theme(self) -> str:
        """One of `theme.CHOICES`."""
        return str(self._store.value("theme", "system"))

    @theme.setter
    def theme(self, choice: str) -> None:
        self._store.setValue("theme", choice)

    @property
    def hidden_panels(self) -> tuple[str, ...]:
        """Names of the panels that are not to be seen."""
        names = self._store.value("hidden panels", [])
        return (names,) if isinstance(names, str) else tuple(cast("list[str]", names or []))

    @hidden_panels.setter
    def hidden_panels(self, names: Iterable[str]) -> None:
        self._store.setValue("hidden panels", list(names))

    @property
    def recent(self) -> tuple[Path, ...]:
        """Studies that were open, the last one first; only those that are still there."""
        stored = self._store.value("recent", [])
        names = [stored] if isinstance(stored, str) else cast("list[str]", stored or [])
        return tuple(path for path in map(Path, names) if path.is_file())

    def remember(self, study: Path) -> None:
        """Put a study in front of the recent ones."""
        path = study.resolve()
        earlier = [study_file for study_file in self.recent if study_file != path]
        names = [str(study_file) for study_file in [path, *earlier][:MOST_RECENT]]
        self._store.setValue("recent", names)

    def bytes_of(self, name: str) -> QByteArray:
        """Return a state of Qt that was kept under this name; empty where none was."""
        state = self._store.value(name)
        return state if isinstance(state, QByteArray) else QByteArray()

    def keep_bytes(self, name: str, state: QByteArray) -> None:
        """Keep a state of Qt under a name."""
        self._store.setValue(name, state)
