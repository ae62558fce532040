"""Files of the window: what is remembered, studies opened, saved and left, imports, plans, exports.

What is not saved is asked about, never lost.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, cast

from PySide6.QtCore import QByteArray, QObject, QSettings, QTimer, QUrl, Signal
from PySide6.QtGui import QDesktopServices
from PySide6.QtWidgets import QFileDialog, QMessageBox, QWidget

from designer.errors import DesignerError
from designer.explore.desktop.live_session import LONG, NAMES, LiveSession
from designer.report import format as fmt
from designer.resources import example_file

if TYPE_CHECKING:
    from designer.explore.export import ExportContent, OptimisedStudy, Written
    from designer.explore.session import Session
    from designer.plugins import Plugins

MAX_RECENT = 8


class Settings:
    """What is remembered, by name; in the user's own settings, or in a file (of a test)."""

    def __init__(self, file: Path | None = None) -> None:
        if file is None:
            self._store = QSettings("cdpr-designer", "explore")
        else:
            self._store = QSettings(str(file), QSettings.Format.IniFormat)

    @property
    def theme(self) -> str:
        return str(self._store.value("theme", "system"))

    @theme.setter
    def theme(self, choice: str) -> None:
        self._store.setValue("theme", choice)

    @property
    def hidden_panels(self) -> tuple[str, ...]:
        names = self._store.value("hidden panels", [])
        return (names,) if isinstance(names, str) else tuple(cast("list[str]", names or []))

    @hidden_panels.setter
    def hidden_panels(self, names: Iterable[str]) -> None:
        self._store.setValue("hidden panels", list(names))

    @property
    def recent(self) -> tuple[Path, ...]:
        """Studies that were open, the last one first; only those that are still there."""
        stored = self._store.value("recent", [])
        names = [stored] if isinstance(stored, str) else cast("list[str]", stored or [])
        return tuple(path for path in map(Path, names) if path.is_file())

    def remember(self, study: Path) -> None:
        path = study.resolve()
        earlier = [study_file for study_file in self.recent if study_file != path]
        names = [str(study_file) for study_file in [path, *earlier][:MAX_RECENT]]
        self._store.setValue("recent", names)

    def bytes_of(self, name: str) -> QByteArray:
        """Return a state of Qt that was kept under this name; empty where none was."""
        state = self._store.value(name)
        return state if isinstance(state, QByteArray) else QByteArray()

    def keep_bytes(self, name: str, state: QByteArray) -> None:
        self._store.setValue(name, state)


_STUDIES = "Studies (*.yaml *.yml);;All files (*)"
_ROBOTS = "Robots of CASPR and WireX (*.xml *.wcrfx);;All files (*)"
_PLANS = "Plans (*.yaml *.yml);;All files (*)"
_POSES = "Poses (*.csv);;All files (*)"
_TITLE = "cdpr-designer"
_STARTER = "fast"  #: The study that has a comment to every field
_EXPORTS: dict[ExportContent, tuple[str, str, str]] = {
    "report": ("Folder for the report", "-report", ""),
    "picture": ("Picture of the scene", ".png", "Pictures (*.png)"),
    "tables": ("Folder for the tables", "-tables", ""),
    "vtk": ("The map for ParaView", "-map.vtu", "VTK grids (*.vtu)"),
    "lengths": ("Lengths of the cables", "-lengths.csv", "Tables (*.csv)"),
    "csv": ("Rows for the workshop", ".csv", "Tables (*.csv)"),
    "caspr": ("Model of CASPR", "_bodies.xml", "Bodies of CASPR (*_bodies.xml)"),
    "moordyn": ("Deck of MoorDyn", ".txt", "Decks of MoorDyn (*.txt)"),
    "mujoco": ("Model of MuJoCo", ".xml", "Models of MuJoCo (*.xml)"),
    "gltf": ("Scenes in space", ".glb", "glTF (*.glb)"),
}
"""Of each export the title of the dialog, how the name ends, and kinds of files; none: a folder."""
_DISK_MS = 2000
"""Between two looks at the file: soon enough for who comes back from another editor."""


