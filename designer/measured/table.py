"""Reads a table of any origin into columns of numbers, within bounds of size.

Columns of a text are separated by commas, or by semicolons or tabs, with decimal points or commas
then. A row below the head without any number holds the columns' units.
"""

from __future__ import annotations

import csv
import math
import re
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from datetime import UTC, datetime
from itertools import chain, islice
from typing import BinaryIO, NamedTuple, NoReturn, TypeAlias

import numpy as np

from designer.arrays import FloatArray, IntArray
from designer.errors import Fault, InputError

LARGEST_FILE_BYTES = 1_000_000_000
_LONGEST_LINE_BYTES = 1_000_000
_CONTROL_CODE = re.compile(r"[\x00-\x08\x0b\x0c\x0e-\x1f\x7f]")
_EXPECTED = "a CSV file: names of columns in its first line, numbers below"
_WITH_DECIMALS = re.compile(r"\s*[-+]?\d*([.,])\d+(?:[eE][-+]?\d+)?\s*")
_ISO_TIME = re.compile(r"\s*\d{4}-\d\d-\d\d[T ]\d\d:\d\d.*")


MOST_ALIKE = 20
"""How many faults of one kind are told one by one; nobody reads more."""

_NOTHING = frozenset({"", "nan", "-nan", "na", "n/a", "#n/a", "null", "none", "-"})


Rows: TypeAlias = Iterator[tuple[int, list[str]]]
"""Rows that are not blank, each with the line where it starts, from 1; 0 where there are none."""


class TextCell(NamedTuple):
    """A cell that holds a text or a time: its row, counted from 0, and how it is written."""

    row: int
    text: str


@dataclass(frozen=True, slots=True, eq=False)
class RawColumn:
    """One column as the file has it.

    Parameters
    ----------
    name : str
        Its name; empty where the first line has none.
    values : array (n_rows,)
        Its numbers; NaN where there is nothing, or a text. Times as in ISO 8601 are seconds since
        1970, UTC where they name no zone.
    n_texts : int
        How many cells hold a text.
    texts : tuple of TextCell
        The first few of those.
    first_time : TextCell or None
        The first cell with a time as in ISO 8601.
    unit : str
        What the row of units says; empty without.
    """

    name: str
    values: FloatArray
    n_texts: int = 0
    texts: tuple[TextCell, ...] = ()
    first_time: TextCell | None = None
    unit: str = ""

    @property
    def n_numbers(self) -> int:
        """How many cells hold a number."""
        return int(np.count_nonzero(~np.isnan(self.values)))

    @property
    def is_empty(self) -> bool:
        """Whether no cell holds anything."""
        return self.n_texts == 0 and self.n_numbers == 0


@dataclass(frozen=True, slots=True, eq=False)
class LogTable:
    """A table as a file has it.

    Parameters
    ----------
    name : str
        The file, for messages.
    columns : tuple of RawColumn
        In the order of the file.
    lines : array (n_rows,)
        Line of each row in the file, from 1; zeros where it has no lines.
    faults : tuple of Fault
        Rows of another width, which are left out, and names that stand twice.
    sha256 : str
        Digest of the file's bytes.
    units_line : int or None
        Line of the row of units.
    head_line : int or None
        Line of the names; None where the file has no lines.
    """

    name: str
    columns: tuple[RawColumn, ...]
    lines: IntArray
    faults: tuple[Fault, ...] = ()
    sha256: str = ""
    units_line: int | None = None
    head_line: int | None = 1

    @property
    def n_rows(self) -> int:
        """Number of rows below the head."""
        return len(self.lines)

    def fault(self, row: int | None, column: str, problem: str, expected: str = "") -> Fault:
        """Return a fault in a row, counted from 0; in the head for None."""
        line = self.head_line if row is None else int(self.lines[row]) or None
        place = "" if row is None else f"row {row + 1} "
        return Fault(self.name, line, column, f"{place}{problem}", expected)

    def first_few(self, faults: Iterable[Fault], total: int, kind: str) -> list[Fault]:
        """Return the first of ``total`` faults of one kind, and one that counts the others."""
        shortlist = list(islice(faults, MOST_ALIKE))
        if total > len(shortlist):
            shortlist.append(
                Fault(self.name, None, "", f"and {total - len(shortlist)} more {kind}")
            )
        return shortlist


