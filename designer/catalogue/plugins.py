"""Finds plugins and asks each for its grades, so that none of them can break the others."""

from __future__ import annotations

import io
import os
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager, redirect_stdout
from dataclasses import dataclass
from importlib.metadata import EntryPoint, entry_points
from typing import TypeVar

import pluggy

import designer
from designer.catalogue import builtin, hookspecs

Value = TypeVar("Value")

BUILTIN_NAME = "builtin"
_BUILTIN_MODULE = builtin.__name__


@dataclass(frozen=True, slots=True)
class Offer:
    """What one plugin, or the user's folder, has to offer.

    Parameters
    ----------
    name : str
        Name of the plugin.
    source : str
        Its distribution and version, or the path of the folder.
    label : str
        Both, for a line about a problem.
    items : tuple
        What `register_grades` gave, not looked at yet.
    """

    name: str
    source: str
    label: str
    items: tuple[object, ...]


def collect_offers(with_plugins: bool) -> tuple[list[Offer], list[str]]:
    """Return what the plugins offer, and one line for each that fails.

    Parameters
    ----------
    with_plugins : bool
        False: only the grades that are shipped.
    """
    problems: list[str] = []
    found = _find(with_plugins, problems)
    offers = [_ask(plugin, problems) for plugin in found]
    return [offer for offer in offers if offer is not None], problems


def one_line(text: object) -> str:
    """Return a text on one line, without control characters, cut short."""
    try:
        words = " ".join(str(text).split())
    except Exception:  # a stranger's exception may fail at telling what it is
        words = "an error without a readable message"
    shown = "".join(letter if letter.isprintable() else "?" for letter in words)
    return shown if len(shown) <= 300 else shown[:300] + "…"


@dataclass(frozen=True, slots=True)
class _Plugin:
    name: str
    source: str
    register_grades: Callable[[], object]


def _find(with_plugins: bool, problems: list[str]) -> list[_Plugin]:
    """Load the entry points, ours first; in a checkout, where we have none, our module itself."""
    manager = pluggy.PluginManager(hookspecs.PROJECT)
    manager.add_hookspecs(hookspecs)
    entries = entry_points(group=hookspecs.ENTRY_POINT_GROUP)
    found: list[_Plugin] = []
    if not any(_is_builtin(entry) for entry in entries):
        source = f"cdpr-designer {designer.__version__}"
        found.append(_registered(manager, builtin, BUILTIN_NAME, source))
    for entry in sorted(entries, key=lambda entry: (not _is_builtin(entry), entry.name)):
        if with_plugins or _is_builtin(entry):
            found += _loaded(manager, entry, problems)
    return found


def _loaded(manager: pluggy.PluginManager, entry: EntryPoint, problems: list[str]) -> list[_Plugin]:
    name, source = one_line(entry.name), _distribution(entry)
    plugin = _attempt(
        lambda: _registered(manager, entry.load(), name, source),
        _label(name, source),
        "cannot be loaded",
        problems,
    )
    return [] if plugin is None else [plugin]


def _registered(manager: pluggy.PluginManager, module: object, name: str, source: str) -> _Plugin:
    manager.register(module, name)
    hooks = manager.hook.register_grades.get_hookimpls()
    own = next((hook.function for hook in hooks if hook.plugin_name == name), None)
    if own is None:
        raise TypeError("it has no hook register_grades()")
    return _Plugin(name, source, own)


def _ask(plugin: _Plugin, problems: list[str]) -> Offer | None:
    label = _label(plugin.name, plugin.source)
    items = _attempt(
        lambda: _listed(plugin.register_grades()), label, "fails in register_grades()", problems
    )
    return None if items is None else Offer(plugin.name, plugin.source, label, items)


def _listed(answer: object) -> tuple[object, ...]:
    if not isinstance(answer, list | tuple):
        raise TypeError(f"it returned {type(answer).__name__}, not a list")
    return tuple(answer)


def _label(name: str, source: str) -> str:
    return f"plugin {name} ({source})"


def _is_builtin(entry: EntryPoint) -> bool:
    return entry.value == _BUILTIN_MODULE


def _distribution(entry: EntryPoint) -> str:
    dist = entry.dist
    return one_line(f"{dist.name} {dist.version}") if dist is not None else entry.value


def _attempt(
    action: Callable[[], Value], label: str, failure: str, problems: list[str]
) -> Value | None:
    """Return what a stranger's code gives; None, and a line in ``problems``, where it fails."""
    caught = io.StringIO()
    value = None
    try:
        with _descriptor_to_stderr(), redirect_stdout(caught):
            value = action()
    except (Exception, SystemExit) as error:  # it may raise anything
        problems.append(f"{label} {failure}: {type(error).__name__}: {one_line(error)}: left out")
    printed = "" if caught.closed else caught.getvalue()
    if printed:
        problems.append(f"{label} wrote to standard output: {one_line(printed)!r}")
    return value


@contextmanager
def _descriptor_to_stderr() -> Iterator[None]:
    """Send what is written below Python, such as by a child process, to standard error."""
    try:
        if sys.stdout is not None:
            sys.stdout.flush()
        saved = os.dup(1)
    except (OSError, ValueError):  # started without a standard output
        yield
        return
    try:
        os.dup2(2, 1)
        yield
    finally:
        os.dup2(saved, 1)
        os.close(saved)
