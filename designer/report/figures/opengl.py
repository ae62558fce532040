"""Whether this machine can draw in three dimensions."""

from __future__ import annotations

import ctypes
import os
import sys

from designer.errors import MissingLibraryError

_LIBRARIES = ("libEGL.so.1", "libOSMesa.so.8", "libOSMesa.so.6")


def require_opengl() -> None:
    """Make sure that scenes can be drawn off-screen, before hours are spent on their content.

    VTK ends the process where it finds no OpenGL library, so this looks first. Only Linux can be
    without one.

    Raises
    ------
    MissingLibraryError
        If there is none; the message names the package to install.
    """
    if not sys.platform.startswith("linux") or any(_loads(name) for name in _LIBRARIES):
        return
    raise MissingLibraryError(
        "the pictures of the report need an OpenGL library and this machine has none; install "
        "it by 'apt-get install libegl1' (Debian, Ubuntu) or 'dnf install mesa-libEGL' (Fedora)"
    )


def prefer_offscreen() -> None:
    """Let VTK go straight for EGL where there is no display, instead of warning about it."""
    if sys.platform.startswith("linux") and not os.environ.get("DISPLAY") and _loads(_LIBRARIES[0]):
        os.environ.setdefault("VTK_DEFAULT_OPENGL_WINDOW", "vtkEGLRenderWindow")


def _loads(name: str) -> bool:
    try:
        ctypes.CDLL(name)
    except OSError:
        return False
    return True
