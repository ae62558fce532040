"""`designer lengths` and `designer pose`: from poses to what each winch pays out, and back."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from designer.cli.options import Config, NoPlugins, catalogue_of, option, output_option, study_of

if TYPE_CHECKING:
    from designer.analysis.lengths import FoundPoses, Lengths


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


def pose(
    config: Config,
    lengths: Annotated[
        Path,
        option("--lengths", metavar="CSV", text="Unstrained lengths: columns length_1_m, …"),
    ],
    output: Annotated[Path | None, output_option("CONFIG-poses.csv", "FILE")] = None,
    no_plugins: NoPlugins = False,
) -> bool:
    """Give all poses found on unstrained lengths of yours, stable or not, with the chosen rope.

    For commissioning: where is the platform, and could it rest elsewhere on the same lengths?
    Writes the columns of the file with position, rotation vector, tensions at the exit points,
    is_stable, and solution, the number of the pose in its row; 0 where none was found. The
    platform is at rest under the loads of `robot`. Other poses may exist than are found.

    Example:  designer pose crane.yaml --lengths winches.csv -o poses.csv

    Exit status 0: each row has one stable pose, within what the rope allows. 1: some have none, or
    several, or no rope was found. 2: the input is wrong.
    """
    from designer.cli.terminal import ProgressBars, announce_compiling, print_left_out, show
    from designer.io.output import require_file, write_file
    from designer.io.poses import read_lengths

    study, plugins = study_of(config, no_plugins)
    table = read_lengths(lengths, study.robot.n_cables)
    path = output or Path(f"{config.stem}-poses.csv")
    require_file(path)
    catalogue = catalogue_of(study, plugins)
    announce_compiling()

    from designer.analysis.analyse import Analysis
    from designer.analysis.lengths import poses_of

    with ProgressBars() as bars:
        analysis = Analysis.begin(study.unproved, catalogue, reporter=bars)
        _ = analysis.qualities
        with bars.task("poses", len(table.length_m)) as advance:
            answer = poses_of(analysis, table.length_m, advance)
    if answer is None:
        show("No rope serves this study, so there are no poses: see designer report.")
        return False
    write_file(path, answer.to_csv(table.names, table.values))
    print_left_out(f"{lengths}: column {name} holds texts: left out" for name in table.left_out)
    return _print_poses(answer, path)


def _print_poses(poses: FoundPoses, path: Path) -> bool:
    """Print how many poses were found, and the rows that are not plain; whether there are none."""
    import numpy as np

    from designer.analysis.lengths import named_rows
    from designer.cli.tables import bad
    from designer.cli.terminal import show

    n_stable = np.bincount(poses.row[poses.is_stable], minlength=poses.n_rows)
    n_found = np.bincount(poses.row, minlength=poses.n_rows)
    over = np.bincount(poses.row[poses.is_stable & ~poses.is_allowed], minlength=poses.n_rows) > 0
    total, stable = len(poses.row), int(n_stable.sum())
    counts = [
        f"{n} {word}{'' if n == 1 else 's'}" for n, word in ((total, "pose"), (poses.n_rows, "row"))
    ]
    show(f"{' found for '.join(counts)} with {poses.cable.name}, {stable} stable.")
    remarks = [
        *named_rows(n_found == 0, "have no pose that was found", "rows"),
        *named_rows((n_found > 0) & (n_stable == 0), "have no stable pose", "rows"),
        *named_rows(n_stable > 1, "have several stable poses", "rows"),
        *named_rows(over, "have a stable pose beyond the allowable tension", "rows"),
    ]
    for line in remarks:
        show(bad(line), soft_wrap=True)
    show(f"{path} written", markup=False)
    return not remarks


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
