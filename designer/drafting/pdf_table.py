"""The table of ropes in a PDF, as rows of texts.

Only tables whose cells are drawn with lines are read. Without lines, cells have to be guessed from
how words are aligned, which was seen to lose the ends of texts, and so would lose digits.
"""

from __future__ import annotations

import io
import re
from collections.abc import Callable
from importlib import import_module
from typing import Any, BinaryIO

from designer.documents.opened import apart
from designer.documents.table import library_of
from designer.errors import InputError, one_line

_LARGEST_BYTES = 50_000_000
_MOST_PAGES = 200
_LONGEST_S = 60
_TOO_MUCH: Any = [], f"reading it takes over {_LONGEST_S} s or 2 GB", "--page N, or a CSV file"
_EXPECTED = "a table of text with lines between its cells; others are copied into a CSV file"
_WITH_COMMA = re.compile(r"\d+,(?:\d{1,2}|\d{4,})|0,\d+")
_WITH_POINT = re.compile(r"\d+\.\d+")
_COMMA_NUMBER = re.compile(r"\d+,\d+")

PdfRows = list[list[str]]


def pdf_rows(
    file: BinaryIO, name: str, page: int | None, has_head: Callable[[PdfRows], bool]
) -> PdfRows:
    """Return the rows of the one table in a PDF that has a head, or that is alone on a page.

    Parameters
    ----------
    file : binary file
    name : str
        The file, for messages.
    page : int or None
        The only page to look at, from 1; None for all.
    has_head : callable
        Tells whether rows begin as a table of ropes does.

    Raises
    ------
    InputError
        If the library that reads such files is missing, the file is damaged or too large, or it
        holds no such table or several.
    """
    library_of("pdfplumber", "pdf-tables", "a PDF", name)
    content = file.read(_LARGEST_BYTES + 1)
    if len(content) > _LARGEST_BYTES:
        expected = f"at most {_LARGEST_BYTES / 1e6:g} MB"
        raise InputError.at(name, "the file is too large", expected)
    tables, problem, expected = apart(_tables, content, _LONGEST_S, page) or _TOO_MUCH
    if problem:
        raise InputError.at(name, problem, expected)
    known = [(number, rows) for number, rows in tables if has_head(rows)]
    if page is not None and not known and len(tables) == 1:
        known = tables
    if not known:
        where = "it" if page is None else f"page {page}"
        problem = f"there is no table in {where} whose head names a breaking load"
        raise InputError.at(name, problem, _EXPECTED)
    if len(known) > 1:
        pages = list(dict.fromkeys(str(number) for number, _ in known))
        if len(pages) == 1:
            problem = f"page {pages[0]} has {len(known)} tables with a breaking load"
            raise InputError.at(name, problem, "one of them, copied into a CSV file")
        problem = f"there are tables with a breaking load on the pages {', '.join(pages)}"
        raise InputError.at(name, problem, "--page N")
    return _with_points(known[0][1])


def _tables(content: bytes, page: int | None) -> tuple[list[tuple[int, PdfRows]], str, str]:
    """Return the tables of all pages, or of one, by the page's number; or why not, and a remedy."""
    try:
        with import_module("pdfplumber").open(io.BytesIO(content)) as pdf:
            if page is None and len(pdf.pages) > _MOST_PAGES:
                return [], f"it has {len(pdf.pages)} pages", "--page N"
            pages = pdf.pages if page is None else pdf.pages[page - 1 : page]
            return [(p.page_number, rows) for p in pages for rows in _tables_of(p)], "", ""
    except Exception as error:  # whatever a damaged file makes of its reader
        problem = f"this is no PDF that can be read: {one_line(error)[:150]}".rstrip(": ")
        return ([], problem, _EXPECTED) if not isinstance(error, MemoryError) else _TOO_MUCH


def _tables_of(page: Any) -> list[PdfRows]:
    return [
        [[" ".join((cell or "").split()) for cell in row] for row in rows]
        for rows in page.extract_tables()
    ]


def _with_points(rows: PdfRows) -> PdfRows:
    """Return rows with decimal points, if their numbers have decimal commas.

    So they have if one of them has other than three digits behind its comma, or a zero alone before
    it, and none has a point.
    """
    cells = [cell for row in rows for cell in row]
    is_comma = any(map(_WITH_COMMA.fullmatch, cells)) and not any(map(_WITH_POINT.fullmatch, cells))
    if not is_comma:
        return rows
    return [
        [cell.replace(",", ".") if _COMMA_NUMBER.fullmatch(cell) else cell for cell in row]
        for row in rows
    ]
