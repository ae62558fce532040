"""Reads grade files and folders of them, and brings all sources together into one catalogue."""

from __future__ import annotations

import difflib
import os
import re
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import asdict, dataclass, field, fields, replace
from functools import partial
from hashlib import sha256
from itertools import islice
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

from pydantic import ValidationError

from designer import checked
from designer.documents.document import GRADE, Document, path_text, read_document
from designer.documents.fields import reader_of, schema_faults
from designer.errors import Fault, InputError, described, one_line
from designer.grades.checks import find_flaws
from designer.grades.grade import Grade, GradeSheet, Units
from designer.plugins import OWN_NAMES, Offer, Plugins, call_hook, find_plugins
from designer.units import split_quantity

if TYPE_CHECKING:
    from designer.model.cable import PriceList
    from designer.study import Study


MAX_FILES = 1000
MAX_ENTRIES = 20_000


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
    rows = [dict(row) if isinstance(row, dict) else row for row in value["sizes"]]
    for row in (row for row in rows if isinstance(row, dict)):
        for name, cell in row.items():
            number = split_quantity(cell)
            if number is not None and units.get(name) and not number[1]:
                row[name] = f"{cell} {units[name]}"
    return {**value, "sizes": rows}


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
    entries = list(islice(_entries(path), MAX_ENTRIES + 1))
    files = [entry for entry in entries if _is_grade_file(entry)]
    if len(entries) > MAX_ENTRIES or len(files) > MAX_FILES:
        expected = f"at most {MAX_FILES} grade files, and {MAX_ENTRIES} files in all"
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


MAX_PROBLEMS_OF_A_SOURCE = 20
_MAX_NAMED = 12


@dataclass(frozen=True, slots=True)
class CatalogueSource:
    """Where grades came from.

    ``name`` is that of a plugin, ``user folder``, or that of a file or folder; ``source`` the
    plugin's distribution and version, or the path. ``sha256`` is a digest of the grades themselves,
    whatever file or program they come from.
    """

    name: str
    source: str
    n_grades: int = field(metadata={"json": "grades"})
    sha256: str = field(default="", compare=False)


