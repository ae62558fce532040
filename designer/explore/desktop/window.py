"""The main window: pages, panels and status bar, which follow the open study by its signals."""

from __future__ import annotations

from PySide6.QtCore import Qt
from PySide6.QtGui import QCloseEvent
from PySide6.QtWidgets import (
    QApplication,
    QDockWidget,
    QHBoxLayout,
    QLabel,
    QMainWindow,
    QPlainTextEdit,
    QProgressBar,
    QStackedWidget,
    QStatusBar,
    QToolButton,
    QWidget,
)

from designer.explore.desktop import theme as themes
from designer.explore.desktop.files import Files
from designer.explore.desktop.live_session import LONG, NAMES, LiveSession
from designer.explore.desktop.menus import HINT, Menus
from designer.explore.desktop.panel_compare import PanelCompare
from designer.explore.desktop.panel_here import PanelHere
from designer.explore.desktop.panel_measured import PanelMeasured
from designer.explore.desktop.panel_requirements import PanelRequirements
from designer.explore.desktop.panel_ropes import PanelRopes
from designer.explore.desktop.panel_study import PanelStudy
from designer.explore.desktop.settings import Settings
from designer.explore.desktop.start_page import StartPage
from designer.explore.desktop.text_page import TextPage
from designer.explore.desktop.widgets import fill, named
from designer.explore.desktop.work_page import WorkPage
from designer.explore.question import Long
from designer.plugins import Plugins

_HINT_MS = 20_000
"""The hint stays longer than a message: a newcomer looks at the scene first."""
_MESSAGE_MS = 15_000
"""Long enough to be read twice; what matters stays among the messages."""
_AREAS = {
    "Study": Qt.DockWidgetArea.LeftDockWidgetArea,
    "Here": Qt.DockWidgetArea.RightDockWidgetArea,
}
_BELOW = Qt.DockWidgetArea.BottomDockWidgetArea
_SIDES_PX = (252, 400)
"""The narrowest in which entries with sliders, and the table of cables, are read in full."""
_BELOW_SHARE = 0.36
"""Of the window's height: at 900 pixels the table of ropes has some six rows below its filters."""


