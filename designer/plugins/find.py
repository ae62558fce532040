"""Finds plugins and asks each for what it has, so that none of them can break the others."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from importlib.metadata import EntryPoint, entry_points

import pluggy

import designer
from designer.plugins import hookspecs
from designer.plugins.guard import attempt, one_line

OWN_ENTRIES = (
    EntryPoint("builtin", "designer.grades.builtin", hookspecs.ENTRY_POINT_GROUP),
    EntryPoint("builtin-effects", "designer.effects.builtin", hookspecs.ENTRY_POINT_GROUP),
)
"""Our own plugins, as `pyproject.toml` declares them.

They are taken from here, so that a checkout on Python's path, which declares nothing, has them too.
"""
OWN_NAMES = frozenset(entry.name for entry in OWN_ENTRIES)
_OWN_MODULES = tuple(entry.value for entry in OWN_ENTRIES)


@dataclass(frozen=True, slots=True)
class Plugin:
    """A plugin that could be loaded: its entry point, its distribution, its hooks by name."""

    name: str
    source: str
    hooks: Mapping[str, Callable[[], object]]

    @property
    def label(self) -> str:
        """Name and source, for a line about a problem."""
        return f"plugin {self.name} ({self.source})"


@dataclass(frozen=True, slots=True)
class Plugins:
    """All plugins that could be loaded: ours first, then the others by name.

    ``problems`` has a line for each that could not be loaded; ``with_others`` tells whether others
    than ours were looked for.
    """

    found: tuple[Plugin, ...]
    problems: tuple[str, ...] = ()
    with_others: bool = True


@dataclass(frozen=True, slots=True)
class Offer:
    """What one plugin, or the user's folder, has to offer; ``items`` are not looked at yet."""

    name: str
    source: str
    label: str
    items: tuple[object, ...]


def find_plugins(with_plugins: bool = True) -> Plugins:
    """Load the entry points, ours first; without plugins, ours alone."""
    problems: list[str] = []
    found: dict[str, Plugin] = {}
    installed = entry_points(group=hookspecs.ENTRY_POINT_GROUP) if with_plugins else ()
    strangers = [entry for entry in installed if entry.value not in _OWN_MODULES]
    strangers.sort(key=lambda entry: (entry.name, entry.value))
    for entry in (*OWN_ENTRIES, *strangers):
        name, source = one_line(entry.name), _distribution(entry)
        plugin = Plugin(name, source, {})
        if name in found:
            problems.append(f"{plugin.label} has the name of {found[name].source}: left out")
            continue
        hooks = attempt(partial(_hooks, entry), plugin.label, "cannot be loaded", problems)
        if hooks is not None:
            found[name] = Plugin(name, source, hooks)
    return Plugins(tuple(found.values()), tuple(problems), with_plugins)


def ask(plugins: Plugins, hook: str) -> tuple[list[Offer], list[str]]:
    """Return what the plugins give in answer to a hook, and one line for each that fails."""
    problems: list[str] = []
    offers = []
    for plugin in plugins.found:
        if hook not in plugin.hooks:
            continue
        answer = partial(_listed, plugin.hooks[hook])
        items = attempt(answer, plugin.label, f"fails in {hook}()", problems)
        if items is not None:
            offers.append(Offer(plugin.name, plugin.source, plugin.label, items))
    return offers, problems


def _hooks(entry: EntryPoint) -> dict[str, Callable[[], object]]:
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


def _listed(hook: Callable[[], object]) -> tuple[object, ...]:
    answer = hook()
    if not isinstance(answer, list | tuple):
        raise TypeError(f"it returned {type(answer).__name__}, not a list")
    return tuple(answer)


def _distribution(entry: EntryPoint) -> str:
    if entry.value in _OWN_MODULES:
        return f"cdpr-designer {designer.__version__}"
    dist = entry.dist
    return one_line(f"{dist.name} {dist.version}") if dist is not None else entry.value
