"""The commands; each is one visible pipeline from a file to an answer.

Nothing heavy is imported here: `designer --help` and `designer catalog` answer at once.
"""

from __future__ import annotations

import atexit
import gc
import shlex
import sys
from collections.abc import Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from designer import __version__
from designer.cli.catalog import catalog
from designer.cli.lengths import lengths, pose
from designer.cli.options import (
    INTERRUPTED,
    NEGATIVE_ANSWER,
    WRONG_INPUT,
    Config,
    HookedCommands,
    NoPlugins,
    Template,
    argument,
    can_ask,
    catalogue_of,
    option,
    output_option,
    study_of,
)
from designer.errors import DesignerError, InputError, OutputError, described, visible
from designer.io.process import interruption, readable_output, settle_in
from designer.resources import example_names

if TYPE_CHECKING:
    from designer.analysis.comparison import Comparison
    from designer.documents.plain import Json
    from designer.grades.registry import Catalogue
    from designer.study import Study


class Commands(HookedCommands):
    """All commands; typer itself would give a closed pipe the status of a negative answer."""

    hook = "register_commands"
    order = (
        "lengths", "pose", "compare", "sweep", "optimise", "import", "export", "verify", "schema",
        "report", "size", "diagnose", "explore", "init", "catalog",
    )  # fmt: skip

    def make_context(self, *arguments: Any, **named: Any) -> Any:
        """Read the arguments; those that ask for help are answered here."""
        with readable_output():
            return super().make_context(*arguments, **named)

    def invoke(self, ctx: Any) -> Any:
        """Run the command that is asked for; one that returns False has answered no."""
        with readable_output():
            try:
                answer = super().invoke(ctx)
            except EOFError as error:  # typer would call it aborted, with the status of an answer
                raise RuntimeError(described(error)) from error
            except typer.Abort:  # the end of input where something was asked
                typer.echo(f"\n{interruption()}", err=True)
                raise typer.Exit(INTERRUPTED) from None
            if answer is False:
                raise typer.Exit(NEGATIVE_ANSWER)
            return answer


app = typer.Typer(
    cls=Commands,
    help="Size the cables of large cable-driven parallel robots, and report it.",
    epilog="Start with:  designer init my-crane.yaml  then  designer report my-crane.yaml",
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    rich_markup_mode="rich",
)
app.add_typer(catalog, name="catalog")
app.command()(lengths)
app.command()(pose)


_OBJECTS_BEFORE_SEARCH = 100_000
"""Between two searches for cycles, which else take a fifteenth of a report's time."""


def main() -> None:
    """Run the command line; a user's mistake ends with one line a fault and exit status 2."""
    gc.set_threshold(_OBJECTS_BEFORE_SEARCH)
    atexit.register(gc.freeze)  # what is left goes with the process: to search it takes a second
    settle_in()
    try:
        with readable_output():
            try:
                app()
            except DesignerError as error:
                print(visible(str(error)), file=sys.stderr)
                sys.exit(WRONG_INPUT)
    except OutputError:  # of standard error itself: nobody can be told
        sys.exit(WRONG_INPUT)


@app.callback(invoke_without_command=True)
def _options(
    context: typer.Context,
    version: Annotated[bool, typer.Option("--version", help="Print the version and stop.")] = False,
    verbose: Annotated[
        bool,
        typer.Option("-v", help="With --version: also all that a bug report needs to say."),
    ] = False,
) -> None:
    if version:
        if verbose:
            from designer.cli.versions import versions

            for name, version_text in versions():
                typer.echo(f"{name:20} {version_text}")
        else:
            typer.echo(f"cdpr-designer {__version__}")
        raise typer.Exit
    if context.invoked_subcommand is None:
        context.fail("-v goes with --version, or a command is missing")