class Window(QMainWindow):
    """Everything that stands in the window; `LiveSession` holds the study and the answers."""

    def __init__(self, plugins: Plugins, settings: Settings) -> None:
        super().__init__()
        self.setObjectName("window")
        self.settings, self.live = settings, LiveSession()
        self.files = Files(self, self.live, plugins, settings)
        self.start, self.work = StartPage(settings), WorkPage(self.live)
        self.text = TextPage(self.live)
        self.pages = QStackedWidget()
        for page in (self.start, self.work, self.text):
            self.pages.addWidget(page)
        self.setCentralWidget(self.pages)
        self.here, self.study_panel = PanelHere(self.live), PanelStudy(self.live)
        self.ropes, self.requirements = PanelRopes(self.live), PanelRequirements(self.live)
        self.compare, self.measured = PanelCompare(self.live), PanelMeasured(self.live)
        self.messages = _messages()
        self.docks = self._put_docks()
        self.status = StatusBar(self.live)
        self.setStatusBar(self.status)
        self.menus = Menus(self)
        self._connect()
        self._restore()
        self._show_page(self.start)

    def _put_docks(self) -> dict[str, QDockWidget]:
        """Put the panels around the scene; those below it share one place."""
        panels = {
            "Study": self.study_panel,
            "Here": self.here,
            "Ropes": self.ropes,
            "Requirements": self.requirements,
            "Compare": self.compare,
            "Measured data": self.measured,
            "Messages": self.messages,
        }
        docks = {}
        for title, panel in panels.items():
            dock = QDockWidget(title, self)
            dock.setObjectName(f"dock {title}")
            dock.setFeatures(dock.features() & ~QDockWidget.DockWidgetFeature.DockWidgetClosable)
            dock.setWidget(panel)
            self.addDockWidget(_AREAS.get(title, _BELOW), dock)
            docks[title] = dock
            if title not in (*_AREAS, "Ropes"):
                self.tabifyDockWidget(docks["Ropes"], dock)
        docks["Ropes"].raise_()
        self.setCorner(Qt.Corner.BottomLeftCorner, _AREAS["Study"])
        self.setCorner(Qt.Corner.BottomRightCorner, _BELOW)  # tables are wide
        return docks

    def _connect(self) -> None:
        live, files = self.live, self.files
        live.opened.connect(self._opened)
        live.changed.connect(self._show_modified)
        live.message.connect(self.messages.appendPlainText)
        self.start.chosen.connect(files.open)
        self.start.asks_for_file.connect(files.ask_and_open)
        files.not_opened.connect(self.start.show_recent)
        files.notice.connect(self.work.show_notice)
        self.work.notice_answered.connect(files.answer_notice)
        self.text.asks_to_reload.connect(files.reload)
        self.text.asks_to_leave.connect(self.show_work)
        self.measured.rows_wanted.connect(self.work.want_rows)
        live.taken_over.connect(self.docks["Compare"].raise_)

    # Pages

    def _opened(self) -> None:
        """Show the study that was opened; the start page for none."""
        session = self.live.session
        self._show_modified()
        if session is None:
            self.setWindowTitle("cdpr-designer")
            self._show_page(self.start)
            return
        self.setWindowTitle(f"{session.name}[*] – cdpr-designer")
        if session.faults:
            self.show_text()
        else:
            self.show_work()
            self.status.showMessage(HINT, _HINT_MS)
        for problem in session.problems:  # instead of the hint
            self.live.message.emit(problem)

    def show_work(self) -> None:
        """Show the scene; the text instead, where there never was a sound study."""
        self.live.flushing.emit()
        has_study = self.live.study is not None
        self._show_page(self.work if has_study else self.text)
        if has_study:
            self.work.scene.setFocus()

    def show_text(self) -> None:
        """Show the study as text, with its faults."""
        self._show_page(self.text)
        self.text.editor.setFocus()

    def _show_page(self, page: QWidget) -> None:
        self.pages.setCurrentWidget(page)
        study = self.live.study
        has_data = study is not None and study.measurements is not None
        for name, dock in self.docks.items():
            has_any = name != "Measured data" or has_data
            dock.setVisible(page is self.work and has_any and self.menus.wants_panel(name))
        if page is self.work and self.settings.bytes_of("layout").isEmpty():
            sides = [self.docks["Study"], self.docks["Here"]]
            self.resizeDocks(sides, list(_SIDES_PX), Qt.Orientation.Horizontal)
            below = round(_BELOW_SHARE * self.height())
            self.resizeDocks([self.docks["Ropes"]], [below], Qt.Orientation.Vertical)
        self.menus.refresh()

    def show_panels(self) -> None:
        """Show the panels that are wanted, and remember which are not."""
        wants = self.menus.wants_panel
        self.settings.hidden_panels = [name for name in self.docks if not wants(name)]
        page = self.pages.currentWidget()
        assert page is not None
        self._show_page(page)

    def _show_modified(self) -> None:
        session = self.live.session
        self.setWindowModified(session is not None and session.is_modified)

    # Look, and the end

    def put_on(self, choice: str) -> None:
        """Take the colours of a theme, or those of the system."""
        self.settings.theme = choice
        app = QApplication.instance()
        assert isinstance(app, QApplication)
        themes.put_on(app, themes.theme_of(choice))
        self.work.follow_theme()
        self.menus.refresh()

    def _restore(self) -> None:
        self.resize(1280, 800)
        self.restoreGeometry(self.settings.bytes_of("geometry"))
        self.restoreState(self.settings.bytes_of("layout"))
        self.put_on(self.settings.theme)
        hints = QApplication.styleHints()
        hints.colorSchemeChanged.connect(lambda _: self.put_on(self.settings.theme))

    def closeEvent(self, event: QCloseEvent) -> None:
        """Ask about what is not saved; end all work."""
        if not self.files.may_leave():
            event.ignore()
            return
        self.files.watch.stop()
        self.settings.keep_bytes("geometry", self.saveGeometry())
        if self.pages.currentWidget() is self.work:
            self.settings.keep_bytes("layout", self.saveState())
        self.live.close()
        self.work.scene.close()
        event.accept()


def _messages() -> QPlainTextEdit:
    messages = QPlainTextEdit(readOnly=True)
    messages.setObjectName("messages")
    messages.setMaximumBlockCount(500)  # a session of days shall not fill the memory
    messages.setTabChangesFocus(True)
    return messages


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
