"""The main window: menus, pages, panels and status bar, which follow the study by its signals."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING

from PySide6.QtCore import Qt
from PySide6.QtGui import QAction, QActionGroup, QCloseEvent, QKeySequence
from PySide6.QtWidgets import (
    QApplication,
    QDialog,
    QDialogButtonBox,
    QDockWidget,
    QHBoxLayout,
    QLabel,
    QMainWindow,
    QMenu,
    QMessageBox,
    QPlainTextEdit,
    QProgressBar,
    QStackedWidget,
    QStatusBar,
    QTextBrowser,
    QToolButton,
    QVBoxLayout,
    QWidget,
)

from designer import __version__
from designer.explore.desktop.files import Files, Settings
from designer.explore.desktop.live_session import LONG, NAMES, LiveSession
from designer.explore.desktop.pages import StartPage
from designer.explore.desktop.widgets import THEME_CHOICES, apply_theme, fill, named, theme_named
from designer.explore.quantities import QUANTITIES
from designer.resources import example_file, example_names

if TYPE_CHECKING:
    from designer.explore.export import ExportContent
    from designer.explore.question import Long

_KEY = QKeySequence.StandardKey
_VIEWS = (
    ("home", "&Whole scene", "Home", "Look at everything from where it is clear"),
    ("top", "From &above", "Ctrl+Alt+T", "Look down"),
    ("front", "From the &front", "Ctrl+Alt+F", "Look along y"),
    ("side", "From the &side", "Ctrl+Alt+S", "Look along x, against it"),
)
_EXPORTS: tuple[tuple[str, ExportContent, str, str, str], ...] = (
    ("report", "report", "&Report …", "Ctrl+R", "All that the command writes"),
    ("picture", "picture", "&Picture …", "Ctrl+Shift+P", "The scene as it is seen"),
    ("tables", "tables", "&Tables …", "Ctrl+Shift+T", "Cables, map and ropes as CSV"),
    ("map", "vtk", "&Map for ParaView …", "Ctrl+Shift+M", "The map as a VTK grid"),
    ("path lengths", "lengths", "&Lengths along the path …", "", "Set-points for the winches"),
    ("workshop", "csv", "&Workshop …", "", "Rows of ropes, lengths to cut and drums"),
    ("CASPR", "caspr", "&CASPR …", "", "A model of CASPR"),
    ("MoorDyn", "moordyn", "Moor&Dyn …", "", "A deck of MoorDyn, which MoorPy reads too"),
    ("MuJoCo", "mujoco", "M&uJoCo …", "", "An MJCF model"),
    ("glTF", "gltf", "&glTF …", "", "What the report draws in space"),
)
PANELS = ("Study", "This pose", "Ropes", "Requirements", "Compare", "Measured data", "Messages")
_THEMES = {"system": "As the system", "light": "Light", "dark": "Dark"}
HINT = (
    "Drag the ring to move the platform, its arrow to lift it; click the map to go there; "
    "F1 for all keys"
)
KEYS = (
    ("Drag the ring around the platform", "moves it in its level (a planar robot in its plane)"),
    ("Drag the arrow above the ring", "lifts and lowers it"),
    (
        "Drag an exit point",
        "moves it in its level, and edits the study; it takes the coordinates "
        "of other exit points and of a grid, unless Ctrl is held",
    ),
    ("Click on an exit point", "gives it an arrow, which lifts and lowers it"),
    ("Click on the map", "takes the platform there"),
    ("Ctrl + M", "measures the distance between two points that are clicked"),
    ("Ctrl + P", "plays the path of the study"),
    ("Arrow keys", "move it along the axis of the frame that is nearest to that direction"),
    ("Page Up, Page Down", "lift and lower it"),
    ("Ctrl + these keys", "turn a platform that can turn, by one degree"),
    ("Shift + these keys", "ten steps at once"),
    ("Drag elsewhere", "turns the view; with Shift or the right button shifts it"),
    ("Wheel", "zooms at the mouse"),
    ("Home", "looks at everything again"),
    ("Ctrl + 1 … 8", "choose what the map is coloured by"),
)


@dataclass(frozen=True, slots=True)
class Command:
    """An entry of a menu; ``run`` is called when it is chosen, ``standard`` are the system's keys.

    Not every system has keys for every standard: ``keys`` work on all.
    """

    name: str
    text: str
    keys: str
    tip: str
    run: Callable[[], object]
    standard: QKeySequence.StandardKey = _KEY.UnknownKey

    def shortcuts(self) -> list[QKeySequence]:
        """Return the keys, those of the system in front."""
        keys = QKeySequence.keyBindings(self.standard)
        fallback = QKeySequence(self.keys)
        return keys if fallback in keys or fallback.isEmpty() else [*keys, fallback]


class Menus:
    """All actions of the window by their names."""

    def __init__(self, window: Window) -> None:
        self._window = window
        self.actions: dict[str, QAction] = {}
        live = window.live
        self._file_menu()
        self._add(
            self._menu("&Edit", "edit menu"),
            Command("undo", "&Undo", "Ctrl+Z", "Take back the last step",
                    lambda: live.do(lambda session: session.undo()), _KEY.Undo),
            Command("redo", "&Redo", "Ctrl+Shift+Z", "Do it again",
                    lambda: live.do(lambda session: session.redo()), _KEY.Redo),
            None,
            Command("put all back", "&Put everything back", "",
                    "Make the whole study as the file has it", live.put_all_back),
        )  # fmt: skip
        self._view_menu()
        self._add(
            self._menu("&Platform", "platform menu"),
            Command("to worst", "To the &worst pose", "Ctrl+G",
                    "Where the rope's utilisation is largest", live.to_worst),
            Command("to pose", "To the &pose of the study", "Ctrl+Shift+G", "As configured",
                    live.to_pose),
            None,
            Command("pin", "P&in this state as A", "Ctrl+D", "Compare with it from now on",
                    live.pin),
            Command("release", "&Release A", "Ctrl+Shift+D", "Compare with nothing", live.release),
            None,
            Command("keep pose", "&Keep as the pose of the study", "Ctrl+K",
                    "Writes this place under `pose`", live.keep_pose),
        )  # fmt: skip
        self._add(
            self._menu("&Tools", "tools menu"),
            Command("optimise", "&Optimise …", "Ctrl+Shift+O",
                    "Choose fields of the study, as a plan says, for the best result",
                    window.files.optimise),
            Command("sweep", "S&weep …", "Ctrl+Shift+W",
                    "Solve the study for all values of a plan, and report them",
                    window.files.sweep),
        )  # fmt: skip
        self._add(
            self._menu("&Help", "help menu"),
            Command("keys", "&Mouse, keys and quantities", "F1", "What they do and are",
                    lambda: Help(window).show(), _KEY.HelpContents),
            Command("about", "&About cdpr-designer", "", "Version and licence",
                    lambda: show_about(window)),
        )  # fmt: skip
        for signal in (live.changed, live.moved, live.answered, live.quantity_changed):
            signal.connect(self.refresh)

    def _menu(self, title: str, name: str) -> QMenu:
        menu = self._window.menuBar().addMenu(title)
        menu.setObjectName(name)
        return menu

    def _file_menu(self) -> None:
        window, files = self._window, self._window.files
        menu = self._menu("&File", "file menu")

        def export(content: ExportContent) -> None:
            if content == "picture":
                files.save_picture(window.work.scene)
            else:
                files.export(content)

        self._add(
            menu,
            Command("new", "&New", "Ctrl+N", "A study with a comment to every field",
                    files.new, _KEY.New),
            Command("open", "&Open …", "Ctrl+O", "Open a study", files.ask_and_open, _KEY.Open),
        )  # fmt: skip
        self._recent = menu.addMenu("Open &recent")
        self._recent.aboutToShow.connect(self._show_recent)
        shipped = menu.addMenu("Open a &shipped study")
        for name in example_names():
            action = shipped.addAction(name)
            action.triggered.connect(lambda _=False, name=name: files.open(example_file(name)))
        self._add(
            menu,
            Command("import", "&Import …", "Ctrl+I", "A robot of CASPR or WireX as a study",
                    files.ask_and_import),
            None,
            Command("save", "&Save", "Ctrl+S", "Save the study, its comments kept",
                    files.save, _KEY.Save),
            Command("save as", "Save &as …", "Ctrl+Shift+S", "Save another file",
                    files.save_as, _KEY.SaveAs),
            Command("reload", "Re&load", "F5", "Take what the file holds now",
                    files.reload, _KEY.Refresh),
            None,
        )  # fmt: skip
        self._add(
            menu.addMenu("E&xport"),
            *(
                Command(f"export {name}", text, keys, tip, partial(export, content))
                for name, content, text, keys, tip in _EXPORTS
            ),
            Command("export lengths", "Lengths at &poses …", "", "At the poses of a table",
                    files.export_lengths),
        )  # fmt: skip
        self._add(
            menu,
            None,
            Command("text", "Study as &text", "Ctrl+E", "Edit the file itself", window.show_text),
            Command("scene", "S&cene", "Ctrl+Return", "Back to the scene", window.show_work),
            None,
            Command("close study", "&Close the study", "Ctrl+W", "To the start page",
                    files.close, _KEY.Close),
            Command("quit", "&Quit", "Ctrl+Q", "End the program", window.close, _KEY.Quit),
        )  # fmt: skip

    def _view_menu(self) -> None:
        window = self._window
        menu = self._menu("&View", "view menu")
        colours = menu.addMenu("&Colour by")
        colours.setObjectName("quantity")
        names = [(q.key, q.title, f"Ctrl+{k}") for k, q in enumerate(QUANTITIES, start=1)]
        self.quantities = self._options(colours, names, window.live.colour_by)
        for quantity in QUANTITIES:
            self.quantities[quantity.key].setToolTip(quantity.definition)

        def look_from(view: str) -> None:
            window.work.look(view)

        views = (
            Command(f"look {view}", text, keys, tip, partial(look_from, view))
            for view, text, keys, tip in _VIEWS
        )
        self._add(menu, None, *views, None)
        look = menu.addMenu("&Theme")
        look.setObjectName("theme")
        options = [(name, _THEMES[name], "") for name in THEME_CHOICES]
        self.themes = self._options(look, options, window.apply_theme)
        panels = menu.addMenu("&Panels")
        for name in PANELS:
            is_shown = name not in window.settings.hidden_panels
            action = QAction(name, window, checkable=True, checked=is_shown)
            action.setObjectName(f"panel {name}")
            action.toggled.connect(window.show_panels)
            panels.addAction(action)
            self.actions[f"panel {name}"] = action

    def _add(self, menu: QMenu, *commands: Command | None) -> None:
        """Put commands into a menu; None is a line between them."""
        menu.setToolTipsVisible(True)
        for command in commands:
            if command is None:
                menu.addSeparator()
                continue
            action = QAction(command.text, self._window)
            action.setObjectName(command.name)
            action.setShortcuts(command.shortcuts())
            action.setToolTip(command.tip)
            action.setStatusTip(command.tip)
            action.triggered.connect(lambda _=False, run=command.run: run())
            menu.addAction(action)
            self.actions[command.name] = action

    def _options(
        self,
        menu: QMenu,
        options: Iterable[tuple[str, str, str]],
        choose: Callable[[str], object],
    ) -> dict[str, QAction]:
        """Put options (name, text, keys) into a menu, one of which is on."""
        group = QActionGroup(self._window)
        actions = {}
        for name, text, keys in options:
            action = QAction(text, self._window, checkable=True)
            action.setObjectName(f"{menu.objectName()} {name}")
            action.setShortcut(QKeySequence(keys))
            action.triggered.connect(lambda _=False, name=name: choose(name))
            group.addAction(action)
            menu.addAction(action)
            actions[name] = action
        return actions

    def _show_recent(self) -> None:
        self._recent.clear()
        for path in self._window.settings.recent:
            action = self._recent.addAction(f"{path.stem}  —  {path.parent}")
            action.triggered.connect(lambda _=False, path=path: self._window.files.open(path))
        if self._recent.isEmpty():
            self._recent.addAction("none yet").setEnabled(False)

    def wants_panel(self, name: str) -> bool:
        """Whether a panel is to be seen where the scene is."""
        return self.actions[f"panel {name}"].isChecked()

    def refresh(self) -> None:
        window, live = self._window, self._window.live
        session, study, page = live.session, live.study, window.pages.currentWidget()
        at_work = study is not None and page is window.work
        allowed = {
            **dict.fromkeys(("save", "save as", "close study"), session is not None),
            "reload": session is not None and session.file is not None,
            "text": session is not None and page is not window.text,
            "scene": study is not None and not at_work,
            "undo": session is not None and bool(session.undo_label),
            "redo": session is not None and bool(session.redo_label),
            "put all back": session is not None and session.is_modified,
            "to worst": at_work and getattr(live.answers.get("worst"), "place", None) is not None,
            "to pose": at_work and study is not None and study.pose is not None,
            **dict.fromkeys(("keep pose", "pin", "optimise", "sweep"), at_work),
            "release": live.pinned is not None,
            **{f"export {name}": at_work for name, *_ in _EXPORTS},
            "export lengths": at_work,
            "export path lengths": at_work
            and study is not None
            and study.robot.platform.motion is not None,
            **{f"look {view}": at_work for view, *_ in _VIEWS},
        }
        for name, is_allowed in allowed.items():
            self.actions[name].setEnabled(is_allowed)
        if session is not None:
            self.actions["undo"].setText(f"&Undo {session.undo_label.lower()}".rstrip())
            self.actions["redo"].setText(f"&Redo {session.redo_label.lower()}".rstrip())
        for key, action in self.quantities.items():
            action.setEnabled(at_work and (key != "utilisation" or live.rope is not None))
        self.quantities[live.quantity].setChecked(True)
        self.themes[window.settings.theme].setChecked(True)


class Help(QDialog):
    """A page of keys and definitions."""

    def __init__(self, parent: QWidget) -> None:
        super().__init__(parent)
        self.setObjectName("help")
        self.setWindowTitle("Mouse, keys and quantities")
        self.resize(620, 560)
        page = QTextBrowser()
        rows = "".join(f"<tr><td><b>{k}</b></td><td>{effect}</td></tr>" for k, effect in KEYS)
        terms = "".join(
            f"<p><b>{q.title}{f' [{q.unit}]' if q.unit else ''}.</b> {q.definition}</p>"
            for q in QUANTITIES
        )
        page.setHtml(f"<table cellpadding='3'>{rows}</table><hr>{terms}")
        buttons = QDialogButtonBox(QDialogButtonBox.StandardButton.Close)
        buttons.rejected.connect(self.reject)
        column = QVBoxLayout(self)
        column.addWidget(page)
        column.addWidget(buttons)


def show_about(parent: QWidget) -> None:
    text = f"cdpr-designer {__version__}\n\nCables of large cable-driven parallel robots."
    QMessageBox.about(parent, "About cdpr-designer", text)


_HINT_MS = 20_000  #: The hint stays longer than a message: a newcomer looks at the scene first
_MESSAGE_MS = 15_000  #: Long enough to be read twice; what matters stays among the messages
_AREAS = {
    "Study": Qt.DockWidgetArea.LeftDockWidgetArea,
    "This pose": Qt.DockWidgetArea.RightDockWidgetArea,
}
_BELOW = Qt.DockWidgetArea.BottomDockWidgetArea
_SIDES_PX = (252, 400)
"""The narrowest in which entries with sliders, and the table of cables, are read in full."""
_BELOW_SHARE = 0.36
"""Of the window's height: at 900 pixels the table of ropes has some six rows below its filters."""


