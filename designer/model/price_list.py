"""What ropes cost by offers that a user has."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path

_SAME_DIAMETER = 2e-3
"""Relative: 9.53 mm is the size of 3/8 in, and no grade has two sizes so near."""


@dataclass(frozen=True, slots=True)
class Offer:
    """The price of a metre of one size, of a date such as ``2026-03`` or ``2026-03-31``.

    The size is named by its id, or by its diameter [m] where ``size_id`` is empty. ``line`` is
    that of the list's file.
    """

    grade: str
    size_id: str
    diameter_m: float
    price_per_m: float
    date: str
    line: int

    @property
    def size(self) -> str:
        """The size as a message names it."""
        return self.size_id or f"{self.diameter_m * 1e3:g} mm"

    def is_for(self, size_id: str, diameter_m: float) -> bool:
        """Tell whether it is for a size of its grade."""
        if self.size_id:
            return self.size_id.casefold() == size_id.casefold()
        return math.isclose(self.diameter_m, diameter_m, rel_tol=_SAME_DIAMETER)


@dataclass(frozen=True, slots=True)
class PriceList:
    """Offers in one currency, from a file."""

    path: Path
    currency: str
    offers: tuple[Offer, ...]

    @property
    def name(self) -> str:
        """The file's name without its folder."""
        return self.path.name

    @property
    def dates(self) -> tuple[str, str]:
        """The earliest and the latest date."""
        dates = [offer.date for offer in self.offers]
        return min(dates), max(dates)

    def offers_of(self, grade: str) -> tuple[Offer, ...]:
        """Return the offers of one grade."""
        return tuple(offer for offer in self.offers if offer.grade == grade)
