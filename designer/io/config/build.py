"""Builds the frozen study, in SI, from a config that passed all checks."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from designer.arrays import frozen_array
from designer.documents.document import Document
from designer.effects.registry import KnownEffects
from designer.errors import InputError
from designer.io.config.effects import read_effects
from designer.io.config.machine import CableSection
from designer.io.config.orientation import rotation_vector_rad
from designer.io.config.regions import RegionSection
from designer.io.config.schema import (
    MeasurementsSection,
    PoseSection,
    SelectionSection,
    StudySection,
    WorkspaceSection,
)
from designer.model.cable import Material
from designer.model.limits import RopeLimits
from designer.model.machine import Surroundings
from designer.model.measurements import LogColumn, Measurements
from designer.model.region import Region
from designer.model.robot import Poses, Robot
from designer.model.space import Orientations
from designer.model.workspace import Workspace
from designer.plugins.find import Plugins, find_plugins
from designer.study import (
    CableGroup,
    DocumentControl,
    Entry,
    GradeFamily,
    Selection,
    Study,
    StudySource,
)
from designer.units import DENSITY, STRESS, format_SI


def build_study(
    section: StudySection, source: StudySource, document: Document, known: KnownEffects,
    plugins: Plugins | None,
) -> Study:  # fmt: skip
    """Return the study that the config describes.

    Raises
    ------
    InputError
        If its cable is of a grade that there is not, or that lacks figures.
    """
    folder = source.path.parent
    robot = section.robot.robot()
    material, family = _material_and_family(section, document, plugins)
    declared = read_effects(section.effects, robot.n_cables, known.by_id)
    return Study(
        name=section.name or source.path.stem,
        robot=robot,
        material=material,
        source=replace(source, entries=_with_family(source.entries, material, family)),
        pose=_pose(section.pose),
        workspace=_workspace(section.workspace, robot),
        selection=_selection(section.selection),
        load_cases=tuple(
            case.load_case(section.cable, _case_region(document, index, robot, case.region))
            for index, case in enumerate(section.load_cases)
        ),
        catalogues=tuple(folder / name for name in section.catalogues),
        measurements=_measurements(section.measurements, folder),
        uncertainty=None if section.uncertainty is None else section.uncertainty.value(),
        effects=tuple(setting for _, setting in declared.effects),
        known_effects=known,
        surroundings=Surroundings(section.surroundings.temperature),
        family=family,
        document=DocumentControl(
            section.document.number or "",
            section.document.revision or "",
            section.document.author or "",
            section.document.checker or "",
            section.document.approver or "",
            None if section.document.logo is None else folder / section.document.logo,
        ),
    )


def _material_and_family(
    section: StudySection, document: Document, plugins: Plugins | None
) -> tuple[Material, GradeFamily | None]:
    """Return the material, and the grade it is of; its safety factor may be the selection's."""
    cable = section.cable
    if isinstance(cable, CableSection):
        return Material(cable.density, cable.youngs_modulus, cable.allowable_stress), None
    from designer.grades.family import GradeError, family_of  # most studies name no grade

    usual = (section.selection or SelectionSection()).safety_factor
    family = GradeFamily(cable.grade, cable.safety_factor or usual)
    files = [Path(document.name).parent / name for name in section.catalogues]
    try:
        return family_of(family, files, plugins or find_plugins(with_plugins=False)), family
    except GradeError as error:
        fault = document.fault(("cable", "grade"), error.problem, error.expected)
        raise InputError([fault]) from None


def _with_family(
    entries: tuple[Entry, ...], material: Material, family: GradeFamily | None
) -> tuple[Entry, ...]:
    """Return the table of inputs with what a grade stands for."""
    if family is None:
        return entries
    meaning = {
        "cable.grade": (
            f"{format_SI(material.density_kg_per_m3, DENSITY)}, "
            f"modulus {format_SI(material.youngs_modulus_Pa, STRESS)}, "
            f"allowable {format_SI(material.allowable_stress_Pa, STRESS)}, on the nominal circle"
        ),
        "cable.safety_factor": f"{family.safety_factor:g}",
    }
    return tuple(replace(e, value_SI=meaning.get(e.field, e.value_SI)) for e in entries)


def _pose(section: PoseSection | None) -> Poses | None:
    if section is None:
        return None
    turn = rotation_vector_rad(section.rotation_vector, section.quaternion, section.euler)
    return Poses.at(section.position, turn)


def _workspace(section: WorkspaceSection | None, robot: Robot) -> Workspace | None:
    if section is None:
        return None
    return Workspace(
        region=section.region.over(robot.exit_points_m),
        samples=section.samples,
        sampling=section.sampling,
        seed=section.seed,
        hangs_below=section.hangs_below,
        clearance_m=section.clearance,
        floor_m=section.floor,
        sag_max=section.sag,
        family_sag_max=section.sag if "sag" in section.model_fields_set else None,
        proof_s=section.proof,
        orientations=_orientations(section),
    )


def _orientations(section: WorkspaceSection) -> Orientations:
    if section.orientation_range is not None:
        return Orientations.within(*section.orientation_range.bounds_rad)
    orientations = section.orientations or (
        () if section.orientation is None else (section.orientation,)
    )
    return (
        Orientations(frozen_array([orientation.turn_rad for orientation in orientations]))
        if orientations
        else Orientations()
    )


def _case_region(
    document: Document, index: int, robot: Robot, section: RegionSection | None
) -> Region | None:
    """Return the region of a load case; a fault where nothing is left of it."""
    if section is None:
        return None
    try:
        return section.over(robot.exit_points_m)
    except ValueError as error:  # QhullError is one
        place = ("load_cases", index, "region")
        raise InputError([document.fault(place, str(error), "a region that has a size")]) from None


def _selection(section: SelectionSection | None) -> Selection | None:
    if section is None:
        return None
    return Selection(
        grades=None if section.grades == "all" else section.grades,
        safety_factor=section.safety_factor,
        objectives=section.objectives,
        termination_efficiency=section.termination_efficiency,
        sheave_diameter_m=section.sheave_diameter,
        groups=tuple(CableGroup(name, cables) for name, cables in (section.groups or {}).items()),
        max_distinct_products=section.max_distinct_products,
        limits=RopeLimits(
            section.limits.stiffness, section.limits.excitation, section.limits.drum_capacity
        ),
    )


def _measurements(section: MeasurementsSection | None, folder: Path) -> Measurements | None:
    if section is None:
        return None
    return Measurements(
        file=folder / section.file,
        linear_density_kg_per_m=section.cable.linear_mass,
        axial_stiffness_N=section.cable.axial_stiffness,
        diameter_m=section.cable.diameter,
        minimum_breaking_load_N=section.cable.minimum_breaking_load,
        columns=tuple(
            LogColumn(name, column.to, *column.conversion())
            for name, column in section.columns.items()
        ),
        settled=section.settled,
        unknown=section.unknown,
        length_noise_m=section.noise.length,
        tension_noise_N=section.noise.tension,
        estimated_noise=section.noise.estimated,
        search_time_s=section.search_time,
    )
