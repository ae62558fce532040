"""`designer export`: the study for another program."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from designer.cli.options import Config, NoPlugins, catalogue_of, output_option, study_of
from designer.errors import InputError, NothingToExportError


def export(
    config: Config,
    to: Annotated[
        str, typer.Option("--to", metavar="FORMAT", help="For which program; see above.")
    ],
    output: Annotated[Path | None, output_option("CONFIG with the ending below", "FILE")] = None,
    no_plugins: NoPlugins = False,
) -> bool:
    """Write the study for another program, and say what that cannot take.

    csv: rows for the workshop, one a cable: rope, length to cut with its rule, terminations, drum,
    unstrained lengths at the reference and the worst pose (.csv).

    caspr: a model of CASPR, which `designer import` reads back (_bodies.xml, and _cables.xml beside
    it). Lost: mass, sag and stretch of cables, loads beside the weight.

    moordyn: a deck of MoorDyn v2 for the reference pose in air, which MoorPy reads too (.txt).
    Lost: pulleys, forces on the platform that are not vertical (it is then held), a robot's plane.

    mujoco: an MJCF model: spatial tendons that pull as our cables do, the reference pose and the
    worst one as key frames (.xml). Lost: sag and mass of cables, pulleys.

    gltf: what the report draws in space: robot, platform and cables in the reference pose and the
    worst one, the region with its maps, a scene each (.glb). Lost: all that is no picture.

    Plugins may bring other formats.

    Numbers are of the robot as the declared effects have it, at rest under the loads of `robot`,
    with the ropes of the answer. What a study has and a file does not is told here and in the file.

    Example:  designer export yard.yaml --to csv -o yard-cables.csv

    Exit status 0: written. 1: no rope serves the study, and nothing is written. 2: the input is
    wrong or the format cannot hold such a robot, and nothing is written.
    """
    from designer.cli.terminal import ProgressBars, announce_compiling, print_left_out, show
    from designer.exports.formats import export_study, load_formats

    study, plugins = study_of(config, no_plugins)
    formats, problems = load_formats(plugins)
    print_left_out(problems)
    if to not in formats:
        raise InputError.at("--to", f"there is no format {to!r}", f"one of {', '.join(formats)}")
    kind = formats[to]
    catalogue = catalogue_of(study, plugins)
    path = output or Path(f"{config.stem}{kind.ending}")
    announce_compiling()
    try:
        with ProgressBars() as bars:
            made = export_study(kind, path, study, catalogue, bars)
    except NothingToExportError as reason:
        show(f"{reason}: see designer report.")
        return False
    for name in made.files:
        show(f"{path.parent / name} written", markup=False)
    print_left_out(f"Not in it: {line}" for line in made.lost)
    return True
