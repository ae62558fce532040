"""What the commands share: exit statuses, arguments and options."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from designer.errors import Fault, InputError
from designer.units import Dimension, QuantityError, read_quantity

NEGATIVE_ANSWER = 1
WRONG_INPUT = 2
INTERRUPTED = 130
"""As the shell gives it after Ctrl-C."""


def path_of(text: str) -> Path:
    """Return the path that an argument names; an empty one names nothing."""
    if not text.strip():  # such as "$OUT" where nothing is in it; pathlib takes it as '.'
        raise InputError([Fault("command line", None, "", "a path is empty", "a file or folder")])
    return Path(text)


def quantity_of(option: str, text: str, dimension: Dimension) -> float:
    """Return the value [SI] that an option names."""
    try:
        return read_quantity(text, dimension)
    except QuantityError as error:
        raise InputError([Fault(option, None, "", error.problem, error.expected)]) from None


def _template_of(text: str) -> Path:
    """Return the folder of templates that an option names, if it can be used."""
    from designer.report.templates import check_templates

    folder = path_of(text)
    check_templates(folder)
    return folder


def output_option(usual: str, metavar: str = "DIR") -> typer.models.OptionInfo:
    """Return the option for the folder, or FILE, to write; ``usual`` is what else is written."""
    kind = "Folder" if metavar == "DIR" else "File"
    return typer.Option(  # type: ignore[no-any-return]  # typer types it for use as a default
        "-o",
        "--output",
        parser=path_of,
        metavar=metavar,
        help=f"{kind} to write, {usual} if left out.",
    )


Config = Annotated[
    Path, typer.Argument(parser=path_of, metavar="CONFIG", help="The study, a YAML file.")
]
NoPlugins = Annotated[
    bool,
    typer.Option(
        "--no-plugins", help="Use shipped grades and effects only, for repeatable studies."
    ),
]
Template = Annotated[
    Path | None,
    typer.Option(
        "--template",
        parser=_template_of,
        metavar="DIR",
        help="Folder of page templates and styles of yours, which come before ours.",
    ),
]