@dataclass(frozen=True, slots=True, repr=False)
class Catalogue(checked.Shown):
    """All grades that are known."""

    grades: tuple[Grade, ...]  #: ids are unique; ``origin`` is the name of a grade's source
    sources: tuple[CatalogueSource, ...]
    problems: tuple[str, ...]  #: what was left out and why, one line each
    with_plugins: bool = True  #: whether plugins of others were looked for

    def grade(self, grade_id: str) -> Grade:
        """Return the grade with this id.

        Raises
        ------
        InputError
            If there is none; names the nearest ids.
        """
        for grade in self.grades:
            if grade.id == grade_id:
                return grade
        raise InputError([Fault("catalogue", None, "", *self.explain_unknown(grade_id))])

    def require_grades_of(self, study: Study) -> None:
        """Refuse a study that names grades which are not here.

        Raises
        ------
        InputError
            With a fault for each; names the nearest ids.
        """
        if (selection := study.selection) is None:
            return
        by_id = {grade.id: grade for grade in self.grades}
        faults = []
        for k, name in enumerate(selection.grades or ()):
            refuse = partial(study.source.fault, f"selection.grades[{k}]")
            grade = by_id.get(name)
            if grade is None:
                faults.append(refuse(*self.explain_unknown(name)))
            elif grade.why_excluded(selection) is not None:
                problem = f"{name} is of {grade.material_name}, and selection.materials is not"
                faults.append(refuse(problem, "a grade of these materials"))
        price_list = selection.price_list
        if price_list is not None and not faults:
            faults = [*self._faults_of_prices(study, price_list)]
        if faults:
            raise InputError(faults)

    def _faults_of_prices(self, study: Study, price_list: PriceList) -> Iterator[Fault]:
        """Yield what a price list has that no grade here is, or that it prices nothing allowed."""
        by_id = {grade.id: grade for grade in self.grades}
        for offer in price_list.offers:
            refuse = partial(Fault, str(price_list.path), offer.line)
            grade = by_id.get(offer.grade)
            if grade is None:
                yield refuse("grade", *self.explain_unknown(offer.grade))
            elif not any(offer.is_for(size.id, size.diameter_m) for size in grade.sizes):
                sizes = [size.id for size in grade.sizes]
                alike = " or ".join(difflib.get_close_matches(offer.size, sizes, n=4, cutoff=0.0))
                problem = f"the grade '{grade.id}' has no size {offer.size}"
                expected = f"such as {alike}; `designer catalog show {grade.id}` has all"
                yield refuse("size", problem, expected)
        offered = [by_id[offer.grade] for offer in price_list.offers if offer.grade in by_id]
        selection = study.selection
        if selection and not any(grade.why_excluded(selection) is None for grade in offered):
            problem = f"{price_list.name} has no price of a grade that the study allows"
            yield study.source.fault("selection.prices", problem, "rows of these grades")

    def explain_unknown(self, grade_id: str) -> tuple[str, str]:
        """Return what is wrong with an id that no grade has, and what was expected."""
        printable_id = one_line(grade_id)
        ours = {"astm-a475-": "guy-strand", "hmpe-computed-": "fibre-rope"}  # as their ids begin
        plugin = next((p for start, p in ours.items() if grade_id.startswith(start)), None)
        if plugin is not None:
            why = "is not installed" if self.with_plugins else "--no-plugins leaves out"
            problem = f"the grade {printable_id!r} is of the plugin {plugin}, which {why}"
            return problem, f"`pip install plugins/{plugin}` in a checkout, or another grade"
        expected = self._alike(grade_id) or "an id that `designer catalog list` shows"
        hint = "" if self.with_plugins else "; --no-plugins leaves out those of plugins"
        return f"there is no grade {printable_id!r}", expected + hint

    def _alike(self, text: str) -> str:
        """Return the ids whose construction or name has this in it, else those nearly so called."""
        part = _letters(text)
        has = re.compile(rf"(?<![a-z0-9]){re.escape(part)}").search  # 9x7 is not in 19x7
        alike = [g for g in self.grades if part and has(_letters(f"{g.construction}|{g.id}"))]
        names = [g.id for g in sorted(alike, key=lambda g: g.is_nominal)]
        if not names:
            nearest = difflib.get_close_matches(text, [grade.id for grade in self.grades], n=3)
            return " or ".join(repr(name) for name in nearest)
        more = len(names) - _MAX_NAMED
        rest = f" or one of {more} more that `designer catalog list` shows" if more > 0 else ""
        return "such as " + ", ".join(names[:_MAX_NAMED]) + rest


def _letters(text: str) -> str:
    return "".join(text.casefold().replace("×", "x").split())


def load_catalogue(
    paths: Sequence[Path] = (), with_plugins: bool = True, plugins: Plugins | None = None
) -> Catalogue:
    """Return the shipped grades, those of all plugins and of the user folder, and of ``paths``.

    A plugin, or a file of the user folder, that is faulty is left out and reported in
    ``problems``; the user has asked for ``paths`` in this very study, so a fault there is fatal.

    Parameters
    ----------
    paths : sequence of Path
        Grade files or folders that a config names.
    with_plugins : bool
        False leaves out plugins and the user folder, for studies that give the same answer on
        every machine.
    plugins : Plugins or None
        Those that were found already, by the same wish; None to find them.

    Raises
    ------
    InputError
        If a file in ``paths`` is faulty, or has the id of another grade.
    """
    if plugins is None:
        plugins = find_plugins(with_plugins)
    offers, failures = call_hook(plugins, "register_grades")
    shelf = _CatalogueBuilder(problems=[*plugins.problems, *failures])
    for offer in offers:
        shelf.add_offer(offer)
    user_folder = user_catalogue_folder()
    if plugins.with_others and user_folder.is_dir():
        label = f"user folder ({user_folder})"
        shelf.add_offer(Offer("user folder", str(user_folder), label, (user_folder,)))
    shelf.add_paths(paths)
    return Catalogue(
        tuple(shelf.grades.values()),
        tuple(shelf.sources),
        tuple(shelf.problems),
        plugins.with_others,
    )


_cached: list[tuple[Plugins, object, Catalogue]] = []


def cached_catalogue(paths: Sequence[Path], plugins: Plugins) -> Catalogue:
    """Return what `load_catalogue` does, read anew only for other plugins or changed files.

    Checking every grade takes longer than most studies.

    Raises
    ------
    InputError
        If a file in ``paths`` is faulty, or has the id of another grade.
    """
    state = tuple((path, _changed_at(path)) for path in (*paths, user_catalogue_folder()))
    if not (_cached and _cached[0][0] is plugins and _cached[0][1] == state):
        _cached[:] = [(plugins, state, load_catalogue(paths, plugins=plugins))]
    return _cached[0][2]


