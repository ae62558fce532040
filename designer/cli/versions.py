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
            release = version(name)
        except PackageNotFoundError:
            release = "not installed"
        yield name, release
    yield "linear algebra", _linear_algebra()
    yield "OpenGL", _opengl()
    yield from _plugins()


def _required() -> list[str]:
    """Return the libraries that cdpr-designer itself asks for."""
    try:
        requirements = requires("cdpr-designer") or []
    except PackageNotFoundError:  # a checkout on Python's path
        return []
    names = (
        _NAME.match(requirement) for requirement in requirements if "extra ==" not in requirement
    )
    return [name[0] for name in names if name]


def _linear_algebra() -> str:
    """Return which libraries NumPy and SciPy compute with, and their kernels for this processor."""
    import scipy.linalg  # noqa: F401  # loads its library
    from threadpoolctl import threadpool_info

    libraries = (library for library in threadpool_info() if library["user_api"] == "blas")
    descriptions = (
        f"{library['internal_api']} {library['version']} {library.get('architecture')}"
        for library in libraries
    )
    return ", ".join(dict.fromkeys(descriptions)) or "unknown"


def _opengl() -> str:
    """Return renderer and version; asked by another process, which a bad driver may end."""
    from designer.report.figures.opengl import why_no_scenes

    missing = why_no_scenes()
    if missing:
        return missing
    answer = subprocess.run(
        [sys.executable, "-P", "-c", _ASK], capture_output=True, text=True, check=False
    )
    return ", ".join(_CAPABILITY.findall(answer.stdout)) or "draws, and does not say how"


def _plugins() -> Iterator[tuple[str, str]]:
    from designer.plugins import OWN_NAMES, find_plugins

    plugins = find_plugins()
    foreign = [plugin for plugin in plugins.loaded if plugin.name not in OWN_NAMES]
    for plugin in foreign:
        yield f"plugin {plugin.name}", plugin.source
    for problem in plugins.problems:
        yield "plugin", problem
    if not foreign and not plugins.problems:
        yield "plugins", "none beside ours"
