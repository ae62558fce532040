"""The page before a study is open: recent studies, and the shipped ones with their pictures."""

from __future__ import annotations

from pathlib import Path

from PySide6.QtCore import Qt, Signal
from PySide6.QtGui import QPixmap, QShowEvent
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
from designer.explore.desktop.widgets import emptied
from designer.resources import example_file, example_names, example_summary

_PICTURE_PX = (200, 125)
_COLUMNS = 4
"""With these pictures and the recent studies as wide as the window at first."""


def picture_file(example: str) -> Path:
    """Return the path of the picture of a shipped study."""
    return example_file(example).parent / "pictures" / f"{example}.png"


class StartPage(QScrollArea):
    """Where a study is chosen."""

    chosen = Signal(Path)
    """A study's file was chosen."""
    asks_for_file = Signal()
    """The user wants to look for a file."""

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
        columns.addLayout(self._recent, 1)
        columns.addLayout(self._shipped(), 4)
        self.setWidget(inside)

    def showEvent(self, event: QShowEvent) -> None:
        """Show what is recent now."""
        self.show_recent()
        super().showEvent(event)

    def show_recent(self) -> None:
        """Show the studies that were open before."""
        emptied(self._recent)
        self._recent.addWidget(_label("cdpr-designer", "title"))
        self._recent.addWidget(_label("Which cable, how thick, and how sure is that?", "muted"))
        self._recent.addSpacing(12)
        button = QPushButton("Open a study …")
        button.setObjectName("open")
        button.setShortcut("Ctrl+O")
        button.clicked.connect(self.asks_for_file)
        self._recent.addWidget(button)
        self._recent.addSpacing(12)
        self._recent.addWidget(_label("Recent", "heading"))
        studies = self._settings.recent
        for path in studies:
            entry = _StudyButton(path.stem, str(path.parent))
            entry.setObjectName(f"recent {path.stem}")
            entry.setToolTip(str(path))
            entry.clicked.connect(lambda _=False, path=path: self.chosen.emit(path))
            self._recent.addWidget(entry)
        if not studies:
            self._recent.addWidget(_label("Studies that you open stand here.", "muted"))
        self._recent.addStretch(1)

    def _shipped(self) -> QVBoxLayout:
        column = QVBoxLayout()
        column.addWidget(_label("Studies to start from", "heading"))
        grid = QGridLayout()
        grid.setSpacing(12)
        for number, name in enumerate(example_names()):
            entry = _StudyButton(name, example_summary(name), picture_file(name))
            entry.setObjectName(f"example {name}")
            entry.clicked.connect(lambda _=False, name=name: self.chosen.emit(example_file(name)))
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
        rows.addWidget(_label(name, "heading"))
        text = _label(summary, "muted")
        text.setWordWrap(True)
        text.setAlignment(Qt.AlignmentFlag.AlignTop)
        rows.addWidget(text, 1)
        self.setMinimumHeight(rows.sizeHint().height() + (24 if picture else 0))


def _picture(file: Path) -> QLabel:
    label = QLabel()
    label.setFixedHeight(_PICTURE_PX[1])
    label.setAlignment(Qt.AlignmentFlag.AlignCenter)
    picture = QPixmap(str(file))
    if not picture.isNull():
        ratio = label.devicePixelRatioF()
        fitted = picture.scaled(
            round(_PICTURE_PX[0] * ratio),
            round(_PICTURE_PX[1] * ratio),
            Qt.AspectRatioMode.KeepAspectRatio,
            Qt.TransformationMode.SmoothTransformation,
        )
        fitted.setDevicePixelRatio(ratio)
        label.setPixmap(fitted)
    return label


def _label(text: str, role: str) -> QLabel:
    label = QLabel(text)
    label.setProperty("role", role)
    return label
