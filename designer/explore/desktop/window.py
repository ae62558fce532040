"""The main window: pages, panels, menus, and how they follow the session."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from PySide6.QtCore import QTimer
from PySide6.QtGui import QCloseEvent
from PySide6.QtWidgets import (
    QApplication,
    QLabel,
    QMainWindow,
    QPlainTextEdit,
    QStackedWidget,
    QWidget,
)

from designer.explore.desktop import theme as themes
from designer.explore.desktop.comparing import Comparing
from designer.explore.desktop.docks import put_docks, size_docks
from designer.explore.desktop.editing import Editing
from designer.explore.desktop.files import Files
from designer.explore.desktop.help import HINT, Help
from designer.explore.desktop.keeping import Keeping
from designer.explore.desktop.live import LONG, NAMES, Live
from designer.explore.desktop.long_work import LongWork
from designer.explore.desktop.menus import Menus
from designer.explore.desktop.moving import Moving
from designer.explore.desktop.panel_compare import PanelCompare
from designer.explore.desktop.panel_here import PanelHere
from designer.explore.desktop.panel_measured import PanelMeasured
from designer.explore.desktop.panel_requirements import PanelRequirements
from designer.explore.desktop.panel_ropes import PanelRopes
from designer.explore.desktop.panel_study import PanelStudy
from designer.explore.desktop.settings import Settings
from designer.explore.desktop.start_page import StartPage
from designer.explore.desktop.tables import grey
from designer.explore.desktop.text_page import TextPage
from designer.explore.desktop.work_page import WorkPage
from designer.explore.session import Session
from designer.plugins.find import Plugins

if TYPE_CHECKING:
    from designer.explore.question import Assignment, Rope
    from designer.explore.requests import Kind

_DISK_MS = 2000


class Window(QMainWindow):
    """Everything that stands in the window; the session holds the study, `Live` the answers."""

    def __init__(self, plugins: Plugins, settings: Settings) -> None:
        super().__init__()
        self.setObjectName("window")
        self.plugins, self.settings = plugins, settings
        self.session: Session | None = None
        self.live = Live()
        self.answers: dict[str, Any] = {}
        self.pages = QStackedWidget()
        self.start, self.work, self.text = StartPage(), WorkPage(), TextPage()
        for page in (self.start, self.work, self.text):
            self.pages.addWidget(page)
        self.setCentralWidget(self.pages)
        self.files, self.keeping = Files(self), Keeping(self)
        self.editing, self.moving, self.comparing = Editing(self), Moving(self), Comparing(self)
        self._make_docks()
        self.busy, self.long = QLabel(), LongWork()
        self.busy.setObjectName("busy")
        self.statusBar().addPermanentWidget(self.busy)
        self.statusBar().addPermanentWidget(self.long)
        self.menus = Menus(self)
        self._connect()
        self._restore()
        self._disk = QTimer(self, interval=_DISK_MS)
        self._disk.timeout.connect(self.files.look_at_disk)
        self._disk.start()
        self.show_start()

    # What there is in the window

    def _make_docks(self) -> None:
        self.here, self.study_panel, self.ropes = PanelHere(), PanelStudy(), PanelRopes()
        self.requirements, self.compare = PanelRequirements(), PanelCompare()
        self.measured = PanelMeasured()
        self.messages = QPlainTextEdit(readOnly=True)
        self.messages.setObjectName("messages")
        self.messages.setMaximumBlockCount(500)
        self.messages.setTabChangesFocus(True)
        panels = {
            "Study": self.study_panel,
            "Here": self.here,
            "Ropes": self.ropes,
            "Requirements": self.requirements,
            "Compare": self.compare,
            "Measured data": self.measured,
            "Messages": self.messages,
        }
        self.docks = put_docks(self, panels)

    def _connect(self) -> None:
        self.start.chosen.connect(self.files.open)
        self.start.asks_for_file.connect(self.files.ask_and_open)
        scene = self.work.scene
        scene.asks_for_position.connect(self.moving.to)
        scene.asks_for_step.connect(self.moving.step)
        scene.asks_for_turn.connect(self.moving.turn)
        self.here.asks_for_place.connect(self.moving.to)
        self.here.asks_to_keep.connect(self.moving.keep)
        self.study_panel.edited.connect(self.editing.enter)
        self.study_panel.settled.connect(self.editing.settle)
        self.study_panel.asks_to_put_back.connect(self.editing.put_back)
        self.study_panel.gave_up.connect(self.editing.give_up)
        self.ropes.chosen.connect(self._choose)
        self.ropes.asks_for_selection.connect(lambda: self.begin_long("select"))
        self.requirements.asks_for_place.connect(self.moving.to)
        self.requirements.asks_for_selection.connect(lambda: self.begin_long("select"))
        self.compare.asks_to_pin.connect(self.comparing.pin)
        self.compare.asks_to_release.connect(self.comparing.release)
        self.compare.difference_wanted.connect(self.comparing.want_in_map)
        self.measured.asks_to_diagnose.connect(lambda: self.begin_long("diagnose"))
        self.measured.asks_to_take_over.connect(self.comparing.take_over)
        self.measured.rows_wanted.connect(self._show_rows)
        self.work.slice_moved.connect(self._move_slice)
        self.work.quantity_changed.connect(self._want_quantity)
        self.work.notice_answered.connect(self._answer_notice)
        self.text.edited.connect(self.editing.write)
        self.text.asks_to_reload.connect(self.files.reload)
        self.text.asks_to_leave.connect(self.show_work)
        self.live.answered.connect(self._answered)
        self.live.failed.connect(self._failed)
        self.live.progressed.connect(self.long.go_on)
        self.live.busy_changed.connect(self._show_busy)
        self.long.asks_to_cancel.connect(self.live.cancel)

    # Pages

    def show_start(self) -> None:
        """Show the page where a study is chosen."""
        self.start.show_recent(self.settings.recent)
        self._show_page(self.start)

    def show_work(self) -> None:
        """Show the scene; the text instead, where there never was a sound study."""
        self.text.flush()
        has_study = self.session is not None and self.session.study is not None
        self._show_page(self.work if has_study else self.text)
        if has_study:
            self.work.scene.setFocus()

    def show_text(self) -> None:
        """Show the study as text, with its faults."""
        self._show_page(self.text)
        self.text.editor.setFocus()

    def _show_page(self, page: QWidget) -> None:
        self.pages.setCurrentWidget(page)
        study = None if self.session is None else self.session.study
        has_data = study is not None and study.measurements is not None
        for name, dock in self.docks.items():
            has_any = name != "Measured data" or has_data
            dock.setVisible(page is self.work and has_any and self.menus.wants_dock(dock))
        if page is self.work and self.settings.bytes_of("layout").isEmpty():
            size_docks(self, self.docks)
        self.menus.refresh()

    def panels_changed(self) -> None:
        """Show the panels that are wanted, and remember which are not."""
        wanted = self.menus.wants_dock
        self.settings.hidden_panels = [n for n, dock in self.docks.items() if not wanted(dock)]
        page = self.pages.currentWidget()
        assert page is not None
        self._show_page(page)

    # A session

    def take_session(self, session: Session) -> None:
        """Work on a study from now on."""
        self.live.forget()
        self.session, self.answers = session, {}
        self.setWindowTitle(f"{session.name}[*] – cdpr-designer")
        self.ropes.show_ropes(None, None)
        self.requirements.show_requirements(None)
        self.here.show_here(None)
        self.compare.show_differences(None)
        self.measured.show_residuals(None)
        self.measured.show_diagnosis(None)
        self.live.against = None
        if session.study is not None:
            self.work.show_study(session.study, afresh=True)
        self.changed()
        if session.faults:
            self.show_text()
        else:
            self.show_work()
            self.statusBar().showMessage(HINT, 20_000)
        for problem in session.problems:  # instead of the hint
            self.tell(problem)

    def changed(self, *, moving: bool = False) -> None:
        """Show the session as it is now, and ask for what follows from it."""
        session = self.session
        if session is None:
            return
        state, study = session.state, session.study
        self.setWindowModified(session.is_modified)
        self.text.show_text(session.text, session.faults, has_study=study is not None)
        if study is not None:
            if study is not getattr(self.live.question, "study", None):
                self.work.show_study(study, afresh=self.live.question is None)
                self.editing.show()
            self.work.show_place(state.place)
            self.here.show_place(state.place, can_turn=not study.robot.is_point_mass)
            self.work.allow_utilisation(state.rope is not None)
        self.menus.refresh()
        self.live.ask_about(session.question(), moving=moving)

    # Map and ropes

    def _choose(self, rope: Rope | Assignment | None) -> None:
        assert self.session is not None
        self.session.choose(rope)
        self.ropes.show_ropes(self.answers.get("ropes"), rope)
        self.changed()
        if rope is not None:
            self.work.choose_quantity("utilisation")

    def _move_slice(self, share: float, moving: bool) -> None:
        self.live.ask_slice(share, moving=moving)

    def _want_quantity(self, key: str) -> None:
        self.live.quantity = key
        shown = self.work.map
        if shown is not None and any(key not in values for values in shown.values.values()):
            self.live.ask_map()
        self.menus.refresh()

    def _show_rows(self, wanted: bool) -> None:
        found = self.answers.get("residuals") if wanted else None
        if found is None:
            self.work.show_rows(np.empty((0, 3)), np.empty(0))
        else:
            self.work.show_rows(found.position_m, found.size())

    def _answer_notice(self, name: str) -> None:
        self.files.answer_notice(name)
        if name == "Open":
            self.keeping.open_written()

    # Answers

    def _answered(self, kind: str, answer: Any) -> None:
        self.answers[kind] = answer
        if kind == "here":
            self.work.show_here(answer)
            self.here.show_here(answer)
        elif kind in ("coarse", "fine"):
            self.work.show_map(answer)
        elif kind == "worst":
            self.work.show_worst(answer)
        elif kind in ("ropes", "select"):
            self._take_ropes(answer)
            if kind == "select":
                self.requirements.show_requirements(answer)
        elif kind == "residuals":
            self.measured.show_residuals(answer)
            self._show_rows(self.measured.in_scene.isChecked())
        elif kind == "diagnose":
            self.measured.show_diagnosis(answer)
        elif kind == "export":
            self.keeping.written(answer)
        self.comparing.show()
        self.menus.refresh()

    def _take_ropes(self, ropes: Any) -> None:
        session = self.session
        assert session is not None
        self.answers["ropes"] = ropes
        is_first = "first ropes" not in self.answers
        self.answers["first ropes"] = True
        best = None if ropes is None else ropes.best
        if is_first and session.state.rope is None and best is not None:
            session.begin_with(best)
            self.changed()
            if self.work.quantity.currentData() == "diameter":  # nobody chose it
                self.work.choose_quantity("utilisation")
        self.ropes.show_ropes(ropes, session.state.rope)

    def _failed(self, kind: str, text: str) -> None:
        self.tell(f"{NAMES.get(kind, kind)}: {text}")

    def tell(self, text: str) -> None:
        """Write a message where it stays, and show it."""
        self.messages.appendPlainText(text)
        self.statusBar().showMessage(text.splitlines()[0] if text else "", 15_000)

    # Work

    def begin_long(self, kind: Kind, **options: Any) -> None:
        """Begin long work, with progress and a button that ends it."""
        if self.live.question is not None:
            self.long.begin(kind, NAMES[kind])
            self.live.ask_long(kind, **options)

    def _show_busy(self) -> None:
        busy = self.live.busy
        short = sorted({NAMES[kind] for kind in busy if kind not in LONG})
        self.busy.setText(f"solving {', '.join(short)} …" if short else "")
        self._show_age()
        if self.long.kind and self.long.kind not in busy:
            self.long.end(self.long.kind)

    def _show_age(self) -> None:
        """Show in grey what is of an older state of the study."""
        old = self.live.outdated
        self.work.show_age(is_map_old="map" in old, is_worst_old="worst" in old)
        grey(old >= {"here"}, *self.here.results)
        grey(old >= {"ropes"}, *self.ropes.results)
        grey(old >= {"select"}, *self.requirements.results)
        grey(bool(old & {"here", "worst", "ropes"}), *self.compare.results)
        grey(old >= {"diagnose"}, self.measured.told)
        grey(old >= {"residuals"}, self.measured.plot)

    # Look, and the end

    def show_help(self) -> None:
        """Show what mouse and keys do."""
        Help(self).show()

    def put_on(self, choice: str) -> None:
        """Take the colours of a theme, or those of the system."""
        self.settings.theme = choice
        theme = themes.theme_of(choice)
        app = QApplication.instance()
        assert isinstance(app, QApplication)
        themes.put_on(app, theme)
        self.work.put_on(theme)
        self.here.put_on(theme)
        self.ropes.put_on(theme)
        self.requirements.put_on(theme)
        self.measured.put_on(theme)
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
        self.text.flush()
        if not self.files.may_leave():
            event.ignore()
            return
        self._disk.stop()
        self.settings.keep_bytes("geometry", self.saveGeometry())
        if self.pages.currentWidget() is self.work:
            self.settings.keep_bytes("layout", self.saveState())
        self.live.close()
        self.work.scene.close()
        event.accept()
