"""Reads a log of any origin into columns of numbers, within bounds of size.

Logs come as text, Excel, Parquet, or bags of ROS. What is no text is told by its first bytes, a bag
of ROS 2 by being a folder. Each library that reads one is an extra; rows then go the way of a
text's, so that all is checked alike.

Columns of a text are separated by commas, or by semicolons or tabs, with decimal points or commas
then. A row below the head without any number holds the columns' units.
"""

from __future__ import annotations

import csv
import hashlib
import importlib
import io
import math
import re
import warnings
import zipfile
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, fields, is_dataclass, replace
from datetime import UTC, datetime
from functools import partial
from itertools import chain, islice
from pathlib import Path
from typing import Any, BinaryIO, NamedTuple, NoReturn, TypeAlias

import numpy as np

from designer.arrays import FloatArray, IntArray
from designer.documents.opened import open_input
from designer.errors import Fault, InputError, one_line

LARGEST_FILE_BYTES = 1_000_000_000
_LONGEST_LINE_BYTES = 1_000_000
_CONTROL_CODE = re.compile(r"[\x00-\x08\x0b\x0c\x0e-\x1f\x7f]")
_CSV_EXPECTED = "a CSV file: names of columns in its first line, numbers below"
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
    """One column as the file has it."""

    name: str  #: its name; empty where the first line has none
    #: (n_rows,): its numbers; NaN where there is nothing, or a text. Times as in ISO 8601 are
    #: seconds since 1970, UTC where they name no zone.
    values: FloatArray
    n_texts: int = 0  #: how many cells hold a text
    texts: tuple[TextCell, ...] = ()  #: the first few of those
    first_time: TextCell | None = None  #: the first cell with a time as in ISO 8601
    unit: str = ""  #: what the row of units says; empty without

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
    """A table as a file has it."""

    name: str  #: the file, for messages
    columns: tuple[RawColumn, ...]  #: in the order of the file
    lines: IntArray  #: (n_rows,): line of each row in the file, from 1; zeros where it has no lines
    #: rows of another width, which are left out, and names that stand twice
    faults: tuple[Fault, ...] = ()
    sha256: str = ""  #: digest of the file's bytes
    units_line: int | None = None  #: line of the row of units
    head_line: int | None = 1  #: line of the names; None where the file has no lines

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
    return _csv_rows(_lines(file, name, see), name)


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


def refuse(name: str, line: int | None, problem: str, expected: str = _CSV_EXPECTED) -> NoReturn:
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


def _csv_rows(lines: Iterator[str], name: str) -> Rows:
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
        if texts and len(cells) == width and all(_number_in(cell) is None for cell in texts):
            return ["" if unit in ("-", "1") else unit for unit in units], line or None, rows
    return [""] * width, None, chain(first, rows)


def read_cells(
    cells: Sequence[str], first_row: int
) -> tuple[FloatArray, list[TextCell], list[TextCell]]:
    """Return the numbers of a column, NaN for nothing or a text; the texts; and the times."""
    with suppress(ValueError):  # the quick way, which most columns allow
        return np.array([_float(cell) for cell in cells]), [], []
    numbers = [_number_in(cell) for cell in cells]
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
    return cell.strip().casefold() not in _NOTHING and _number_in(cell) is not None


def _number_in(cell: str) -> float | None:
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


# Other formats.

_MOST_ROWS, _MOST_CELLS = 10_000_000, 50_000_000
_LAST_ROW = 1 << 20  # of a sheet of Excel
_DENSEST = 50  # a workbook with the same value everywhere unpacks to 16 times its size
_LONGEST_ARRAY = 64
"""Longer ones in a message are scans or images, no readings."""


class _Format(NamedTuple):
    """A binary format: what its files begin with, and the library that reads it, with its extra."""

    start: bytes
    called: str
    module: str
    extra: str
    rows: Callable[[Any, BinaryIO], Rows]


def read_table(file: BinaryIO, name: str, most_texts: int = MOST_ALIKE) -> LogTable:
    """Return the table in an open file, which messages call ``name``; see `table_of`.

    Raises
    ------
    InputError
        If it is too large, is in none of the formats, is empty, or has no head.
    """
    rows, digest = cells_of(file, name)
    table = table_of(rows, name, most_texts)
    return replace(table, sha256=digest())


