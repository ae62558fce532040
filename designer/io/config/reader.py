"""From a config file to a study: read, check everything, build."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from pydantic import ValidationError

from designer.documents.document import Document, path_text, read_document
from designer.documents.section import MOST_FAULTS, schema_faults
from designer.effects.registry import SHIPPED, KnownEffects
from designer.errors import InputError
from designer.io.config.checks import all_faults
from designer.io.config.effects import effect_entries, read_effects
from designer.io.config.entries import all_entries
from designer.io.config.machine import CableSection
from designer.io.config.regions import RegionSection
from designer.io.config.schema import SelectionSection, StudySection
from designer.model.cable import Material
from designer.model.machine import Surroundings
from designer.model.region import Region
from designer.model.robot import Robot
from designer.plugins.find import Plugins, find_plugins
from designer.study import Entry, GradeFamily, Study, StudySource
from designer.units import DENSITY, STRESS, format_SI


def read_study(
    path: Path, known_effects: KnownEffects | None = None, plugins: Plugins | None = None
) -> Study:
    """Return the study that the config file describes.

    Parameters
    ----------
    path : Path
        A YAML file.
    known_effects : KnownEffects or None
        Which effects it may declare; None for ours alone, without those of plugins.
    plugins : Plugins or None
        Whose grades ``cable`` may name; None for ours and those that the file itself adds.

    Raises
    ------
    designer.errors.InputError
        If anything is wrong with it; carries every fault, a hundred at most, in the order of the
        lines.
    """
    known, document = known_effects or SHIPPED, read_document(path)
    return study_of(checked(document, known), document, path, known, plugins)


def study_of(
    section: StudySection,
    document: Document,
    path: Path,
    known: KnownEffects,
    plugins: Plugins | None = None,
) -> Study:
    """Return the study of a document, `checked`, that lies, or is to lie, at a path.

    Raises
    ------
    InputError
        If its cable is of a grade that there is not, or that lacks figures.
    """
    folder, robot = path.parent, section.robot.robot()
    if section.name is None:
        section = section.model_copy(update={"name": path.stem})
    material, family = _material_and_family(section, document, plugins)
    entries = all_entries(section, document.root)
    effects = document.root.child("effects")
    if effects is not None:
        entries += effect_entries(section.effects, effects, robot.n_cables, known.by_id)
    pose, workspace, selection = section.pose, section.workspace, section.selection
    measurements, uncertainty = section.measurements, section.uncertainty
    lines = {path_text(keys): node.line for keys, node in document.root.walk()}
    given = _with_family(tuple(entries), material, family)
    return Study(
        name=section.name or path.stem,
        robot=robot,
        material=material,
        source=StudySource(path, document.sha256, given, lines),
        pose=None if pose is None else pose.poses(),
        workspace=None if workspace is None else workspace.workspace(robot.exit_points_m),
        selection=None if selection is None else selection.selection(),
        load_cases=tuple(
            case.load_case(section.cable, _case_region(document, index, robot, case.region))
            for index, case in enumerate(section.load_cases)
        ),
        catalogues=tuple(folder / name for name in section.catalogues),
        measurements=None if measurements is None else measurements.measurements(folder),
        uncertainty=None if uncertainty is None else uncertainty.value(),
        effects=tuple(
            setting
            for _, setting in read_effects(section.effects, robot.n_cables, known.by_id).effects
        ),
        known_effects=known,
        surroundings=Surroundings(section.surroundings.temperature),
        family=family,
        document=section.document.control(folder),
    )


def _material_and_family(
    section: StudySection, document: Document, plugins: Plugins | None
) -> tuple[Material, GradeFamily | None]:
    """Return the material, and the grade it is of; its safety factor may be the selection's."""
    cable = section.cable
    if isinstance(cable, CableSection):
        return Material(cable.density, cable.youngs_modulus, cable.allowable_stress), None
    from designer.grades.registry import kept_catalogue  # most studies name no grade

    usual = (section.selection or SelectionSection()).safety_factor
    family = GradeFamily(cable.grade, cable.safety_factor or usual)
    files = [Path(document.name).parent / name for name in section.catalogues]
    catalogue = kept_catalogue(
        [file for file in files if file.exists()], plugins or find_plugins(with_plugins=False)
    )
    grade = next((grade for grade in catalogue.grades if grade.id == cable.grade), None)
    if grade is None:
        why = catalogue.explain_unknown(cable.grade)
    else:
        try:
            return grade.family(family.safety_factor), family
        except ValueError as error:  # a grade made in Python may lack stiffness or area
            problem = f"cannot stand for a family: {error}"
            why = problem, "a grade with breaking load, mass and stiffness"
    raise InputError([document.fault(("cable", "grade"), *why)])


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


def checked(document: Document, known: KnownEffects) -> StudySection:
    """Return what the document holds by the schema; `InputError` with all faults otherwise."""
    faults = [*document.faults, *all_faults(document, known.by_id)]
    section = None
    try:
        section = StudySection.model_validate(document.root.data())
    except ValidationError as error:
        faults += schema_faults(error, document, StudySection)
    if section is None or faults:
        faults.sort(key=lambda fault: (fault.line or 0, fault.field))
        raise InputError(faults[:MOST_FAULTS])
    return section
