"""`designer import`: a robot of another program as a study."""

from __future__ import annotations

import math
import shlex
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from designer.cli.options import NoPlugins, argument, option, output_option, quantity_of
from designer.errors import InputError, visible
from designer.units import LENGTH, MASS, NUMBER, Dimension

if TYPE_CHECKING:
    from designer.foreign.robot import ForeignRobot, Point
    from designer.foreign.study import Gap
    from designer.plugins import Plugins

Vector = Any
"""Three numbers in one text; typer would have a tuple as three arguments."""


def _number(
    name: str, metavar: str, text: str, dimension: Dimension, least: float = -math.inf
) -> Any:
    def read(written: str) -> float:
        value = quantity_of(name, written, dimension)
        if value < least:
            raise InputError.at(name, f"{written} is too small", f"{least:g} or more")
        return value

    return option(name, metavar=metavar, text=text, parser=read)


def _vector(name: str, text: str, dimension: Dimension) -> Any:
    def read(written: str) -> Point:
        parts = [quantity_of(name, part, dimension) for part in written.strip("[] ").split(",")]
        if len(parts) != 3:
            raise InputError.at(name, f"{written!r} is no point", "three: X,Y,Z")
        x, y, z = parts
        return x, y, z

    return option(name, metavar="X,Y,Z", text=text, parser=read)


def import_(
    file: Annotated[Path, argument("FILE", "A CASPR model (.xml), .wcrfx or a plugin's file.")],
    output: Annotated[Path | None, output_option("FILE's name with .yaml", "CONFIG")] = None,
    other: Annotated[
        Path | None,
        option(
            "--cables",
            "--bodies",
            metavar="XML",
            text="The other file of a CASPR model, where it does not lie beside.",
        ),
    ] = None,
    cable_set: Annotated[
        str | None, typer.Option(metavar="ID", help="Which cables of a CASPR model.")
    ] = None,
    mass: Annotated[
        float | None, _number("--mass", "MASS", "Of the platform, such as '90 kg'.", MASS)
    ] = None,
    payload: Annotated[float, _number("--payload", "MASS", "Added to it.", MASS, 0.0)] = 0.0,
    centre_of_mass: Annotated[
        Vector, _vector("--centre-of-mass", "Of the platform, in its own frame.", LENGTH)
    ] = None,
    pose: Annotated[Vector, _vector("--pose", "Position to size for.", LENGTH)] = None,
    gravity: Annotated[Vector, _vector("--gravity", "Where things fall.", NUMBER)] = None,
    grade: Annotated[
        str | None, typer.Option(metavar="ID", help="A rope of `designer catalog list`.")
    ] = None,
    safety_factor: Annotated[
        float | None,
        _number("--safety-factor", "NUMBER", "Breaking load over tension.", NUMBER, 1.0),
    ] = None,
    no_plugins: NoPlugins = False,
) -> bool:
    """Make a commented study of a robot in a file of CASPR, of WireX, or of a plugin's kind.

    CASPR keeps a model in two files, NAME_bodies.xml and NAME_cables.xml: name either. What neither
    the file nor an option says is marked 'fill in', and told.

    Example:  designer import CoGiRo_bodies.xml --grade unirope-7x19-galvanised

    Exit status 0: the study is whole. 1: it is written, and something is to be filled in. 2: the
    input is wrong or no study can hold such a robot, and nothing is written.
    """
    from designer.cli.terminal import print_left_out
    from designer.foreign.study import (
        ImportAnswers,
        gaps,
        load_importers,
        read_foreign,
        study_text,
    )
    from designer.io.output import write_new_file
    from designer.plugins import find_plugins

    plugins = find_plugins(with_plugins=not no_plugins)
    importers, problems = load_importers(plugins)
    print_left_out([*plugins.problems, *problems])
    robot = read_foreign(file, other, cable_set, importers)
    answers = ImportAnswers(mass, payload, centre_of_mass, pose, gravity, grade, safety_factor)
    text = study_text(robot, answers)
    missing = gaps(text)
    stem = file.stem.removesuffix("_bodies").removesuffix("_cables")
    path = output or Path(f"{stem}.yaml")
    _require_valid(text, missing, robot, path, plugins)
    write_new_file(path, text)
    _tell(path, robot, missing)
    return not missing


def _require_valid(
    text: str, missing: tuple[Gap, ...], robot: ForeignRobot, path: Path, plugins: Plugins
) -> None:
    """Refuse a study that is faulty beside what is to be filled in, in the foreign file's name."""
    from designer.documents.document import document_of
    from designer.effects.registry import SHIPPED
    from designer.io.config.reader import checked, study_of

    document = document_of(text.encode(), robot.file)
    marked = {gap.field for gap in missing}
    try:
        section = checked(document, SHIPPED)
        study_of(section, document, path, SHIPPED, plugins)
    except InputError as error:
        faults = [replace(fault, line=None) for fault in error.faults if fault.field not in marked]
        if faults:
            raise InputError(faults) from None


def _tell(path: Path, robot: ForeignRobot, missing: tuple[Gap, ...]) -> None:
    load = "a point mass" if robot.attachments_m is None else "a platform"
    cables = f"{len(robot.exit_points_m)} cables on {load}"
    typer.echo(f"{path} written: {visible(robot.name)}, {cables}.")
    for remarks in robot.remarks.values():
        typer.echo("\n".join(f"  {visible(remark)}" for remark in remarks))
    if not missing:
        typer.echo(f"Next:  designer size {shlex.quote(str(path))}")
        return
    typer.echo("The file does not tell everything. Fill in, or import with the option:")
    for gap in missing:
        typer.echo(f"  line {gap.line}: {gap.field} ({gap.option})")
