"""`designer explore`: the desktop window."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from designer.cli.options import NoPlugins, argument, option
from designer.errors import InputError, MissingLibraryError


def explore(
    config: Annotated[Path | None, argument("[CONFIG]", "The study, a YAML file.")] = None,
    screenshot: Annotated[
        Path | None,
        option(
            "--screenshot",
            metavar="FILE",
            text="Save a picture of the window once everything is answered, and close it.",
        ),
    ] = None,
    no_plugins: NoPlugins = False,
) -> None:
    """Open the desktop window to find a design in.

    Needs the extra `desktop`:  pip install 'cdpr-designer[desktop]'

    Example:  designer explore my-crane.yaml

    Exit status 0: the window was closed. 2: no window can be opened, or the file cannot be read.
    """
    from designer.explore.desktop.display import begin_probe, why_no_library, why_no_window

    missing = why_no_library()
    if missing:
        raise MissingLibraryError(missing)
    if config is not None and not config.is_file():
        raise InputError.at(config, "there is no such file", "a study")
    missing = why_no_window(begin_probe())
    if missing:
        raise MissingLibraryError(missing)
    from designer.explore.desktop.app import run

    raise typer.Exit(run(config, screenshot, with_plugins=not no_plugins))
