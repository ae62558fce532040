"""The plugin door: how grades, effects, commands, files and sections of a report come in.

Our own rings, capabilities that sizing, selection and the report do not need, come in by it too.

A plugin is a Python distribution with an entry point in the group ``designer.plugins``, whose
module implements one of the hooks below, or several::

    from pathlib import Path
    from designer.plugins import hookimpl

    @hookimpl
    def register_grades():
        return [Path(__file__).parent / "grades"]

Plugins are loaded into this process and trusted as any installed package is. One that raises or
exits becomes a line with its name and its distribution, and everything else works.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from contextlib import contextmanager, redirect_stdout
from dataclasses import dataclass
from functools import partial
from importlib.metadata import EntryPoint, distributions
from importlib.util import find_spec
from os import PathLike
from typing import TYPE_CHECKING, Any, TypeVar

import pluggy

import designer
from designer.errors import MissingRingError, PluginError, described, one_line

if TYPE_CHECKING:
    from designer.analysis.analyse import Analysis
    from designer.effects.effect import Effect
    from designer.exports.formats import Format
    from designer.foreign.robot import Importer
    from designer.grades.grade import Grade

PROJECT = "designer"
ENTRY_POINT_GROUP = "designer.plugins"


@dataclass(frozen=True, slots=True)
class Ring:
    """A capability that sizing, selection and the report do not need."""

    name: str
    rooms: tuple[str, ...]  #: folders of `designer/`; the last has its hooks
    commands: tuple[str, ...]  #: that it brings

    @property
    def is_installed(self) -> bool:
        """Whether a distribution has it."""
        specs = [find_spec(f"designer.{room}") for room in self.rooms]
        return all(spec is not None and spec.origin is not None for spec in specs)


RINGS = (
    Ring("reference", ("reference",), ("verify",)),
    Ring("exchange", ("foreign", "exports"), ("import", "export")),
    Ring("batch", ("sweeps", "optimum"), ("sweep", "optimise")),
    Ring("diagnosis", ("measured", "diagnosis"), ("diagnose",)),
    Ring("drafting", ("drafting",), ("catalog new",)),
    Ring("window", ("explore",), ("explore",)),
)
"""What no room of the core imports, and no other ring but where `tests/test_house.py` says so."""
OWN_ENTRIES = tuple(
    EntryPoint(name, f"designer.{module}", ENTRY_POINT_GROUP)
    for name, module in (
        ("builtin", "grades.builtin"),
        ("builtin-effects", "effects.builtin"),
        *((ring.name, ring.rooms[-1]) for ring in RINGS),
    )
)
"""Our own plugins, as `pyproject.toml` declares them.

They are taken from here, so that a checkout on Python's path, which declares nothing, has them too.
"""
OWN_NAMES = frozenset(entry.name for entry in OWN_ENTRIES)
OWN_SOURCE = f"cdpr-designer {designer.__version__}"

Value = TypeVar("Value")

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


@hookspec
def register_commands() -> Sequence[Callable[..., object]]:
    """Return a list of functions, each a command of its name as `typer` makes it.

    One that returns False has answered no.
    """
    raise NotImplementedError  # only the signature counts


@hookspec
def register_catalog_commands() -> Sequence[Callable[..., object]]:
    """Return a list of functions as before, each a command below `designer catalog`."""
    raise NotImplementedError  # only the signature counts


@hookspec
def register_importers() -> Sequence[Importer]:
    """Return a list of what reads robots from other programs' files, for `designer import`."""
    raise NotImplementedError  # only the signature counts


@hookspec
def register_exporters() -> Sequence[Format]:
    """Return a list of formats for `designer export`."""
    raise NotImplementedError  # only the signature counts


@hookspec
def register_report_sections() -> Sequence[Callable[[Analysis], tuple[str, str] | None]]:
    """Return a list of functions, each a section of the design report by its name.

    It returns title and body: text, or HTML as `markupsafe.Markup`; None where the study gives
    nothing for it.
    """
    raise NotImplementedError  # only the signature counts


@hookspec
def register_template_filters() -> Sequence[Callable[..., object]]:
    """Return a list of functions, each a filter of its name in templates of pages.

    Those of plugins are for the design report.
    """
    raise NotImplementedError  # only the signature counts


HOOKS = tuple(name for name in globals() if name.startswith("register_"))
"""Names of all hooks."""


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
    """All plugins that could be loaded: ours first, then the others by name."""

    loaded: tuple[Plugin, ...]
    problems: tuple[str, ...] = ()  #: a line for each that could not be loaded
    with_others: bool = True  #: whether others than ours were looked for


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
    absent = {ring.name for ring in RINGS if not ring.is_installed}
    plugins = {
        entry.name: Plugin(entry.name, OWN_SOURCE, _hooks_of(entry))
        for entry in OWN_ENTRIES
        if entry.name not in absent
    }
    for entry, source in _installed(problems) if with_plugins else ():
        name = one_line(entry.name)
        label = Plugin(name, source, {}).label
        if name in plugins:
            problems.append(f"{label} has the name of {plugins[name].source}: left out")
            continue
        hooks = attempt(partial(_hooks_of, entry), label, "cannot be loaded", problems)
        if hooks is not None:
            plugins[name] = Plugin(name, source, hooks)
    return Plugins(tuple(plugins.values()), tuple(problems), with_plugins)


