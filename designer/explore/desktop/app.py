"""The program around the window: Qt's application, the picture of the window, the end."""

from __future__ import annotations

import signal
import socket
import sys
from pathlib import Path

from PySide6.QtCore import QSocketNotifier, QTimer
from PySide6.QtWidgets import QApplication

from designer.explore.desktop.files import Settings
from designer.explore.desktop.window import Window

_MAX_WAIT_S = 300
"""Room for kernels that are compiled first and a large map, on a machine with other work."""


def application() -> QApplication:
    app = QApplication.instance()
    if isinstance(app, QApplication):
        return app
    sys.setswitchinterval(1e-3)  # the worker's thread shall hold the window up for less than that
    app = QApplication(sys.argv[:1])
    app.setApplicationName("cdpr-designer")
    app.setStyle("Fusion")
    return app


def run(
    config: Path | None,
    screenshot: Path | None,
    *,
    with_plugins: bool = True,
    settings: Settings | None = None,
) -> int:
    """Open the window, on a study if there is one; return the exit status.

    With ``screenshot``, save a picture of the window once everything is answered, and close it.
    """
    app = application()
    window = Window(settings or Settings(), with_plugins=with_plugins)
    end = _EndOnSignal(window)
    window.show()
    if config is not None:
        window.files.open(config)
    picture = _Picture(window, screenshot) if screenshot is not None else None
    status = app.exec()
    end.stop()
    return picture.status if picture is not None else int(status)


class _Picture:
    """Waits until everything is answered and drawn, saves the picture, and closes the window."""

    def __init__(self, window: Window, file: Path) -> None:
        self.status = 1
        self._window, self._file = window, file
        self._ticks_left = _MAX_WAIT_S * 10
        self._calm = 0
        self._timer = QTimer(window, interval=100)
        self._timer.timeout.connect(self._look)
        self._timer.start()

    def _look(self) -> None:
        self._ticks_left -= 1
        self._calm = self._calm + 1 if self._window.live.is_at_rest else 0
        if self._calm >= 8 or self._ticks_left <= 0:
            self._timer.stop()
            saved = self._window.grab().save(str(self._file))
            if saved and self._ticks_left > 0:
                self.status = 0
            else:
                why = "cannot be written" if not saved else "not everything was answered in time"
                print(f"{self._file}: {why}", file=sys.stderr)
            self._window.close()


class _EndOnSignal:
    """Closes the window where the program is asked to end; Qt's loop hears no signal by itself."""

    def __init__(self, window: Window) -> None:
        self._ours, theirs = socket.socketpair()
        self._ours.setblocking(False)
        theirs.setblocking(False)
        self._theirs = theirs
        self._before = signal.set_wakeup_fd(theirs.fileno(), warn_on_full_buffer=False)
        self._notifier = QSocketNotifier(self._ours.fileno(), QSocketNotifier.Type.Read, window)
        self._notifier.activated.connect(lambda: self._ours.recv(64))

    def stop(self) -> None:
        """Leave signals to the program again."""
        signal.set_wakeup_fd(self._before)
        self._notifier.setEnabled(False)
        self._ours.close()
        self._theirs.close()
