"""Opening, saving and leaving a study; what is not saved is asked about, never lost."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

from PySide6.QtWidgets import QFileDialog, QMessageBox

from designer.errors import DesignerError
from designer.explore.desktop.live import LONG, NAMES
from designer.explore.session import Session
from designer.report import format as fmt
from designer.resources import example_file, example_names

if TYPE_CHECKING:
    from designer.explore.desktop.window import Window

_STUDIES = "Studies (*.yaml *.yml);;All files (*)"


class Files:
    """What the window does with files."""

    def __init__(self, window: Window) -> None:
        self._window = window
        self._told_disk = "same"

    def open(self, path: Path) -> None:
        """Open a study, shipped ones as a copy that has no file yet."""
        if not self.may_leave():
            return
        try:
            session = self._session(path)
        except DesignerError as error:
            self._window.tell(str(error))
            QMessageBox.warning(self._window, "cdpr-designer", str(error))
            self._window.start.show_recent(self._window.settings.recent)
            return
        if session.file is not None:
            self._window.settings.remember(path)
        self._window.work.show_notice("")
        self._told_disk = "same"
        self._window.take_session(session)

    def _session(self, path: Path) -> Session:
        plugins = self._window.plugins
        if path.stem in example_names() and path == example_file(path.stem):
            return Session.example(path.stem, plugins)
        return Session.open(path, plugins)

    def ask_and_open(self) -> None:
        """Let the user look for a study."""
        name, _ = QFileDialog.getOpenFileName(self._window, "Open a study", "", _STUDIES)
        if name:
            self.open(Path(name))

    def close(self) -> None:
        """Go back to the start page."""
        window = self._window
        if self.may_leave():
            window.live.forget()
            window.session = None
            window.setWindowModified(False)
            window.setWindowTitle("cdpr-designer")
            window.show_start()

    def save(self) -> bool:
        """Save the study; tells whether it was."""
        session = self._window.session
        if session is None:
            return True
        if session.file is None:
            return self.save_as()
        return self._written(session.save)

    def save_as(self) -> bool:
        """Save the study under another name; tells whether it was."""
        session = self._window.session
        if session is None:
            return True
        start = str(session.file or Path(f"{session.path.stem}.yaml").resolve())
        name, _ = QFileDialog.getSaveFileName(self._window, "Save the study as", start, _STUDIES)
        if not name:
            return False
        path = Path(name) if Path(name).suffix else Path(f"{name}.yaml")
        if not self._written(lambda: session.save_as(path)):
            return False
        self._window.settings.remember(path)
        return True

    def _written(self, write: Callable[[], None]) -> bool:
        self._window.text.flush()
        try:
            write()
        except DesignerError as error:
            self._window.tell(str(error))
            QMessageBox.warning(self._window, "Not saved", str(error))
            return False
        session = self._window.session
        assert session is not None
        self._told_disk = "same"
        self._window.work.show_notice("")
        self._window.editing.show()
        self._window.changed()
        self._window.statusBar().showMessage(f"Saved {session.file}", 8000)
        return True

    def reload(self) -> None:
        """Take what the file holds now."""
        session = self._window.session
        if session is None:
            return
        try:
            session.reload()
        except DesignerError as error:
            self._window.tell(str(error))
            return
        self._told_disk = "same"
        self._window.work.show_notice("")
        self._window.editing.show()
        self._window.changed()

    def may_leave(self) -> bool:
        """Ask what becomes of long work and of changes; tells whether to go on."""
        return self._may_end_work() and self._may_drop_changes()

    def _may_end_work(self) -> bool:
        """Ask whether work of minutes that goes on may end without a result."""
        going_on = [NAMES[kind] for kind in LONG if kind in self._window.live.busy]
        if self._window.session is None or not going_on:
            return True
        button = QMessageBox.StandardButton
        asked = QMessageBox(self._window)
        asked.setObjectName("unfinished")
        asked.setIcon(QMessageBox.Icon.Question)
        is_or_are = "is" if len(going_on) == 1 else "are"
        asked.setText(f"{fmt.capital(fmt.listing(going_on))} {is_or_are} not finished. End it?")
        asked.setStandardButtons(button.Yes | button.Cancel)
        asked.setDefaultButton(button.Cancel)
        return bool(asked.exec() == button.Yes)

    def _may_drop_changes(self) -> bool:
        """Ask what becomes of changes that are not saved."""
        session = self._window.session
        if session is None or not session.is_modified:
            return True
        button = QMessageBox.StandardButton
        asked = QMessageBox(self._window)
        asked.setObjectName("unsaved")
        asked.setIcon(QMessageBox.Icon.Question)
        asked.setText(f"The changes of “{session.name}” are not saved.")
        asked.setStandardButtons(button.Save | button.Discard | button.Cancel)
        asked.setDefaultButton(button.Save)
        answer = asked.exec()
        if answer == button.Save:
            return self.save()
        return bool(answer == button.Discard)

    def look_at_disk(self) -> None:
        """Tell where the file was changed by another program, or is gone."""
        session = self._window.session
        if session is None or session.file is None:
            return
        found = session.disk()
        if found == self._told_disk:
            return
        self._told_disk = found
        notice = self._window.work.show_notice
        if found == "changed":
            notice(f"{session.file.name} was changed by another program.", "Reload", "Keep mine")
        elif found == "gone":
            notice(f"{session.file.name} is gone. Saving writes it again.", "Save", "Later")
        else:
            notice("")

    def answer_notice(self, name: str) -> None:
        """Do what the button of the notice says."""
        self._window.work.show_notice("")
        if name == "Reload":
            self.reload()
        elif name == "Save":
            self.save()
