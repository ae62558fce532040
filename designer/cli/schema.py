"""`designer schema`: what a study may hold, for editors."""

from __future__ import annotations

from functools import partial
from pathlib import Path
from typing import Annotated

import typer

from designer.cli.options import NoPlugins, option


def schema(
    output: Annotated[
        Path | None,
        option("-o", "--output", metavar="FILE", text="File to write; printed if left out."),
    ] = None,
    no_plugins: NoPlugins = False,
) -> None:
    """Give the JSON Schema of a study, by which editors complete, explain and check it.

    `designer init` writes it beside the study. Write it again after an update of cdpr-designer, or
    when a plugin that brings effects has come or gone.

    Example:  designer schema -o cdpr-designer.schema.json
    """
    from designer.io.output import write_file

    text = _text(no_plugins)
    if output is None:
        typer.echo(text, nl=False)
        return
    write_file(output, text)
    typer.echo(f"{output} written")


def write_with_schema(study: Path, text: str) -> None:
    """Write a new study, and beside it the schema that its head names."""
    from designer.io.config.moved import SCHEMA_FILE, with_modeline
    from designer.io.output import write_file, write_new_file
    from designer.io.process import undone_at_end

    schema = _text(no_plugins=False)
    write_new_file(study, with_modeline(text))
    with undone_at_end() as undo:
        undo.add(partial(study.unlink, missing_ok=True))
        write_file(study.with_name(SCHEMA_FILE), schema)
        undo.forget()


def _text(no_plugins: bool) -> str:
    from designer.cli.terminal import print_left_out
    from designer.effects.load import load_effects
    from designer.io.config.json_schema import schema_text
    from designer.plugins import find_plugins

    effects = load_effects(find_plugins(with_plugins=not no_plugins))
    print_left_out(effects.problems)
    return schema_text(effects.by_id)
