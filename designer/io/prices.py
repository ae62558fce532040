"""Price lists of a user: a CSV file, or a sheet of Excel, with a row for each size."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from datetime import date
from functools import partial
from itertools import islice
from pathlib import Path

from designer.documents.bounds import BOUNDS, Bound
from designer.documents.opened import open_input, reason
from designer.documents.table import cells_of
from designer.errors import Fault, InputError
from designer.model.cable import PriceList, RopePrice
from designer.spelling import did_you_mean
from designer.units import LENGTH, QuantityError, read_quantity

_COLUMNS = "grade, size or diameter_mm, price_per_m, currency, date"
_TEXTS = ("grade", "price_per_m", "currency", "date")
_DIAMETER = re.compile(r"diameter_(\w+)")
_CURRENCY = re.compile(r"[A-Z]{3}")
_DATE = re.compile(r"\d{4}(-\d\d){0,2}")
_MAX_OFFERS = 20_000
_MAX_FAULTS = 20
ErrorOf = Callable[[str, str], InputError]


def read_prices(path: Path, error_of: ErrorOf) -> tuple[PriceList, str]:
    """Return the prices in a file, and the SHA-256 of its bytes.

    Its columns are ``grade``, ``size`` (as `designer catalog show` names it) or ``diameter_mm``,
    ``price_per_m``, ``currency`` (such as EUR, the same in all rows) and ``date`` (2026, 2026-03 or
    2026-03-31), in any order; others are refused. ``error_of`` makes the error where the file
    cannot be opened.

    Raises
    ------
    InputError
        With a fault for each cell that is wrong.
    """
    try:
        file = open_input(path)
    except (OSError, ValueError) as error:
        problem, expected = f"{path}: {reason(error)}", f"a CSV file with columns {_COLUMNS}"
        raise error_of(problem, expected) from None
    with file:
        rows, digest = cells_of(file, str(path))
        (head_line, head), *below = [*islice(rows, _MAX_OFFERS + 2)] or [(1, [])]
    names = [cell.strip().casefold() for cell in head]
    faults = [Fault(str(path), head_line, *flaw) for flaw in _head_flaws(names)]
    if not below:
        faults.append(Fault(str(path), None, "", "there is no price", "a row for each size"))
    if len(below) > _MAX_OFFERS:
        expected = f"at most {_MAX_OFFERS}"
        faults.append(Fault(str(path), None, "", "there are too many rows", expected))
    if not faults:
        reading = _Reading(str(path), names)
        offers = [reading.offer(line, cells) for line, cells in below]
        faults = reading.faults
    if faults:
        more = len(faults) - _MAX_FAULTS
        rest = [Fault(str(path), None, "", f"and {more} more of this kind")] if more > 0 else []
        raise InputError([*faults[:_MAX_FAULTS], *rest])
    priced = tuple(offer for offer in offers if offer is not None)
    return PriceList(path, reading.currency, priced), digest()


def _head_flaws(names: list[str]) -> Iterator[tuple[str, str, str]]:
    """Yield column, problem and what is expected of each name that is missing or not known."""
    sizes = [name for name in names if name == "size" or _DIAMETER.fullmatch(name)]
    for name in _TEXTS:
        if name not in names:
            yield name, "there is no such column", _COLUMNS
    if len(sizes) != 1:
        problem = f"there are {' and '.join(sizes)}" if sizes else "there is no such column"
        yield "size", problem, "one column size, or diameter_mm"
    for name in names:
        if name not in _TEXTS and name not in sizes:
            yield name, "is not known", _COLUMNS + did_you_mean(name, (*_TEXTS, "size"))
        elif names.count(name) > 1:
            yield name, "is there twice", "a name for each column"
            return
        elif (match := _DIAMETER.fullmatch(name)) and not _is_unit(match[1]):
            yield name, f"'{match[1]}' is no unit of length", "such as diameter_mm"


def _is_unit(text: str) -> bool:
    try:
        read_quantity(f"1 {text}", LENGTH)
    except QuantityError:
        return False
    return True


class _FlawError(ValueError):
    """What is wrong with a cell: column, what was found, what was expected."""


@dataclass
class _Reading:
    """Rows as they are read; what they have in common."""

    file: str
    names: list[str]
    currency: str = ""
    currency_line: int = 0
    faults: list[Fault] = field(default_factory=list)
    lines: dict[tuple[str, str], int] = field(default_factory=dict)

    def offer(self, line: int, cells: list[str]) -> RopePrice | None:
        """Return the offer of a row; None with a fault where it is none."""
        refuse = partial(Fault, self.file, line)
        if len(cells) != len(self.names):
            expected = f"{len(self.names)}, as the first line has names"
            self.faults.append(refuse("", f"has {len(cells)} values", expected))
            return None
        texts = {n: " ".join(cell.split()) for n, cell in zip(self.names, cells, strict=True)}
        try:
            offer = self._read(line, texts)
        except _FlawError as flaw:
            self.faults.append(refuse(*flaw.args))
            return None
        earlier = self.lines.setdefault((offer.grade, offer.size.casefold()), line)
        if earlier != line:
            problem = f"line {earlier} has a price of '{offer.grade}', {offer.size}, already"
            self.faults.append(refuse("size", problem, "one row for each size"))
        return offer

    def _read(self, line: int, texts: Mapping[str, str]) -> RopePrice:
        for name, text in texts.items():
            if not text:
                raise _FlawError(name, "holds nothing", "a value in each row")
        currency = texts["currency"]
        if not _CURRENCY.fullmatch(currency):
            raise _FlawError("currency", f"holds {currency!r}", "three capitals such as EUR")
        if not self.currency:
            self.currency, self.currency_line = currency, line
        if currency != self.currency:
            expected = f"{self.currency} as in line {self.currency_line}, since rates change"
            raise _FlawError("currency", f"holds {currency!r}", expected)
        date_text = texts["date"].removesuffix("T00:00:00")  # as a sheet of Excel has dates
        if not _is_date(date_text):
            expected = "a date such as 2026-03-31, 2026-03 or 2026"
            raise _FlawError("date", f"holds {date_text!r}", expected)
        size_id, diameter_m = texts.get("size", ""), 0.0
        for name, text in texts.items():
            if match := _DIAMETER.fullmatch(name):
                scale = read_quantity(f"1 {match[1]}", LENGTH)
                diameter_m = scale * _number(name, text, BOUNDS["rope diameter"], scale)
        price = _number("price_per_m", texts["price_per_m"], BOUNDS["price"])
        return RopePrice(texts["grade"], size_id, diameter_m, price, date_text, line)


def _is_date(text: str) -> bool:
    try:
        date.fromisoformat(text + "-01-01"[len(text) - 4 :])
    except ValueError:
        return False
    return _DATE.fullmatch(text) is not None


def _number(column: str, text: str, bound: Bound, scale: float = 1.0) -> float:
    """Return the number in a cell, whose bounds are those of the number times ``scale``."""
    try:
        value = float(text)
    except ValueError:
        value = float("nan")
    lowest, highest = bound.least / scale, bound.most / scale
    if not lowest <= value <= highest:
        raise _FlawError(column, f"holds {text!r}", f"a number from {lowest:g} to {highest:g}")
    return value