def _changed_at(path: Path) -> tuple[float, ...]:
    """Return when a file, or those of a folder, were changed; nothing where there is none."""
    try:
        files = sorted(path.rglob("*")) if path.is_dir() else [path]
        return tuple(file.stat().st_mtime for file in files)
    except OSError:
        return ()


def user_catalogue_folder() -> Path:
    """Return the folder whose grade files are always loaded, if it exists."""
    from platformdirs import user_data_path

    return user_data_path("cdpr-designer", appauthor=False) / "catalog"


@dataclass(slots=True)
class _CatalogueBuilder:
    """The catalogue while it is being filled."""

    problems: list[str]
    grades: dict[str, Grade] = field(default_factory=dict)
    sources: list[CatalogueSource] = field(default_factory=list)

    def add_offer(self, offer: Offer) -> None:
        """Add what is sound in an offer; report the rest."""
        complaints: list[str] = []
        before = len(self.grades)
        for item in offer.items:
            for grade in _grades_in(item, complaints.append, offer.name in OWN_NAMES):
                complaints += self._add(replace(grade, origin=offer.name))
        lines = [f"{offer.label}: {one_line(complaint)}: left out" for complaint in complaints]
        self.problems += lines[:MAX_PROBLEMS_OF_A_SOURCE]
        hidden = len(lines) - MAX_PROBLEMS_OF_A_SOURCE
        if hidden > 0:
            self.problems.append(f"{offer.label}: {hidden} more problems of this kind")
        added = list(self.grades.values())[before:]
        self.sources.append(CatalogueSource(offer.name, offer.source, len(added), _digest(added)))

    def add_paths(self, paths: Sequence[Path]) -> None:
        """Add what the config names; refuse all of it if anything is faulty."""
        faults: list[Fault] = []
        for path in paths:
            files, unreadable = read_grades(path, needs_any=True)
            faults += unreadable
            for file in files:
                problems = self._add(replace(file.grade, origin=path.name))
                faults += [id_fault(file, problem) for problem in problems]
            digest = _digest([file.grade for file in files])
            self.sources.append(CatalogueSource(path.name, str(path), len(files), digest))
        if faults:
            raise InputError(faults)

    def _add(self, grade: Grade) -> list[str]:
        """Add a grade, unless its id is taken; return what is wrong."""
        earlier = self.grades.setdefault(grade.id, grade)
        if earlier is grade:
            return []
        return [f"grade {grade.id!r} of {_label(grade)} is in {_label(earlier)} already"]


def _digest(grades: Iterable[Grade]) -> str:
    figures = sorted(repr(replace(grade, origin="", file="")) for grade in grades)
    return sha256("\n".join(figures).encode()).hexdigest()


def _label(grade: Grade) -> str:
    return f"{grade.origin!r} ({grade.file})" if grade.file else repr(grade.origin)


def _grades_in(item: object, complain: Callable[[str], None], is_own: bool) -> list[Grade]:
    """Return the sound grades of one item that a plugin gave.

    Our own were checked when they were read, or are by tests.
    """
    if isinstance(item, Grade):
        return [item] if is_own else _sound(item, complain)
    if not isinstance(item, str | PathLike):
        complain(f"register_grades() gave {type(item).__name__}, not a path or a Grade")
        return []
    path = Path(os.fsdecode(item))
    if not path.is_absolute():
        complain(f"register_grades() gave the relative path {str(path)!r}")
        return []
    files, faults = read_grades(path)
    for fault in faults:
        complain(str(fault))
    return [file.grade for file in files]


def _sound(grade: Grade, complain: Callable[[str], None]) -> list[Grade]:
    try:
        hash(grade)  # no lists, where tuples belong
        flaws = find_flaws(grade)
    except Exception as error:  # a grade made in Python may hold values of any type
        complain(f"a Grade is not usable: {described(error)}")
        return []
    for flaw in flaws:
        keys, *words = flaw
        complain(str(Fault(f"grade {grade.id!r}", None, path_text(keys), *words)))
    return [] if flaws else [grade]
