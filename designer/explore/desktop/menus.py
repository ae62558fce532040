"""The menu bar: every action with its name, its keys and what it does; what is possible; help."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING

from PySide6.QtGui import QAction, QActionGroup, QKeySequence
from PySide6.QtWidgets import (
    QDialog,
    QDialogButtonBox,
    QMenu,
    QMessageBox,
    QTextBrowser,
    QVBoxLayout,
    QWidget,
)

from designer import __version__
from designer.explore.desktop import theme as themes
from designer.explore.quantities import QUANTITIES
from designer.resources import example_file, example_names

if TYPE_CHECKING:
    from designer.explore.desktop.window import Window
    from designer.explore.export import What

_KEY = QKeySequence.StandardKey
_VIEWS = (
    ("home", "&Whole scene", "Home", "Look at everything from where it is clear"),
    ("top", "From &above", "Ctrl+Alt+T", "Look down"),
    ("front", "From the &front", "Ctrl+Alt+F", "Look along y"),
    ("side", "From the &side", "Ctrl+Alt+S", "Look along x, against it"),
)
_EXPORTS: tuple[tuple[str, What, str, str, str], ...] = (
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
PANELS = ("Study", "Here", "Ropes", "Requirements", "Compare", "Measured data", "Messages")
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
    ("Ctrl + 1 … 7", "choose what the map is coloured by"),
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
        self._file_menu()
        self._edit_menu()
        self._view_menu()
        self._platform_menu()
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
        for signal in (window.live.changed, window.live.moved, window.live.answered):
            signal.connect(self.refresh)
        window.live.quantity_changed.connect(self.refresh)

    def _menu(self, title: str, name: str) -> QMenu:
        menu = self._window.menuBar().addMenu(title)
        menu.setObjectName(name)
        return menu

    def _file_menu(self) -> None:
        window, files = self._window, self._window.files
        menu = self._menu("&File", "file menu")
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
                Command(f"export {name}", text, keys, tip,
                        partial(self._export, content))
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

    def _edit_menu(self) -> None:
        live = self._window.live
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

    def _view_menu(self) -> None:
        window = self._window
        menu = self._menu("&View", "view menu")
        colours = menu.addMenu("&Colour by")
        colours.setObjectName("quantity")
        names = [(q.key, q.title, f"Ctrl+{k}") for k, q in enumerate(QUANTITIES, start=1)]
        self.quantities = self._options(colours, names, window.live.colour_by)
        for quantity in QUANTITIES:
            self.quantities[quantity.key].setToolTip(quantity.definition)
        views = (
            Command(f"look {view}", text, keys, tip, partial(self._look, view))
            for view, text, keys, tip in _VIEWS
        )
        self._add(menu, None, *views, None)
        look = menu.addMenu("&Theme")
        look.setObjectName("theme")
        options = [(name, _THEMES[name], "") for name in themes.CHOICES]
        self.themes = self._options(look, options, window.put_on)
        panels = menu.addMenu("&Panels")
        for name in PANELS:
            is_shown = name not in window.settings.hidden_panels
            action = QAction(name, window, checkable=True, checked=is_shown)
            action.setObjectName(f"panel {name}")
            action.toggled.connect(window.show_panels)
            panels.addAction(action)
            self.actions[f"panel {name}"] = action

    def _platform_menu(self) -> None:
        live = self._window.live
        self._add(
            self._menu("&Platform", "platform menu"),
            Command("to worst", "To the &worst pose", "Ctrl+G", "Where most is asked of the rope",
                    live.to_worst),
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

    def _export(self, content: What) -> None:
        if content == "picture":
            self._window.files.save_picture(self._window.work.scene)
        else:
            self._window.files.export(content)

    def _look(self, view: str) -> None:
        self._window.work.look(view)

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
        """Allow what can be done now."""
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
    """Say which program and version this is."""
    text = f"cdpr-designer {__version__}\n\nCables of large cable-driven parallel robots."
    QMessageBox.about(parent, "About cdpr-designer", text)
