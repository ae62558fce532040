"""The hooks of the plugin door.

A plugin is a Python distribution with an entry point in the group ``designer.plugins`` whose
module implements one of the hooks, or both::

    from pathlib import Path
    from designer.plugins import hookimpl

    @hookimpl
    def register_grades():
        return [Path(__file__).parent / "grades"]

What loads them here runs a stranger's code, so it is called by who guards it.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Sequence
from importlib.metadata import EntryPoint
from os import PathLike
from typing import TYPE_CHECKING

import pluggy

from designer.errors import one_line

if TYPE_CHECKING:
    from designer.effects.effect import Effect
    from designer.grades.grade import Grade

PROJECT = "designer"
ENTRY_POINT_GROUP = "designer.plugins"

hookspec = pluggy.HookspecMarker(PROJECT)
hookimpl = pluggy.HookimplMarker(PROJECT)


@hookspec
def register_grades() -> Sequence[PathLike[str] | str | Grade]:
    """Return a list of grade files, folders of grade files, and `Grade` objects.

    Files and folders are absolute paths.
    """
    raise NotImplementedError  # only the signature counts


@hookspec
def register_effects() -> Sequence[Effect]:
    """Return a list of effects; they act after ours, in the order of the list."""
    raise NotImplementedError  # only the signature counts


HOOKS = (register_grades.__name__, register_effects.__name__)
"""Names of all hooks."""
PLAIN = {register_grades.__name__: "designer.grades.plain"}
"""Of hooks whose answers come from another process: what makes them plain data, and back."""


def hooks_of(entry: EntryPoint) -> dict[str, Callable[[], object]]:
    """Load an entry point, and return its hooks by name.

    Raises
    ------
    Exception
        Of any kind, if it cannot be loaded, or has no hook.
    """
    if entry.pattern.match(entry.value) is None:
        raise ValueError(f"its entry point {one_line(entry.value)!r} names no module")
    # A manager for each, so that pluggy looks at one stranger at a time.
    manager = pluggy.PluginManager(PROJECT)
    manager.add_hookspecs(sys.modules[__name__])
    manager.register(entry.load(), entry.name)
    manager.check_pending()  # a hook that is misspelt
    hooks = {
        name: implementation.function
        for name in HOOKS
        for implementation in getattr(manager.hook, name).get_hookimpls()
    }
    if not hooks:
        raise TypeError("it has no hook " + " or ".join(f"{name}()" for name in HOOKS))
    return hooks


def listed(hook: Callable[[], object]) -> tuple[object, ...]:
    """Return what a hook gives, which is to be a list."""
    answer = hook()
    if not isinstance(answer, list | tuple):
        raise TypeError(f"it returned {type(answer).__name__}, not a list")
    return tuple(answer)
