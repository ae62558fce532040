"""The commands; each is one visible pipeline from a file to an answer.

Nothing heavy is imported here: `designer --help` and `designer catalog` answer at once.
"""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from designer import __version__
from designer.errors import DesignerError, Fault, InputError

if TYPE_CHECKING:
    from designer.catalogue.registry import Catalogue
    from designer.study import Study

NEGATIVE_ANSWER = 1
WRONG_INPUT = 2

app = typer.Typer(
    help="Size the cables of large cable-driven parallel robots, and report it.",
    epilog="Start with:  designer init my-crane.yaml  then  designer report my-crane.yaml",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    rich_markup_mode="rich",
)
catalog = typer.Typer(help="Look at the rope grades that are known.", no_args_is_help=True)
app.add_typer(catalog, name="catalog")

Config = Annotated[Path, typer.Argument(metavar="CONFIG", help="The study, a YAML file.")]
NoPlugins = Annotated[
    bool, typer.Option("--no-plugins", help="Use the shipped grades only, for repeatable studies.")
]


def main() -> None:
    """Run the command line; a user's mistake ends with one line a fault and exit status 2."""
    try:
        app()
    except DesignerError as error:
        print(error, file=sys.stderr)
        sys.exit(WRONG_INPUT)


def _version(wanted: bool) -> None:
    if wanted:
        typer.echo(f"cdpr-designer {__version__}")
        raise typer.Exit


@app.callback()
def _options(
    _: Annotated[
        bool,
        typer.Option(
            "--version",
            help="Print the version and stop.",
            is_eager=True,
            callback=_version,
        ),
    ] = False,
) -> None:
    pass


@app.command()
def report(
    config: Config,
    output: Annotated[
        Path | None,
        typer.Option(
            "-o", "--output", metavar="DIR", help="Folder to write, CONFIG-report if left out."
        ),
    ] = None,
    no_plugins: NoPlugins = False,
) -> None:
    """Size, sweep the workspace, choose a rope, and write the report.

    Writes report.html, report.pdf, result.json and workspace.nc.

    Example:  designer report fast.yaml -o fast-report

    Exit status 0: there is a cable. 1: there is none, and the report says why. 2: the input is
    wrong, and nothing is written.
    """
    from designer.output import output_folder
    from designer.report.figures.opengl import require_opengl
    from designer.study import require_square
    from designer.terminal import ProgressBars, announce_compiling, print_faults_of, print_summary

    study = _study(config)
    require_square(study)
    if study.workspace is None and study.pose is None:
        raise InputError(
            [study.source.fault("", "nothing to solve", "a pose, a workspace or both")]
        )
    folder = output or Path(f"{config.stem}-report")
    require_opengl()
    catalogue = _catalogue(study, with_plugins=not no_plugins)
    print_faults_of(catalogue)
    announce_compiling()

    from designer.analysis import analyse
    from designer.report.render import write_report
    from designer.result_json import write_result

    with output_folder(folder) as building, ProgressBars() as bars:
        analysis = analyse(study, catalogue, building, bars)
        with bars.task("report", 1) as advance:
            write_report(analysis, building)
            advance(1)
        write_result(analysis, building / "result.json")
    print_summary(analysis, folder)
    if not analysis.is_positive:
        raise typer.Exit(NEGATIVE_ANSWER)


@app.command()
def size(
    config: Config,
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON instead of tables.")] = False,
) -> None:
    """Size the configured pose alone: massless, loop with its iterates, optimum.

    Example:  designer size fast.yaml
    """
    from designer.result_json import size_text
    from designer.study import require_square
    from designer.terminal import announce_compiling, print_pose

    study = _study(config)
    require_square(study)
    announce_compiling()
    from designer.analysis import analyse_pose

    pose = analyse_pose(study)
    if pose is None:
        raise InputError(
            [study.source.fault("pose", "is missing", "a pose, such as [250, 200, -50]")]
        )
    if as_json:
        typer.echo(size_text(study, pose))
    else:
        print_pose(study, pose)
    if not pose.sizing.statics.is_solved:
        raise typer.Exit(NEGATIVE_ANSWER)


