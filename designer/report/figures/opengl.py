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
sys.modules["numpy"] = None
import vtkmodules.vtkRenderingOpenGL2
from vtkmodules.vtkCommonCore import vtkUnsignedCharArray
from vtkmodules.vtkFiltersSources import vtkPlaneSource
from vtkmodules.vtkRenderingCore import vtkActor, vtkPolyDataMapper, vtkRenderer, vtkRenderWindow
window, scene, plane = vtkRenderWindow(), vtkRenderer(), vtkPlaneSource()
actor, mapper, pixel = vtkActor(), vtkPolyDataMapper(), vtkUnsignedCharArray()
window.SetOffScreenRendering(True)
window.SetSize(40, 40)
window.AddRenderer(scene)
mapper.SetInputConnection(plane.GetOutputPort())
actor.SetMapper(mapper)
actor.GetProperty().SetColor(0.2, 0.4, 0.8)
actor.GetProperty().LightingOff()
scene.AddActor(actor)
window.Render()
window.GetPixelData(20, 20, 20, 20, 0, pixel, 0)
sys.exit([pixel.GetValue(k) for k in range(3)] != [0x33, 0x66, 0xCC])
"""
"""With VTK alone, without NumPy for it, which takes twice as long."""


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
