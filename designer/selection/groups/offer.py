"""What may go onto a group of cables: the products that no other one beats."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from designer.arrays import FloatArray
from designer.grades.grade import Grade, Size
from designer.model.cable import Cable


@dataclass(frozen=True, slots=True, eq=False)
class Product:
    """One size of one grade, as it would be on the machine.

    Parameters
    ----------
    grade, size
        The product.
    cable : Cable
        Its figures as the solver takes them, safety factor applied.
    """

    grade: Grade
    size: Size
    cable: Cable

    @property
    def label(self) -> str:
        """Size and grade in one line."""
        return f"{self.size.id} of {self.grade.id}"

    @property
    def largest_strain(self) -> float:
        """Strain at the allowable tension; the cable never stretches more."""
        return self.cable.allowable_tension_N / self.cable.axial_stiffness_N


def undominated(products: Sequence[Product], *, by_price: bool = False) -> tuple[Product, ...]:
    """Return the products that no other one beats, the lightest first.

    One beats another if it is not heavier, not stiffer, not weaker, and, where the price decides,
    not dearer. Weight and stiffness are what a cable loads the others with; so what holds with the
    beaten product holds with the better one, as a rule. Of equal products the first one stays.
    """
    figures = np.array([_figures(product, by_price) for product in products]).reshape(-1, 4)
    kept = [k for k in range(len(figures)) if not _is_beaten(figures, k)]
    kept.sort(key=lambda k: tuple(figures[k]))
    return tuple(products[k] for k in kept)


def priced(products: Sequence[Product]) -> tuple[Product, ...]:
    """Return the products with a price, in the currency that most of them have."""
    known = [one for one in products if one.size.price_per_m is not None and one.grade.currency]
    currencies = Counter(one.grade.currency for one in known)
    most = max(currencies, key=lambda name: (currencies[name], name or ""), default=None)
    return tuple(one for one in known if one.grade.currency == most)


def _figures(product: Product, by_price: bool) -> tuple[float, float, float, float]:
    """What may not be larger in a product that beats another one."""
    cable = product.cable
    price = product.size.price_per_m if by_price else None
    return (
        cable.linear_density_kg_per_m,
        -cable.allowable_tension_N,
        cable.axial_stiffness_N,
        0.0 if price is None else price,
    )


def _is_beaten(figures: FloatArray, k: int) -> bool:
    beats = (figures <= figures[k]).all(axis=1)
    is_better = (figures < figures[k]).any(axis=1)
    comes_first = np.arange(len(figures)) < k
    return bool((beats & (is_better | comes_first)).any())
