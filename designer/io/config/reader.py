"""From a config file to a study: read, check everything, build, and list every field in SI."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from pydantic import BaseModel, ValidationError

from designer.documents.document import Document, Key, Keys, Node, path_text, read_document
from designer.documents.fields import QuantityField, reader_in
from designer.documents.section import MOST_FAULTS, schema_faults
from designer.effects.registry import SHIPPED, KnownEffects
from designer.errors import InputError
from designer.io.config.checks import all_faults
from designer.io.config.columns import ColumnSection
from designer.io.config.effects import read_effects
from designer.io.config.machine import CableSection, LoadCaseSection
from designer.io.config.places import Places, places_of
from designer.io.config.regions import OrientationSection
from designer.io.config.schema import SelectionSection, StudySection
from designer.io.prices import read_prices
from designer.model.cable import Material, PriceList
from designer.model.load_case import MOST_DIRECTIONS, LoadCase
from designer.model.region import Region
from designer.model.robot import Robot, Surroundings
from designer.model.space import Orientations
from designer.plugins import Plugins, find_plugins
from designer.study import DeclaredEffect, Entry, GradeFamily, Study, StudySource
from designer.units import DENSITY, NUMBER, STRESS, Dimension, format_SI


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
    declared = read_effects(section.effects, robot.n_cables, known.by_id).effects
    entries += _effect_entries(declared, document.root, known, robot.n_cables)
    of_sessions = _session_effects(section, robot.n_cables, known)
    for declared_there in of_sessions:
        entries += _effect_entries(declared_there, document.root, known, robot.n_cables)
    pose, selection = section.pose, section.selection
    places = places_of(section, document, robot, material)
    if places.motion is not None:
        robot = replace(robot, platform=replace(robot.platform, motion=places.motion))
    price_list, tables = _price_list(section, document)
    measurements, uncertainty = section.measurements, section.uncertainty
    lines = {path_text(keys): node.line for keys, node in document.root.walk()}
    given = _with_family(tuple(entries), material, family)
    # A member of the family bears at the drum what its stress allows, and less at the exit point.
    kept = robot.winches.reeving_efficiency
    material = replace(material, allowable_stress_Pa=kept * material.allowable_stress_Pa)
    return Study(
        name=section.name or path.stem,
        robot=robot,
        material=material,
        source=StudySource(path, document.sha256, given, lines, (*places.tables, *tables)),
        pose=None if pose is None else pose.poses(),
        workspace=places.workspace,
        selection=None if selection is None else selection.selection(price_list),
        load_cases=tuple(
            _load_case(document, index, robot, section, places)
            for index in range(len(section.load_cases))
        ),
        catalogues=tuple(folder / name for name in section.catalogues),
        measurements=None if measurements is None else measurements.measurements(folder),
        uncertainty=None if uncertainty is None else uncertainty.value(),
        effects=tuple(effect for _, effect in declared),
        session_effects=tuple(
            tuple(effect for _, effect in declared_there) for declared_there in of_sessions
        ),
        known_effects=known,
        surroundings=Surroundings(section.surroundings.temperature),
        family=family,
        document=section.document.control(folder),
    )


def _price_list(
    section: StudySection, document: Document
) -> tuple[PriceList | None, tuple[tuple[str, str], ...]]:
    """Return the price list that a study names, if any, and the name and digest of its file."""
    name = section.selection.prices if section.selection else None
    if name is None:
        return None, ()

    def error(problem: str, expected: str) -> InputError:
        return InputError([document.fault(("selection", "prices"), problem, expected)])

    price_list, sha256 = read_prices(Path(document.name).parent / name, error)
    return price_list, ((name, sha256),)


def _session_effects(
    section: StudySection, n_cables: int, known: KnownEffects
) -> list[list[tuple[Keys, DeclaredEffect]]]:
    """Return what is declared of each session of the measurements, each effect with its place."""
    sessions = section.measurements.sessions if section.measurements else None
    place: Keys = ("measurements", "sessions")
    return [
        read_effects(each.effects, n_cables, known.by_id, (*place, number, "effects")).effects
        for number, each in enumerate(sessions or ())
    ]


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
            f"{format_SI(float(material.density_kg_per_m3), DENSITY)}, "
            f"modulus {format_SI(material.youngs_modulus_Pa, STRESS)}, "
            f"allowable {format_SI(material.allowable_stress_Pa, STRESS)}, on the nominal circle"
        ),
        "cable.safety_factor": f"{family.safety_factor:g}",
    }
    return tuple(replace(e, value_SI=meaning.get(e.field, e.value_SI)) for e in entries)


def _load_case(
    document: Document, index: int, robot: Robot, study: StudySection, places: Places
) -> LoadCase:
    """Return a load case; a fault where its loads are too many to solve all of them."""
    section = study.load_cases[index]
    case_places = _case_places(document, index, robot, section, places)
    case = section.load_case(study.cable, *case_places)
    count = case.direction_count(robot)
    if case.wrench_set is None or count <= MOST_DIRECTIONS:
        return case
    of_set = len(case.wrench_set.wrenches_N)
    problem = f"{of_set} wrenches in {count // of_set} directions of wind, inertia and loss"
    expected = f"{MOST_DIRECTIONS} loads at most, not {count}"
    raise InputError([document.fault(("load_cases", index, "wrench_set"), problem, expected)])


def _case_places(
    document: Document, index: int, robot: Robot, section: LoadCaseSection, places: Places
) -> tuple[Region | None, Orientations | None]:
    """Return the region of a load case, and orientations that belong to it; None for the study's.

    A fault where nothing is left of it, or a list has poses for the case as well.
    """
    of_list = places.of_cases.get(section.name, (None, None))
    if section.region is None:
        return of_list
    if of_list[0] is not None or places.are_turned_one_by_one:
        problem = "the list of workspace.poses says where the platform is, and how it is turned"
        expected = "poses of that list for this load case, in its column load_case"
        raise InputError([document.fault(("load_cases", index, "region"), problem, expected)])
    try:
        return section.region.over(robot.exit_points_m), None
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


DEFAULT = "default"
_MOST_ROWS = 64


def all_entries(section: BaseModel, node: Node | None, place: tuple[Key, ...] = ()) -> list[Entry]:
    """Return the entries of a section and all below it, in the order of the schema.

    Fields and sections that the file leaves out are marked ``default``.
    """
    entries: list[Entry] = []
    for name, info in type(section).model_fields.items():
        value = getattr(section, name)
        below = field_node(node, name, section)
        if isinstance(value, BaseModel):
            entries += all_entries(value, below, (*place, name))
        else:
            reader = reader_in(info.rebuild_annotation())
            dimension = reader.dimension if isinstance(reader, QuantityField) else NUMBER
            entries += _entries(value, below, (*place, name), dimension)
    return entries


def as_given(node: Node | None) -> str:
    """Return a value as the file has it, ``default`` where it has none."""
    return DEFAULT if node is None else node.as_written()


def field_node(node: Node | None, name: str, section: BaseModel) -> Node | None:
    """Return the node of a section's field, None where the file gives none.

    A list or a text in place of a section gives the section's first field.
    """
    if node is None:
        return None
    is_shorthand = isinstance(node.content, tuple | str)
    is_first = name == next(iter(type(section).model_fields))
    part_node = node if is_shorthand and is_first else node.child(name)
    is_empty = part_node is None or (
        isinstance(part_node.content, str) and part_node.data() is None
    )
    return None if is_empty else part_node


def _entries(
    value: Any, node: Node | None, place: tuple[Key, ...], dimension: Dimension
) -> Iterator[Entry]:
    if node is None:
        yield Entry(path_text(place), DEFAULT, _in_SI(value, dimension))
    elif isinstance(value, tuple) and any(isinstance(item, BaseModel) for item in value):
        for index, item in enumerate(value):
            yield Entry(
                path_text((*place, index)),
                as_given(node.child(index)),
                "none" if item is None else _in_words(item, node.child(index)),
            )
    elif isinstance(value, dict) and value:
        for name, item in value.items():
            if isinstance(item, tuple):
                yield from _entries(item, node.child(name), (*place, name), NUMBER)
            elif isinstance(item, ColumnSection):
                yield Entry(path_text((*place, name)), as_given(node.child(name)), item.meaning)
    elif not (isinstance(value, tuple) and value and isinstance(value[0], tuple)):
        yield Entry(path_text(place), node.as_written(), _in_SI(value, dimension))
    elif len(value) > _MOST_ROWS:
        ends = f"{_in_SI(value[0], dimension)} … {_in_SI(value[-1], dimension)}"
        yield Entry(path_text(place), f"{len(value)} rows", ends)
    else:
        for index, row in enumerate(value):
            yield from _entries(row, node.child(index), (*place, index), dimension)


def _in_words(section: BaseModel, node: Node | None) -> str:
    """Return what a section in a list gives, in SI units."""
    if isinstance(section, OrientationSection):
        return str(section)
    written = (entry for entry in all_entries(section, node) if entry.given != DEFAULT)
    return ", ".join(f"{entry.field} {entry.value_SI}" for entry in written)


def _in_SI(value: Any, dimension: Dimension) -> str:
    if value is None or value in ((), {}):
        return "none"
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, float):
        return format_SI(value, dimension)
    if isinstance(value, tuple):
        return f"[{', '.join(_in_SI(item, NUMBER) for item in value)}] {dimension.unit}".rstrip()
    return str(value)


def _effect_entries(
    declared: Sequence[tuple[Keys, DeclaredEffect]], root: Node, known: KnownEffects, n_cables: int
) -> Iterator[Entry]:
    """Yield the rows of the table of inputs for effects without faults, each with its place."""
    for place, effect in declared:
        if effect.cable is not None:
            yield Entry(path_text((*place, "cable")), str(effect.cable), str(effect.cable))
        for parameter in known.by_id[effect.id].parameters_for(n_cables):
            at = (*place, parameter.name)
            value_text = format_SI(effect.parameters[parameter.name], parameter.dimension)
            yield Entry(path_text(at), as_given(root.at(at)), value_text)
