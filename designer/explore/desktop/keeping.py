"""What goes out of the window: report, picture, tables, the map for ParaView."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from PySide6.QtCore import QUrl
from PySide6.QtGui import QDesktopServices
from PySide6.QtWidgets import QFileDialog

from designer.explore.export import Exported

if TYPE_CHECKING:
    from designer.explore.desktop.window import Window


class Keeping:
    """Exports, each asked for a place first, done by the worker, and told of when it is there."""

    def __init__(self, window: Window) -> None:
        self._window = window
        self._written: Exported | None = None

    def report(self) -> None:
        """Write the report and all results, as the command does."""
        self._into_folder("report", "Folder for the report")

    def tables(self) -> None:
        """Write cables, map and ropes as tables."""
        self._into_folder(
            "tables", "Folder for the tables", ropes=self._window.answers.get("ropes")
        )

    def map_file(self) -> None:
        """Write the map for ParaView."""
        start = str(self._folder() / f"{self._stem()}-map.vtu")
        name, _ = QFileDialog.getSaveFileName(
            self._window, "The map for ParaView", start, "VTK grids (*.vtu)"
        )
        if name:
            target = Path(name).with_suffix(".vtu")
            self._window.begin_long("export", what="vtk", target=target)

    def picture(self) -> None:
        """Save the scene as it is seen."""
        start = str(self._folder() / f"{self._stem()}.png")
        name, _ = QFileDialog.getSaveFileName(
            self._window, "Picture of the scene", start, "Pictures (*.png)"
        )
        if name:
            path = Path(name).with_suffix(".png")
            saved = self._window.work.scene.grab().save(str(path))
            told = f"Saved {path}" if saved else f"{path}: cannot be written"
            self._window.tell(told)

    def _into_folder(self, what: str, title: str, **options: object) -> None:
        start = str(self._folder() / f"{self._stem()}-{what}")
        name, _ = QFileDialog.getSaveFileName(
            self._window, title, start, "", options=QFileDialog.Option.ShowDirsOnly
        )
        if name:
            self._window.begin_long("export", what=what, target=Path(name), **options)

    def written(self, found: Exported) -> None:
        """Tell what was written, and offer to open it."""
        self._written = found
        self._window.tell(f"Written: {', '.join(str(path) for path in found.files)}")
        folder = found.files[0].parent
        self._window.work.show_notice(f"{found.files[0].name} is in {folder}.", "Open", "Close")

    def open_written(self) -> None:
        """Open what was written in the program that the system has for it."""
        if self._written is not None:
            QDesktopServices.openUrl(QUrl.fromLocalFile(str(self._written.files[0])))

    def _folder(self) -> Path:
        session = self._window.session
        file = session.file if session is not None else None
        return Path.cwd() if file is None else file.resolve().parent

    def _stem(self) -> str:
        session = self._window.session
        return "study" if session is None else session.path.stem