@app.command()
def report(
    config: Config,
    output: Annotated[Path | None, output_option("CONFIG-report")] = None,
    quick: Annotated[
        bool, typer.Option("--quick", help="Page 1 and the answer alone, into CONFIG-quick.")
    ] = False,
    template: Template = None,
    no_plugins: NoPlugins = False,
) -> bool:
    """Size, sweep the workspace, choose a rope, and write the report.

    Writes report.html, report.pdf, result.json, candidates.csv, reactions.csv, workspace.nc
    and, along a path, path.csv. With --quick it tries no proof and writes page 1 alone, without
    charts, as report.html: for trying out changes in seconds.

    \b
    Examples:
      designer report fast.yaml -o fast-report
      designer report fast.yaml --quick

    Exit status 0: the answer is yes, every requirement holds. 1: it is no, or open, and the report
    says why. 2: the input is wrong, and nothing is written.
    """
    from designer.cli.tables import print_summary
    from designer.cli.terminal import ProgressBars, announce_compiling, print_left_out
    from designer.io.output import file_names, output_folder
    from designer.report.figures.opengl import begin_probe, why_no_scenes
    from designer.study import require_answerable

    study, plugins = study_of(config, no_plugins)
    require_answerable(study)
    folder = output or Path(f"{config.stem}-{'quick' if quick else 'report'}")
    if not quick:
        begin_probe()
    catalogue = catalogue_of(study, plugins)
    announce_compiling(proves=not quick)

    from designer.analysis.analyse import Analysis, analyse
    from designer.report.render import REPORT_FILES, write_report_files

    with output_folder(folder, REPORT_FILES) as building, ProgressBars() as bars:
        if quick:
            analysis = Analysis.begin(study.unproved, catalogue, reporter=bars)
        else:
            analysis = analyse(study, catalogue, building, bars)
        problems = write_report_files(analysis, building, template, bars, quick=quick)
        written = file_names(building)
    print_left_out(filter(None, ["" if quick else why_no_scenes(), *problems]))
    print_summary(analysis, folder, written)
    return analysis.is_positive


@app.command()
def size(
    config: Config,
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON instead of tables.")] = False,
    no_plugins: NoPlugins = False,
) -> bool:
    """Size the configured pose alone: massless, loop with its iterates, optimum.

    Example:  designer size fast.yaml
    """
    from designer.analysis.result_json import size_dict
    from designer.cli.tables import print_pose
    from designer.cli.terminal import announce_compiling
    from designer.documents.plain import json_text

    study, plugins = study_of(config, no_plugins)
    if study.selection is not None and study.selection.grades is not None:
        catalogue_of(study, plugins)  # misspelt grades are told here as by `report`
    announce_compiling()
    from designer.analysis.pose import analyse_pose

    pose = analyse_pose(study)
    if as_json:
        typer.echo(json_text(size_dict(study, pose)))
    else:
        print_pose(study, pose)
    return bool(pose.sizing.statics.is_solved)


@app.command()
def init(
    path: Annotated[
        Path | None, argument("PATH", "File to write, EXAMPLE.yaml if left out.")
    ] = None,
    example: Annotated[
        str | None,
        typer.Option(
            "--example",
            metavar="NAME",
            help="Which study to copy; see --list. Left out, a terminal is asked; else the hoist.",
            autocompletion=example_names,
        ),
    ] = None,
    lists: Annotated[
        bool, typer.Option("--list", help="Tell what studies there are, and stop.")
    ] = False,
) -> None:
    """Write a commented study to start from, and beside it the schema by which editors check it.

    Of the shipped examples, the one that is nearest to your robot; `fast` explains all fields.

    \b
    Examples:
      designer init my-crane.yaml
      designer init --example fast all-fields.yaml
    """
    from designer.resources import example_file, example_summary

    names = example_names()
    width = max(map(len, names))
    summaries = [f"{name:{width}}  {example_summary(name)}" for name in names]
    if lists:
        typer.echo("\n".join(summaries))
        return
    if example is None and can_ask():
        for number, summary in enumerate(summaries, start=1):
            typer.echo(f"{number:3}  {summary}")
        while example not in names:
            answer = typer.prompt("Which is nearest to yours? Number or name", default="hoist")
            is_number = answer.isdecimal() and 0 < int(answer) <= len(names)
            example = names[int(answer) - 1] if is_number else answer.strip()
    example = example or "hoist"
    if example not in names:
        raise InputError.at("--example", f"there is no example {example!r}", ", ".join(names))
    target = path or Path(f"{example}.yaml")
    _write_with_schema(target, example_file(example).read_text(encoding="utf-8"))
    typer.echo(f"{target} written. Next:  designer report {shlex.quote(str(target))}")


