"""What `import designer` offers to call: each a pipeline of its own, without a command line."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any, TypeVar

import numpy as np
from numpy.typing import ArrayLike

from designer.analysis.analyse import Analysis
from designer.analysis.analyse import analyse as analyse_study
from designer.analysis.comparison import Comparison
from designer.analysis.comparison import compare as compare_results
from designer.analysis.lengths import FoundPoses, Lengths, lengths_of, poses_of
from designer.analysis.pose import PoseAnalysis, analyse_pose
from designer.arrays import FloatArray
from designer.effects.load import load_effects
from designer.errors import InputError, WrongValueError
from designer.grades.registry import Catalogue, load_catalogue
from designer.io import config
from designer.io.results import read_result
from designer.model.motion import limited, timed
from designer.model.region import PointList
from designer.model.robot import Poses
from designer.model.space import ListedOrientations, Orientations
from designer.model.workspace import Workspace
from designer.plugins import find_plugins
from designer.progress import SILENT, Reporter
from designer.report.render import write_report as write_analysis
from designer.study import Study

AnyStudy = Study | Path | str
"""A study, or the path of its file."""
Answer = TypeVar("Answer")

__all__ = [
    "analyse",
    "catalogue",
    "compare",
    "find_poses",
    "follow",
    "lengths",
    "read_study",
    "size",
    "write_report",
]


def read_study(path: Path | str, *, with_plugins: bool = True) -> Study:
    """Return the study that a config file describes.

    Parameters
    ----------
    path : Path or str
        A YAML file.
    with_plugins : bool
        False leaves out what plugins bring, for the same answer on every machine.

    Raises
    ------
    InputError
        If anything is wrong with it: a line for each fault, as `designer report` prints them.
    """
    plugins = find_plugins(with_plugins)
    return config.read_study(Path(path), load_effects(plugins), plugins)


def catalogue(paths: Sequence[Path | str] = (), *, with_plugins: bool = True) -> Catalogue:
    """Return all grades: shipped, of plugins, of the user's folder, and of files or folders.

    Raises
    ------
    InputError
        If a file in ``paths`` is faulty.
    """
    return load_catalogue([Path(path) for path in paths], with_plugins)


def analyse(
    study: AnyStudy,
    catalogue: Catalogue | None = None,
    folder: Path | None = None,
    reporter: Reporter = SILENT,
) -> Analysis:
    """Return the analysis of a study, or of its file, with every stage computed.

    Parameters and errors are those of `designer.analysis.analyse.analyse`, and of `read_study`.
    """
    return analyse_study(as_study(study), catalogue, folder, reporter)


def write_report(
    analysis: Analysis | AnyStudy,
    folder: Path | str,
    template: Path | str | None = None,
    *,
    quick: bool = False,
) -> None:
    """Write the report and all results into a folder, as `designer report` does; all or nothing.

    A study, or its file, is analysed first. The rest is as `designer.report.render.write_report`
    does: an earlier report is replaced, ``template`` is a folder of templates that come before
    ours, and a ``quick`` report is page 1 in HTML alone.
    """
    if not isinstance(analysis, Analysis):
        study = as_study(analysis)
        analysis = Analysis.begin(study.unproved) if quick else analyse_study(study)
    write_analysis(analysis, folder, template, quick=quick)


def size(study: AnyStudy) -> PoseAnalysis:
    """Size the configured pose alone: massless, by the loop, and the optimum.

    Raises
    ------
    InputError
        If the study has no pose, or the robot has fewer cables than degrees of freedom.
    """
    return analyse_pose(as_study(study))


def follow(
    study: AnyStudy,
    places: ArrayLike,
    time_s: ArrayLike | None = None,
    *,
    speed_max_m_per_s: float | None = None,
    acceleration_max_m_per_s2: float | None = None,
) -> Study:
    """Return the study with its platform in motion along a path, in place of its region.

    Parameters
    ----------
    study : Study, Path or str
        The study; its workspace, if any, keeps the rest of its fields.
    places : array (n, 3 or 6)
        Positions, and rotation vectors where the platform turns [m, rad].
    time_s : array (n,), optional
        When it is there [s]; it starts and ends at rest.
    speed_max_m_per_s, acceleration_max_m_per_s2 : float, optional
        Instead of times: limits that it keeps to, from rest to rest.

    Raises
    ------
    InputError
        If there are neither times nor both limits, or a value is wrong.
    """
    study = as_study(study)
    rows = _rows("places", places)
    rows = np.pad(rows, ((0, 0), (0, 6 - rows.shape[1])))
    up, limits = study.robot.level[2], (speed_max_m_per_s, acceleration_max_m_per_s2)
    if time_s is not None:
        times = _rows("time_s", time_s, len(rows))[0]
        if not (np.diff(times) > 0.0).all():
            raise WrongValueError("follow", "time_s", "time_s must rise")
        motion = timed(times, rows, up, "at_rest", "the path")
    elif limits[0] and limits[1] and min(limits[0], limits[1]) > 0.0:
        reach_m = float(np.linalg.norm(study.robot.attachments_m, axis=1).max())
        motion = limited(rows, up, reach_m, "the path", limits[0], limits[1])
    else:
        raise WrongValueError("follow", "time_s", "time_s is missing", "times, or both limits")
    platform = replace(study.robot.platform, motion=motion)
    if motion.turns and platform.inertia_kg_m2 is None:
        raise WrongValueError("Platform", "inertia_kg_m2", "inertia_kg_m2 is missing: it turns")
    region = PointList(np.unique(motion.positions_m, axis=0))
    law = (
        ListedOrientations.of(motion.positions_m, motion.rotation_vectors_rad)
        if motion.turns
        else None
    )
    workspace = study.workspace or Workspace(region)
    workspace = replace(workspace, region=region, orientations=Orientations(law=law))
    return replace(study, robot=replace(study.robot, platform=platform), workspace=workspace)


def lengths(study: Analysis | AnyStudy, poses: Poses | ArrayLike) -> Lengths:
    """Return unstrained lengths and tensions at poses, with the cables of the design, at rest.

    ``poses`` may be an array (n, 3 or 6) of positions, and rotation vectors [m, rad].

    Raises
    ------
    InputError
        If no rope serves the study.
    """
    poses = poses if isinstance(poses, Poses) else Poses.at(_rows("poses", poses))
    return _served(lengths_of(_begun(study), poses))


def find_poses(study: Analysis | AnyStudy, length_m: ArrayLike) -> FoundPoses:
    """Return all poses found on unstrained lengths (n, n_cables) [m], stable or not.

    With the cables of the design, at rest, as `designer pose` does.

    Raises
    ------
    InputError
        If no rope serves the study, or the lengths are not of its cables.
    """
    analysis = _begun(study)
    rows = _rows("length_m", length_m, analysis.study.robot.n_cables)
    if not (rows > 0.0).all():
        raise WrongValueError("find_poses", "length_m", "length_m must be above 0")
    return _served(poses_of(analysis, rows))


def compare(a: Analysis | AnyStudy, b: Analysis | AnyStudy) -> Comparison:
    """Return what differs between two analyses, studies, their files, or files ``result.json``."""

    def result(source: Analysis | AnyStudy) -> Mapping[str, Any]:
        if isinstance(source, str | Path) and Path(source).suffix == ".json":
            return read_result(Path(source))
        return (source if isinstance(source, Analysis) else analyse(source)).to_dict()

    return compare_results(result(a), result(b))


def _rows(name: str, values: ArrayLike, *widths: int) -> FloatArray:
    """Return numbers as rows (n, one of the widths: 3 or 6 if left out)."""
    try:
        rows = np.atleast_2d(np.asarray(values, dtype=np.float64))
    except (TypeError, ValueError):
        raise WrongValueError("array", name, f"{name} is {values!r:.60}", "numbers") from None
    widths = widths or (3, 6)
    if rows.ndim != 2 or rows.shape[1] not in widths or not np.isfinite(rows).all():
        expected = f"finite numbers in the shape (n, {' or '.join(map(str, widths))})"
        raise WrongValueError("array", name, f"{name} has the shape {np.shape(values)}", expected)
    return rows


def as_study(study: AnyStudy) -> Study:
    """Return a study, read if it is named by its file."""
    return read_study(study) if isinstance(study, str | Path) else study


def _begun(study: Analysis | AnyStudy) -> Analysis:
    return study if isinstance(study, Analysis) else Analysis.begin(as_study(study).unproved)


def _served(answer: Answer | None) -> Answer:
    if answer is None:
        raise InputError.at("study", "no rope serves it, so there are no lengths")
    return answer
