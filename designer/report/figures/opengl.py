"""Whether this machine can draw in three dimensions."""

from __future__ import annotations

import ctypes
import os
import sys

from designer.errors import MissingLibraryError

_EGL = "libEGL.so.1"
_MESA_OFFSCREEN = ("libOSMesa.so.8", "libOSMesa.so.6")
_DESKTOP = "libGL.so.1"


def require_opengl() -> None:
    """Make sure that scenes can be drawn off-screen, before the work on their content begins.

    VTK ends the whole process where it finds no OpenGL library, so this looks first. Only Linux
    can be without one.

    Raises
    ------
    MissingLibraryError
        If there is none; the message names the package to install.
    """
    if not sys.platform.startswith("linux") or _can_draw():
        return
    raise MissingLibraryError(
        "the pictures of the report need an OpenGL library and this machine has none; install "
        "it by 'apt-get install libegl1' (Debian, Ubuntu) or 'dnf install mesa-libEGL' (Fedora)"
    )


def prefer_offscreen() -> None:
    """Let VTK go straight for EGL where there is no display, instead of warning about it."""
    if sys.platform.startswith("linux") and not os.environ.get("DISPLAY") and _has_egl_device():
        os.environ.setdefault("VTK_DEFAULT_OPENGL_WINDOW", "vtkEGLRenderWindow")


def _can_draw() -> bool:
    on_screen = bool(os.environ.get("DISPLAY")) and _library(_DESKTOP) is not None
    return on_screen or _has_egl_device() or any(_library(name) for name in _MESA_OFFSCREEN)


def _has_egl_device() -> bool:
    """Ask EGL for its devices: the library without a driver behind it is of no use."""
    egl = _library(_EGL)
    if egl is None:
        return False
    egl.eglGetProcAddress.restype = ctypes.c_void_p
    address = egl.eglGetProcAddress(b"eglQueryDevicesEXT")
    if not address:
        return True  # too old to ask
    count = ctypes.c_int32(0)
    query = ctypes.CFUNCTYPE(
        ctypes.c_uint32, ctypes.c_int32, ctypes.c_void_p, ctypes.POINTER(ctypes.c_int32)
    )(address)
    return bool(query(0, None, ctypes.byref(count))) and count.value > 0


def _library(name: str) -> ctypes.CDLL | None:
    try:
        return ctypes.CDLL(name)
    except OSError:
        return None
