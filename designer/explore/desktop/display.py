"""Whether a window can be opened here, found out where a crash does no harm."""

from __future__ import annotations

import subprocess
import sys
from importlib.util import find_spec

_MAX_WAIT_S = 60.0  #: A forwarded display is slow, one that never answers must not hold up for ever
_OPEN = """
import sys
from PySide6.QtGui import QGuiApplication, QOffscreenSurface, QOpenGLContext
application = QGuiApplication([])
context, surface = QOpenGLContext(), QOffscreenSurface()
surface.create()
found = context.create() and context.makeCurrent(surface)
version = context.format().version() if found else (0, 0)
sys.exit(0 if tuple(version) >= (3, 2) else 3)
"""
_NO_OPENGL = 3
_LIBRARIES = ("PySide6", "pyvistaqt")
_PACKAGES = (
    "libegl1 libgl1 libgl1-mesa-dri libxcb-cursor0 libxcb-icccm4 libxcb-image0 libxcb-keysyms1 "
    "libxcb-render-util0 libxcb-shape0 libxcb-xinerama0 libxkbcommon-x11-0 libdbus-1-3"
)


def why_no_library() -> str:
    """Return how to install what the window is made of; empty where it is installed."""
    if all(find_spec(name) is not None for name in _LIBRARIES):
        return ""
    return "The window needs PySide6 and PyVistaQt:  pip install 'cdpr-designer[desktop]'"


def begin_probe() -> subprocess.Popen[str]:
    """Begin to open a window in another process: Qt ends the whole one where it cannot."""
    return subprocess.Popen(
        [sys.executable, "-P", "-c", _OPEN],
        stdin=subprocess.DEVNULL,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
        text=True,
    )


def why_no_window(probe: subprocess.Popen[str]) -> str:
    """Return in one line why no window can be opened here; empty where one can."""
    try:
        _, complaint = probe.communicate(timeout=_MAX_WAIT_S)
    except subprocess.TimeoutExpired:
        probe.kill()
        _, complaint = probe.communicate()
    if probe.returncode == 0:
        return ""
    if probe.returncode == _NO_OPENGL:
        return "No window can be opened: this display has no OpenGL 3.2, which the scene needs."
    if not sys.platform.startswith("linux"):
        return f"No window can be opened. Qt says: {' '.join(complaint.split())[:200]}"
    if "could not connect to display" in complaint:
        return (
            "No window can be opened: there is no display. Set DISPLAY or WAYLAND_DISPLAY, "
            "log in with 'ssh -X', or use 'xvfb-run designer explore …'."
        )
    return f"No window can be opened. What Qt needs is installed by 'apt-get install {_PACKAGES}'."