def text_rows(file: BinaryIO, name: str, see: Callable[[bytes], None]) -> Rows:
    """Yield the rows of a text, whose bytes `see` is given.

    Raises
    ------
    InputError
        If it is too large, is no text in UTF-8, or is no CSV.
    """
    return _rows(_lines(file, name, see), name)


def table_of(rows: Rows, name: str, most_texts: int = MOST_ALIKE) -> LogTable:
    """Return the table of such rows, names of columns first; messages call the file ``name``.

    Of a column so many texts are kept.

    Raises
    ------
    InputError
        If it is empty or has no head.
    """
    head_line, names = _head(rows, name)
    units, units_line, rows = _units(rows, len(names))
    columns = [_Filling(most_texts) for _ in names]
    lines: list[int] = []
    misfits: list[tuple[int, int]] = []
    # Few enough that their text takes no memory to speak of, many enough for whole columns.
    while block := list(islice(rows, 4096)):
        first_row = len(lines)
        lines += [line for line, _ in block]
        widths = enumerate((len(cells) for _, cells in block), start=first_row)
        misfits += [(row, width) for row, width in widths if width != len(names)]
        blanks = [""] * len(names)  # a row of another width stays as one without anything in it
        whole_rows = (cells if len(cells) == len(names) else blanks for _, cells in block)
        for column, filled in zip(columns, zip(*whole_rows, strict=True), strict=True):
            column.add(filled, first_row)
    filled_columns = tuple(
        column.column(*head)
        for head, column in zip(zip(names, units, strict=True), columns, strict=True)
    )
    table = LogTable(
        name,
        filled_columns,
        np.array(lines, dtype=np.int64),
        units_line=units_line,
        head_line=head_line,
    )
    expected = f"{len(names)}, as the first line has names"
    of_another_width = (
        table.fault(row, "", f"has {width} value{'s' * (width != 1)}", expected)
        for row, width in misfits
    )
    faults = table.first_few(of_another_width, len(misfits), "rows of another width")
    places: dict[str, int] = {}
    repeated = []
    for place, heading in enumerate(names, start=1):
        if heading and heading in places:
            problem = f"columns {places[heading]} and {place} have the same name"
            repeated.append(table.fault(None, heading, problem, "a name for each column"))
        places.setdefault(heading, place)
    return replace(table, faults=(*repeated, *faults))


def refuse(name: str, line: int | None, problem: str, expected: str = _EXPECTED) -> NoReturn:
    """Raise what is wrong with a file as a whole, or at a line."""
    raise InputError.at(name, problem, expected, line=line)


def _lines(file: BinaryIO, name: str, see: Callable[[bytes], None]) -> Iterator[str]:
    """Yield the lines one by one, so that neither size nor an endless file fills the memory."""
    size = 0
    for number, raw in enumerate(iter(lambda: file.readline(_LONGEST_LINE_BYTES), b""), start=1):
        size += len(raw)
        if size > LARGEST_FILE_BYTES:
            limit = f"at most {LARGEST_FILE_BYTES / 1e6:g} MB"
            refuse(name, None, "the file is too large", limit)
        see(raw)
        try:
            text = raw.decode("utf-8-sig" if number == 1 else "utf-8")
        except UnicodeDecodeError:
            refuse(name, number, "this is not text in UTF-8")
        if _CONTROL_CODE.search(text):
            refuse(name, number, "this is a binary file")
        if len(raw) == _LONGEST_LINE_BYTES:
            refuse(name, number, "this line is too long")
        yield text


def _rows(lines: Iterator[str], name: str) -> Rows:
    """Yield each row that is not blank, with the line where it starts."""
    head: list[str] = []
    for text in lines:
        head.append(text)
        if text.strip():
            break
    # Commas within quotes separate nothing; a comma where there are as many of each.
    marks = re.sub(r'"[^"]*"', "", "".join(head[-1:]))
    delimiter = max(",;\t", key=marks.count)
    reader = csv.reader(chain(head, lines), delimiter=delimiter)
    decimals: dict[str, int] = {}  # the first line with each mark
    while True:
        line = reader.line_num + 1
        try:
            cells = next(reader)
        except StopIteration:
            return
        except csv.Error as error:
            if str(error).startswith("new-line character"):
                expected = "line feeds, as text files have now"
                refuse(name, line, "the lines end with carriage returns alone", expected)
            refuse(name, line, f"this is not valid CSV: {error}")
        if delimiter != ",":
            cells = [_with_point(cell, line, decimals) for cell in cells]
        if len(decimals) > 1:
            comma, point = decimals[","], decimals["."]
            problem = f"line {comma} has a decimal comma, line {point} a decimal point"
            refuse(name, line, problem, "one of them in the whole file")
        if len(cells) > 1 or "".join(cells).strip():
            yield line, cells


