"""Take the pictures of the window that the README and the start page show.

xvfb-run -a -s '-screen 0 1280x800x24' python tests/benchmarks/window_pictures.py
"""

from __future__ import annotations

import time
from pathlib import Path
from tempfile import mkdtemp

from PySide6.QtCore import Qt
from PySide6.QtGui import QPixmap
from PySide6.QtWidgets import QApplication

from designer.explore.desktop.app import application
from designer.explore.desktop.files import Settings
from designer.explore.desktop.window import Window
from designer.resources import example_file, example_names

PICTURES = example_file("fast").parent / "pictures"
SMALL_PX = (400, 250)


def opened(name: str, theme: str) -> Window:
    """A window on a shipped study, everything answered and drawn."""
    settings = Settings(Path(mkdtemp()) / "settings.ini")
    settings.theme = theme
    window = Window(settings, with_plugins=False)
    window.show()
    window.files.open(example_file(name))
    rest(window)
    return window


def rest(window: Window) -> None:
    """Wait until everything is answered and drawn."""
    calm = 0
    while calm < 40:
        QApplication.processEvents()
        time.sleep(0.02)
        calm = calm + 1 if window.live.is_at_rest else 0


def keep(picture: QPixmap, name: str) -> None:
    """Write a picture with few colours, small enough for a repository."""
    from PIL import Image

    file = PICTURES / f"{name}.png"
    picture.save(str(file))
    Image.open(file).convert("RGB").quantize(256).save(file, optimize=True)
    print(f"{file.name}: {file.stat().st_size // 1000} kB")


def main() -> None:
    """Take all of them."""
    application()
    PICTURES.mkdir(exist_ok=True)
    for name in example_names():
        window = opened(name, "light")
        window.work.scene.colour_legend.hide()
        keep(
            window.work.scene.grab().scaled(
                *SMALL_PX,
                Qt.AspectRatioMode.KeepAspectRatioByExpanding,
                Qt.TransformationMode.SmoothTransformation,
            ),
            name,
        )
        if name == "yard":
            window.work.scene.colour_legend.show()
            keep(window.grab(), "window-yard")
        window.close()
    window = opened("cogiro", "dark")
    window.live.pin()
    window.live.do(lambda session: session.edit("robot.platform.mass", "140 kg"))
    rest(window)
    window.docks["Compare"].raise_()
    window.compare.in_map.setChecked(True)
    rest(window)
    keep(window.grab(), "window-cogiro-compare")
    window.live.session = None
    window.close()
    settings = Settings(Path(mkdtemp()) / "settings.ini")
    settings.theme = "light"
    start = Window(settings, with_plugins=False)
    start.show()
    rest(start)
    keep(start.grab(), "window-start")
    start.close()


if __name__ == "__main__":
    main()
