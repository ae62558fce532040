"""Whether this machine can draw in three dimensions, found out where a crash does no harm."""

from __future__ import annotations

import atexit
import os
import subprocess
import sys
from functools import cache

_CHOICE = "VTK_DEFAULT_OPENGL_WINDOW"
_EGL = "vtkEGLRenderWindow"
_LONGEST_S = 120.0
_DRAW = """
import sys
import pyvista
plotter = pyvista.Plotter(off_screen=True, window_size=(40, 40))
plotter.add_mesh(pyvista.Plane(), color="#3366cc", lighting=False)
plotter.view_xy()
sys.exit(tuple(plotter.screenshot(return_img=True)[20, 20]) != (0x33, 0x66, 0xCC))
"""


@cache
def why_no_scenes() -> str:
    """Return why scenes cannot be drawn here, and what to install; empty where they can.

    VTK ends the whole process where it finds no OpenGL, or a library without a driver. So another
    process draws first, and its way of drawing, where it comes to a picture, is taken here.
    """
    for window in _windows():
        if _has_drawn(window):
            if window:
                os.environ[_CHOICE] = window
            return ""
    remedy = "They need a graphics driver with OpenGL."
    if sys.platform.startswith("linux"):
        remedy = (
            "What they need is installed by 'apt-get install libegl1 libgl1-mesa-dri' (Debian, "
            "Ubuntu) or 'dnf install mesa-libEGL mesa-dri-drivers' (Fedora)."
        )
    return f"Pictures in space are left out, since this machine cannot draw them. {remedy}"


def begin_probe() -> None:
    """Begin to find it out, so that `why_no_scenes` need not wait for it later."""
    _probe(_windows()[0])


def _windows() -> tuple[str, ...]:
    """Return what to try: VTK's own choice (empty), or EGL, which needs no display."""
    if not sys.platform.startswith("linux") or os.environ.get(_CHOICE):
        return ("",)
    return ("", _EGL) if os.environ.get("DISPLAY") else (_EGL, "")


def _has_drawn(window: str) -> bool:
    process = _probe(window)
    try:
        return process.wait(_LONGEST_S) == 0
    except subprocess.TimeoutExpired:
        _end(process)
        return False


def _end(process: subprocess.Popen[bytes]) -> None:
    process.kill()
    process.wait()


@cache
def _probe(window: str) -> subprocess.Popen[bytes]:
    process = subprocess.Popen(
        [sys.executable, "-P", "-c", _DRAW],
        env={**os.environ, _CHOICE: window} if window else None,
        stdin=subprocess.DEVNULL,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    )
    atexit.register(_end, process)  # where nobody asks what it found
    return process