@app.command()
def compare(
    a: Annotated[Path, argument("A", "A study or result.json.")],
    b: Annotated[Path, argument("B", "Another one.")],
    output: Annotated[Path | None, output_option("A-B-comparison")] = None,
    template: Template = None,
    no_plugins: NoPlugins = False,
) -> None:
    """Put two designs side by side: what differs in what was asked, and in the answer.

    Studies are solved first; results of `designer report` are taken as they are. Writes
    comparison.html, comparison.pdf and comparison.json.

    Example:  designer compare crane.yaml crane-report/result.json
    """
    from designer.cli.terminal import ProgressBars, announce_compiling
    from designer.io.output import file_names, output_folder
    from designer.io.results import read_result

    sources: list[Json | tuple[Study, Catalogue]] = []
    plugins = None
    for path in (a, b):
        if path.suffix == ".json":
            sources.append(read_result(path))
        else:
            study, plugins = study_of(path, no_plugins, plugins)
            sources.append((study, catalogue_of(study, plugins)))
    announce_compiling(proves=True)

    from designer.analysis.analyse import analyse
    from designer.analysis.comparison import compare as compare_results
    from designer.documents.plain import json_text
    from designer.report.comparison import write_comparison

    folder = output or Path(f"{a.stem}-{b.stem}-comparison")
    with output_folder(folder) as building, ProgressBars() as bars:
        results = [
            source if isinstance(source, dict) else analyse(*source, reporter=bars).to_dict()
            for source in sources
        ]
        comparison = compare_results(*results)
        write_comparison(comparison, (a.name, b.name), building, template)
        text = f"{json_text(comparison.to_dict())}\n"
        (building / "comparison.json").write_text(text, encoding="utf-8")
        written = file_names(building)
    _print_comparison(comparison, (a.name, b.name), folder, written)


def _print_comparison(
    comparison: Comparison, names: tuple[str, str], folder: Path, written: Sequence[str]
) -> None:
    from rich.markup import escape

    from designer.cli.terminal import bare_table, show
    from designer.report.phrases import relative_change, result_value

    if comparison.is_same:
        show("Nothing differs.")
    table = bare_table("", f"A: {names[0]}", f"B: {names[1]}", "change")
    for line in (*comparison.inputs, *comparison.answers, *comparison.unmet):
        if line.differs:
            values = (result_value(value, line.path) for value in (line.a, line.b))
            table.add_row(*map(escape, (line.label or line.path, *values, relative_change(line))))
    if table.row_count:
        show(table)
    show(f"{folder}: {', '.join(written)}", markup=False)


@app.command()
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

    text = _schema_text(no_plugins)
    if output is None:
        typer.echo(text, nl=False)
        return
    write_file(output, text)
    typer.echo(f"{output} written")


def _write_with_schema(study: Path, text: str) -> None:
    """Write a new study, and beside it the schema that its head names."""
    from designer.io.config.moved import SCHEMA_FILE, with_modeline
    from designer.io.output import write_file, write_new_file
    from designer.io.process import undone_at_end

    schema = _schema_text(no_plugins=False)
    write_new_file(study, with_modeline(text))
    with undone_at_end() as undo:
        undo.add(partial(study.unlink, missing_ok=True))
        write_file(study.with_name(SCHEMA_FILE), schema)
        undo.forget()


def _schema_text(no_plugins: bool) -> str:
    from designer.cli.terminal import print_left_out
    from designer.effects.load import load_effects
    from designer.io.config.json_schema import schema_text
    from designer.plugins import find_plugins

    effects = load_effects(find_plugins(with_plugins=not no_plugins))
    print_left_out(effects.problems)
    return schema_text(effects.by_id)
