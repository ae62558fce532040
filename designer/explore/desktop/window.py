"""The main window: pages, panels, menus, and how they follow the session."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np
from PySide6.QtCore import Qt, QTimer
from PySide6.QtGui import QCloseEvent
from PySide6.QtWidgets import (
    QApplication,
    QDockWidget,
    QLabel,
    QMainWindow,
    QPlainTextEdit,
    QStackedWidget,
    QWidget,
)

from designer.arrays import FloatArray
from designer.explore.compare import Pin, compare
from designer.explore.desktop import theme as themes
from designer.explore.desktop.files import Files
from designer.explore.desktop.help import HINT, Help
from designer.explore.desktop.keeping import Keeping
from designer.explore.desktop.live import LONG, Live
from designer.explore.desktop.long_work import LongWork
from designer.explore.desktop.menus import Menus
from designer.explore.desktop.panel_compare import PanelCompare
from designer.explore.desktop.panel_here import PanelHere
from designer.explore.desktop.panel_measured import PanelMeasured
from designer.explore.desktop.panel_ropes import PanelRopes
from designer.explore.desktop.panel_study import PanelStudy
from designer.explore.desktop.settings import Settings
from designer.explore.desktop.start_page import StartPage
from designer.explore.desktop.text_page import TextPage
from designer.explore.desktop.work_page import WorkPage
from designer.explore.session import Session
from designer.plugins.find import Plugins

if TYPE_CHECKING:
    from designer.explore.question import Assignment, Rope
    from designer.explore.requests import Kind

_DISK_MS = 2000
_TURN_RAD = float(np.radians(1.0))
_NAMES = {
    "here": "the pose",
    "coarse": "the map",
    "fine": "the map",
    "worst": "the worst pose",
    "ropes": "the candidates",
    "select": "the full selection",
    "residuals": "the residuals",
    "diagnose": "the diagnosis",
    "export": "the export",
}


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
        self._make_docks()
        self._make_status()
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
        self.compare, self.measured = PanelCompare(), PanelMeasured()
        self.messages = QPlainTextEdit(readOnly=True)
        self.messages.setObjectName("messages")
        self.messages.setMaximumBlockCount(500)
        self.messages.setTabChangesFocus(True)
        area = Qt.DockWidgetArea
        self.docks: dict[str, QDockWidget] = {}
        for name, widget, where in (
            ("Study", self.study_panel, area.LeftDockWidgetArea),
            ("Here", self.here, area.RightDockWidgetArea),
            ("Ropes", self.ropes, area.BottomDockWidgetArea),
            ("Compare", self.compare, area.BottomDockWidgetArea),
            ("Measured data", self.measured, area.BottomDockWidgetArea),
            ("Messages", self.messages, area.BottomDockWidgetArea),
        ):
            self.add_dock(name, widget, where)
        for name in ("Compare", "Measured data", "Messages"):
            self.tabifyDockWidget(self.docks["Ropes"], self.docks[name])
        self.docks["Ropes"].raise_()
        for corner, side in (
            (Qt.Corner.BottomLeftCorner, area.LeftDockWidgetArea),
            (Qt.Corner.BottomRightCorner, area.RightDockWidgetArea),
        ):
            self.setCorner(corner, side)

    def add_dock(self, name: str, widget: QWidget, where: Qt.DockWidgetArea) -> QDockWidget:
        """Put a panel into the window."""
        dock = QDockWidget(name, self)
        dock.setObjectName(f"dock {name}")
        dock.setFeatures(dock.features() & ~QDockWidget.DockWidgetFeature.DockWidgetClosable)
        dock.setWidget(widget)
        self.addDockWidget(where, dock)
        self.docks[name] = dock
        return dock

    def _make_status(self) -> None:
        self.busy, self.long = QLabel(), LongWork()
        self.busy.setObjectName("busy")
        self.statusBar().addPermanentWidget(self.busy)
        self.statusBar().addPermanentWidget(self.long)

    def _connect(self) -> None:
        self.start.chosen.connect(self.files.open)
        self.start.asks_for_file.connect(self.files.ask_and_open)
        scene = self.work.scene
        scene.asks_for_position.connect(self._move_to)
        scene.asks_for_step.connect(self._step)
        scene.asks_for_turn.connect(self._turn)
        self.here.asks_for_place.connect(lambda place: self._move_to(place, False))
        self.here.asks_to_keep.connect(self.keep_pose)
        self.study_panel.edited.connect(self._edit)
        self.study_panel.settled.connect(self._settle)
        self.study_panel.asks_to_put_back.connect(self._put_back)
        self.study_panel.gave_up.connect(self._give_up)
        self.ropes.chosen.connect(self._choose)
        self.ropes.asks_for_selection.connect(lambda: self.begin_long("select"))
        self.compare.asks_to_pin.connect(self.pin)
        self.compare.asks_to_release.connect(self.release)
        self.compare.difference_wanted.connect(self._want_difference)
        self.measured.asks_to_diagnose.connect(lambda: self.begin_long("diagnose"))
        self.measured.asks_to_take_over.connect(self._take_over)
        self.measured.rows_wanted.connect(self._show_rows)
        self.work.slice_moved.connect(self._move_slice)
        self.work.quantity_changed.connect(self._want_quantity)
        self.work.notice_answered.connect(self._answer_notice)
        self.text.edited.connect(self._edit_text)
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
        for name, dock in self.docks.items():
            has_any = name != "Measured data" or self._has_data
            dock.setVisible(page is self.work and has_any and self.menus.wants_dock(dock))
        if page is self.work and self.settings.bytes_of("layout").isEmpty():
            sides = [self.docks["Study"], self.docks["Here"]]
            self.resizeDocks(sides, [252, 392], Qt.Orientation.Horizontal)
            self.resizeDocks([self.docks["Ropes"]], [190], Qt.Orientation.Vertical)
        self.menus.refresh()

    def panels_changed(self) -> None:
        """Show the panels that are wanted, and remember which are not."""
        wanted = self.menus.wants_dock
        self.settings.hidden_panels = [n for n, dock in self.docks.items() if not wanted(dock)]
        page = self.pages.currentWidget()
        assert page is not None
        self._show_page(page)

    @property
    def _has_data(self) -> bool:
        study = None if self.session is None else self.session.study
        return study is not None and study.measurements is not None

    # A session

    def take_session(self, session: Session) -> None:
        """Work on a study from now on."""
        self.live.forget()
        self.session, self.answers = session, {}
        self.setWindowTitle(f"{session.name}[*] – cdpr-designer")
        for problem in session.problems:
            self.tell(problem)
        self.ropes.show_ropes(None, None)
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
                self.study_panel.show_fields(session.fields(), session.rejected, session.differing)
            self.work.show_place(state.place)
            self.here.show_place(state.place, can_turn=not study.robot.is_point_mass)
        self.menus.refresh()
        self.live.ask_about(session.question(), moving=moving)

    def _edit(self, path: str, text: str, moving: bool) -> None:
        assert self.session is not None
        self.session.edit(path, text, continuous=moving)
        self.refresh_fields()
        self.changed(moving=moving)

    def refresh_fields(self) -> None:
        """Show the fields, and what was refused."""
        assert self.session is not None
        session = self.session
        self.study_panel.show_fields(session.fields(), session.rejected, session.differing)

    def _settle(self) -> None:
        assert self.session is not None
        self.session.settle()
        self.changed()

    def _put_back(self, path: str) -> None:
        assert self.session is not None
        self.session.put_back(path)
        self.refresh_fields()
        self.changed()

    def _give_up(self, path: str) -> None:
        assert self.session is not None
        self.session.drop_rejected(path)
        self.refresh_fields()

    def _edit_text(self, text: str) -> None:
        assert self.session is not None
        if text != self.session.text:
            self.session.set_text(text, continuous=True)
            self.refresh_fields()
            self.changed()

    def undo(self) -> None:
        """Take back the last step."""
        self._go(lambda session: session.undo())

    def redo(self) -> None:
        """Do again what was taken back last."""
        self._go(lambda session: session.redo())

    def _go(self, step: Callable[[Session], None]) -> None:
        if self.session is not None:
            step(self.session)
            self.refresh_fields()
            self.changed()
            self.ropes.show_ropes(self.answers.get("ropes"), self.session.state.rope)
            self._pin_changed()

    def put_all_back(self) -> None:
        """Make the whole study as the file has it."""
        if self.session is not None and self.session.is_modified:
            self.session.settle()
            self.session.set_text(self.session.saved_text)
            self.refresh_fields()
            self.changed()

    # The platform

    def _move_to(self, place: FloatArray, moving: bool) -> None:
        assert self.session is not None
        if self.session.study is None:
            return
        self.session.move(place, continuous=moving)
        if not moving:
            self.session.settle()
        self.changed(moving=moving)

    def _step(self, direction: FloatArray, times: float) -> None:
        assert self.session is not None
        place = self.session.state.place.copy()
        place[:3] += times * self.step_m * direction
        self._nudge(place)

    def _turn(self, axis: FloatArray, times: float) -> None:
        from scipy.spatial.transform import Rotation

        assert self.session is not None
        study = self.session.study
        if study is None:
            return
        if study.robot.is_planar:
            normal = np.asarray(study.robot.upright[1])
            axis = normal * float(axis.sum())
        place = self.session.state.place.copy()
        turned = Rotation.from_rotvec(times * _TURN_RAD * axis) * Rotation.from_rotvec(place[3:])
        place[3:] = turned.as_rotvec()
        self._nudge(place)

    def _nudge(self, place: FloatArray) -> None:
        """A step of the keys; several of them are one step to undo."""
        assert self.session is not None
        self.session.move(place, continuous=True)
        self.changed(moving=True)

    @property
    def step_m(self) -> float:
        """How far a key moves the platform: a round length, about a hundredth of what is shown."""
        size = float(np.ptp(self.work.scene.stage.bounds_m, axis=0).max())
        power = 10.0 ** np.floor(np.log10(size / 100.0))
        return float(power * max(k for k in (1.0, 2.0, 5.0) if k * power <= size / 100.0))

    def to_worst(self) -> None:
        """Take the platform to the worst pose."""
        worst = self.answers.get("worst")
        if worst is not None and worst.place is not None:
            self._move_to(worst.place, False)

    def to_pose(self) -> None:
        """Take the platform to the pose of the study."""
        if self.session is not None and self.session.study is not None:
            pose = self.session.study.pose
            if pose is not None:
                self._move_to(pose.place, False)

    def keep_pose(self) -> None:
        """Write the place of the platform into the study."""
        if self.session is not None:
            for fault in self.session.keep_pose():
                self.tell(str(fault))
            self.refresh_fields()
            self.changed()

    # Map and ropes

    def _choose(self, rope: Rope | Assignment | None) -> None:
        assert self.session is not None
        self.session.choose(rope)
        self.ropes.show_ropes(self.answers.get("ropes"), rope)
        self.changed()
        self.work.choose_quantity("diameter" if rope is None else "utilisation")

    def _move_slice(self, share: float, moving: bool) -> None:
        self.live.ask_slice(share, moving=moving)

    def _want_quantity(self, key: str) -> None:
        self.live.quantity = key
        shown = self.work.map
        if shown is not None and any(key not in values for values in shown.values.values()):
            self.live.ask_map()
        self.menus.refresh()

    # A, and measured data

    def _present(self) -> Pin | None:
        """The present state with what is known of it."""
        session, known = self.session, self.answers.get
        question = None if session is None else session.question()
        if session is None or question is None:
            return None
        return Pin(question, session.fields(), known("here"), known("worst"), known("ropes"))

    def pin(self) -> None:
        """Keep the present state as A."""
        if self.session is not None:
            self.session.set_pin(self._present())
            self._pin_changed()

    def release(self) -> None:
        """Compare with nothing any more."""
        if self.session is not None:
            self.session.set_pin(None)
            self._pin_changed()

    def _pin_changed(self) -> None:
        self._show_differences()
        self._want_difference(self.compare.in_map.isChecked())
        self.menus.refresh()

    def _show_differences(self) -> None:
        pin = None if self.session is None else self.session.state.pin
        now = self._present()
        found = compare(pin, now) if isinstance(pin, Pin) and now is not None else None
        self.compare.show_differences(found)

    def _want_difference(self, wanted: bool) -> None:
        pin = None if self.session is None else self.session.state.pin
        against = pin.question if wanted and isinstance(pin, Pin) else None
        if against is not self.live.against:
            self.live.against = against
            self.live.ask_map()

    def _take_over(self, text: str) -> None:
        assert self.session is not None
        self.session.set_pin(self._present())
        self.session.set_text(text)
        self.refresh_fields()
        self.changed()
        self.docks["Compare"].raise_()

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
        elif kind == "residuals":
            self.measured.show_residuals(answer)
            self._show_rows(self.measured.in_scene.isChecked())
        elif kind == "diagnose":
            self.measured.show_diagnosis(answer)
        elif kind == "export":
            self.keeping.written(answer)
        self._show_differences()
        self.menus.refresh()

    def _take_ropes(self, ropes: Any) -> None:
        session = self.session
        assert session is not None
        self.answers["ropes"] = ropes
        is_first = "first ropes" not in self.answers
        self.answers["first ropes"] = True
        if is_first and session.state.rope is None and ropes.best is not None:
            session.begin_with(ropes.best)
            self.changed()
        self.ropes.show_ropes(ropes, session.state.rope)

    def _failed(self, kind: str, text: str) -> None:
        self.tell(f"{_NAMES.get(kind, kind)}: {text}")

    def tell(self, text: str) -> None:
        """Write a message where it stays, and show it."""
        self.messages.appendPlainText(text)
        self.statusBar().showMessage(text.splitlines()[0] if text else "", 15_000)

    # Work

    def begin_long(self, kind: Kind, **options: Any) -> None:
        """Begin long work, with progress and a button that ends it."""
        if self.live.question is not None:
            self.long.begin(kind, _NAMES[kind])
            self.live.ask_long(kind, **options)

    def _show_busy(self) -> None:
        busy = self.live.busy
        short = sorted({_NAMES[kind] for kind in busy if kind not in LONG})
        self.busy.setText(f"solving {', '.join(short)} …" if short else "")
        if self.long.kind and self.long.kind not in busy:
            self.long.end(self.long.kind)

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