class Files(QObject):
    """Dialogs about files, and what follows; plugins are looked for with the first study."""

    notice = Signal(str, tuple)
    """A line that asks for attention, and the names of its buttons; no line for no text."""
    opening = Signal(str)  #: A study of this name is about to be opened
    not_opened = Signal()  #: A study could not be opened, and may be gone

    def __init__(
        self, parent: QWidget, live: LiveSession, settings: Settings, *, with_plugins: bool
    ) -> None:
        super().__init__(parent)
        self._parent, self._live = parent, live
        self._settings, self._with_plugins = settings, with_plugins
        self._disk = "same"
        self._written: tuple[Path, ...] = ()
        self._optimised: OptimisedStudy | None = None
        self.watch = QTimer(self, interval=_DISK_MS)
        self.watch.timeout.connect(self.look_at_disk)
        self.watch.start()
        live.listen(self._show_written, "export", "sweep")
        live.listen(self._show_optimised, "optimise")

    @cached_property
    def _plugins(self) -> Plugins:
        from designer.plugins import find_plugins

        return find_plugins(self._with_plugins)

    # Studies

    def new(self) -> None:
        """Begin a study with a comment to every field."""
        self.open(example_file(_STARTER))

    def ask_and_open(self) -> None:
        name, _ = QFileDialog.getOpenFileName(self._parent, "Open a study", "", _STUDIES)
        if name:
            self.open(Path(name))

    def ask_and_import(self) -> None:
        """Let the user look for a robot of another program, and write it as a study."""
        name, _ = QFileDialog.getOpenFileName(self._parent, "Import a robot", "", _ROBOTS)
        if not name:
            return
        from designer.io.output import write_file
        from designer.plugins import require_ring

        source = Path(name)
        stem = source.stem.removesuffix("_bodies").removesuffix("_cables")
        start = str(source.with_name(f"{stem}.yaml"))
        name, _ = QFileDialog.getSaveFileName(self._parent, "Save the study as", start, _STUDIES)

        def write() -> None:
            require_ring("import")
            from designer.foreign import study as foreign

            importers, _ = foreign.load_importers(self._plugins)
            robot = foreign.read_foreign(source, importers=importers)
            text = foreign.study_text(robot, foreign.ImportAnswers())
            write_file(Path(name), text)  # what the robot's file does not say is to be filled in

        if name and self._succeeds(write, "Not imported"):
            self.open(Path(name))

    def open(self, path: Path) -> None:
        """Open a study, shipped ones as a copy that has no file yet."""
        opened: list[Session] = []
        if not self.may_leave():
            return
        self.opening.emit(path.stem)
        from designer.explore.session import Session

        if not self._succeeds(lambda: opened.append(Session.open(path, self._plugins)), _TITLE):
            self.not_opened.emit()
            return
        if opened[0].file is not None:
            self._settings.remember(path)
        self._disk = "same"
        self._live.open(opened[0])

    def close(self) -> None:
        if self.may_leave():
            self._live.open(None)

    def save(self) -> bool:
        """Save the study; tells whether it was."""
        session = self._live.session
        if session is None:
            return True
        return self.save_as() if session.file is None else self._saved(session.save)

    def save_as(self) -> bool:
        """Save the study under another name; tells whether it was."""
        session = self._live.session
        if session is None:
            return True
        start = str(session.file or Path(f"{session.path.stem}.yaml").resolve())
        name, _ = QFileDialog.getSaveFileName(self._parent, "Save the study as", start, _STUDIES)
        if not name:
            return False
        path = Path(name) if Path(name).suffix else Path(f"{name}.yaml")
        if not self._saved(lambda: session.save_as(path)):
            return False
        self._settings.remember(path)
        return True

    def _saved(self, write: Callable[[], None]) -> bool:
        self._live.flushing.emit()
        if not self._succeeds(write, "Not saved"):
            return False
        self._follow_disk()
        assert self._live.session is not None
        self._live.message.emit(f"Saved {self._live.session.file}")
        return True

    def reload(self) -> None:
        session = self._live.session
        if session is not None:
            try:
                session.reload()
            except DesignerError as error:
                self._live.message.emit(str(error))
                return
            self._follow_disk()

    def _follow_disk(self) -> None:
        """File and session are the same again."""
        self._disk = "same"
        self.notice.emit("", ())
        self._live.do(lambda _: None)

    def _succeeds(self, step: Callable[[], object], failure: str) -> bool:
        """Take a step; where it fails, say why under a title."""
        try:
            step()
        except DesignerError as error:
            self._live.message.emit(str(error))
            QMessageBox.warning(self._parent, failure, str(error))
            return False
        return True

    # Leaving

    def may_leave(self) -> bool:
        """Ask what becomes of long work and of changes that are not saved; whether to go on."""
        self._live.flushing.emit()
        session, kind = self._live.session, QMessageBox.StandardButton
        unfinished = [NAMES[work] for work in LONG if work in self._live.busy]
        if session is not None and unfinished:
            is_or_are = "is" if len(unfinished) == 1 else "are"
            text = f"{fmt.capital(fmt.listing(unfinished))} {is_or_are} not finished. End it?"
            buttons = kind.Yes | kind.Cancel
            answer = QMessageBox.question(self._parent, _TITLE, text, buttons, kind.Cancel)
            if answer != kind.Yes:
                return False
        if session is None or not session.is_modified:
            return True
        text = f"The changes of “{session.name}” are not saved."
        buttons = kind.Save | kind.Discard | kind.Cancel
        answer = QMessageBox.question(self._parent, _TITLE, text, buttons, kind.Save)
        return self.save() if answer == kind.Save else answer == kind.Discard

    def look_at_disk(self) -> None:
        """Say where the file was changed by another program, or is gone."""
        session = self._live.session
        if session is None or session.file is None:
            return
        disk, before = session.disk(), self._disk
        self._disk = disk
        if disk == before:
            return
        name = session.file.name
        if disk == "changed":
            self.notice.emit(f"{name} was changed by another program.", ("Reload", "Keep mine"))
        elif disk == "gone":
            self.notice.emit(f"{name} is gone. Saving writes it again.", ("Save", "Later"))
        else:
            self.notice.emit("", ())

    def answer_notice(self, button: str) -> None:
        self.notice.emit("", ())
        if button == "Reload":
            self.reload()
        elif button == "Save":
            self.save()
        elif button == "Take over":
            self._take_over_optimised()
        elif button == "Open" and self._written:
            QDesktopServices.openUrl(QUrl.fromLocalFile(str(self._written[0])))

    # Plans

    def optimise(self) -> None:
        plan = self._choose_file("Plan of an optimisation", _PLANS)
        if plan is not None:
            self._live.begin_long("optimise", plan=plan)

    def sweep(self) -> None:
        """Ask for a plan and where its store is to be, and solve the study for all its values."""
        plan = self._choose_file("Plan of a sweep", _PLANS)
        if plan is None:
            return
        start, option = str(plan.with_suffix(".zarr").resolve()), QFileDialog.Option.ShowDirsOnly
        title = "Store of the sweep"
        name, _ = QFileDialog.getSaveFileName(self._parent, title, start, "", options=option)
        if name:
            self._live.begin_long("sweep", plan=plan, target=Path(name))

    def _choose_file(self, title: str, kinds: str) -> Path | None:
        session = self._live.session
        if session is None:
            return None
        start = str(session.path.resolve().parent)
        name, _ = QFileDialog.getOpenFileName(self._parent, title, start, kinds)
        return Path(name) if name else None

    def _show_optimised(self, optimised: OptimisedStudy | None) -> None:
        self._optimised = optimised
        if optimised is None:
            return
        lines = optimised.headline, *optimised.variables, *optimised.trust
        self._live.message.emit("\n".join(lines))
        if optimised.text is None:
            self.notice.emit(optimised.headline, ("Close",))
        else:
            chosen = "; ".join(optimised.variables)
            self.notice.emit(f"{optimised.headline}. {chosen}", ("Take over", "Close"))

    def _take_over_optimised(self) -> None:
        """Go on with the better design; what was changed since the search began is told of."""
        optimised, session = self._optimised, self._live.session
        if session is None or optimised is None or optimised.text is None:
            return
        if session.text != optimised.given_text:
            text = "Changes made since the search began are not in this design; undo has them."
            self._live.message.emit(text)
        self._live.take_over(optimised.text)

    # Exports

    def export_lengths(self) -> None:
        """Ask for a table of poses and where their lengths are to be, and write them."""
        poses = self._choose_file("Poses", _POSES)
        if poses is not None:
            self.export("lengths", poses=poses)

    def export(self, content: ExportContent, **options: Path) -> None:
        target = self._choose_target(content)
        if target is not None:
            ropes = self._live.answers.get("ropes") if content == "tables" else None
            self._live.begin_long("export", content=content, target=target, ropes=ropes, **options)

    def save_picture(self, scene: QWidget) -> None:
        target = self._choose_target("picture")
        if target is not None:
            is_saved = scene.grab().save(str(target))
            text = f"Saved {target}" if is_saved else f"{target}: cannot be written"
            self._live.message.emit(text)

    def _choose_target(self, content: ExportContent) -> Path | None:
        session, (title, ending, kinds) = self._live.session, _EXPORTS[content]
        if session is None:
            return None
        folder = Path.cwd() if session.file is None else session.file.resolve().parent
        start = str(folder / f"{session.path.stem}{ending}")
        shown = QFileDialog.Option(0) if kinds else QFileDialog.Option.ShowDirsOnly
        name, _ = QFileDialog.getSaveFileName(self._parent, title, start, kinds, options=shown)
        target, needed = Path(name), kinds[kinds.find("*") + 1 : -1]
        if not name.endswith(needed):
            target = target.with_name(f"{target.stem}{needed}")
        return target if name else None

    def _show_written(self, written: Written | None) -> None:
        self._written = () if written is None else written.files
        if written is None:
            self.notice.emit("", ())
            return
        lines = f"Written: {', '.join(map(str, written.files))}", *written.remarks
        self._live.message.emit("\n".join(lines))
        main = written.files[0]
        self.notice.emit(f"{main.name} is in {main.parent}.", ("Open", "Close"))