def _with_point(cell: str, line: int, decimals: dict[str, int]) -> str:
    """Return a cell with a decimal point, and note in which line its mark is seen first."""
    match = _WITH_DECIMALS.fullmatch(cell)
    if match is None:
        return cell
    decimals.setdefault(match[1], line)
    return cell.replace(",", ".")


def _head(rows: Rows, name: str) -> tuple[int | None, list[str]]:
    line, cells = next(rows, (1, []))
    names = [cell.strip() for cell in cells]
    if not names:
        refuse(name, None, "the file is empty")
    if all(is_number(cell) for cell in names):
        refuse(name, line, "the first line holds numbers", "the names of the columns")
    if names[0].startswith("#"):
        refuse(name, line, "the first line is a comment", "the names of the columns")
    if len(names) == 1 and " " in names[0]:
        expected = "by commas, semicolons or tabs"
        refuse(name, line, "the columns are separated by spaces", expected)
    return line or None, names


def _units(rows: Rows, width: int) -> tuple[list[str], int | None, Rows]:
    """Return the row of units, if there is such, its line, and the rows below."""
    first = list(islice(rows, 1))
    for line, cells in first:
        units = [cell.strip().removeprefix("[").removesuffix("]").strip() for cell in cells]
        texts = [cell for cell in cells if cell.strip().casefold() not in _NOTHING]
        if texts and len(cells) == width and all(_number(cell) is None for cell in texts):
            return ["" if unit in ("-", "1") else unit for unit in units], line or None, rows
    return [""] * width, None, chain(first, rows)


def read_cells(
    cells: Sequence[str], first_row: int
) -> tuple[FloatArray, list[TextCell], list[TextCell]]:
    """Return the numbers of a column, NaN for nothing or a text; the texts; and the times."""
    with suppress(ValueError):  # the quick way, which most columns allow
        return np.array([_float(cell) for cell in cells]), [], []
    numbers = [_number(cell) for cell in cells]
    written = [TextCell(row, cell.strip()) for row, cell in enumerate(cells, start=first_row)]
    texts = [cell for cell, number in zip(written, numbers, strict=True) if number is None]
    times = [
        cell
        for cell, number in zip(written, numbers, strict=True)
        if number is not None and _ISO_TIME.fullmatch(cell.text)
    ]
    return np.array([math.nan if number is None else number for number in numbers]), texts, times


def is_number(cell: str) -> bool:
    """Return whether a cell holds a number, be it infinite."""
    return cell.strip().casefold() not in _NOTHING and _number(cell) is not None


def _number(cell: str) -> float | None:
    """Return the number, NaN for nothing, None for a text."""
    if cell.strip().casefold() in _NOTHING:
        return math.nan
    try:
        if _ISO_TIME.fullmatch(cell):
            time = datetime.fromisoformat(cell.strip())
            return (time if time.tzinfo else time.replace(tzinfo=UTC)).timestamp()
        return _float(cell)
    except ValueError:
        return None


def _float(cell: str) -> float:
    if "_" in cell:  # Python reads '1_2' as 12
        raise ValueError(cell)
    return float(cell)


@dataclass(slots=True)
class _Filling:
    """A column that grows block by block."""

    most_texts: int
    blocks: list[FloatArray] = field(default_factory=list)
    n_texts: int = 0
    texts: list[TextCell] = field(default_factory=list)
    first_time: TextCell | None = None

    def add(self, cells: Sequence[str], first_row: int) -> None:
        values, texts, times = read_cells(cells, first_row)
        if self.first_time is None and times:
            self.first_time = times[0]
        self.blocks.append(values)
        self.n_texts += len(texts)
        self.texts += texts[: self.most_texts - len(self.texts)]

    def column(self, name: str, unit: str) -> RawColumn:
        values = np.concatenate(self.blocks) if self.blocks else np.empty(0)
        return RawColumn(name, values, self.n_texts, tuple(self.texts), self.first_time, unit)
