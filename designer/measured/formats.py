"""Tables in all formats that logs come in: text, Excel, Parquet, and bags of ROS.

What is no text is told by its first bytes, a bag of ROS 2 by being a folder. Each library that
reads one is an extra; rows then go the way of a text's, so that all is checked alike.
"""

from __future__ import annotations

import hashlib
import importlib
import io
import math
import warnings
import zipfile
from collections.abc import Callable, Iterator, Sequence
from dataclasses import fields, is_dataclass, replace
from datetime import datetime
from functools import partial
from pathlib import Path
from typing import Any, BinaryIO, NamedTuple

import numpy as np

from designer.documents.opened import open_input
from designer.errors import one_line
from designer.measured.table import (
    LARGEST_FILE_BYTES,
    MOST_ALIKE,
    LogTable,
    RawColumn,
    Rows,
    refuse,
    table_of,
    text_rows,
)

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
            what = kind.called.partition(" ")[2]
            refuse(name, None, f"this is no {what} that can be read: {one_line(error)}")


def _require_size(
    n_rows: int, n_cells: int, n_bytes: int = 0, n_packed: int = LARGEST_FILE_BYTES
) -> None:
    """Refuse what fills the memory, by what a file says of itself or by what came of it."""
    most = min(LARGEST_FILE_BYTES, max(1_000_000, _DENSEST * n_packed))
    if n_rows > _MOST_ROWS or n_cells > _MOST_CELLS or max(n_bytes, n_cells) > most:
        limits = f"{_MOST_ROWS:,} rows, {_MOST_CELLS:,} cells or {most:,} bytes"
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
    for batch in table.iter_batches(4096):
        columns = [_parquet_cells(column) for column in batch.columns]
        yield from ((0, list(cells)) for cells in zip(*columns, strict=True))


def _parquet_cells(column: Any) -> list[str]:
    arrow = importlib.import_module("pyarrow")
    if arrow.types.is_timestamp(column.type):  # Python has no nanoseconds
        column = column.cast(arrow.timestamp("us", column.type.tz), safe=False)
    return [_text(cell) for cell in column.to_pylist()]


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
            named = [topic for topic in topics if any(_is_of(topic, name) for name in wanted)]
            messages: dict[str, list[dict[str, float]]] = {topic: [] for topic in named}
            chosen = [each for each in reader.connections if each.topic in named]
            for connection, recorded_ns, raw in (
                reader.messages(connections=chosen) if chosen else ()
            ):
                message = reader.deserialize(raw, connection.msgtype)
                cells = {"time_s": _stamp_s(message) or 1e-9 * recorded_ns}
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


def _is_of(topic: str, column: str) -> bool:
    return column.startswith(f"{topic}.")


def _stamp_s(message: Any) -> float:
    """Return the time in a message's header [s]; 0 without."""
    stamp = getattr(getattr(message, "header", None), "stamp", None)
    return 0.0 if stamp is None else stamp.sec + 1e-9 * stamp.nanosec


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
