"""What `designer --version -v` tells: all that a bug report needs of a machine."""

from __future__ import annotations

import platform
import re
import subprocess
import sys
from collections.abc import Iterator
from importlib.metadata import PackageNotFoundError, requires, version

from designer import __version__

_NAME = re.compile(r"[\w.-]+")
_ALSO = ("llvmlite", "vtk", "PySide6-Essentials", "pyvistaqt")
_ASK = """
import pyvista
plotter = pyvista.Plotter(off_screen=True, window_size=(40, 40))
plotter.show(auto_close=False)
print(plotter.render_window.ReportCapabilities())
"""
_CAPABILITY = re.compile(r"^OpenGL (?:renderer|version) string:\s*(.+)$", re.MULTILINE)


def versions() -> Iterator[tuple[str, str]]:
    """Yield what there is, and which, in the order in which it is asked for."""
    yield "cdpr-designer", __version__
    yield "Python", f"{platform.python_version()} ({sys.executable})"
    yield "system", f"{platform.platform()}, {platform.machine()}"
    for name in (*_required(), *_ALSO):
        try:
            found = version(name)
        except PackageNotFoundError:
            found = "not installed"
        yield name, found
    yield "linear algebra", _linear_algebra()
    yield "OpenGL", _opengl()
    yield from _plugins()


def _required() -> list[str]:
    """Return the libraries that cdpr-designer itself asks for."""
    try:
        asked = requires("cdpr-designer") or []
    except PackageNotFoundError:  # a checkout on Python's path
        return []
    names = (_NAME.match(one) for one in asked if "extra ==" not in one)
    return [name[0] for name in names if name]


def _linear_algebra() -> str:
    """Return which libraries NumPy and SciPy compute with, and their kernels for this processor."""
    import scipy.linalg  # noqa: F401  # loads its library
    from threadpoolctl import threadpool_info

    found = (one for one in threadpool_info() if one["user_api"] == "blas")
    told = (f"{one['internal_api']} {one['version']} {one.get('architecture')}" for one in found)
    return ", ".join(dict.fromkeys(told)) or "unknown"


def _opengl() -> str:
    """Return renderer and version; asked by another process, which a bad driver may end."""
    from designer.report.figures.opengl import why_no_scenes

    missing = why_no_scenes()
    if missing:
        return missing
    asked = subprocess.run(
        [sys.executable, "-P", "-c", _ASK], capture_output=True, text=True, check=False
    )
    return ", ".join(_CAPABILITY.findall(asked.stdout)) or "draws, and does not say how"


def _plugins() -> Iterator[tuple[str, str]]:
    from designer.plugins.find import OWN_NAMES, find_plugins

    plugins = find_plugins()
    others = [one for one in plugins.found if one.name not in OWN_NAMES]
    for one in others:
        yield f"plugin {one.name}", one.source
    for problem in plugins.problems:
        yield "plugin", problem
    if not others and not plugins.problems:
        yield "plugins", "none beside ours"
