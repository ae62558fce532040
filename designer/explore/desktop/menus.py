"""The menu bar: what can be done, with its keys, and what can be done right now."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

from PySide6.QtGui import QAction
from PySide6.QtWidgets import QDockWidget, QMenu

from designer.explore.desktop import theme as themes
from designer.explore.desktop.actions import Entry, choices, fill
from designer.explore.quantities import QUANTITIES
from designer.resources import example_file, example_names

if TYPE_CHECKING:
    from designer.explore.desktop.window import Window


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
            self._menu("&Help", "help menu"),
            Entry("keys", "&Mouse, keys and quantities", "F1", "What they do and are",
                  window.show_help),
        )  # fmt: skip

    def _menu(self, title: str, name: str) -> QMenu:
        menu = self._window.menuBar().addMenu(title)
        menu.setObjectName(name)
        return menu

    def _file_menu(self) -> None:
        window, files = self._window, self._window.files
        menu = self._menu("&File", "file menu")
        self._add(
            menu,
            Entry("open", "&Open …", "Ctrl+O", "Open a study", files.ask_and_open),
        )
        self._recent = menu.addMenu("Open &recent")
        self._recent.aboutToShow.connect(self._show_recent)
        shipped = menu.addMenu("Open a &shipped study")
        for name in example_names():
            action = shipped.addAction(name)
            action.triggered.connect(lambda _=False, name=name: files.open(example_file(name)))
        self._add(
            menu,
            None,
            Entry("save", "&Save", "Ctrl+S", "Save the study, its comments kept", files.save),
            Entry("save as", "Save &as …", "Ctrl+Shift+S", "Save another file", files.save_as),
            Entry("reload", "Re&load", "F5", "Take what the file holds now", files.reload),
            None,
        )
        self._add(
            menu.addMenu("E&xport"),
            Entry("export report", "&Report …", "Ctrl+R", "All that the command writes",
                  window.keeping.report),
            Entry("export picture", "&Picture …", "Ctrl+Shift+P", "The scene as it is seen",
                  window.keeping.picture),
            Entry("export tables", "&Tables …", "Ctrl+Shift+T", "Cables, map and ropes as CSV",
                  window.keeping.tables),
            Entry("export map", "&Map for ParaView …", "Ctrl+Shift+M", "The map as a VTK grid",
                  window.keeping.map_file),
        )  # fmt: skip
        self._add(
            menu,
            None,
            Entry("text", "Study as &text", "Ctrl+E", "Edit the file itself", window.show_text),
            Entry("scene", "S&cene", "Ctrl+Return", "Back to the scene", window.show_work),
            None,
            Entry("close study", "&Close the study", "Ctrl+W", "To the start page", files.close),
            Entry("quit", "&Quit", "Ctrl+Q", "End the program", window.close),
        )

    def _edit_menu(self) -> None:
        window = self._window
        self._add(
            self._menu("&Edit", "edit menu"),
            Entry("undo", "&Undo", "Ctrl+Z", "Take back the last step", window.editing.undo),
            Entry("redo", "&Redo", "Ctrl+Shift+Z", "Do it again", window.editing.redo),
            None,
            Entry(
                "put all back",
                "&Put everything back",
                "",
                "Make the whole study as the file has it",
                window.editing.put_all_back,
            ),
        )

    def _view_menu(self) -> None:
        window, work = self._window, self._window.work
        menu = self._menu("&View", "view menu")
        colours = menu.addMenu("&Colour by")
        colours.setObjectName("quantity")
        names = [(q.key, q.title, f"Ctrl+{k}") for k, q in enumerate(QUANTITIES, start=1)]
        self.quantities = choices(window, colours, names, work.choose_quantity)
        for quantity in QUANTITIES:
            self.quantities[quantity.key].setToolTip(quantity.definition)
        self._add(
            menu,
            None,
            *(
                Entry(f"look {where}", text, keys, tip, partial(work.look, where))
                for where, text, keys, tip in (
                    ("home", "&Whole scene", "Home", "Look at everything from where it is clear"),
                    ("top", "From &above", "Ctrl+Alt+T", "Look down"),
                    ("front", "From the &front", "Ctrl+Alt+F", "Look along y"),
                    ("side", "From the &side", "Ctrl+Alt+S", "Look along x, against it"),
                )
            ),
            None,
        )
        look = menu.addMenu("&Theme")
        look.setObjectName("theme")
        titles = {"system": "As the system", "light": "Light", "dark": "Dark"}
        options = [(name, titles[name], "") for name in themes.CHOICES]
        self.themes = choices(window, look, options, window.put_on)
        panels = menu.addMenu("&Panels")
        for name in window.docks:
            shown = name not in window.settings.hidden_panels
            action = QAction(name, window, checkable=True, checked=shown)
            action.setObjectName(f"panel {name}")
            action.toggled.connect(window.panels_changed)
            panels.addAction(action)
            self.actions[f"panel {name}"] = action

    def _platform_menu(self) -> None:
        window = self._window
        self._add(
            self._menu("&Platform", "platform menu"),
            Entry("to worst", "To the &worst pose", "Ctrl+G", "Where most is asked of the rope",
                  window.moving.to_worst),
            Entry("to pose", "To the &pose of the study", "Ctrl+Shift+G", "As configured",
                  window.moving.to_pose),
            None,
            Entry("pin", "P&in this state as A", "Ctrl+D", "Compare with it from now on",
                  window.comparing.pin),
            Entry("release", "&Release A", "Ctrl+Shift+D", "Compare with nothing",
                  window.comparing.release),
            None,
            Entry("keep pose", "&Keep as the pose of the study", "Ctrl+K",
                  "Writes this place under `pose`", window.moving.keep),
        )  # fmt: skip

    def _add(self, menu: QMenu, *entries: Entry | None) -> None:
        self.actions |= fill(self._window, menu, entries)

    def _show_recent(self) -> None:
        self._recent.clear()
        for path in self._window.settings.recent:
            action = self._recent.addAction(f"{path.stem}  —  {path.parent}")
            action.triggered.connect(lambda _=False, path=path: self._window.files.open(path))
        if self._recent.isEmpty():
            self._recent.addAction("none yet").setEnabled(False)

    def wants_dock(self, dock: QDockWidget) -> bool:
        """Whether a panel is to be seen where the scene is."""
        return self.actions[f"panel {dock.windowTitle()}"].isChecked()

    def refresh(self) -> None:
        """Allow what can be done now."""
        window, session = self._window, self._window.session
        has_study = session is not None and session.study is not None
        at_work = has_study and window.pages.currentWidget() is window.work
        allowed = {
            "save": session is not None,
            "save as": session is not None,
            "reload": session is not None and session.file is not None,
            "text": session is not None and window.pages.currentWidget() is not window.text,
            "scene": has_study and not at_work,
            "close study": session is not None,
            "undo": session is not None and session.can_undo,
            "redo": session is not None and session.can_redo,
            "put all back": session is not None and session.is_modified,
            "to worst": at_work and getattr(window.answers.get("worst"), "place", None) is not None,
            "to pose": at_work and session is not None and session.study is not None
            and session.study.pose is not None,
            "keep pose": at_work,
            "pin": at_work,
            "release": session is not None and session.state.pin is not None,
            **{f"export {what}": at_work for what in ("report", "picture", "tables", "map")},
            **{f"look {where}": at_work for where in ("home", "top", "front", "side")},
        }  # fmt: skip
        for name, is_so in allowed.items():
            self.actions[name].setEnabled(bool(is_so))
        if session is not None:
            self.actions["undo"].setText(f"&Undo {session.undo_label.lower()}".rstrip())
            self.actions["redo"].setText(f"&Redo {session.redo_label.lower()}".rstrip())
        for action in self.quantities.values():
            action.setEnabled(at_work)
        has_rope = session is not None and session.state.rope is not None
        self.quantities["utilisation"].setEnabled(bool(at_work and has_rope))
        self.quantities[str(window.work.quantity.currentData())].setChecked(True)
        self.themes[window.settings.theme].setChecked(True)
