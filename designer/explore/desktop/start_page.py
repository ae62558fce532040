"""The page before a study is open: recent studies, and the shipped ones with their pictures."""

from __future__ import annotations

from pathlib import Path

from PySide6.QtCore import QSize, Qt, Signal
from PySide6.QtGui import QIcon, QShowEvent
from PySide6.QtWidgets import (
    QGridLayout,
    QHBoxLayout,
    QLabel,
    QPushButton,
    QScrollArea,
    QSizePolicy,
    QVBoxLayout,
    QWidget,
)

from designer.explore.desktop.settings import Settings
from designer.explore.desktop.widgets import button, emptied, fill, label, named
from designer.resources import example_file, example_names, example_summary

_PICTURE_PX = (200, 125)
_COLUMNS = 4
"""With these pictures and the recent studies as wide as the window at first."""


class StartPage(QScrollArea):
    """Where a study is chosen."""

    chosen = Signal(Path)
    """A study's file was chosen."""
    asks_for_file = Signal()
    """The user wants to look for a file."""
    asks_for_new = Signal()
    asks_to_import = Signal()

    def __init__(self, settings: Settings) -> None:
        super().__init__()
        self._settings = settings
        self.setObjectName("start page")
        self.setWidgetResizable(True)
        inside = QWidget()
        columns = QHBoxLayout(inside)
        columns.setContentsMargins(28, 24, 28, 24)
        columns.setSpacing(28)
        self._recent = QVBoxLayout()
        columns.addLayout(self._ways(), 1)
        columns.addLayout(self._shipped(), 4)
        self.setWidget(inside)

    def showEvent(self, event: QShowEvent) -> None:
        """Show what is recent now."""
        self.show_recent()
        super().showEvent(event)

    def show_recent(self) -> None:
        """Show the studies that were open before."""
        emptied(self._recent)
        studies = self._settings.recent
        for path in studies:
            entry = _StudyButton(path.stem, str(path.parent))
            entry = named(entry, f"recent {path.stem}", str(path))
            entry.clicked.connect(lambda _=False, path=path: self.chosen.emit(path))
            self._recent.addWidget(entry)
        if not studies:
            self._recent.addWidget(label("Studies that you open stand here.", "muted"))

    def _ways(self) -> QVBoxLayout:
        """How to begin; the keys of that are those of the menu."""
        column = QVBoxLayout()
        column.setSpacing(8)
        question = label("Which cable, how thick, and how sure is that?", "muted")
        fill(column, label("cdpr-designer", "title"), question)
        column.addSpacing(12)
        ways = (
            ("new study", "New study", self.asks_for_new, "A study with a comment to every field"),
            ("open", "Open a study …", self.asks_for_file, "A study of yours"),
            ("import", "Import a robot …", self.asks_to_import, "A robot of CASPR or WireX"),
        )
        fill(column, *(button(name, text, ask.emit, tip) for name, text, ask, tip in ways))
        column.addSpacing(12)
        fill(column, label("Recent", "heading"), self._recent, None)
        return column

    def _shipped(self) -> QVBoxLayout:
        column = QVBoxLayout()
        column.addWidget(label("Studies to start from", "heading"))
        grid = QGridLayout()
        grid.setSpacing(12)
        for number, name in enumerate(example_names()):
            file = example_file(name)
            picture = file.parent / "pictures" / f"{name}.png"
            entry = named(_StudyButton(name, example_summary(name), picture), f"example {name}")
            entry.clicked.connect(lambda _=False, file=file: self.chosen.emit(file))
            grid.addWidget(entry, number // _COLUMNS, number % _COLUMNS)
        column.addLayout(grid)
        column.addStretch(1)
        return column


class _StudyButton(QPushButton):
    """A study to choose: its picture, if any, its name, and what it is."""

    def __init__(self, name: str, summary: str, picture: Path | None = None) -> None:
        super().__init__()
        self.setProperty("role", "study")
        self.setAccessibleName(name)
        self.setCursor(Qt.CursorShape.PointingHandCursor)
        self.setSizePolicy(QSizePolicy.Policy.Preferred, QSizePolicy.Policy.Expanding)
        rows = QVBoxLayout(self)
        rows.setContentsMargins(10, 10, 10, 10)
        if picture is not None:
            rows.addWidget(_picture(picture))
        rows.addWidget(label(name, "heading"))
        text = label(summary, "muted")
        text.setWordWrap(True)
        text.setAlignment(Qt.AlignmentFlag.AlignTop)
        rows.addWidget(text, 1)
        self.setMinimumHeight(rows.sizeHint().height() + (24 if picture else 0))


def _picture(file: Path) -> QLabel:
    label = QLabel()
    label.setFixedHeight(_PICTURE_PX[1])
    label.setAlignment(Qt.AlignmentFlag.AlignCenter)
    label.setPixmap(QIcon(str(file)).pixmap(QSize(*_PICTURE_PX), label.devicePixelRatioF()))
    return label