@app.command()
def diagnose(
    config: Config,
    output: Annotated[
        Path | None,
        typer.Option(
            "-o", "--output", metavar="DIR", help="Folder to write, CONFIG-diagnosis if left out."
        ),
    ] = None,
    no_plugins: NoPlugins = False,
) -> None:
    """Compare measured data with the model, and find the effect that the model lacks.

    Writes diagnosis.html, diagnosis.pdf, diagnosis.json and CONFIG.diagnosed.yaml, which has what
    was found under `effects:`; `designer report` on it uses it everywhere.

    Example:  designer diagnose built-crane.yaml

    Exit status 0: all structure is explained. 1: some is left. 2: the input is wrong.
    """
    from designer.measured.read import read_measured
    from designer.output import output_folder
    from designer.terminal import Spinner, announce_compiling, print_diagnosis, print_faults_of

    study = _study(config)
    if study.measurements is None:
        raise InputError([study.source.fault("measurements", "is missing", "a table to compare")])
    measured = read_measured(study)
    catalogue = _catalogue(study, with_plugins=not no_plugins)
    print_faults_of(catalogue)
    announce_compiling()
    folder = output or Path(f"{config.stem}-diagnosis")

    from designer.diagnosis.case import case_of
    from designer.diagnosis.design import with_design
    from designer.diagnosis.diagnose import diagnose as run
    from designer.diagnosis_files import diagnosed_config, diagnosis_text
    from designer.report.diagnosis import write_diagnosis

    with output_folder(folder) as building, Spinner("searching") as spinner:
        diagnosis = run(case_of(study, study.measurements, measured), spinner)
        spinner("the design with and without")
        diagnosis = with_design(diagnosis, catalogue.grades)
        spinner("report")
        write_diagnosis(diagnosis, building)
        (building / "diagnosis.json").write_text(diagnosis_text(diagnosis), encoding="utf-8")
        text = diagnosed_config(diagnosis, folder)
        (building / f"{config.stem}.diagnosed.yaml").write_text(text, encoding="utf-8")
    print_diagnosis(diagnosis, folder)
    if diagnosis.is_unexplained:
        raise typer.Exit(NEGATIVE_ANSWER)


@app.command()
def init(
    path: Annotated[
        Path | None, typer.Argument(metavar="PATH", help="File to write, EXAMPLE.yaml if left out.")
    ] = None,
    example: Annotated[
        str, typer.Option("--example", metavar="NAME", help="Which study to copy.")
    ] = "fast",
) -> None:
    """Write a commented study to start from.

    Example:  designer init --example yard my-crane.yaml
    """
    from designer.output import write_new_file
    from designer.resources import example_file, example_names

    if example not in example_names():
        names = ", ".join(example_names())
        raise InputError([Fault("--example", None, "", f"there is no example {example!r}", names)])
    target = path or Path(f"{example}.yaml")
    write_new_file(target, example_file(example).read_text(encoding="utf-8"))
    typer.echo(f"{target} written. Next:  designer report {target}")


@catalog.command("list")
def catalog_list(no_plugins: NoPlugins = False) -> None:
    """List all grades with their source.

    Example:  designer catalog list
    """
    from designer.catalogue.listing import list_rows
    from designer.catalogue.registry import load_catalogue
    from designer.terminal import print_faults_of, print_grades

    catalogue = load_catalogue(with_plugins=not no_plugins)
    print_faults_of(catalogue)
    print_grades(list_rows(catalogue))


@catalog.command("show")
def catalog_show(
    grade: Annotated[str, typer.Argument(metavar="GRADE", help="Id from `designer catalog list`.")],
    no_plugins: NoPlugins = False,
) -> None:
    """Show one grade: where its figures come from, and its sizes.

    Example:  designer catalog show unirope-7x19-galvanised
    """
    from designer.catalogue.registry import load_catalogue
    from designer.terminal import print_grade

    print_grade(load_catalogue(with_plugins=not no_plugins).grade(grade))


@catalog.command("check")
def catalog_check(
    path: Annotated[Path, typer.Argument(metavar="PATH", help="Grade file, or a folder of them.")],
) -> None:
    """Check grade files: units, figures, unknown fields.

    Example:  designer catalog check my-ropes/
    """
    from designer.catalogue.listing import check_path

    faults = check_path(path)
    if faults:
        raise InputError(faults)
    typer.echo(f"{path}: no fault found")


def _study(config: Path) -> Study:
    from designer.config import read_study

    return read_study(config)


def _catalogue(study: Study, *, with_plugins: bool) -> Catalogue:
    from designer.catalogue.registry import load_catalogue

    catalogue = load_catalogue(study.catalogues, with_plugins=with_plugins)
    known = {grade.id for grade in catalogue.grades}
    wanted = study.selection.grades if study.selection else None
    faults = [
        study.source.fault(f"selection.grades[{k}]", *catalogue.explain_unknown(grade))
        for k, grade in enumerate(wanted or ())
        if grade not in known
    ]
    if faults:
        raise InputError(faults)
    return catalogue
