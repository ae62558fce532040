"""`designer lengths`: what each winch has to pay out at given poses, and which are not held."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from designer.cli.options import Config, NoPlugins, catalogue_of, option, output_option, study_of

if TYPE_CHECKING:
    from designer.analysis.lengths import Lengths


def lengths(
    config: Config,
    poses: Annotated[
        Path | None,
        option(
            "--poses",
            metavar="CSV",
            text="Poses: columns x_m, y_m, z_m, and rx_rad, ry_rad, rz_rad if the platform turns; "
            "may be left out where the study has a workspace.path.",
        ),
    ] = None,
    output: Annotated[Path | None, output_option("CONFIG-lengths.csv", "FILE")] = None,
    no_plugins: NoPlugins = False,
) -> bool:
    """Give the unstrained lengths and tensions at poses of yours, with the chosen rope.

    Writes the poses with the length of each cable, its tension at the exit point, and a verdict.
    Without rx_rad, ry_rad and rz_rad a platform is turned as the workspace has it, if in one way.
    Without --poses these are set-points along workspace.path, with their times, in motion.

    Example:  designer lengths crane.yaml --poses path.csv -o winches.csv

    Exit status 0: every pose is held. 1: some are not, or no rope was found. 2: the input is wrong.
    """
    from designer.cli.terminal import ProgressBars, announce_compiling, print_left_out, show
    from designer.io.output import require_file, write_file
    from designer.io.poses import along_path, poses_in, read_poses

    study, plugins = study_of(config, no_plugins)
    table = along_path(study) if poses is None else read_poses(poses, study.robot)
    turned = poses_in(study.workspace, table)
    path = output or Path(f"{config.stem}-lengths.csv")
    require_file(path)
    catalogue = catalogue_of(study, plugins)
    announce_compiling(proves=True)

    from designer.analysis.analyse import Analysis
    from designer.analysis.lengths import lengths_of, scope_of_lengths

    with ProgressBars() as bars:
        analysis = Analysis.begin(study, catalogue, reporter=bars)
        answer = lengths_of(analysis, turned, in_motion=poses is None)
    if answer is None:
        show("No rope serves this study, so there are no lengths: see designer report.")
        return False
    write_file(path, answer.to_csv(table.names, table.values))
    print_left_out(f"{poses}: column {name} holds texts: left out" for name in table.left_out)
    _print_lengths(answer, path)
    for line in scope_of_lengths(study, in_motion=poses is None):
        show(line, soft_wrap=True)
    return bool(answer.holds.all())


def _print_lengths(lengths: Lengths, path: Path) -> None:
    """Print a table of the cables, and the rows that are not held or lie outside the region."""
    import numpy as np

    from designer.cli.tables import bad, figure
    from designer.cli.terminal import bare_table, show

    statics = lengths.statics
    is_solved = statics.is_solved
    if is_solved.any():
        length_m, stroke_m = statics.length_m[is_solved], lengths.stroke_m
        turns = np.broadcast_to(stroke_m / lengths.cable.turn_m, stroke_m.shape)
        used = 100.0 * lengths.utilisation[is_solved].max(axis=0)
        columns = (length_m.min(axis=0), length_m.max(axis=0), stroke_m, turns, used)
        table = bare_table(
            "cable", "shortest [m]", "longest [m]", "stroke [m]", "drum turns", "used [%]",
            title=f"{len(is_solved)} poses with {lengths.cable.name}",
        )  # fmt: skip
        for cable, row in enumerate(zip(*columns, strict=True), start=1):
            texts = (figure(x, places) for x, places in zip(row, (4, 4, 4, 1, 1), strict=True))
            table.add_row(str(cable), *texts)
        show(table)
        if np.isfinite(turns).any():
            show("Drum turns: in one layer on the drum that the rope's grade suggests.")
    for line in lengths.remarks():
        show(bad(line), soft_wrap=True)
    show(f"{path} written", markup=False)
