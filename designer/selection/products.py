"""What may go onto the cables: sizes of the grades that a study allows, as they would be there."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from designer.effects.design import AsBuilt
from designer.grades.grade import Grade, Size
from designer.model.cable import Cable
from designer.selection.efficiency import Allowance
from designer.study import Selection


@dataclass(frozen=True, slots=True, eq=False)
class Product:
    """One size of one grade, as it would be on the machine."""

    grade: Grade
    size: Size
    cable: Cable  # Its figures as the solver takes them, efficiency and safety factor applied
    efficiency: float = 1.0  # Share of the breaking load that end fittings and bending leave

    @property
    def label(self) -> str:
        """Size and grade in one line."""
        return f"{self.size.id} of {self.grade.id}"

    @property
    def largest_strain(self) -> float:
        """Strain at the allowable tension; the cable never stretches more."""
        return self.cable.allowable_tension_N / self.cable.axial_stiffness_N


def is_allowed(grade: Grade, named: Sequence[str] | None) -> bool:
    """Tell whether a study that names these grades, or none, considers a grade."""
    return grade.why_only_by_name is None if named is None else grade.id in named


def products_of(selection: Selection, grades: Sequence[Grade], built: AsBuilt) -> list[Product]:
    """Return every size of these grades that the sheave allows, with its figures as built."""
    allowance = Allowance.of(selection)
    each = ((g, s, allowance.efficiency(g, s.diameter_m)) for g in grades for s in g.sizes)
    return [
        Product(grade, size, built.of_products.cable(allowance.cable(grade, size)), share)
        for grade, size, share in each
        if not math.isnan(share)
    ]


def common_currency(grades: Sequence[Grade]) -> str | None:
    """Return the currency in which most sizes are priced; None where none is."""
    priced = [g.currency for g in grades for s in g.sizes if g.currency and s.price_per_m]
    return max(sorted(set(priced)), key=priced.count, default=None)


def cost(product: Product, length_m: float, currency: str | None) -> float:
    """Return the price of this length; NaN without one in the currency of the comparison."""
    if product.size.price_per_m is None or product.grade.currency != currency:
        return math.nan
    return product.size.price_per_m * length_m


def priced(products: Sequence[Product]) -> tuple[Product, ...]:
    """Return the products with a price, in the currency that most of them have."""
    known = [one for one in products if one.size.price_per_m is not None and one.grade.currency]
    each = [one.grade.currency or "" for one in known]
    most = max(sorted(set(each), reverse=True), key=each.count, default=None)
    return tuple(one for one in known if one.grade.currency == most)


def undominated(products: Sequence[Product], *, by_price: bool = False) -> tuple[Product, ...]:
    """Return the products that no other one beats, the lightest first.

    One beats another if it is not heavier, not stiffer, not weaker, and, where the price decides,
    not dearer. Weight and stiffness are what a cable loads the others with; so what holds with the
    beaten product holds with the better one, as a rule. Of equal products the first one stays.
    """
    figures = np.array(
        [
            (
                one.cable.linear_density_kg_per_m,
                -one.cable.allowable_tension_N,
                one.cable.axial_stiffness_N,
                (one.size.price_per_m or 0.0) if by_price else 0.0,
            )
            for one in products
        ]
    ).reshape(-1, 4)

    def is_beaten(k: int) -> bool:
        beats = (figures <= figures[k]).all(axis=1)
        is_better = (figures < figures[k]).any(axis=1)
        return bool((beats & (is_better | (np.arange(len(figures)) < k))).any())

    kept = [k for k in range(len(figures)) if not is_beaten(k)]
    return tuple(products[k] for k in sorted(kept, key=lambda k: tuple(figures[k])))
