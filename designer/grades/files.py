"""Reads grade files, and folders of them."""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping
from dataclasses import asdict, dataclass, fields
from itertools import islice
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from designer.documents.document import GRADE, Document, read_document
from designer.documents.section import reader_of, schema_faults
from designer.errors import Fault, InputError
from designer.grades.checks import find_flaws
from designer.grades.grade import Grade, GradeSheet
from designer.grades.parts import Units
from designer.units import split_quantity

MOST_FILES = 1000
MOST_ENTRIES = 20_000


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
    return grade_of(read_document(path, GRADE), path.name)


def grade_of(document: Document, file: str) -> Grade:
    """Return the grade of a document that is, or is to be, in a file; raises as `read_grade`."""
    faults = list(document.faults)
    try:
        sheet = reader_of(GradeSheet).validate_python(_with_units(document.root.data()))
    except ValidationError as error:
        faults += schema_faults(error, document, GradeSheet)
    else:
        values = {field.name: getattr(sheet, field.name) for field in fields(sheet)}
        grade = Grade(**values, file=file)
        faults += [document.fault(*flaw) for flaw in find_flaws(grade)]
    if faults:
        raise InputError(sorted(faults, key=lambda fault: fault.line or 0))
    return grade


def _with_units(value: Any) -> Any:
    """Return a grade whose table has on each bare number, quoted or not, its unit of ``units``."""
    if not isinstance(value, dict) or not isinstance(value.get("sizes"), list):
        return value
    try:
        units = asdict(reader_of(Units).validate_python(value.get("units")))
    except ValidationError:  # is reported once, not in every row
        return value
    return {**value, "sizes": [_with_unit(row, units) for row in value["sizes"]]}


def _with_unit(row: Any, units: Mapping[str, str | None]) -> Any:
    if not isinstance(row, dict):
        return row
    row = dict(row)
    for name, value in row.items():
        number = split_quantity(value)
        if number is not None and units.get(name) and not number[1]:
            row[name] = f"{value} {units[name]}"
    return row


def read_grades(path: Path, needs_any: bool = False) -> tuple[list[GradeFile], list[Fault]]:
    """Return the grades in a file or folder, and every fault of the files that give none.

    Two files of the same folder with one id are a fault of the later one; a folder without any is
    one itself, where it needs to have some.
    """
    grades: dict[str, GradeFile] = {}
    faults: list[Fault] = []
    try:
        files = grade_files(path)
    except InputError as error:
        return [], list(error.faults)
    for file in files:
        try:
            grade_file = GradeFile(read_grade(file), file)
        except InputError as error:
            faults += error.faults
            continue
        earlier = grades.setdefault(grade_file.grade.id, grade_file)
        if earlier is not grade_file:
            faults.append(
                id_fault(grade_file, f"{grade_file.grade.id!r} is in {earlier.path} already")
            )
    if needs_any and not grades and not faults:
        problem = "there is no grade file in this folder"
        faults.append(Fault(str(path), None, "", problem, "*.yaml files"))
    return list(grades.values()), faults


def id_fault(grade_file: GradeFile, problem: str) -> Fault:
    """Return a fault of this grade's id, with its line."""
    return read_document(grade_file.path).fault(("id",), problem, "an id of its own")


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
        raise InputError.at(path, "the folder holds too many files", expected)
    return sorted(files)


def _entries(folder: Path) -> Iterator[Path]:
    def refuse(error: OSError) -> None:
        reason = (error.strerror or "not readable").lower()
        problem = f"the folder cannot be listed: {reason}"
        raise InputError.at(error.filename or folder, problem)

    for place, folders, names in os.walk(folder, onerror=refuse):
        folders[:] = [name for name in folders if not name.startswith(".")]
        yield from (Path(place, name) for name in names)


def _is_grade_file(path: Path) -> bool:
    """Tell whether to read this; a link that leads nowhere is read, so that it is reported."""
    if path.suffix.lower() not in (".yaml", ".yml") or path.name.startswith("."):
        return False
    try:
        return path.is_file() or not path.exists()
    except OSError:  # no right to look
        return True
