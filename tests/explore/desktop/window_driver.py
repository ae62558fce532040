"""Drives a window as a user does: by the mouse and the keys, on what is seen.

Importing this skips a module of tests where there is no Qt, or no display to open a window on.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any, TypeVar

import numpy as np
import pytest

for _library in ("PySide6", "pyvistaqt", "pytestqt"):
    pytest.importorskip(_library, reason=f"{_library} is not installed: pip install -e '.[dev]'")
if sys.platform.startswith("linux") and not os.environ.get("DISPLAY"):
    pytest.skip("no display; run under xvfb-run -a", allow_module_level=True)

from PySide6.QtCore import QObject, QPoint, Qt, QTimer  # noqa: E402
from PySide6.QtGui import QImage  # noqa: E402
from PySide6.QtTest import QTest  # noqa: E402
from PySide6.QtWidgets import QApplication, QLineEdit, QSlider, QWidget  # noqa: E402

from designer.arrays import FloatArray  # noqa: E402
from designer.explore.desktop.files import Settings  # noqa: E402
from designer.explore.desktop.window import Window  # noqa: E402
from designer.explore.session import Session  # noqa: E402
from designer.model.cable import Cable  # noqa: E402
from designer.model.robot import Poses  # noqa: E402
from designer.resources import example_file  # noqa: E402
from designer.statics.inverse import solve_sagging  # noqa: E402

Some = TypeVar("Some", bound=QObject)
_RGB = QImage.Format.Format_RGB888
LEFT = Qt.MouseButton.LeftButton
LONGEST_MS = 600_000  # a guard against what never ends: beside other work a step takes minutes


class Driver:
    """A window of its own, with settings in a folder of its own."""

    def __init__(
        self, bot: Any, folder: Path, theme: str = "light", *, with_plugins: bool = False
    ) -> None:
        self.bot = bot
        self.settings = Settings(folder / "settings.ini")
        self.settings.theme = theme or self.settings.theme
        self.window = Window(self.settings, with_plugins=with_plugins)
        with bot.waitExposed(self.window):
            self.window.show()
        self.window.activateWindow()  # without a window manager nobody else does it
        bot.waitUntil(self.window.isActiveWindow, timeout=LONGEST_MS)

    def open(self, study: str | Path) -> None:
        """Open a shipped study by its name, or a file, and wait for all answers."""
        self.window.files.open(example_file(study) if isinstance(study, str) else study)
        self.rest()

    def reset(self) -> None:
        """Show what is shown at first."""
        self.window.create_panels()
        work = self.window.work
        self.window.live.session = None
        for box in (work.surface, work.slice):
            box.setChecked(True)
        work.holds_scale.setChecked(False)
        for box in (work.exaggeration, work.quantity):
            box.setCurrentIndex(0)
        work.height_slider.setValue(50)
        table = self.window.ropes.table
        table.sortByColumn(table.model().columnCount() - 1, Qt.SortOrder.AscendingOrder)

    def rest(self) -> None:
        """Wait until everything is answered and drawn."""

        def answered() -> None:
            live = self.window.live
            assert live.is_at_rest, f"waits for {sorted(live.busy) or 'a timer'}"

        calm = 0
        while calm < 3:
            self.bot.waitUntil(answered, timeout=LONGEST_MS)
            self.bot.wait(20)
            calm = calm + 1 if self.window.live.is_at_rest else 0

    @property
    def session(self) -> Session:
        """The session of the window."""
        assert self.window.live.session is not None
        return self.window.live.session

    @property
    def place(self) -> FloatArray:
        """Where the platform is."""
        return self.session.state.place

    def find(self, kind: type[Some], name: str) -> Some:
        """Return the part of the window with this name."""
        found = self.window.findChild(kind, name)
        assert found is not None, name
        return found  # type: ignore[no-any-return]

    # Mouse and keys

    @property
    def scene(self) -> Any:
        """The scene."""
        return self.window.work.scene

    def pixel(self, position_m: Sequence[float] | FloatArray) -> QPoint:
        """Return where a position is seen in the scene."""
        x, y = self.scene.view.pixels(np.asarray(position_m, dtype=float))
        return QPoint(round(x), round(y))

    def click(self, widget: QWidget, at: QPoint | None = None) -> None:
        """Click on a widget, in its middle if nothing else is said."""
        place = widget.rect().center() if at is None else at
        QTest.mouseClick(widget, LEFT, Qt.KeyboardModifier.NoModifier, place)

    def press(self, name: str) -> None:
        """Click on a button or box with this name."""
        widget = self.find(QWidget, name)
        assert widget.isVisible(), f"{name} cannot be seen"
        self.click(widget, QPoint(8, widget.height() // 2))

    def drag(self, widget: QWidget, *places: QPoint) -> None:
        """Press at the first place, move over the others, let go at the last."""
        QTest.mousePress(widget, LEFT, Qt.KeyboardModifier.NoModifier, places[0])
        for place in places[1:]:
            QTest.mouseMove(widget, place)
            QTest.qWait(5)
        QTest.mouseRelease(widget, LEFT, Qt.KeyboardModifier.NoModifier, places[-1])

    def keys(self, keys: str) -> None:
        """Press a shortcut or a key, such as ``Ctrl+Z``, where the focus is."""
        if QApplication.activeWindow() is None:  # after a dialog
            self.window.activateWindow()
            self.bot.waitUntil(self.window.isActiveWindow, timeout=LONGEST_MS)
        widget = QApplication.focusWidget() or self.window
        QTest.keySequence(widget, keys)

    def type_into(self, name: str, text: str) -> None:
        """Replace what is in an entry, and press Return."""
        entry = self.find(QLineEdit, name)
        self.click(entry)
        entry.selectAll()
        QTest.keyClick(entry, Qt.Key.Key_Delete)
        QTest.keyClicks(entry, text)
        QTest.keyClick(entry, Qt.Key.Key_Return)

    def slide(self, name: str, *shares: float) -> None:
        """Drag the handle of a slider from where it is over shares of its range."""
        slider = self.find(QSlider, name)
        span = slider.maximum() - slider.minimum()
        at = [(slider.value() - slider.minimum()) / span, *shares]
        places = [QPoint(round(8 + s * (slider.width() - 16)), slider.height() // 2) for s in at]
        self.drag(slider, *places)

    def answer(self, *buttons: Any) -> list[str]:
        """Click a button of each of the next message boxes; returns where their texts stand."""
        told: list[str] = []
        left, tries = list(buttons), iter(range(200))

        def look() -> None:
            box: Any = QApplication.activeModalWidget()
            button = None if box is None else box.button(left[0])
            if button is None:
                if next(tries, None) is not None:
                    QTimer.singleShot(50, look)
                return
            told.append(box.text())
            del left[0]
            if left:
                QTimer.singleShot(50, look)
            QTest.mouseClick(button, LEFT)

        QTimer.singleShot(50, look)
        return told

    # What is seen

    def picture(self, widget: QWidget | None = None) -> np.ndarray[Any, Any]:
        """Return what is seen of a widget, red, green and blue (height, width, 3)."""
        image = (widget or self.window).grab().toImage().convertToFormat(_RGB)
        rows = np.frombuffer(image.constBits(), dtype=np.uint8)
        rows = rows.reshape(image.height(), image.bytesPerLine())[:, : 3 * image.width()]
        return rows.reshape(image.height(), image.width(), 3).copy()

    def close(self) -> None:
        """Close the window without a question."""
        if self.window.live.session is not None:
            self.window.live.session = None
        self.window.close()
        self.window.deleteLater()
        QApplication.processEvents()


def small_yard(folder: Path) -> Path:
    """Write the shipped yard crane with few samples, and return its file."""
    text = example_file("yard").read_text(encoding="utf-8")
    file = folder / "yard.yaml"
    file.write_text(text.replace("samples: 20000", "samples: 600"), encoding="utf-8")
    return file


def built_yard(folder: Path, driver: Driver) -> Path:
    """Write the yard crane with forty measured poses, its first winch homed 50 mm wrong."""
    file = small_yard(folder)
    driver.open(file)
    robot, region = driver.session.study.robot, driver.session.study.workspace.region
    position = region.inside_m(np.random.default_rng(5), 40)
    statics = solve_sagging(robot, Poses.at(position), Cable(0.006, 0.142, 1.6e6, 5e3))
    length = statics.length_m + np.array([0.05, 0.0, 0.0])
    names = "x_m,y_m,z_m,length_1_m,length_2_m,length_3_m"
    np.savetxt(
        folder / "log.csv", np.column_stack([position, length]), "%.6f", ",", header=names,
        comments="",
    )  # fmt: skip
    built = folder / "built.yaml"
    built.write_text(
        file.read_text(encoding="utf-8") + "measurements:\n  file: log.csv\n"
        "  cable: {linear_mass: 0.142 kg/m, axial_stiffness: 1.6 MN}\n"
        "  noise: {length: 1 mm}\n",
        encoding="utf-8",
    )
    return built


def n_colours(picture: np.ndarray[Any, Any]) -> int:
    """How many colours a picture has that cover more than a few pixels."""
    _, counts = np.unique(picture.reshape(-1, 3), axis=0, return_counts=True)
    return int((counts > 30).sum())