class Window(QMainWindow):
    """Everything that stands in the window; `LiveSession` holds the study and the answers."""

    def __init__(self, settings: Settings, *, with_plugins: bool = True) -> None:
        super().__init__()
        self.setObjectName("window")
        self.settings, self.live = settings, LiveSession()
        self.files = Files(self, self.live, settings, with_plugins=with_plugins)
        self.start = StartPage(settings)
        self.messages = named(QPlainTextEdit(readOnly=True), "messages")
        self.messages.setMaximumBlockCount(500)  # a session of days shall not fill the memory
        self.messages.setTabChangesFocus(True)
        self.pages = QStackedWidget()
        self.pages.addWidget(self.start)
        self.setCentralWidget(self.pages)
        self.docks: dict[str, QDockWidget] = {}
        self.status = StatusBar(self.live)
        self.setStatusBar(self.status)
        self.menus = Menus(self)
        live, files, start = self.live, self.files, self.start
        live.opened.connect(self._show_opened)
        live.changed.connect(self._show_modified)
        live.message.connect(self.messages.appendPlainText)
        start.chosen.connect(files.open)
        start.asks_for_file.connect(files.ask_and_open)
        start.asks_for_new.connect(files.new)
        start.asks_to_import.connect(files.ask_and_import)
        files.opening.connect(self._begin_to_open)
        files.not_opened.connect(start.show_recent)
        self.resize(1280, 800)
        self.restoreGeometry(settings.bytes_of("geometry"))
        self.apply_theme(settings.theme)
        hints = QApplication.styleHints()
        hints.colorSchemeChanged.connect(lambda _: self.apply_theme(settings.theme))
        self._show_page(start)

    def create_panels(self) -> None:
        """Make what a study is shown in, once: its libraries take longer than the start page."""
        if self.docks:
            return
        from designer.explore.desktop.pages import TextPage
        from designer.explore.desktop.panel_pose import PanelPose
        from designer.explore.desktop.panel_study import PanelStudy
        from designer.explore.desktop.panels_below import (
            PanelCompare,
            PanelMeasured,
            PanelRequirements,
            PanelRopes,
        )
        from designer.explore.desktop.work_page import WorkPage

        live, files = self.live, self.files
        self.work, self.text = WorkPage(live), TextPage(live)
        for page in (self.work, self.text):
            self.pages.addWidget(page)
        self.study_panel, self.pose, self.ropes = (
            PanelStudy(live),
            PanelPose(live),
            PanelRopes(live),
        )
        self.requirements, self.compare = PanelRequirements(live), PanelCompare(live)
        self.measured, docks = PanelMeasured(live), self.docks
        panels = (self.study_panel, self.pose, self.ropes, self.requirements, self.compare)
        for title, panel in zip(PANELS, (*panels, self.measured, self.messages), strict=True):
            dock = QDockWidget(title, self)
            dock.setObjectName(f"dock {title}")
            dock.setFeatures(dock.features() & ~QDockWidget.DockWidgetFeature.DockWidgetClosable)
            dock.setWidget(panel)
            self.addDockWidget(_AREAS.get(title, _BELOW), dock)
            docks[title] = dock
            if title not in (*_AREAS, "Ropes"):  # those below the scene share one place
                self.tabifyDockWidget(docks["Ropes"], dock)
        docks["Ropes"].raise_()
        self.setCorner(Qt.Corner.BottomLeftCorner, _AREAS["Study"])
        self.setCorner(Qt.Corner.BottomRightCorner, _BELOW)  # tables are wide
        files.notice.connect(self.work.show_notice)
        self.work.notice_answered.connect(files.answer_notice)
        self.text.asks_to_reload.connect(files.reload)
        self.text.asks_to_leave.connect(self.show_work)
        self.measured.rows_wanted.connect(self.work.want_rows)
        self.pose.modes.moves_in_scene.connect(self.work.play_mode)
        live.taken_over.connect(self.docks["Compare"].raise_)
        self.restoreState(self.settings.bytes_of("layout"))
        self._show_page(self.start)
        self.work.follow_theme()

    # Pages

    def _begin_to_open(self, name: str) -> None:
        """Say so at once, since what a study is shown in may have to be made first."""
        if not self.docks:
            self.status.showMessage(f"Opening {name} …")
            self.status.repaint()
            self.create_panels()

    def _show_opened(self) -> None:
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
        self._show_page(self.text)
        self.text.editor.setFocus()

    def _show_page(self, page: QWidget) -> None:
        self.pages.setCurrentWidget(page)
        study = self.live.study
        has_data = study is not None and study.measurements is not None
        at_work = bool(self.docks) and page is self.work
        for name, dock in self.docks.items():
            has_any = name != "Measured data" or has_data
            dock.setVisible(at_work and has_any and self.menus.wants_panel(name))
        if at_work and self.settings.bytes_of("layout").isEmpty():
            sides = [self.docks["Study"], self.docks["This pose"]]
            self.resizeDocks(sides, list(_SIDES_PX), Qt.Orientation.Horizontal)
            below = round(_BELOW_SHARE * self.height())
            self.resizeDocks([self.docks["Ropes"]], [below], Qt.Orientation.Vertical)
        self.menus.refresh()

    def show_panels(self) -> None:
        """Show the panels that are wanted, and remember which are not."""
        wants = self.menus.wants_panel
        self.settings.hidden_panels = [name for name in PANELS if not wants(name)]
        page = self.pages.currentWidget()
        assert page is not None
        self._show_page(page)

    def _show_modified(self) -> None:
        session = self.live.session
        self.setWindowModified(session is not None and session.is_modified)

    # Look, and the end

    def apply_theme(self, choice: str) -> None:
        self.settings.theme = choice
        app = QApplication.instance()
        assert isinstance(app, QApplication)
        apply_theme(app, theme_named(choice))
        if self.docks:
            self.work.follow_theme()
        self.menus.refresh()

    def closeEvent(self, event: QCloseEvent) -> None:
        if not self.files.may_leave():
            event.ignore()
            return
        self.files.watch.stop()
        self.settings.keep_bytes("geometry", self.saveGeometry())
        if self.docks and self.pages.currentWidget() is self.work:
            self.settings.keep_bytes("layout", self.saveState())
        if self.docks:  # nothing moves any more
            self.pose.modes.close()
            self.work.plays_path.setChecked(False)
        self.live.close()
        if self.docks:
            self.work.scene.close()
        event.accept()


class StatusBar(QStatusBar):
    """Follows the work on the open study."""

    def __init__(self, live: LiveSession) -> None:
        super().__init__()
        self._live = live
        self._busy, self.long = named(QLabel(), "busy"), LongWork(live)
        self.addPermanentWidget(self._busy)
        self.addPermanentWidget(self.long)
        live.busy_changed.connect(self._show_busy)
        live.message.connect(lambda text: self.showMessage(text.partition("\n")[0], _MESSAGE_MS))

    def _show_busy(self) -> None:
        short = sorted({NAMES[kind] for kind in self._live.busy if kind not in LONG})
        self._busy.setText(f"solving {', '.join(short)} …" if short else "")


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
        cancel.clicked.connect(lambda: None if self._kind is None else live.cancel(self._kind))
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

    def _progress(self, kind: str, task: str, steps: int, total: int) -> None:
        if kind == self._kind:
            self._task.setText(task)
            self._bar.setRange(0, max(total, 0))
            self._bar.setValue(steps)

    def _end(self) -> None:
        if self._kind is None or self._kind in self._live.busy:
            return
        running = [kind for kind in LONG if kind in self._live.busy]
        if running:
            self._begin(running[0])
        else:
            self._kind = None
            self.hide()
