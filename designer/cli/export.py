"""`designer export`: the study for another program."""

from __future__ import annotations

from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer

from designer.cli.options import Config, NoPlugins, catalogue_of, output_option, study_of
from designer.errors import InputError


class Target(StrEnum):
    """The formats, as `designer.exports.formats.FORMATS` has them."""

    CASPR = "caspr"
    MOORDYN = "moordyn"
    MUJOCO = "mujoco"
    GLTF = "gltf"
    CSV = "csv"


def export(
    config: Config,
    to: Annotated[Target, typer.Option("--to", help="For which program; see above.")],
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

    Numbers are of the robot as the declared effects have it, at rest under the loads of `robot`,
    with the ropes of the answer. What a study has and a file does not is told here and in the file.

    Example:  designer export yard.yaml --to csv -o yard-cables.csv

    Exit status 0: written. 1: no rope serves the study, and nothing is written. 2: the input is
    wrong or the format cannot hold such a robot, and nothing is written.
    """
    from designer.cli.terminal import ProgressBars, announce_compiling, print_left_out, show
    from designer.exports.formats import FORMATS
    from designer.io.output import output_folder, require_file

    study, plugins = study_of(config, no_plugins)
    catalogue = catalogue_of(study, plugins)
    kind = FORMATS[to.value]
    path = output or Path(f"{config.stem}{kind.ending}")
    if not path.name.endswith(kind.ending):
        expected = f"a name that ends in {kind.ending}"
        raise InputError.at("--output", f"{path} is no file of {to.value}", expected)
    announce_compiling()

    from designer.exports.robot import ExportedRobot

    with output_folder(path.parent) as building, ProgressBars() as bars:
        require_file(path)  # what is in the way shows before the work
        exported = ExportedRobot.of(study, catalogue, bars, with_maps=kind.needs_maps)
        if kind.needs_ropes and not exported.has_ropes():
            show("No rope serves this study, so there is nothing to cut: see designer report.")
            return False
        if kind.needs_cables and exported.design is None:
            show("No cable serves this study, so there is nothing to write: see designer report.")
            return False
        made = kind.write(exported, path.name.removesuffix(kind.ending))
        for name, content in made.files.items():
            (building / name).write_bytes(content)
    for name in made.files:
        show(f"{path.parent / name} written", markup=False)
    print_left_out(f"Not in it: {line}" for line in made.lost)
    return True
