"""Finds plugins and asks each for its grades, so that none of them can break the others."""

from __future__ import annotations

import io
import os
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager, redirect_stdout
from dataclasses import dataclass
from importlib.metadata import EntryPoint, entry_points

import pluggy

import designer
from designer.catalogue import builtin, hookspecs

BUILTIN_NAME = "builtin"
_BUILTIN_MODULE = builtin.__name__


@dataclass(frozen=True, slots=True)
class Offer:
    """What one plugin returned.

    Parameters
    ----------
    name : str
        Name of the plugin.
    source : str
        Its distribution and version.
    items : tuple
        What `register_grades` gave, not looked at yet.
    """

    name: str
    source: str
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
    register_grades: Callable[[], object] | None


def _find(with_plugins: bool, problems: list[str]) -> list[_Plugin]:
    """Load the entry points, ours first; in a checkout, where we have none, our module itself."""
    manager = pluggy.PluginManager(hookspecs.PROJECT)
    manager.add_hookspecs(hookspecs)
    found = []
    entries = entry_points(group=hookspecs.ENTRY_POINT_GROUP)
    for entry in sorted(entries, key=lambda entry: (not _is_builtin(entry), entry.name)):
        if with_plugins or _is_builtin(entry):
            source = _distribution(entry)
            with _guarded(f"{entry.name!r} ({source})", "cannot be loaded", problems):
                found.append(_registered(manager, entry.load(), entry.name, source))
    if not any(_is_builtin(entry) for entry in entries):
        source = f"cdpr-designer {designer.__version__}"
        found.insert(0, _registered(manager, builtin, BUILTIN_NAME, source))
    return found


def _registered(manager: pluggy.PluginManager, module: object, name: str, source: str) -> _Plugin:
    manager.register(module, name)
    hooks = manager.hook.register_grades.get_hookimpls()
    own = (hook.function for hook in hooks if hook.plugin_name == name)
    return _Plugin(name, source, next(own, None))


def _ask(plugin: _Plugin, problems: list[str]) -> Offer | None:
    label = f"{plugin.name!r} ({plugin.source})"
    if plugin.register_grades is None:
        problems.append(f"plugin {label} has no hook register_grades(): left out")
        return None
    answer: object = None
    with _guarded(label, "fails in register_grades()", problems) as has_failed:
        answer = plugin.register_grades()
    if has_failed():
        return None
    if not isinstance(answer, list | tuple):
        found = f"register_grades() returned {type(answer).__name__}, not a list"
        problems.append(f"plugin {label}: {found}: left out")
        return None
    return Offer(plugin.name, plugin.source, tuple(answer))


def _is_builtin(entry: EntryPoint) -> bool:
    return entry.value == _BUILTIN_MODULE


def _distribution(entry: EntryPoint) -> str:
    dist = entry.dist
    return one_line(f"{dist.name} {dist.version}") if dist is not None else entry.value


@contextmanager
def _guarded(label: str, failure: str, problems: list[str]) -> Iterator[Callable[[], bool]]:
    """Turn whatever a plugin raises or prints into a line of ``problems``.

    Yields a function that tells, afterwards, whether it failed.
    """
    failed = False
    caught = io.StringIO()
    try:
        with _descriptor_to_stderr(), redirect_stdout(caught):
            yield lambda: failed
    except (Exception, SystemExit) as error:  # a stranger's code may raise anything
        failed = True
        reason = one_line(f"{type(error).__name__}: {one_line(error)}")
        problems.append(f"plugin {label} {failure}: {reason}: left out")
    printed = "" if caught.closed else caught.getvalue()
    if printed:
        problems.append(f"plugin {label} wrote to standard output: {one_line(printed)!r}")


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
