"""The commands; each is one visible pipeline from a file to an answer.

Nothing heavy is imported here: `designer --help` and `designer catalog` answer at once.
"""

from __future__ import annotations

import atexit
import gc
import shlex
import sys
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from designer import __version__
from designer.cli.catalog import catalog
from designer.cli.compare import compare
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
from designer.cli.plan import write_plan
from designer.cli.schema import schema, write_with_schema
from designer.errors import (
    DesignerError,
    InputError,
    OutputError,
    described,
    visible,
)
from designer.io.process import interruption, readable_output, settle_in
from designer.resources import example_names

if TYPE_CHECKING:
    from designer.diagnosis.result import Diagnosis


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
app.command()(compare)
app.command()(schema)


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
def diagnose(
    config: Config,
    output: Annotated[Path | None, output_option("CONFIG-diagnosis")] = None,
    checks: Annotated[
        bool, typer.Option("--check", help="Search nothing: how well do the declared effects fit?")
    ] = False,
    data: Annotated[
        Path | None,
        option("--data", metavar="CSV", text="Measured data, instead of the study's."),
    ] = None,
    plans: Annotated[
        bool, typer.Option("--plan", help="Before there are data: which poses to measure?")
    ] = False,
    poses: Annotated[
        int | None, typer.Option("--poses", metavar="N", help="With --plan: how many poses.")
    ] = None,
    unknown: Annotated[
        list[str] | None,
        typer.Option(
            "--unknown", metavar="NAME", help="With --plan: instead of measurements.unknown."
        ),
    ] = None,
    length_noise: Annotated[
        str | None,
        typer.Option(
            metavar="LENGTH", help="With --plan: deviation of a length, instead of the study's."
        ),
    ] = None,
    tension_noise: Annotated[
        str | None,
        typer.Option(metavar="FORCE", help="With --plan: deviation of a tension, as before."),
    ] = None,
    template: Template = None,
    no_plugins: NoPlugins = False,
) -> bool:
    """Compare measured data with the model, and find the effect that the model lacks.

    Writes diagnosis.html, diagnosis.pdf, diagnosis.json, residuals.csv and CONFIG.diagnosed.yaml,
    which has what was fitted and found under `effects:`, and how surely it is known under
    `uncertainty:`; `designer report` on it uses both. With --check
    nothing is searched, and check.html, check.pdf and diagnosis.json go into CONFIG-check.

    With --plan there are no data yet: it chooses the poses that tell most of what is unknown, and
    writes plan.csv for the controller, plan.html, plan.pdf and plan.json, with the deviations to
    expect, into CONFIG-plan; with -o FILE.csv the table alone. What is unknown, what will be read
    and its noise stand under `measurements:`, whose file need not be there, or in options.

    \b
    Examples:
      designer diagnose built-crane.yaml
      A month later:  designer diagnose --check built-crane.diagnosed.yaml --data new.csv
      Before:  designer diagnose --plan crane.yaml --unknown anchors --length-noise "1 mm"

    Exit status 0: the model, with what was found, agrees with the data, or the plan tells all that
    is unknown. 1: something is left or not plausible, declared effects do not help, or the plan
    leaves something unknown. 2: the input is wrong.
    """
    asked = (poses, unknown, length_noise, tension_noise)
    if plans:
        is_alone = not checks and data is None
        return write_plan(config, output, *asked, is_alone, template, no_plugins=no_plugins)
    if any(asked):
        raise InputError.at("designer diagnose", "has options of a plan", "--plan beside them")
    from designer.cli.tables import print_check, print_diagnosis
    from designer.cli.terminal import ProgressBars, announce_compiling, print_left_out
    from designer.io.output import file_names, output_folder, require_file
    from designer.measured.read import read_measured
    from designer.measured.table import is_bag

    study, plugins = study_of(config, no_plugins)
    if data is not None and study.measurements is not None:
        if not data.is_file() and not is_bag(data):
            raise InputError.at("--data", f"there is no file {data}", "a CSV file")
        study = replace(study, measurements=study.measurements.of_file(data))
    measured = read_measured(study)
    catalogue = None if checks else catalogue_of(study, plugins)
    announce_compiling()
    folder = output or Path(f"{config.stem}-{'check' if checks else 'diagnosis'}")

    from designer.diagnosis.check import Check, check
    from designer.diagnosis.design import with_design
    from designer.diagnosis.diagnose import diagnose_study
    from designer.io.results import diagnosed_config
    from designer.report.diagnosis.report import write_check, write_diagnosis

    doing = "checking" if checks else "searching"
    with output_folder(folder) as building, ProgressBars(doing) as bars:
        require_file(folder / f"{config.stem}.diagnosed.yaml")
        result: Check | Diagnosis
        if catalogue is None:
            result = check(study, measured, bars)
            bars("report")
            write_check(result, building, template)
        else:
            result = diagnose_study(study, measured, bars)
            bars("the design with and without")
            result = with_design(result, catalogue.grades)
            bars("report")
            write_diagnosis(result, building, template)
            residuals = result.residuals_csv()
            (building / "residuals.csv").write_text(residuals, encoding="utf-8")
            text = diagnosed_config(result, folder)
            (building / f"{config.stem}.diagnosed.yaml").write_text(text, encoding="utf-8")
        (building / "diagnosis.json").write_text(f"{result.to_json()}\n", encoding="utf-8")
        written = file_names(building)
    if isinstance(result, Check):
        print_check(result, folder, written)
        return result.is_positive
    n_known = len(study.known_effects.problems)
    print_left_out(result.study.known_effects.problems[n_known:])
    print_diagnosis(result, folder, written)
    return result.is_positive


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
    write_with_schema(target, example_file(example).read_text(encoding="utf-8"))
    typer.echo(f"{target} written. Next:  designer report {shlex.quote(str(target))}")