def cells_of(file: BinaryIO, name: str) -> tuple[Rows, Callable[[], str]]:
    """Return the rows of an open file as texts, and what tells the SHA-256 of all that was read.

    Raises
    ------
    InputError
        If it is too large, or the library that reads it is missing; the rows, as they are read, if
        it is none of the formats.
    """
    digest = hashlib.sha256()
    start = file.read(max(len(kind.start) for kind in _FORMATS))
    file.seek(0)
    kind = next((kind for kind in _FORMATS if start.startswith(kind.start)), None)
    if kind is None:
        return text_rows(file, name, digest.update), digest.hexdigest
    content = file.read(LARGEST_FILE_BYTES + 1)
    if len(content) > LARGEST_FILE_BYTES:
        limit = f"at most {LARGEST_FILE_BYTES / 1e6:g} MB"
        refuse(name, None, "the file is too large", limit)
    digest.update(content)
    library = library_of(kind.module, kind.extra, kind.called, name)
    return _checked(kind, kind.rows(library, io.BytesIO(content)), name), digest.hexdigest


def library_of(module: str, extra: str, called: str, name: str) -> Any:
    """Return the library that reads a file of an optional format.

    Raises
    ------
    InputError
        If it is not installed; names the extra that brings it.
    """
    try:
        return importlib.import_module(module)
    except ImportError:
        problem = f"this is {called}, and {module.partition('.')[0]}, which reads such, is missing"
        refuse(name, None, problem, f"pip install 'cdpr-designer[{extra}]', or a CSV file")


def _checked(kind: _Format, rows: Rows, name: str) -> Rows:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of styles and the like, which are not read
        try:
            n_cells = 0
            for n_rows, row in enumerate(rows):
                n_cells += len(row[1])
                _require_size(n_rows, n_cells)
                yield row
        except Exception as error:  # whatever a damaged file makes of its reader
            kind_of_file = kind.called.partition(" ")[2]
            refuse(name, None, f"this is no {kind_of_file} that can be read: {one_line(error)}")


def _require_size(
    n_rows: int, n_cells: int, n_bytes: int = 0, n_packed: int = LARGEST_FILE_BYTES
) -> None:
    """Refuse what fills the memory, by what a file says of itself or by what came of it."""
    max_bytes = min(LARGEST_FILE_BYTES, max(1_000_000, _DENSEST * n_packed))
    if n_rows > _MOST_ROWS or n_cells > _MOST_CELLS or max(n_bytes, n_cells) > max_bytes:
        limits = f"{_MOST_ROWS:,} rows, {_MOST_CELLS:,} cells or {max_bytes:,} bytes"
        raise ValueError(f"it unpacks to more than {limits}")


def _workbook_rows(openpyxl: Any, file: BinaryIO) -> Rows:
    """Yield the rows of the first sheet, by their numbers there.

    The library's own loop leaves out rows that the sheet does not say that it has, and those whose
    number is not above that of the row before.
    """
    n_bytes = sum(part.file_size for part in zipfile.ZipFile(file).infolist())
    _require_size(0, 0, n_bytes, file.seek(0, io.SEEK_END))
    book = openpyxl.load_workbook(file, read_only=True, data_only=True)
    sheet = book.worksheets[0]
    reader = importlib.import_module("openpyxl.worksheet._reader").WorkSheetParser(
        sheet._get_source(), sheet._shared_strings, data_only=True, epoch=book.epoch,
        date_formats=book._date_formats, timedelta_formats=book._timedelta_formats,
    )  # fmt: skip
    width = last = 0
    for number, row in reader.parse():
        if not last < number <= _LAST_ROW or len({cell["column"] for cell in row}) < len(row):
            raise ValueError(f"row {number} follows row {last}, or has a cell twice")
        last = number
        texts = {cell["column"]: text for cell in row if (text := _text(cell["value"]))}
        if texts:
            width = width or max(texts)  # that of the head
            yield number, [texts.get(k, "") for k in range(1, max(width, *texts) + 1)]


def _parquet_rows(parquet: Any, file: BinaryIO) -> Rows:
    table = parquet.ParquetFile(file)
    head = table.metadata
    n_bytes = sum(head.row_group(k).total_byte_size for k in range(head.num_row_groups))
    n_cells = head.num_rows * head.num_columns
    _require_size(head.num_rows, n_cells, n_bytes, file.seek(0, io.SEEK_END))
    yield 0, list(table.schema_arrow.names)
    arrow = importlib.import_module("pyarrow")
    for batch in table.iter_batches(4096):
        columns = []
        for column in batch.columns:
            cells = column
            if arrow.types.is_timestamp(column.type):  # Python has no nanoseconds
                cells = column.cast(arrow.timestamp("us", column.type.tz), safe=False)
            columns.append([_text(cell) for cell in cells.to_pylist()])
        yield from ((0, list(row)) for row in zip(*columns, strict=True))


