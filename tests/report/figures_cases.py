"""Small studies that the figures are tested with: one for each thing that can be in the way."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike

from designer.analysis.analyse import Analysis
from designer.analysis.maps import WorkspaceMaps, workspace_maps
from designer.analysis.provenance import Provenance
from designer.arrays import FloatArray, frozen_array
from designer.grades.registry import Catalogue
from designer.model.cable import Material
from designer.model.polygon import every_second
from designer.model.region import PointList, Prism, Region
from designer.model.robot import Platform, Poses, Robot
from designer.model.workspace import HangsBelow, Workspace
from designer.study import Study, StudySource

STEEL = Material(7800.0, 200e9, 180e6)
THREE = Robot(frozen_array([[0, 0, 0], [500, 0, 0], [250, 433.01, 0]]), Platform(4000.0))
_LAYER = (-200.0, -40.0)
_LOW = (-60.0, -40.0)


def _ring(radius_m: float, degrees: list[float]) -> np.ndarray:
    angle = np.radians(degrees)
    return np.stack([radius_m * np.cos(angle), radius_m * np.sin(angle), 0 * angle], axis=1)


SIX = Robot(
    frozen_array(_ring(150.0, [2, -2, 122, 118, 242, 238])),
    Platform(
        4000.0,
        frozen_array(_ring(5.0, [60, -60, 180, 60, 300, 180])),
        frozen_array([0.1, -0.2, -1.0]),
    ),
)


def points(positions_m: ArrayLike) -> PointList:
    """Return a list of points."""
    return PointList(frozen_array(positions_m))


def inset(metres: float, robot: Robot = THREE) -> Prism:
    """Return the prism over the exit points, moved inward."""
    return Prism.over(robot.exit_points_m, metres, _LAYER)


class Coarse(Prism):
    """A prism with a ninth of the points on its maps, for a robot that takes long to size."""

    def section_m(self, share: float = 1.0, rings: int = 30, spokes: int = 80) -> FloatArray:
        return super().section_m(share, rings, spokes)

    def cutaway_m(self, toward_m: FloatArray) -> Mapping[str, FloatArray]:
        grids = super().cutaway_m(toward_m)
        return {name: grid[every_second(grid)] for name, grid in grids.items()}


Case = tuple[Robot, Region, HangsBelow]
CASES: dict[str, Case] = {
    "served": (THREE, inset(10.35), "include"),
    "exclude": (THREE, inset(10.35), "exclude"),
    "partly": (THREE, inset(0.0), "include"),
    "partly_exclude": (THREE, inset(0.0), "exclude"),
    "found_by_search": (THREE, inset(4.5), "include"),
    "box": (THREE, Prism.box((100.0, 400.0), (-20.0, 250.0), _LAYER), "include"),
    "six": (SIX, Coarse.over(SIX.exit_points_m, 25.0, (-80.0, -20.0)), "include"),
    "points": (THREE, points([[250, 200, -50], [250, 20, -40], [120, 60, -80]]), "include"),
    "one_point": (THREE, points([[250, 144, -50]]), "include"),
    "lost_points": (THREE, points([[250, 2, -50], [250, -20, -50]]), "include"),
    "outside": (THREE, Prism.box((230.0, 270.0), (-30.0, -10.0), _LOW), "include"),
    "unheld": (THREE, Prism.box((230.0, 270.0), (1.0, 3.0), _LOW), "include"),
    "all_left_out": (THREE, Prism.box((230.0, 270.0), (20.0, 40.0), _LOW), "exclude"),
    "flat": (THREE, Prism.over(THREE.exit_points_m, 10.35, (-40.0, -40.0)), "include"),
    "speck": (THREE, Prism.box((249.5, 250.5), (143.0, 145.0), (-51.0, -50.0)), "include"),
}


def study_of(name: str) -> Study:
    """Return the study of a case, with a pose that can be held."""
    robot, region, hangs_below = CASES[name]
    workspace = Workspace(region, samples=400, hangs_below=hangs_below)
    position = [250.0, 200.0, -50.0] if robot is THREE else [10.0, 20.0, -40.0]
    return Study(
        name="A & B <crane>",
        robot=robot,
        material=STEEL,
        source=StudySource(Path("study.yaml"), "0" * 64, ()),
        pose=Poses.at(position),
        workspace=workspace,
    )


def with_maps(study: Study) -> tuple[Analysis, WorkspaceMaps]:
    """Return the analysis of a study, and what its figures show."""
    analysis = Analysis(study, Catalogue((), (), ()), Provenance.now())
    return analysis, workspace_maps(analysis)


@cache
def solved(name: str) -> tuple[Analysis, WorkspaceMaps]:
    """Return the analysis of a case and its maps, computed once for all tests."""
    return with_maps(study_of(name))


def maps_of(name: str) -> WorkspaceMaps:
    """Return the maps of a case."""
    return solved(name)[1]


def pose_at(name: str, position_m: list[float]) -> Study:
    """Return the study of a case with another pose."""
    return replace(study_of(name), pose=Poses.at(position_m))
