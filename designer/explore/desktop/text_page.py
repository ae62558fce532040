"""The study as text, with all that is wrong in it: for faults, and for what no panel has."""

from __future__ import annotations

from PySide6.QtCore import QRect, QSize, Qt, QTimer, Signal
from PySide6.QtGui import QColor, QFontDatabase, QPainter, QPaintEvent, QResizeEvent, QTextCursor
from PySide6.QtWidgets import (
    QListWidget,
    QListWidgetItem,
    QPlainTextEdit,
    QSplitter,
    QVBoxLayout,
    QWidget,
)

from designer.explore.desktop.live_session import LiveSession
from designer.explore.desktop.widgets import beside, button, label, named
from designer.report import format as fmt

_PAUSE_MS = 400
"""Nothing was typed for so long: the text is read."""


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
        rows.addLayout(beside(self._heading, None, reload, self.leave))
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
        """Hand on what was typed."""
        self._live.write(self.editor.toPlainText())

    def _flush(self) -> None:
        """Do so at once."""
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