def _text(cell: object) -> str:
    if isinstance(cell, datetime):
        return cell.isoformat()
    return "" if cell is None else str(cell)


_FORMATS = (
    _Format(b"PAR1", "a Parquet file", "pyarrow.parquet", "parquet", _parquet_rows),
    _Format(b"PK\x03\x04", "an Excel workbook", "openpyxl", "excel", _workbook_rows),
)


def is_bag(path: Path) -> bool:
    """Return whether a path is that of a bag of ROS 2, which is a folder, or of ROS 1."""
    return (path / "metadata.yaml").is_file() or (path.suffix == ".bag" and path.is_file())


def read_bag(path: Path, wanted: Sequence[str]) -> list[LogTable]:
    """Return a table for each topic of a bag that one of the wanted columns is in.

    Columns are called by the topic and the field in its messages, such as
    ``/camera/pose.pose.position.x`` or ``/winches.position[0]``, and ``time_s`` is the stamp in a
    message's header, else when it was recorded [s, since 1970].

    Raises
    ------
    InputError
        If it cannot be read, or has none of the topics.
    """
    highlevel = library_of("rosbags.highlevel", "ros", "a bag of ROS", str(path))
    typesys = importlib.import_module("rosbags.typesys")
    standard = typesys.get_typestore(typesys.Stores.LATEST)
    try:
        with highlevel.AnyReader([path], default_typestore=standard) as reader:
            topics = sorted({connection.topic for connection in reader.connections})
            named = [t for t in topics if any(name.startswith(f"{t}.") for name in wanted)]
            messages: dict[str, list[dict[str, float]]] = {topic: [] for topic in named}
            chosen = [c for c in reader.connections if c.topic in named]
            for connection, recorded_ns, raw in (
                reader.messages(connections=chosen) if chosen else ()
            ):
                message = reader.deserialize(raw, connection.msgtype)
                stamp = getattr(getattr(message, "header", None), "stamp", None)
                stamp_s = 0.0 if stamp is None else stamp.sec + 1e-9 * stamp.nanosec
                cells = {"time_s": stamp_s or 1e-9 * recorded_ns}
                cells.update(_leaves(message, connection.topic))
                messages[connection.topic].append(cells)
    except Exception as error:  # whatever a damaged bag makes of its reader
        problem = f"this is no bag that can be read: {one_line(error)}"
        refuse(str(path), None, problem, "a bag of ROS")
    if not named:
        expected = (
            f"columns such as '{topics[0] if topics else '/topic'}.field' in measurements.columns"
        )
        refuse(str(path), None, f"none of its topics is used: {', '.join(topics)}", expected)
    sha256 = _digest(path)
    return [
        _table_of_messages(f"{path} ({topic})", cells, sha256)
        for topic, cells in messages.items()
        if cells
    ]


def _leaves(value: Any, path: str) -> Iterator[tuple[str, float]]:
    """Yield the numbers in a message with their names."""
    if is_dataclass(value):
        for entry in fields(value):
            if entry.name != "header":
                yield from _leaves(getattr(value, entry.name), f"{path}.{entry.name}")
    elif isinstance(value, list | tuple | np.ndarray) and len(value) <= _LONGEST_ARRAY:
        for place, part in enumerate(value):
            yield from _leaves(part, f"{path}[{place}]")
    elif isinstance(value, int | float | np.number):
        yield path, float(value)


def _table_of_messages(name: str, messages: list[dict[str, float]], sha256: str) -> LogTable:
    names = dict.fromkeys(column for cells in messages for column in cells)
    messages = sorted(messages, key=lambda cells: cells["time_s"])
    columns = tuple(
        RawColumn(column, np.array([cells.get(column, math.nan) for cells in messages]))
        for column in names
    )
    lines = np.zeros(len(messages), dtype=np.int64)
    return LogTable(name, columns, lines, sha256=sha256, head_line=None)


def _digest(path: Path) -> str:
    digest = hashlib.sha256()
    for part in sorted(path.iterdir()) if path.is_dir() else [path]:
        if part.is_file():
            with open_input(part) as file:
                for chunk in iter(partial(file.read, 1 << 20), b""):
                    digest.update(chunk)
    return digest.hexdigest()
