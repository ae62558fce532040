"""What `import designer` offers to call: each a pipeline of its own, without a command line."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path

from designer.analysis.analyse import analyse
from designer.analysis.pose import PoseAnalysis, analyse_pose
from designer.diagnosis.result import Diagnosis
from designer.effects.load import load_effects
from designer.grades.registry import Catalogue, load_catalogue
from designer.io import config
from designer.plugins import find_plugins
from designer.report.render import write_report
from designer.study import Study

__all__ = ["analyse", "catalogue", "diagnose", "read_study", "size", "write_report"]


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


def size(study: Study) -> PoseAnalysis:
    """Size the configured pose alone: massless, by the loop, and the optimum.

    Raises
    ------
    InputError
        If the study has no pose, or the robot has fewer cables than degrees of freedom.
    """
    return analyse_pose(study)


def diagnose(
    study: Study,
    data: Path | str | None = None,
    progress: Callable[[str], None] = lambda _: None,
) -> Diagnosis:
    """Compare measured data with the model, and find the effect that the model lacks.

    Parameters
    ----------
    study : Study
        With ``measurements``.
    data : Path or str, optional
        Measured data, instead of the study's.
    progress : callable
        Called with what is being done.

    Raises
    ------
    InputError
        If there is nothing to compare, or the data are not as they should be.
    """
    from designer.diagnosis.diagnose import diagnose_study
    from designer.measured.read import read_measured

    if data is not None and study.measurements is not None:
        study = replace(study, measurements=study.measurements.of_file(Path(data)))
    return diagnose_study(study, read_measured(study), progress)
