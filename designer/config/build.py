"""Builds the frozen study, in SI, from a config that passed all checks."""

from __future__ import annotations

from pathlib import Path

from designer.arrays import frozen_array
from designer.cable import Material
from designer.config.columns import log_column
from designer.config.effects import read_effects
from designer.config.schema import (
    BoxSection,
    CableSection,
    MeasurementsSection,
    PointsSection,
    PoseSection,
    PrismSection,
    RobotSection,
    SelectionSection,
    StudySection,
    WorkspaceSection,
)
from designer.region import PointList, Prism, Region
from designer.robot import Platform, Poses, Robot
from designer.study import Measurements, Selection, Source, Study, Workspace


def build_study(section: StudySection, source: Source) -> Study:
    """Return the study that the config describes."""
    folder = source.path.parent
    robot = _robot(section.robot)
    return Study(
        name=section.name or source.path.stem,
        robot=robot,
        material=_material(section.cable),
        source=source,
        pose=_pose(section.pose),
        workspace=_workspace(section.workspace, robot),
        selection=_selection(section.selection),
        catalogues=tuple(folder / name for name in section.catalogues),
        measurements=_measurements(section.measurements, folder),
        effects=tuple(one for _, one in read_effects(section.effects, robot.n_cables).effects),
    )


def _robot(section: RobotSection) -> Robot:
    body = section.platform
    attachments = None if body.attachments is None else frozen_array(body.attachments)
    platform = Platform(body.mass, attachments, frozen_array(body.centre_of_mass))
    return Robot(frozen_array(section.anchors), platform)


def _material(section: CableSection) -> Material:
    return Material(section.density, section.youngs_modulus, section.allowable_stress)


def _pose(section: PoseSection | None) -> Poses | None:
    return None if section is None else Poses.at(section.position, section.rotation_vector)


def _workspace(section: WorkspaceSection | None, robot: Robot) -> Workspace | None:
    if section is None:
        return None
    return Workspace(
        region=_region(section.region, robot),
        samples=section.samples,
        sampling=section.sampling,
        seed=section.seed,
        hangs_below=section.hangs_below,
    )


def _region(section: PrismSection | BoxSection | PointsSection, robot: Robot) -> Region:
    if isinstance(section, BoxSection):
        return Prism.box(*section.box)
    if isinstance(section, PointsSection):
        return PointList(frozen_array(section.points))
    corners = robot.exit_points_m if section.prism == "anchors" else section.prism
    return Prism.over(corners, section.inset, section.z)


def _selection(section: SelectionSection | None) -> Selection | None:
    if section is None:
        return None
    return Selection(None if section.grades == "all" else section.grades, section.safety_factor)


def _measurements(section: MeasurementsSection | None, folder: Path) -> Measurements | None:
    if section is None:
        return None
    return Measurements(
        file=folder / section.file,
        linear_density_kg_per_m=section.cable.linear_mass,
        axial_stiffness_N=section.cable.axial_stiffness,
        columns=tuple(log_column(*item) for item in section.columns.items()),
        settled=section.settled,
        unknown=section.unknown,
        length_noise_m=section.noise.length,
        tension_noise_N=section.noise.tension,
    )
