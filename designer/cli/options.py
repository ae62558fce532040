"""What the commands share: exit statuses, arguments and options, the study that they name."""

from __future__ import annotations

import sys
from collections.abc import Callable
from copy import copy
from functools import partial
from pathlib import Path
from types import FunctionType
from typing import TYPE_CHECKING, Annotated, Any

import typer
from rich.markup import escape
from typer.core import TyperGroup

from designer.errors import DesignerError, InputError
from designer.io.process import is_terminal
from designer.units import Dimension, QuantityError, read_quantity

if TYPE_CHECKING:
    from designer.grades.registry import Catalogue
    from designer.plugins import Plugins
    from designer.study import Study

NEGATIVE_ANSWER = 1
"""Of a command that returns False."""
WRONG_INPUT = 2
INTERRUPTED = 130
"""As the shell gives it after Ctrl-C."""


class HookedCommands(TyperGroup):
    """Commands of the core, and those that a hook gives: of our rings, and of plugins.

    Their help is as wide as the terminal, and has no markup.
    """

    hook: str
    order: tuple[str, ...]  #: in which they are listed; those of plugins follow

    def __init__(self, **settings: Any) -> None:
        super().__init__(**settings)
        self._core, self._levels = tuple(self.commands), set[bool]()

    def list_commands(self, ctx: Any) -> list[str]:
        """Return the names of all commands."""
        from designer.plugins import any_installed

        self._add(with_plugins=any_installed())
        rank = {name: place for place, name in enumerate(self.order)}
        return sorted(self.commands, key=lambda name: rank.get(name, len(rank)))

    def _add(self, *, with_plugins: bool) -> None:
        """Add the commands of our rings, or of plugins as well, unless they are there."""
        from designer.cli.terminal import print_left_out
        from designer.plugins import attempt, command_name, find_plugins, registered

        if with_plugins in self._levels:
            return
        self._levels.add(with_plugins)
        plugins = find_plugins(with_plugins)
        functions, problems = registered(plugins, self.hook, FunctionType, command_name, self._core)
        for name, (function, label) in functions.items():
            if name not in self.commands:
                made = partial(_hooked_command, name, function, label)
                command = attempt(made, label, f"has an unusable command {name}", problems)
                if command is not None:
                    self.commands[name] = command
        print_left_out([*plugins.problems, *problems])

    def get_command(self, ctx: Any, name: str) -> Any:
        """Return a command; plugins are looked at where none of ours has the name.

        Its help is joined to paragraphs: rich would keep the line breaks of its docstring.
        """
        from designer.plugins import any_installed, require_ring

        if name not in self.commands:
            self._add(with_plugins=False)
        if name not in self.commands and any_installed():
            self._add(with_plugins=True)
        if name not in self.commands:
            require_ring(f"catalog {name}" if "catalog" in self.hook else name)
        command = copy(super().get_command(ctx, name))
        if command is not None and command.help:
            paragraphs = escape(command.help).split("\n\n")
            joined = (
                part if part.startswith("\b") else part.replace("\n", " ") for part in paragraphs
            )
            command.help = "\n\n".join(joined)
        return command


def _hooked_command(name: str, function: FunctionType, label: str) -> Any:
    """Return a function as a command; whatever goes wrong in a plugin's names the plugin."""
    from designer.plugins import named

    single = typer.Typer(add_completion=False, rich_markup_mode="rich")
    single.command(name)(function)
    command: Any = typer.main.get_command(single)
    action = command.callback
    answers = (DesignerError, typer.Exit, typer.Abort, typer.BadParameter, SystemExit)

    def run(*arguments: Any, **options: Any) -> Any:
        with named(label, f"fails in the command {name}", *answers, BrokenPipeError):
            return action(*arguments, **options)

    command.callback = run
    return command


def can_ask() -> bool:
    """Tell whether somebody sits at a terminal and can be asked."""
    return is_terminal(sys.stdin) and is_terminal(sys.stdout)


def path_of(text: str) -> Path:
    """Return the path that an argument names; an empty one names nothing."""
    if not text.strip():  # such as "$OUT" where nothing is in it; pathlib takes it as '.'
        raise InputError.at("command line", "a path is empty", "a file or folder")
    return Path(text)


def quantity_of(option: str, text: str, dimension: Dimension) -> float:
    """Return the value [SI] that an option names."""
    try:
        return read_quantity(text, dimension)
    except QuantityError as error:
        raise InputError.at(option, error.problem, error.expected) from None


def _template_of(text: str) -> Path:
    """Return the folder of templates that an option names, if it can be used."""
    from designer.report.templates import check_templates

    folder = path_of(text)
    check_templates(folder)
    return folder


def argument(metavar: str, text: str) -> Any:
    """Return an argument that names a file or folder; ``text`` is its help."""
    return typer.Argument(parser=path_of, metavar=metavar, help=text)


def option(*names: str, metavar: str, text: str, parser: Callable[[str], Any] = path_of) -> Any:
    """Return an option with a value, a file or folder unless ``parser`` reads something else."""
    return typer.Option(*names, parser=parser, metavar=metavar, help=text)


def output_option(usual: str, metavar: str = "DIR") -> Any:
    """Return the option for the folder, or FILE, to write; ``usual`` is what else is written."""
    kind = "Folder" if metavar == "DIR" else "File"
    text = f"{kind} to write, {usual} if left out."
    return option("-o", "--output", metavar=metavar, text=text)


Config = Annotated[Path, argument("CONFIG", "The study, a YAML file.")]
NoPlugins = Annotated[
    bool,
    typer.Option(
        "--no-plugins", help="Use shipped grades and effects only, for repeatable studies."
    ),
]
AsJson = Annotated[bool, typer.Option("--json", help="Print JSON instead of a table.")]
Template = Annotated[
    Path | None,
    option(
        "--template",
        metavar="DIR",
        text="Folder of page templates and styles of yours, which come before ours.",
        parser=_template_of,
    ),
]


def study_of(
    config: Path, no_plugins: bool, plugins: Plugins | None = None
) -> tuple[Study, Plugins]:
    """Read a study with the plugins that there are, or with those that were found for another.

    Names plugins and effects that cannot be used.
    """
    from designer.cli.terminal import print_left_out
    from designer.effects.load import load_effects
    from designer.io.config import read_study
    from designer.plugins import find_plugins

    plugins = plugins or find_plugins(with_plugins=not no_plugins)
    effects = load_effects(plugins)
    print_left_out(effects.problems)
    return read_study(config, effects, plugins), plugins


def catalogue_of(study: Study, plugins: Plugins) -> Catalogue:
    """Load all grades; names those that could not be used, and knows those that a study names."""
    from designer.cli.terminal import print_left_out
    from designer.grades.registry import load_catalogue

    catalogue = load_catalogue(study.catalogues, plugins=plugins)
    problems = study.known_effects.problems
    print_left_out(problem for problem in catalogue.problems if problem not in problems)
    catalogue.require_grades_of(study)
    return catalogue
