"""What ropes cost: by the study's own list, by their grades, or about, where neither has a price.

Then curves of the price of a metre over the diameter, c₁ d + c₂ d², for mooring ropes (MoorPy,
library/MoorProps_newCosts.yaml, 2024; OMAE2025-156384). Ropes of machines are sold elsewhere and in
other lengths, hence the wide interval, which is ours.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import lru_cache

from designer.grades.grade import Grade
from designer.model.cable import Offer
from designer.selection.candidate import common_currency
from designer.study import Selection


@dataclass(frozen=True, slots=True)
class PriceEstimate:
    """Prices that are borrowed: of which year, from where, and what share of them one may pay."""

    currency: str
    year: int
    low: float
    high: float
    source: str


BORROWED = PriceEstimate(
    "USD", 2024, 0.5, 2.0, "MoorPy, library/MoorProps_newCosts.yaml; OMAE2025-156384"
)
_PER_M = {
    "steel": (258.0, 14_300.0),
    "polyester": (117.0, 12_700.0),
    "nylon": (9.84, 14_300.0),
    "HMPE": (-2_270.0, 110_000.0),
}
"""c₁ [USD/m²] and c₂ [USD/m³], by material."""
_THICK_M = 0.05
"""Least diameter for a curve that is negative for thin ropes."""


def with_prices(
    grades: Sequence[Grade], selection: Selection
) -> tuple[Sequence[Grade], PriceEstimate | None]:
    """Return the grades with the prices that a study compares, and what is borrowed of these.

    The prices of the study's own list come before those of grades; where there are such, sizes
    priced in another currency have none. Borrowed are prices where the cost is an objective and no
    grade that the study allows has a price of its own; materials without a curve stay without.
    """
    if selection.price_list is not None:
        currency, offers_of = selection.price_list.currency, selection.price_list.offers_of
        return [_listed(grade, currency, offers_of(grade.id)) for grade in grades], None
    allowed = [grade for grade in grades if grade.why_excluded(selection) is None]
    if "cost" not in selection.objectives or common_currency(allowed) is not None:
        return grades, None
    return [_estimated(grade) for grade in grades], BORROWED


@lru_cache(maxsize=2**14)  # the same sizes whenever asked: candidates are told apart by them
def _listed(grade: Grade, currency: str, offers: tuple[Offer, ...]) -> Grade:
    is_comparable = grade.currency == currency
    if not offers and (is_comparable or grade.currency is None):
        return grade
    sizes = []
    for size in grade.sizes:
        prices = (o.price_per_m for o in offers if o.is_for(size.id, size.diameter_m))
        own = size.price_per_m if is_comparable else None
        sizes.append(replace(size, price_per_m=next(prices, own)))
    return replace(grade, sizes=tuple(sizes), currency=currency)


def offered(grades: Sequence[Grade], selection: Selection) -> list[Grade]:
    """Return the grades that a study allows, with the prices that it compares."""
    sold, _ = with_prices(grades, selection)
    return [grade for grade in sold if grade.why_excluded(selection) is None]


@lru_cache(maxsize=2**14)  # the same sizes whenever asked: candidates are told apart by them
def _estimated(grade: Grade) -> Grade:
    if grade.material not in _PER_M or any(s.price_per_m is not None for s in grade.sizes):
        return grade
    linear, square = _PER_M[grade.material]
    sizes = tuple(
        replace(size, price_per_m=size.diameter_m * (linear + square * size.diameter_m))
        if linear > 0.0 or size.diameter_m >= _THICK_M
        else size
        for size in grade.sizes
    )
    return replace(grade, sizes=sizes, currency=BORROWED.currency)
