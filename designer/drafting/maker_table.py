"""A maker's table of sizes as it was printed: which column is what, in which unit."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from itertools import islice
from pathlib import Path

from designer.documents.opened import open_input, reason
from designer.documents.table import cells_of
from designer.drafting.pdf_table import pdf_rows
from designer.errors import Fault, InputError, visible
from designer.grades.grade import DIMENSIONS, MAX_SIZES
from designer.units import QuantityError, describe, read_quantity

SIZE = "id"
FIGURES = (SIZE, *DIMENSIONS)
NEEDED = ("diameter", "minimum_breaking_load", "linear_mass")
_MOST_ABOVE = 20
"""Lines above the head, such as a title."""
_EXPECTED = "a CSV file, an Excel workbook or a PDF with a row for each size"

_HEADS = {
    SIZE: r"size|item|article|artikel|part n|code|ref|bezeichnung|nenngr|\btext|\bname",
    "diameter": r"diam|\bdia\b|durchmesser|[øØ⌀]|^d$|^d\b(?!/)|diamètre|diámetro",
    "minimum_breaking_load": r"mbl|mbf|mbs|f ?min\b|break|bruch|strength|rupture|rotura",
    "linear_mass": r"mass|weight|gewicht|masse|poids|peso|^wt\b",
    "metallic_area": r"metal\w* (?:area|cross|sec)|metall\w*quer|cross.?section|querschnitt|^area",
}
"""What the heads of makers' tables have in them, in the languages of Europe's catalogues."""
_NO_MINIMUM = re.compile(
    r"average|mean\b|mittel|typical|aggregate|calculated|rechn|moyen|safe|work|wll|swl|proof|grade",
    re.IGNORECASE,
)
"""Loads that are none at which no rope of the size breaks."""
_UNITS = {
    "diameter": {'"': "in", "''": "in", "inches": "in", "zoll": "in"},
    "minimum_breaking_load": {
        "lb": "lbf", "lbs": "lbf", "pounds": "lbf", "kg": "kgf", "kp": "kgf",
        "kips": "kip", "kn": "kN", "dan": "daN",
    },
    "linear_mass": {
        "kg/%m": "kg/100m", "kg/100 m": "kg/100m", "lbs/ft": "lb/ft", "lbs/100ft": "lb/100ft",
        "lbs/100 ft": "lb/100ft", "lb./ft.": "lb/ft", "lbs./ft.": "lb/ft", "kg/mtr": "kg/m",
    },
    "metallic_area": {"mm2": "mm^2", "mm²": "mm^2", "in2": "in^2", "sq mm": "mm^2"},
}  # fmt: skip
"""How tables write units, beside what every file may hold."""
_OF = r"tons?\s*\(?\s*(?:of )?"
_TONS = {
    "short_ton_force": rf"(?:short|u\.?s\.?|net) tons?|{_OF}2[ ,]?000 ?lbs?\.?\)?",
    "long_ton_force": rf"(?:long|u\.?k\.?|imperial|gross) tons?|{_OF}2[ ,]?240 ?lbs?\.?\)?",
    "tonf": rf"te?|tf|mp|tonnes?|metric tons?|{_OF}1[ ,]?000 ?kg\)?",
}
"""The same of tons; which one a plain ton is, has to be asked for."""


@dataclass(frozen=True, slots=True)
class FoundColumn:
    """A column: its place from 0, its head, and the unit that the table prints, if it does.

    Some have a second figure in brackets, in another unit, which is left out.
    """

    place: int
    head: str
    unit: str | None = None
    has_brackets: bool = False


@dataclass(frozen=True, slots=True)
class MakerRow:
    """A size: its line in the file, its id, and the text of each figure with a decimal point."""

    line: int
    id: str
    figures: Mapping[str, str]


@dataclass(frozen=True, slots=True)
class MakerTable:
    """A table whose columns are known."""

    name: str  #: the file, for messages
    head_line: int
    heads: tuple[str, ...]
    columns: Mapping[str, FoundColumn]  #: that are used, by what they are: one of `FIGURES`
    cells: tuple[tuple[int, list[str]], ...]  #: line and cells of each row below

    @property
    def left_out(self) -> tuple[str, ...]:
        """Heads of the columns that are not used."""
        used = {column.place for column in self.columns.values()}
        return tuple(head for place, head in enumerate(self.heads) if head and place not in used)

    def fault(self, line: int, column: str, problem: str, expected: str) -> Fault:
        """Return what is wrong with a cell."""
        return Fault(self.name, line, column, problem, expected)

    def rows(
        self, units: Mapping[str, str], leave_out: Callable[[str], object] = lambda _: None
    ) -> tuple[MakerRow, ...]:
        """Return the sizes, ascending in diameter; lines without any figure are passed over.

        ``leave_out`` is called with words for each size that lacks a figure that is needed.

        Raises
        ------
        InputError
            With a fault for each cell that holds no number.
        """
        faults: list[Fault] = []
        rows: list[MakerRow] = []
        for line, cells in self.cells:
            texts = {f: _cell(cells, c) for f, c in self.columns.items()}
            needed = [texts[figure] for figure in NEEDED]
            if not any(map(_number, needed)) and sum(text[:1].isdigit() for text in needed) < 2:
                continue  # a heading between the rows, or a note below them
            figures = {f: _number(texts[f]) for f in texts if f != SIZE and texts[f]}
            for figure in [f for f in self.columns if f != SIZE]:
                if texts[figure] and figures[figure] is None:
                    head, problem = self.columns[figure].head, f"holds {describe(texts[figure])}"
                    expected = f"a number, the {figure}; or the row left out"
                    faults.append(self.fault(line, head, problem, expected))
            lacking = [figure for figure in NEEDED if not texts[figure]]
            if lacking:
                leave_out(f"line {line}, {' '.join(filter(None, cells[:2]))}: no {lacking[0]}")
                continue
            first = _BRACKETS.sub("", texts["diameter"][:_LONGEST_NUMBER])
            size_id = texts.get(SIZE) or f"{first} {units['diameter']}"
            numbers = {figure: text for figure, text in figures.items() if text is not None}
            rows.append(MakerRow(line, " ".join(size_id.split()), numbers))
        if not rows:
            faults.append(Fault(self.name, None, "", "there is no size below the head", _EXPECTED))
        if len(rows) > MAX_SIZES:
            expected = f"at most {MAX_SIZES}"
            faults.append(Fault(self.name, None, "", f"there are {len(rows)} sizes", expected))
        if faults:
            raise InputError(faults)
        return tuple(sorted(rows, key=lambda row: float(row.figures["diameter"])))


Choose = Callable[[str, Sequence[str], str], int | None]
"""What asks which of some heads a figure is: its name, the heads, why it is asked."""


def read_maker_table(
    path: Path,
    named: Mapping[str, str],
    choose: Choose = lambda *_: None,
    page: int | None = None,
) -> MakerTable:
    """Return the table in a file: its columns guessed from their heads where they are not named.

    Parameters
    ----------
    path : Path
        A CSV file, of commas, semicolons or tabs, an Excel workbook, or a PDF; of the latter a line
        is a row of its table.
    named : mapping
        Heads of columns, or their numbers from 1, by what they are.
    choose : callable
        Asked where a column is in doubt; None is no answer.
    page : int or None
        Where the table of a PDF stands, from 1; None where no other page has such a table.

    Raises
    ------
    InputError
        If it cannot be read, or a column is not known.
    """
    lines = _lines(path, page)
    if not lines:
        raise InputError.at(path, "the file is empty", _EXPECTED)
    at = next((k for k, (_, cells) in enumerate(lines[:_MOST_ABOVE]) if _is_head(cells)), 0)
    (head_line, cells), below = lines[at], lines[at + 1 :]
    heads = tuple(visible(" ".join(cell.split())) for cell in cells)
    printed_units = [""] * len(heads)
    if below and not any(map(_number, below[0][1])):
        printed_units = [*below[0][1], *printed_units][: len(heads)]
    columns: dict[str, FoundColumn] = {}
    faults: list[Fault] = []
    for figure in sorted(FIGURES, key=lambda f: (f not in named, FIGURES.index(f))):
        taken = [column.place for column in columns.values()]
        try:
            place = _place(figure, heads, printed_units, named, taken, choose)
        except ValueError as error:
            faults.append(Fault(str(path), head_line, figure, *error.args))
            continue
        if place is not None:
            columns[figure] = FoundColumn(place, heads[place])
    if "diameter" not in columns and SIZE in columns and SIZE not in named and not faults:
        columns["diameter"] = columns.pop(SIZE)  # a table whose sizes are its diameters
    for figure in NEEDED:
        if figure not in columns and not any(fault.field == figure for fault in faults):
            problem = f"no column is known to be it, of {', '.join(filter(None, heads))}"
            expected = f"--column {figure}=HEAD"
            faults.append(Fault(str(path), head_line, figure, problem, expected))
    if faults:
        raise InputError(faults)
    for figure, column in columns.items():
        texts = [_cell(cells, column) for _, cells in below]
        if figure in NEEDED and texts and not any(texts):
            expected = f"the {figure} of each size, from the maker: nothing stands in for it"
            faults.append(Fault(str(path), head_line, column.head, "the column is empty", expected))
        columns[figure] = _with_unit(figure, column, printed_units[column.place], texts)
    if faults:
        raise InputError(faults)
    return MakerTable(str(path), head_line, heads, columns, tuple(below))


def _lines(path: Path, page: int | None) -> list[tuple[int, list[str]]]:
    try:
        file = open_input(path)
    except (OSError, ValueError) as error:
        raise InputError.at(path, f"the file cannot be read: {reason(error)}", _EXPECTED) from None
    with file:
        is_pdf = file.read(5) == b"%PDF-"
        file.seek(0)
        if page is not None and not is_pdf:
            raise InputError.at("--page", f"{path} is no PDF", "the page of a PDF")
        rows = (
            enumerate(pdf_rows(file, str(path), page, _has_head), start=1)
            if is_pdf
            else cells_of(file, str(path))[0]
        )
        return [*islice(rows, MAX_SIZES + 4 * _MOST_ABOVE)]


def _has_head(rows: Sequence[Sequence[str]]) -> bool:
    return any(map(_is_head, rows[:_MOST_ABOVE]))


def _is_head(cells: Sequence[str]) -> bool:
    """Tell whether cells name a breaking load and something else."""
    known = {figure for cell in cells for figure in FIGURES if _may_be(figure, cell)}
    return "minimum_breaking_load" in known and len(known) > 1


def _may_be(figure: str, head: str) -> bool:
    if not re.search(_HEADS[figure], _plain(head), re.IGNORECASE):
        return False
    return figure != "minimum_breaking_load" or not _NO_MINIMUM.search(head)


def _place(
    figure: str,
    heads: Sequence[str],
    printed_units: Sequence[str],
    named: Mapping[str, str],
    taken: Sequence[int],
    choose: Choose,
) -> int | None:
    """Return which column a figure is, None for none; ValueError where it is in doubt."""
    if figure in named:
        return _named_place(heads, named[figure])
    alike = [k for k, head in enumerate(heads) if k not in taken and _may_be(figure, head)]
    if figure == SIZE:
        return alike[0] if alike else None
    if len({_without_unit(figure, heads[k]) for k in alike}) > 1:
        listed = [heads[k] for k in alike]
        answer = choose(figure, listed, "several columns may be it")
        if answer is None:
            problem = f"may be {' or '.join(map(repr, listed))}"
            raise ValueError(problem, f"--column {figure}=HEAD")
        return alike[answer]
    if not alike and figure in NEEDED and figure != "diameter":
        free = [k for k, head in enumerate(heads) if head and k not in taken]
        answer = choose(figure, [heads[k] for k in free], "no column is known to be it")
        return None if answer is None else free[answer]
    with_unit = [k for k in alike if _units(figure, printed_units[k]) | _units(figure, heads[k])]
    return next(iter(with_unit or alike), None)


def _named_place(heads: Sequence[str], text: str) -> int:
    """Return the place of a column that an option names by its head or number."""
    same = [k for k, head in enumerate(heads) if head.casefold() == text.strip().casefold()]
    if len(same) == 1:
        return same[0]
    if text.isdecimal() and 1 <= int(text) <= len(heads):
        return int(text) - 1
    problem = f"{text!r} is the head of {'several columns' if same else 'no column'}"
    raise ValueError(problem, f"one of {', '.join(filter(None, heads))}, or its number from 1")


def _plain(head: str) -> str:
    """Return a head such as ``linear_mass_kg_per_m`` as words and a unit."""
    return head.replace("_", " ").replace(" per ", "/").replace(",", " ")


def _without_unit(figure: str, head: str) -> str:
    """Return a head without its unit: alike for one figure in two units."""
    words = _IN_BRACKETS.sub("", _plain(head)).casefold().split()
    while words and known_unit(figure, words[-1]) is not None:
        words.pop()
    return " ".join(words).strip(" :/.")


def _with_unit(figure: str, column: FoundColumn, printed: str, texts: Sequence[str]) -> FoundColumn:
    """Return a column with its unit, where the row of units, its head or else its cells have one.

    Where all cells have a second figure in brackets, a unit in brackets is that one's.
    """
    if figure == SIZE:
        return column
    numbers = [text for text in texts if _number(text)]
    has_brackets = [_BRACKETS.search(text) is not None for text in numbers]
    in_two_units = bool(numbers) and all(has_brackets)
    bare = {_BRACKETS.sub("", text) for text in numbers}
    marks = {re.sub(r"[\d\s./,-]", "", text) for text in bare}
    units = _units(figure, printed, in_two_units) or _units(figure, column.head, in_two_units)
    if figure == "diameter" and not units and len(marks) == 1:
        units = {known_unit("diameter", marks.pop())}
    unit = units.pop() if len(units) == 1 else None
    return replace(column, unit=unit, has_brackets=any(has_brackets))


def _units(figure: str, head: str, in_two_units: bool = False) -> set[str | None]:
    """Return the units that a head names, behind its words and in brackets."""
    head = _plain(head)
    words, bare = head.split(), _IN_BRACKETS.sub(" ", head).split()
    endings = [" ".join(part[-n:]) for part in (words, bare) for n in (4, 3, 2, 1)]
    behind = {next(filter(None, (known_unit(figure, ending) for ending in endings)), None)}
    within = {known_unit(figure, part) for part in _IN_BRACKETS.findall(head)} - {None}
    if in_two_units:
        return behind - {None}
    is_preposition = bool(within) and bare[-1:] == ["in"]  # such as "diameter in (mm)"
    return within | (set() if is_preposition else behind - {None})


def known_unit(figure: str, text: str) -> str | None:
    """Return a unit of a figure as a grade file has it; None for what is none."""
    unit = " ".join(text.split()).removeprefix("in ") if len(text) > 2 else text
    unit = _UNITS[figure].get(unit.casefold(), unit)
    if figure == "minimum_breaking_load":
        tons = (ton for ton, spelling in _TONS.items() if re.fullmatch(spelling, unit, re.I))
        unit = next(tons, unit)
    if not unit or len(unit) > 20:
        return None
    try:
        read_quantity(f"1 {unit}", DIMENSIONS[figure])
    except QuantityError:
        return None
    return unit


def _cell(cells: Sequence[str], column: FoundColumn) -> str:
    return cells[column.place].strip() if column.place < len(cells) else ""


_BRACKETS = re.compile(r"(?<=\S)\s*[\[(][^\[\]()]*\d[^\[\]()]*[\])]$")
"""A figure in another unit, behind the first."""
_IN_BRACKETS = re.compile(r"[\[(](.*?)[\])]")
_LONGEST_NUMBER = 40
_FRACTION = re.compile(r"(?:(\d+)[\s-]+)?(\d+)\s*/\s*(\d+)")
_THOUSANDS = re.compile(r"\d{1,3}(?:[ ,'\u00a0\u202f]\d{3})+(?:\.\d+)?")


def _number(text: str) -> str | None:
    """Return a number of a table with a decimal point and no marks between thousands.

    A part of an inch such as ``1-1/8"`` becomes a decimal fraction; a second number in brackets is
    left out. None for what is no number.
    """
    if len(text) > _LONGEST_NUMBER:
        return None
    bare = _BRACKETS.sub("", text).strip("\"*†' ").removesuffix("mm").removesuffix("in").strip(' "')
    if match := _FRACTION.fullmatch(bare):
        whole, upper, lower = (int(part or 0) for part in match.groups())
        return f"{float(whole + Fraction(upper, lower)):.10g}" if lower else None
    if _THOUSANDS.fullmatch(bare):
        bare = re.sub(r"[ ,'\u00a0\u202f]", "", bare)
    return bare if re.fullmatch(r"\d+(?:\.\d*)?|\.\d+", bare) and float(bare) > 0.0 else None
