"""Reads grade files, and folders of them."""

from __future__ import annotations

import os
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import islice
from pathlib import Path
from typing import get_args

from pydantic import ValidationError

from designer.documents.document import GRADE, Document, read_document
from designer.documents.faults import schema_faults
from designer.errors import Fault, InputError
from designer.grades.checks import find_flaws
from designer.grades.grade import (
    AreaFactor,
    ComputedColumn,
    ComputedFigure,
    Grade,
    Limits,
    Modulus,
    Reference,
    SheaveRatio,
    Size,
    ThermalExpansion,
)
from designer.grades.schema import (
    GradeSection,
    ModulusSection,
    SizeSection,
    StiffnessSection,
)
from designer.grades.stiffness import RelativeStiffness

MOST_FILES = 1000
MOST_ENTRIES = 20_000
_SUFFIXES = (".yaml", ".yml")


@dataclass(frozen=True, slots=True)
class GradeFile:
    """A grade and the file it was read from."""

    grade: Grade
    path: Path


def read_grade(path: Path) -> Grade:
    """Return the grade in a file.

    Raises
    ------
    InputError
        If anything is wrong with it; carries every fault, in the order of the lines.
    """
    document = read_document(path, GRADE)
    faults = list(document.faults)
    grade = None
    try:
        grade = _grade(GradeSection.model_validate(document.root.data()), path.name)
    except ValidationError as error:
        faults += schema_faults(error, document, GradeSection)
    if grade is not None:
        faults += _flaws(grade, document)
    if grade is None or faults:
        raise InputError(sorted(faults, key=lambda fault: fault.line or 0))
    return grade


def read_grades(path: Path) -> tuple[list[GradeFile], list[Fault]]:
    """Return the grades in a file or folder, and every fault of the files that give none.

    Two files of the same folder with one id are a fault of the later one.
    """
    grades: dict[str, GradeFile] = {}
    faults: list[Fault] = []
    try:
        files = grade_files(path)
    except InputError as error:
        return [], list(error.faults)
    for file in files:
        try:
            found = GradeFile(read_grade(file), file)
        except InputError as error:
            faults += error.faults
            continue
        first = grades.setdefault(found.grade.id, found)
        if first is not found:
            faults.append(id_fault(found, f"{found.grade.id!r} is in {first.path} already"))
    return list(grades.values()), faults


def id_fault(found: GradeFile, problem: str) -> Fault:
    """Return a fault of this grade's id, with its line."""
    return read_document(found.path).fault(("id",), problem, "an id of its own")


def nothing_found_fault(path: Path) -> Fault:
    """Return the fault that a folder, which was meant to have grades, has none."""
    return Fault(str(path), None, "", "there is no grade file in this folder", "*.yaml files")


def grade_files(path: Path) -> list[Path]:
    """Return a file itself, or the YAML files in a folder and the folders below, sorted.

    Links to folders are not followed, so that a loop of links cannot trap us; hidden files and
    what is no regular file are passed over.

    Raises
    ------
    InputError
        If there is no such file or folder, if it cannot be listed, or if it holds too much.
    """
    if not path.is_dir():
        return [path]  # whether it is readable is found out by reading it
    entries = list(islice(_entries(path), MOST_ENTRIES + 1))
    files = [entry for entry in entries if _is_grade_file(entry)]
    if len(entries) > MOST_ENTRIES or len(files) > MOST_FILES:
        expected = f"at most {MOST_FILES} grade files, and {MOST_ENTRIES} files in all"
        raise InputError([Fault(str(path), None, "", "the folder holds too many files", expected)])
    return sorted(files)


def _entries(folder: Path) -> Iterator[Path]:
    def refuse(error: OSError) -> None:
        reason = (error.strerror or "not readable").lower()
        problem = f"the folder cannot be listed: {reason}"
        raise InputError([Fault(str(error.filename or folder), None, "", problem)])

    for place, folders, names in os.walk(folder, onerror=refuse):
        folders[:] = [name for name in folders if not name.startswith(".")]
        yield from (Path(place, name) for name in names)


def _is_grade_file(path: Path) -> bool:
    """Tell whether to read this; a link that leads nowhere is read, so that it is reported."""
    if path.suffix.lower() not in _SUFFIXES or path.name.startswith("."):
        return False
    try:
        return path.is_file() or not path.exists()
    except OSError:  # no right to look
        return True


def _flaws(grade: Grade, document: Document) -> list[Fault]:
    return [document.fault(one.keys, one.problem, one.expected) for one in find_flaws(grade)]


def _grade(section: GradeSection, file: str) -> Grade:
    expansion, factor, ratio = section.thermal_expansion, section.area_factor, section.sheave_ratio
    return Grade(
        id=section.id,
        manufacturer=section.manufacturer,
        product=section.product,
        construction=section.construction,
        core=section.core,
        finish=section.finish,
        sizes=tuple(_size(size) for size in section.sizes),
        source=Reference(**section.source.model_dump()),
        trust=section.trust,
        modulus=_modulus(section.modulus) if section.modulus else None,
        stiffness=_stiffness(section.stiffness) if section.stiffness else None,
        material=section.material,
        standard=section.standard,
        wire_grade=section.wire_grade,
        area_factor=AreaFactor(**factor.model_dump()) if factor else None,
        thermal_expansion=(
            ThermalExpansion(expansion.value, expansion.basis, expansion.source)
            if expansion
            else None
        ),
        sheave_ratio=SheaveRatio(**ratio.model_dump()) if ratio else None,
        limits=Limits(**section.limits.model_dump()) if section.limits else None,
        currency=section.currency,
        computed=tuple(
            ComputedFigure(figure, how)
            for figure in get_args(ComputedColumn)
            if (how := getattr(section.computed, figure)) is not None
        ),
        notes=section.notes,
        file=file,
    )


def _modulus(section: ModulusSection) -> Modulus:
    return Modulus(
        section.value,
        section.reference_area,
        section.basis,
        section.source,
        section.uncertainty,
    )


def _stiffness(section: StiffnessSection) -> RelativeStiffness:
    if section.by_load_fraction is not None:
        loads, ratios = zip(*section.by_load_fraction, strict=True)
    else:
        assert section.ea_over_breaking_load is not None  # the schema sees to it
        ratios = (section.ea_over_breaking_load,)
        loads = () if section.at_load_fraction is None else (section.at_load_fraction,)
    return RelativeStiffness(ratios, loads, section.basis, section.source, section.uncertainty)


def _size(section: SizeSection) -> Size:
    return Size(
        id=section.id,
        diameter_m=section.diameter,
        minimum_breaking_load_N=section.minimum_breaking_load,
        linear_density_kg_per_m=section.linear_mass,
        metallic_area_m2=section.metallic_area,
        doubt=section.doubt,
        price_per_m=section.price_per_m,
    )