def call_hook(plugins: Plugins, hook: str) -> tuple[list[Offer], list[str]]:
    """Return what the plugins give in answer to a hook, and one line for each that fails."""
    problems: list[str] = []
    offers = []
    for plugin in plugins.loaded:
        if hook not in plugin.hooks:
            continue
        answer = partial(_listed, plugin.hooks[hook])
        if plugin.name in OWN_NAMES:  # a fault of ours is no problem of a plugin
            items: tuple[object, ...] | None = answer()
        else:
            items = attempt(answer, plugin.label, f"fails in {hook}()", problems)
        if items is not None:
            offers.append(Offer(plugin.name, plugin.source, plugin.label, items))
    return offers, problems


def registered(
    plugins: Plugins,
    hook: str,
    kind: type[Value],
    name_of: Callable[[Value], str],
    taken: Collection[str] = (),
) -> tuple[dict[str, tuple[Value, str]], list[str]]:
    """Return what the plugins give in answer to a hook, by name, each with its plugin's label.

    The label of our own is empty. What is not of the class ``kind``, or has a name that is
    ``taken``, is left out with a line.
    """
    offers, problems = call_hook(plugins, hook)
    items: dict[str, tuple[Value, str]] = {}
    for offer in offers:
        for item in offer.items:
            problem = ""
            if not isinstance(item, kind):
                problem = f"{type(item).__name__} (expected {kind.__name__})"
            elif (name := name_of(item)) in taken or name in items:
                problem = f"{name!r}, which is there already"
            else:
                items[name] = item, "" if offer.name in OWN_NAMES else offer.label
            if problem:
                problems.append(f"{offer.label}: {hook}() gave {one_line(problem)}: left out")
    return items, problems


def command_name(function: Any) -> str:
    """Return a function's name with hyphens, as commands and sections have it.

    A name that Python keeps for itself ends in one more, such as ``import_``.
    """
    return str(function.__name__).removesuffix("_").replace("_", "-")


@contextmanager
def named(label: str, failure: str, *passed: type[BaseException]) -> Iterator[None]:
    """Make whatever goes wrong in a plugin a `PluginError`, except errors that are ``passed``.

    Without a label it is ours, and stays as it is.
    """
    try:
        yield
    except BaseException as error:  # it may also exit
        if not label or isinstance(error, (KeyboardInterrupt, *passed)):
            raise
        raise PluginError(f"{label} {failure}: {described(error)}") from error


def attempt(
    action: Callable[[], Value], label: str, failure: str, problems: list[str]
) -> Value | None:
    """Return what a plugin's code gives; None, and a line in ``problems``, where it fails.

    The line says whose code it is and what it did: ``label`` ``failure``, such as "cannot be
    loaded". What it prints goes to standard error: standard output may be read by a program.
    """
    try:
        with named(label, failure), redirect_stdout(sys.stderr):
            return action()
    except PluginError as error:
        problems.append(f"{error}: left out")
        return None


def require_ring(command: str) -> None:
    """Refuse a command whose ring a distribution left out; says which brings it.

    Raises
    ------
    MissingRingError
        If it is of a ring of ours that is not installed.
    """
    for ring in RINGS:
        if command in ring.commands and not ring.is_installed:
            folders = ", ".join(f"designer/{room}" for room in ring.rooms)
            raise MissingRingError(
                f"designer {command}: comes with the ring '{ring.name}' ({folders}), "
                "which is not installed here"
            )


def any_installed() -> bool:
    """Return whether plugins of others are installed, without loading any."""
    problems: list[str] = []
    return bool(_installed(problems) or problems)


def _installed(problems: list[str]) -> list[tuple[EntryPoint, str]]:
    """Return the entry points of others by name, each with its distribution and version."""
    own = {entry.value for entry in OWN_ENTRIES}
    entries: dict[EntryPoint, str] = {}
    for distribution in distributions():
        try:
            for entry in distribution.entry_points.select(group=ENTRY_POINT_GROUP):
                if entry.value not in own:  # the first on Python's path is the one that is loaded
                    source = one_line(f"{distribution.name} {distribution.version}")
                    entries.setdefault(entry, source)
        except Exception as error:  # metadata that are damaged
            place = one_line(getattr(distribution, "_path", "a distribution"))
            problems.append(f"{place}: its metadata cannot be read: {described(error)}: left out")
    return sorted(entries.items(), key=lambda item: (item[0].name, item[0].value))


def _hooks_of(entry: EntryPoint) -> dict[str, Callable[[], object]]:
    """Load an entry point, and return its hooks by name; raises anything where that fails."""
    if entry.pattern.match(entry.value) is None:
        raise ValueError(f"its entry point {one_line(entry.value)!r} names no module")
    manager = pluggy.PluginManager(PROJECT)  # for each its own: an error is of this plugin
    manager.add_hookspecs(sys.modules[__name__])
    manager.register(entry.load(), entry.name)
    manager.check_pending()  # a hook that is misspelt
    hooks = {
        name: implementation.function
        for name in HOOKS
        for implementation in getattr(manager.hook, name).get_hookimpls()
    }
    if not hooks:
        raise TypeError("it has no hook such as register_grades()")
    return hooks


def _listed(hook: Callable[[], object]) -> tuple[object, ...]:
    answer = hook()
    if not isinstance(answer, list | tuple):
        raise TypeError(f"it returned {type(answer).__name__}, not a list")
    return tuple(answer)
