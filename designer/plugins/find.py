"""Finds plugins and asks each for what it has, so that none of them can break the others."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from importlib import import_module
from importlib.metadata import EntryPoint, distributions, entry_points

import designer
from designer.errors import described, one_line
from designer.plugins.examine import PluginQuestion, examine
from designer.plugins.guard import attempt
from designer.plugins.hooks import ENTRY_POINT_GROUP, PLAIN, hooks_of, listed

OWN_ENTRIES = (
    EntryPoint("builtin", "designer.grades.builtin", ENTRY_POINT_GROUP),
    EntryPoint("builtin-effects", "designer.effects.builtin", ENTRY_POINT_GROUP),
)
"""Our own plugins, as `pyproject.toml` declares them.

They are taken from here, so that a checkout on Python's path, which declares nothing, has them too.
"""
OWN_NAMES = frozenset(entry.name for entry in OWN_ENTRIES)
OWN_SOURCE = f"cdpr-designer {designer.__version__}"
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
    """Load the entry points, ours first; without plugins, ours alone.

    Those of others are loaded, and asked, in processes of their own first.
    """
    problems: list[str] = []
    plugins: dict[str, Plugin] = {}
    for entry in OWN_ENTRIES:
        plugins[entry.name] = Plugin(entry.name, OWN_SOURCE, hooks_of(entry))
    strangers = []
    for entry in _strangers(problems) if with_plugins else ():
        name, source = one_line(entry.name), _distribution(entry, problems)
        if source is None:
            continue
        plugin = Plugin(name, source, {})
        if name in plugins:
            problems.append(f"{plugin.label} has the name of {plugins[name].source}: left out")
            continue
        plugins[name] = plugin
        strangers.append(PluginQuestion(entry, source, plugin.label))
    for stranger, answer in zip(strangers, examine(strangers), strict=True):
        problems += answer.problems
        name = one_line(stranger.entry.name)
        plugin = plugins.pop(name)
        if answer.items:
            hooks = {hook: _hook(stranger, hook, items) for hook, items in answer.items.items()}
            plugins[name] = Plugin(name, plugin.source, hooks)
    return Plugins(tuple(plugins.values()), tuple(problems), with_plugins)


def ask(plugins: Plugins, hook: str) -> tuple[list[Offer], list[str]]:
    """Return what the plugins give in answer to a hook, and one line for each that fails."""
    problems: list[str] = []
    offers = []
    for plugin in plugins.found:
        if hook not in plugin.hooks:
            continue
        answer = partial(listed, plugin.hooks[hook])
        if plugin.name in OWN_NAMES:  # needs no guard; a machine that is busy may take its time
            items: tuple[object, ...] | None = answer()
        else:
            items = attempt(answer, plugin.label, f"fails in {hook}()", problems)
        if items is not None:
            offers.append(Offer(plugin.name, plugin.source, plugin.label, items))
    return offers, problems


def _hook(request: PluginQuestion, hook: str, items: Sequence[object]) -> Callable[[], object]:
    """Return what gives a plugin's answer: from plain data, or by the plugin itself."""
    if hook in PLAIN:
        plain = import_module(PLAIN[hook])
        return lambda: [plain.from_plain(item) for item in items]
    return lambda: hooks_of(request.entry)[hook]()  # noqa: PLW0108  # loads the plugin when called


def _strangers(problems: list[str]) -> list[EntryPoint]:
    """Return the entry points of others by name; names a distribution that cannot be read."""
    try:
        entries = list(entry_points(group=ENTRY_POINT_GROUP))
    except Exception:  # one that cannot be read takes all along
        entries = list(_one_by_one(problems))
    strangers = [entry for entry in entries if entry.value not in _OWN_MODULES]
    return sorted(strangers, key=lambda entry: (entry.name, entry.value))


def _one_by_one(problems: list[str]) -> Iterator[EntryPoint]:
    seen = set()
    for place in distributions():
        path = getattr(place, "_path", "a distribution")
        try:
            if place.name not in seen:  # the first on Python's path is the one that is loaded
                yield from place.entry_points.select(group=ENTRY_POINT_GROUP)
            seen.add(place.name)
        except Exception as error:
            line = f"{one_line(path)}: its metadata cannot be read: {described(error)}: left out"
            problems.append(line)


def _distribution(entry: EntryPoint, problems: list[str]) -> str | None:
    """Return distribution and version of a plugin; None, with a line, where they are unreadable."""
    dist = entry.dist
    if dist is None:
        return one_line(entry.value)
    try:
        return one_line(f"{dist.name} {dist.version}")
    except Exception as error:
        label = f"plugin {one_line(entry.name)} ({one_line(entry.value)})"
        problems.append(f"{label}: its metadata cannot be read: {described(error)}: left out")
        return None
