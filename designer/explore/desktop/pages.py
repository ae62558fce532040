"""Pages beside the scene: the start page, and the study as text with all that is wrong in it."""

from __future__ import annotations

from pathlib import Path

from PySide6.QtCore import QRect, QSize, Qt, QTimer, Signal
from PySide6.QtGui import (
    QColor,
    QFontDatabase,
    QIcon,
    QPainter,
    QPaintEvent,
    QResizeEvent,
    QShowEvent,
    QTextCursor,
)
from PySide6.QtWidgets import (
    QGridLayout,
    QHBoxLayout,
    QLabel,
    QListWidget,
    QListWidgetItem,
    QPlainTextEdit,
    QPushButton,
    QScrollArea,
    QSizePolicy,
    QSplitter,
    QVBoxLayout,
    QWidget,
)

from designer.explore.desktop.files import Settings
from designer.explore.desktop.live_session import LiveSession
from designer.explore.desktop.widgets import button, clear_layout, fill, label, named, row_of
from designer.report import format as fmt
from designer.resources import example_file, example_names, example_summary

_PICTURE_PX = (200, 125)
_COLUMNS = 4  #: With these pictures and the recent studies as wide as the window at first


class StartPage(QScrollArea):
    """Where a study is chosen."""

    chosen = Signal(Path)  #: A study's file was chosen
    asks_for_file = Signal()  #: The user wants to look for a file
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
        left = QVBoxLayout()
        left.setSpacing(8)
        question = label("Which cable, how thick, and how sure is that?", "muted")
        fill(left, label("cdpr-designer", "title"), question)
        left.addSpacing(12)
        for name, text, ask, tip in (
            ("new study", "New study", self.asks_for_new, "A study with a comment to every field"),
            ("open", "Open a study …", self.asks_for_file, "A study of yours"),
            ("import", "Import a robot …", self.asks_to_import, "A robot of CASPR or WireX"),
        ):
            left.addWidget(button(name, text, ask.emit, tip))
        left.addSpacing(12)
        fill(left, label("Recent", "heading"), self._recent, None)
        shipped, grid = QVBoxLayout(), QGridLayout()
        grid.setSpacing(12)
        for number, name in enumerate(example_names()):
            file = example_file(name)
            picture = file.parent / "pictures" / f"{name}.png"
            entry = named(_StudyButton(name, example_summary(name), picture), f"example {name}")
            entry.clicked.connect(lambda _=False, file=file: self.chosen.emit(file))
            grid.addWidget(entry, number // _COLUMNS, number % _COLUMNS)
        fill(shipped, label("Studies to start from", "heading"), grid, None)
        columns.addLayout(left, 1)
        columns.addLayout(shipped, 4)
        self.setWidget(inside)

    def showEvent(self, event: QShowEvent) -> None:
        self.show_recent()
        super().showEvent(event)

    def show_recent(self) -> None:
        clear_layout(self._recent)
        studies = self._settings.recent
        for path in studies:
            entry = _StudyButton(path.stem, str(path.parent))
            entry = named(entry, f"recent {path.stem}", str(path))
            entry.clicked.connect(lambda _=False, path=path: self.chosen.emit(path))
            self._recent.addWidget(entry)
        if not studies:
            self._recent.addWidget(label("Studies that you open stand here.", "muted"))


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
            image = QLabel()
            image.setFixedHeight(_PICTURE_PX[1])
            image.setAlignment(Qt.AlignmentFlag.AlignCenter)
            pixels = QIcon(str(picture)).pixmap(QSize(*_PICTURE_PX), image.devicePixelRatioF())
            image.setPixmap(pixels)
            rows.addWidget(image)
        rows.addWidget(label(name, "heading"))
        text = label(summary, "muted")
        text.setWordWrap(True)
        text.setAlignment(Qt.AlignmentFlag.AlignTop)
        rows.addWidget(text, 1)
        self.setMinimumHeight(rows.sizeHint().height() + (24 if picture else 0))


_PAUSE_MS = 400  #: Nothing was typed for so long: the text is read


class TextPage(QWidget):
    """An editor with line numbers, and the list of faults."""

    asks_to_reload = Signal()
    asks_to_leave = Signal()

    def __init__(self, live: LiveSession) -> None:
        super().__init__()
        self._live = live
        self.setObjectName("text page")
        self.editor, self.faults = named(_Editor(), "editor"), named(QListWidget(), "faults")
        self.faults.setWordWrap(True)
        self.faults.itemActivated.connect(self._go_to)
        self.faults.itemClicked.connect(self._go_to)
        self._pause = QTimer(self, singleShot=True, interval=_PAUSE_MS)
        self._pause.timeout.connect(self._write)
        self.editor.textChanged.connect(self._pause.start)
        self._heading = named(label("", "heading"), "number of faults")
        self.leave = button("leave text", "Show the scene", self.asks_to_leave.emit)
        reload = button("reload text", "Reload the file", self.asks_to_reload.emit)
        split = QSplitter(Qt.Orientation.Vertical)
        split.addWidget(self.editor)
        split.addWidget(self.faults)
        split.setStretchFactor(0, 4)
        split.setStretchFactor(1, 1)
        rows = QVBoxLayout(self)
        rows.addLayout(row_of(self._heading, None, reload, self.leave))
        rows.addWidget(split, 1)
        live.changed.connect(self._show_text)
        live.flushing.connect(self._flush)

    def _show_text(self) -> None:
        """Show the text, unless it is the one that is being written, and its faults."""
        session = self._live.session
        if session is None:
            return
        text, faults = session.text, session.faults
        if text != self.editor.toPlainText():
            self.editor.blockSignals(True)
            self.editor.setPlainText(text)
            self.editor.blockSignals(False)
            self.editor.make_room()
        self.faults.clear()
        for fault in faults:
            line = f"line {fault.line}: " if fault.line else ""
            expected = f" (expected {fault.expected})" if fault.expected else ""
            field = f"{fault.field}: " if fault.field else ""
            item = QListWidgetItem(f"{line}{field}{fault.problem}{expected}")
            item.setData(Qt.ItemDataRole.UserRole, fault.line)
            self.faults.addItem(item)
        self.faults.setVisible(bool(faults))
        self.editor.faulty = {fault.line for fault in faults if fault.line}
        self.editor.numbers.update()
        count = fmt.plural(len(faults), "fault")
        self._heading.setText(f"{count} in this study" if faults else "No faults")
        self.leave.setEnabled(session.study is not None)

    def _write(self) -> None:
        self._live.write(self.editor.toPlainText())

    def _flush(self) -> None:
        if self._pause.isActive():
            self._pause.stop()
            self._write()

    def _go_to(self, item: QListWidgetItem) -> None:
        line = item.data(Qt.ItemDataRole.UserRole)
        if line:
            block = self.editor.document().findBlockByNumber(line - 1)
            self.editor.setTextCursor(QTextCursor(block))
            self.editor.centerCursor()
            self.editor.setFocus()


class _Editor(QPlainTextEdit):
    """A plain text with its line numbers, those with faults marked."""

    def __init__(self) -> None:
        super().__init__()
        self.setFont(QFontDatabase.systemFont(QFontDatabase.SystemFont.FixedFont))
        self.setLineWrapMode(QPlainTextEdit.LineWrapMode.NoWrap)
        self.setTabChangesFocus(True)
        self.faulty: set[int] = set()
        self.numbers = _Numbers(self)
        self.blockCountChanged.connect(self.make_room)
        self.updateRequest.connect(self._scrolled)
        self.make_room()

    def numbers_width(self) -> int:
        digits = len(str(max(self.blockCount(), 1)))
        return 14 + self.fontMetrics().horizontalAdvance("9") * digits

    def resizeEvent(self, event: QResizeEvent) -> None:
        super().resizeEvent(event)
        area = self.contentsRect()
        self.numbers.setGeometry(
            QRect(area.left(), area.top(), self.numbers_width(), area.height())
        )

    def paint_numbers(self) -> None:
        painter = QPainter(self.numbers)
        painter.fillRect(self.numbers.rect(), self.palette().window())
        block = self.firstVisibleBlock()
        top = self.blockBoundingGeometry(block).translated(self.contentOffset()).top()
        while block.isValid() and top <= self.height():
            number, height = block.blockNumber() + 1, self.blockBoundingRect(block).height()
            is_faulty = number in self.faulty
            brush = self.palette().brightText() if is_faulty else self.palette().placeholderText()
            painter.setPen(QColor(brush.color()))
            box = QRect(0, round(top), self.numbers.width() - 6, round(height))
            text = f"▸{number}" if is_faulty else str(number)
            painter.drawText(box, Qt.AlignmentFlag.AlignRight, text)
            block, top = block.next(), top + height

    def make_room(self) -> None:
        self.setViewportMargins(self.numbers_width(), 0, 0, 0)

    def _scrolled(self, area: QRect, down: int) -> None:
        if down:
            self.numbers.scroll(0, down)
        else:
            self.numbers.update(0, area.y(), self.numbers.width(), area.height())


class _Numbers(QWidget):
    def __init__(self, editor: _Editor) -> None:
        super().__init__(editor)
        self._editor = editor

    def sizeHint(self) -> QSize:
        return QSize(self._editor.numbers_width(), 0)

    def paintEvent(self, event: QPaintEvent) -> None:
        self._editor.paint_numbers()
