"""The hooks of one plugin, loaded; runs a stranger's code, so it is called by who guards it."""

from __future__ import annotations

from collections.abc import Callable
from importlib.metadata import EntryPoint

import pluggy

from designer.errors import one_line
from designer.plugins import hookspecs


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
    manager = pluggy.PluginManager(hookspecs.PROJECT)
    manager.add_hookspecs(hookspecs)
    manager.register(entry.load(), entry.name)
    manager.check_pending()  # a hook that is misspelt
    hooks = {
        name: implementation.function
        for name in hookspecs.HOOKS
        for implementation in getattr(manager.hook, name).get_hookimpls()
    }
    if not hooks:
        raise TypeError("it has no hook " + " or ".join(f"{name}()" for name in hookspecs.HOOKS))
    return hooks


def listed(hook: Callable[[], object]) -> tuple[object, ...]:
    """Return what a hook gives, which is to be a list."""
    answer = hook()
    if not isinstance(answer, list | tuple):
        raise TypeError(f"it returned {type(answer).__name__}, not a list")
    return tuple(answer)
