"""From a config file to a study: read, check everything, build, and list every field in SI."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from pydantic import BaseModel, ValidationError

from designer.arrays import FloatArray, frozen_array
from designer.documents.document import Document, Key, Keys, Node, path_text, read_document
from designer.documents.fields import MOST_FAULTS, QuantityField, reader_in, schema_faults
from designer.effects.registry import SHIPPED, KnownEffects
from designer.errors import InputError
from designer.io.config.checks import all_faults
from designer.io.config.effects import read_effects
from designer.io.config.machine import CableSection, LoadCaseSection, OrientationSection
from designer.io.config.schema import (
    ORIENTATION_KINDS,
    ColumnSection,
    PathSection,
    SelectionSection,
    StudySection,
    WorkspaceSection,
)
from designer.io.poses import TIME, PoseTable, path_faults, read_poses
from designer.io.prices import read_prices
from designer.model.cable import Material, PriceList
from designer.model.load_case import MAX_DIRECTIONS, LoadCase
from designer.model.motion import Motion, limited, timed
from designer.model.region import PointList, Region
from designer.model.robot import Robot, Surroundings
from designer.model.space import ListedOrientations, Orientations, OrientationTable, Toward
from designer.model.workspace import Workspace
from designer.plugins import Plugins, find_plugins
from designer.study import DeclaredEffect, Entry, GradeFamily, Study, StudySource
from designer.units import DENSITY, NUMBER, STRESS, Dimension, format_SI
from designer.workspace.best_orientations import BestOrientations

Listed = tuple[Region, Orientations]
DEFAULT = "default"
_PATH = ("workspace", "path")
MAX_ROWS = 1000
"""Of a table of orientations: each costs time at every pose."""
_MAX_ROWS = 64
"""Of a list in the table of inputs."""


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
    inputs = _with_family(tuple(entries), material, family)
    # A member of the family bears at the drum what its stress allows, and less at the exit point.
    efficiency = robot.winches.reeving_efficiency
    material = replace(material, allowable_stress_Pa=efficiency * material.allowable_stress_Pa)
    return Study(
        name=section.name or path.stem,
        robot=robot,
        material=material,
        source=StudySource(path, document.sha256, inputs, lines, (*places.tables, *tables)),
        pose=None if pose is None else pose.poses(),
        workspace=places.workspace,
        selection=None if selection is None else selection.selection(price_list, inputs),
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
        read_effects(session.effects, n_cables, known.by_id, (*place, number, "effects")).effects
        for number, session in enumerate(sessions or ())
    ]


def _material_and_family(
    section: StudySection, document: Document, plugins: Plugins | None
) -> tuple[Material, GradeFamily | None]:
    """Return the material, and the grade it is of; its safety factor may be the selection's."""
    cable = section.cable
    if isinstance(cable, CableSection):
        return Material(cable.density, cable.youngs_modulus, cable.allowable_stress), None
    from designer.grades.registry import cached_catalogue  # most studies name no grade

    usual = (section.selection or SelectionSection()).safety_factor
    family = GradeFamily(cable.grade, cable.safety_factor or usual)
    files = [Path(document.name).parent / name for name in section.catalogues]
    catalogue = cached_catalogue(
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
    if case.wrench_set is None or count <= MAX_DIRECTIONS:
        return case
    of_set = len(case.wrench_set.wrenches_N)
    problem = f"{of_set} wrenches in {count // of_set} directions of wind, inertia and loss"
    expected = f"{MAX_DIRECTIONS} loads at most, not {count}"
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


@dataclass(frozen=True, slots=True)
class Places:
    """The workspace of a study, and what of a list of poses is for one load case alone.

    ``tables`` are the names and digests of the files that it was read with, ``motion`` is how the
    platform moves from pose to pose.
    """

    workspace: Workspace | None
    of_cases: Mapping[str, Listed] = field(default_factory=dict)
    tables: tuple[tuple[str, str], ...] = ()
    motion: Motion | None = None

    @property
    def are_turned_one_by_one(self) -> bool:
        """Whether only listed poses have an orientation."""
        law = None if self.workspace is None else self.workspace.orientations.law
        return isinstance(law, ListedOrientations)


def places_of(
    section: StudySection, document: Document, robot: Robot, material: Material
) -> Places:
    """Return which poses a study asks for.

    Raises
    ------
    InputError
        If a table that it names cannot be read, or does not fit the rest.
    """
    workspace = section.workspace
    if workspace is None:
        return Places(None)
    build = _PlacesBuilder(document, robot, material)
    if workspace.path is not None:
        places = build.along_path(section, workspace.path)
    elif workspace.region is None:
        places = build.listed(workspace, [case.name for case in section.load_cases])
    else:
        region = workspace.region.over(robot.exit_points_m)
        places = Places(workspace.workspace(region, build.orientations(workspace, region)))
    return replace(places, tables=tuple(build.tables))


@dataclass(frozen=True, slots=True)
class _PlacesBuilder:
    document: Document
    robot: Robot
    material: Material
    tables: list[tuple[str, str]] = field(default_factory=list)

    def _error(self, keys: Keys, problem: str, expected: str = "") -> InputError:
        return InputError([self.document.fault(keys, problem, expected)])

    def _table(self, keys: Keys, name: str) -> PoseTable:
        path = Path(self.document.name).parent / name
        table = read_poses(path, self.robot, partial(self._error, keys))
        self.tables.append((name, table.sha256))
        return table

    def orientations(self, section: WorkspaceSection, region: Region) -> Orientations:
        """Return how the platform is turned over a region."""
        single, free = section.orientation, section.orientation_free
        if free is not None:
            ends = frozen_array(free.bounds_rad)
            law = BestOrientations(self.robot, self.material, region, ends, section.hangs_below)
            return Orientations(law=law)
        if single is not None and single.toward is not None:
            return Orientations(law=Toward(frozen_array(single.toward), frozen_array(single.axis)))
        if single is not None and single.table is not None:
            return Orientations(law=self._turn_table(single.table))
        return section.fixed_orientations()

    def _turn_table(self, name: str) -> OrientationTable:
        keys = ("workspace", "orientation", "table")
        places = self._table(keys, name).places
        if places.shape[1] < 6:
            expected = "the columns rx_rad, ry_rad and rz_rad"
            raise self._error(keys, f"{name} has no orientations", expected)
        if len(places) > MAX_ROWS:
            raise self._error(keys, f"{name} has {len(places)} rows", f"at most {MAX_ROWS}")
        if len(np.unique(places[:, :3], axis=0)) < len(places):
            problem = f"{name} has a position in two rows"
            raise self._error(keys, problem, "one orientation for each position")
        position_m, turn_rad = (frozen_array(part) for part in np.hsplit(places, 2))
        return OrientationTable(position_m, turn_rad, name)

    def listed(self, section: WorkspaceSection, cases: list[str]) -> Places:
        """Return a list of poses, and what of it is for one load case alone."""
        keys = ("workspace", "poses")
        assert section.poses is not None
        table = self._table(keys, section.poses)
        if table.places.shape[1] == 6:
            for kind in ORIENTATION_KINDS:
                if getattr(section, kind) is not None:
                    problem = f"{section.poses} has orientations of its own"
                    raise self._error(("workspace", kind), problem, "one of the two")
        owner = np.array(table.load_cases or [""] * len(table.places))
        strangers = sorted({*owner.tolist()} - {"", *cases})
        if strangers:
            problem = f"{section.poses} has poses for '{strangers[0]}', which is no load case"
            raise self._error(keys, problem, f"one of {', '.join(cases) or 'none: there are none'}")
        every = self._poses(section, table.places)
        of_cases = {}
        for name in cases if (owner != "").any() else ():
            is_own = (owner == name) | (owner == "")
            if not is_own.any():
                raise self._error(keys, f"{section.poses} has no pose for load case '{name}'")
            of_cases[name] = self._poses(section, table.places[is_own])
        return Places(section.workspace(*every), of_cases)

    def along_path(self, section: StudySection, path: PathSection) -> Places:
        """Return the instants of a path, and how the platform moves through them."""
        workspace = section.workspace
        assert workspace is not None
        table = self._table((*_PATH, "file"), path.file)
        places = self._turned(workspace, table, path.file)
        faults = list(path_faults(table, has_limits=path.speed_max is not None))
        if faults:
            raise InputError(faults)
        motion = self._motion(path, table, places)
        if motion.turns:
            self._require_inertia(section, path.file)
        region, orientations = self._poses(workspace, motion.places)
        return Places(workspace.workspace(region, orientations), motion=motion)

    def _motion(self, path: PathSection, table: PoseTable, places: FloatArray) -> Motion:
        """Return the motion through the places (n_rows, 6) of a table, by times or by limits."""
        name, up = path.file, self.robot.level[2]
        limits = {name: getattr(path, name) for name in ("speed_max", "acceleration_max")}
        if TIME in table.names:
            for limit in (limit for limit, value in limits.items() if value is not None):
                problem = f"{name} has times of its own, in its column {TIME}"
                raise self._error((*_PATH, limit), problem, "one of the two")
            time_s = table.values[:, table.names.index(TIME)]
            return timed(time_s, places, up, path.ends or "at_rest", name)
        for limit in (limit for limit, value in limits.items() if value is None):
            problem = f"{limit} is missing, and {name} has no column {TIME}"
            raise self._error(_PATH, problem, f"{limit}: …, or times in the file")
        if path.ends is not None:
            problem = f"{name} has no column {TIME}: it is passed from rest to rest"
            raise self._error((*_PATH, "ends"), problem, "times in the file, or no ends")
        reach_m = float(np.linalg.norm(self.robot.attachments_m, axis=1).max())
        return limited(places, up, reach_m, name, *limits.values())

    def _require_inertia(self, section: StudySection, name: str) -> None:
        """Refuse a path that turns a platform whose inertia is not known in every load case."""
        problem, expected = f"{name} turns the platform", "moments of inertia [xx, yy, zz]"
        if self.robot.platform.inertia_kg_m2 is None:
            missing = f"inertia is missing, and {problem}"
            raise self._error(("robot", "platform"), missing, f"inertia: {expected}")
        for index, case in enumerate(section.load_cases):
            if case.mass is not None and case.inertia is None:
                keys = ("load_cases", index, "mass")
                problem = f"has no inertia beside it, and {problem}"
                raise self._error(keys, problem, f"inertia: {expected}")

    def _turned(self, section: WorkspaceSection, table: PoseTable, name: str) -> FloatArray:
        """Return the places of a path (n_rows, 6), turned as it says or in one way all along."""
        has_turns = table.places.shape[1] == 6
        single = section.orientation
        is_fixed = single is None or (single.toward is None and single.table is None)
        for kind in ORIENTATION_KINDS:
            if getattr(section, kind) is None or (
                kind == "orientation" and is_fixed and not has_turns
            ):
                continue
            problem = (
                f"{name} has orientations of its own"
                if has_turns
                else f"the platform moves along {name}"
            )
            expected = "one of the two" if has_turns else "rx_rad, ry_rad and rz_rad in the file"
            raise self._error(("workspace", kind), problem, expected)
        if has_turns:
            return table.places
        turn = section.fixed_orientations().turns_rad[:1]
        return np.hstack([table.places, np.repeat(turn, len(table.places), axis=0)])

    def _poses(self, section: WorkspaceSection, places: FloatArray) -> Listed:
        positions, turns = places[:, :3], places[:, 3:]
        region = PointList(frozen_array(np.unique(positions, axis=0)))
        if not turns.size:
            return region, self.orientations(section, region)
        is_level = not turns.any()
        return region, Orientations(
            law=None if is_level else ListedOrientations.of(positions, turns)
        )


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
    elif len(value) > _MAX_ROWS:
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
