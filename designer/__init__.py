"""Design exploration for large cable-driven parallel robots.

Everything in `__all__` is meant to be used from Python; it is loaded when it is first asked for.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

__version__ = "0.1.0"

_HOMES = {
    "designer.api": "analyse catalogue compare find_poses follow lengths read_study size"
    " write_report",
    "designer.analysis.analyse": "Analysis",
    "designer.analysis.comparison": "Comparison",
    "designer.analysis.lengths": "FoundPoses Lengths",
    "designer.analysis.pose": "PoseAnalysis",
    "designer.grades.grade": "Grade",
    "designer.grades.registry": "Catalogue",
    "designer.diagnosis.result": "Diagnosis",
    "designer.diagnosis.study": "diagnose",
    "designer.exports.formats": "export",
    "designer.errors": "DesignerError EffectError InputError OutputError",
    "designer.model.cable": "Cable Material",
    "designer.model.load_case": "Ice LoadCase Wind",
    "designer.model.measurements": "Measurements",
    "designer.model.region": "PointList Prism Rectangle",
    "designer.model.robot": "Platform Poses Robot",
    "designer.model.space": "Orientations",
    "designer.model.uncertainty": "Normal Uncertainty Uniform",
    "designer.model.verdict": "Verdict",
    "designer.model.winches": "Drum Winches",
    "designer.model.workspace": "Workspace",
    "designer.optimum.optimise": "Optimum optimise",
    "designer.resources": "example_file example_names",
    "designer.sweeps.run": "sweep",
    "designer.study": "CableGroup DeclaredEffect RopeLimits Selection Study",
}
"""Where the public names are defined, those of each module separated by spaces."""
_HOME_OF = {name: home for home, names in _HOMES.items() for name in names.split()}

if TYPE_CHECKING:
    from designer.analysis.analyse import Analysis
    from designer.analysis.comparison import Comparison
    from designer.analysis.lengths import FoundPoses, Lengths
    from designer.analysis.pose import PoseAnalysis
    from designer.api import (
        analyse,
        catalogue,
        compare,
        find_poses,
        follow,
        lengths,
        read_study,
        size,
        write_report,
    )
    from designer.diagnosis.result import Diagnosis
    from designer.diagnosis.study import diagnose
    from designer.errors import DesignerError, EffectError, InputError, OutputError
    from designer.exports.formats import export
    from designer.grades.grade import Grade
    from designer.grades.registry import Catalogue
    from designer.model.cable import Cable, Material
    from designer.model.load_case import Ice, LoadCase, Wind
    from designer.model.measurements import Measurements
    from designer.model.region import PointList, Prism, Rectangle
    from designer.model.robot import Platform, Poses, Robot
    from designer.model.space import Orientations
    from designer.model.uncertainty import Normal, Uncertainty, Uniform
    from designer.model.verdict import Verdict
    from designer.model.winches import Drum, Winches
    from designer.model.workspace import Workspace
    from designer.optimum.optimise import Optimum, optimise
    from designer.resources import example_file, example_names
    from designer.study import CableGroup, DeclaredEffect, RopeLimits, Selection, Study
    from designer.sweeps.run import sweep

__all__ = [
    "Analysis",
    "Cable",
    "CableGroup",
    "Catalogue",
    "Comparison",
    "DeclaredEffect",
    "DesignerError",
    "Diagnosis",
    "Drum",
    "EffectError",
    "FoundPoses",
    "Grade",
    "Ice",
    "InputError",
    "Lengths",
    "LoadCase",
    "Material",
    "Measurements",
    "Normal",
    "Optimum",
    "Orientations",
    "OutputError",
    "Platform",
    "PointList",
    "PoseAnalysis",
    "Poses",
    "Prism",
    "Rectangle",
    "Robot",
    "RopeLimits",
    "Selection",
    "Study",
    "Uncertainty",
    "Uniform",
    "Verdict",
    "Winches",
    "Wind",
    "Workspace",
    "analyse",
    "catalogue",
    "compare",
    "diagnose",
    "example_file",
    "example_names",
    "export",
    "find_poses",
    "follow",
    "lengths",
    "optimise",
    "read_study",
    "size",
    "sweep",
    "write_report",
]


def __getattr__(name: str) -> Any:
    """Load a public name when it is first asked for, so that importing this costs nothing."""
    if name not in _HOME_OF:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(_HOME_OF[name]), name)


def __dir__() -> list[str]:
    return [*__all__, "__version__"]
