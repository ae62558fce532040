"""What may go onto the cables: sizes of grades as they would be there, their figures and prices.

Candidates are compared by objectives, each a number of which less is better. A rope costs what the
study's own list says, or its grade; where neither has a price, about what curves of the price of a
metre over the diameter say, c₁ d + c₂ d², for mooring ropes (MoorPy,
library/MoorProps_newCosts.yaml, 2024; OMAE2025-156384). Ropes of machines are sold elsewhere and in
other lengths, hence the wide interval, which is ours.
"""

from __future__ import annotations

import math
import re
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Literal

import numpy as np

from designer import checked
from designer.effects.design import AsBuilt
from designer.grades.grade import Grade, Size
from designer.model.cable import Cable, RopePrice, SizeUnits
from designer.model.load_case import STATIC
from designer.model.verdict import Requirement
from designer.selection.cases import CaseResult, governing
from designer.selection.reeving import Allowance
from designer.selection.verify import NOT_TRIED, Sampled, Verification
from designer.study import Objective, Selection

Standing = Literal[
    "chosen", "undominated", "dominated", "not_comparable", "rejected", "too_thin", "not_held"
]
"""What became of a candidate; those of the first two span the Pareto set."""
_INCHES = ("in", "inch", "ft", "foot", "feet")
_IN_INCHES = re.compile(r"\d\s*(in\.?|inch|inches|[\"″])$")


@dataclass(frozen=True, slots=True)
class Meaning:
    """An objective: the field of `CandidateFigures`, its name at length and in a word, its unit."""

    field: str
    title: str
    word: str
    unit: str
    more_is_better: bool = False


MEANINGS: Mapping[Objective, Meaning] = {
    "mass": Meaning("mass_kg", "mass of all cables", "mass", "kg"),
    "cost": Meaning("cost", "price of all cables", "price", ""),
    "drum_diameter": Meaning("drum_diameter_m", "drum diameter", "drum diameter", "m"),
    "max_tension": Meaning("max_tension_N", "largest tension", "tension", "N"),
    "stiffness": Meaning("stiffness_N_per_m", "smallest stiffness", "stiffness", "N/m", True),
}


@dataclass(frozen=True, slots=True)
class CandidateFigures:
    """What a candidate is compared by; NaN where it is not known."""

    mass_kg: float = math.nan  #: of all cables, each at the longest length that it needs [kg]
    cost: float = math.nan  #: price of these lengths, in the currency of the comparison
    drum_diameter_m: float = math.nan  #: drum or sheave that the grade's D/d asks for [m]
    max_tension_N: float = math.nan  #: largest tension, which the winch has to bear [N]
    stiffness_N_per_m: float = math.nan  #: smallest force over displacement of the platform [N/m]

    def value(self, objective: Objective) -> float:
        """Return the figure of an objective, in the sense in which it is shown."""
        return float(getattr(self, MEANINGS[objective].field))

    def burden(self, objective: Objective) -> float:
        """Return the figure such that less is better; one that is not known is the worst."""
        value = self.value(objective)
        if np.isnan(value):
            return np.inf
        return -value if MEANINGS[objective].more_is_better else value


UNKNOWN = CandidateFigures()
"""Of a candidate that was not solved yet."""


@dataclass(slots=True, eq=False, repr=False)
class Candidate(checked.Shown):
    """One size of one grade as it would be on the machine; what is known of it grows.

    First its figures alone, then what it meets over the samples, then between them; last whether
    it is chosen, and why.
    """

    grade: Grade
    size: Size
    cable: Cable  #: as the solver takes it, efficiency and safety factor applied
    efficiency: float = 1.0  #: share of the breaking load that fittings, bending and sheaves leave
    verification: Verification = NOT_TRIED  #: what it meets in the load case that governs
    cases: tuple[CaseResult, ...] = ()
    """What it meets in each direction of each load case, of each case in the worst one where its
    standing is known; up to the first that it does not hold."""
    figures: CandidateFigures = UNKNOWN  #: what it is compared by
    rejected_by: Requirement | None = None  #: beside strength, that it is known to fail
    standing: Standing | Literal[""] = ""  #: what became of it; empty where it was not compared
    reason: str = ""  #: why, for the reader: decided once, read by all pages and files
    dominated_by: Candidate | None = None  #: as good in everything compared, better in something
    preferred_to: Candidate | None = None
    """The best one, where this one is as good and is chosen for the units of its size."""
    requirements: tuple[Requirement, ...] = ()
    """All that the study asks of it; empty where that was not evaluated in full."""

    @property
    def name(self) -> str:
        """Grade and size."""
        return f"{self.grade.id}, {self.size.id}"

    @property
    def ids(self) -> dict[str, str]:
        """Grade and size as files of results name them."""
        return {"grade": self.grade.id, "size_id": self.size.id}

    @property
    def label(self) -> str:
        """Size and grade in one line."""
        return f"{self.size.id} of {self.grade.id}"

    @property
    def units(self) -> SizeUnits:
        """What its size is named in; else what the table of its grade gives diameters in."""
        table = self.grade.units
        in_inches = table is not None and table.diameter in _INCHES
        return "imperial" if in_inches or _IN_INCHES.search(self.size.id) else "metric"

    @property
    def largest_strain(self) -> float:
        """Strain at the allowable tension; the cable never stretches more."""
        return self.cable.allowable_tension_N / self.cable.axial_stiffness_N

    @property
    def verified(self) -> bool:
        """Whether it holds everywhere, between the samples as well, with its own figures."""
        return self.verification.holds and self.verification.is_refined

    @property
    def governing(self) -> CaseResult:
        """The load case that asks for most."""
        return governing(self.cases)

    @property
    def sampled(self) -> Sampled:
        """What it meets over the samples in the load case that governs."""
        return self.governing.sampled

    @property
    def in_case(self) -> str:
        """That case, as it ends a sentence; empty where the study has none."""
        case = self.governing.case
        return "" if case is STATIC else f" in the load case '{case.name}'"

    @property
    def total_mass_kg(self) -> float:
        """Mass of all cables at the longest length each needs [kg]."""
        return self.figures.mass_kg

    def key(self, objectives: Sequence[Objective]) -> tuple[float, ...]:
        """Sort by the objective that decides; then by the others, in their order."""
        return (*(self.figures.burden(o) for o in objectives), self.figures.mass_kg)


def candidates_of(selection: Selection, grades: Sequence[Grade], built: AsBuilt) -> list[Candidate]:
    """Return every size of these grades that study and sheave allow, with its figures as built."""
    allowance = Allowance.of(selection, built.robot.winches)
    sizes = (
        (grade, size, allowance.efficiency(grade, size.diameter_m))
        for grade in grades
        for size in grade.sizes
        if grade.why_excluded(selection, size) is None
    )
    return [
        Candidate(grade, size, built.of_products.cable(allowance.cable(grade, size)), efficiency)
        for grade, size, efficiency in sizes
        if not math.isnan(efficiency)
    ]


def common_currency(grades: Sequence[Grade]) -> str | None:
    """Return the currency in which most sizes are priced; None where none is."""
    return _commonest(g.currency for g in grades for s in g.sizes if s.price_per_m is not None)


def _commonest(currencies: Iterable[str | None]) -> str | None:
    """Return the currency named most often, of several the first by its letters."""
    counts = Counter(sorted(filter(None, currencies)))
    return max(counts, key=lambda currency: counts[currency], default=None)


def cost(candidate: Candidate, length_m: float, currency: str | None) -> float:
    """Return the price of this length; NaN without one in the currency of the comparison."""
    if candidate.size.price_per_m is None or candidate.grade.currency != currency:
        return math.nan
    return candidate.size.price_per_m * length_m


def priced(candidates: Sequence[Candidate]) -> tuple[Candidate, ...]:
    """Return the candidates with a price, in the currency that most of them have."""
    sold = [c for c in candidates if c.size.price_per_m is not None and c.grade.currency]
    commonest = _commonest(candidate.grade.currency for candidate in sold)
    return tuple(candidate for candidate in sold if candidate.grade.currency == commonest)


def undominated(
    candidates: Sequence[Candidate], *, by_price: bool = False, at_any_tension: bool = False
) -> tuple[Candidate, ...]:
    """Return the candidates that no other one beats, the lightest first.

    One beats another if it is not heavier, not stiffer, not weaker, and, where the price decides,
    not dearer. Weight and stiffness are what a cable loads the others with; so what holds with the
    beaten rope holds with the better one, as a rule. Of equal ropes the first one stays.

    Stiffness is that of the cable as it is, see `designer.selection.cases`; with
    ``at_any_tension`` a rope beats another only where it is not stiffer whatever either meets.
    """
    figures = np.array(
        [
            (
                candidate.cable.mean_density_kg_per_m,
                -candidate.cable.allowable_tension_N,
                candidate.cable.axial_stiffness_N,
                (candidate.size.price_per_m or 0.0) if by_price else 0.0,
            )
            for candidate in candidates
        ]
    ).reshape(-1, 4)
    softest, stiffest = figures.copy(), figures.copy()
    for k, candidate in enumerate(candidates):
        if at_any_tension and (law := candidate.cable.stiffening) is not None:
            softest[k, 2], stiffest[k, 2] = min(law.axial_stiffness_N), max(law.axial_stiffness_N)

    def is_beaten(k: int) -> bool:
        beats = (stiffest <= softest[k]).all(axis=1)
        is_better = (stiffest < softest[k]).any(axis=1)
        return bool((beats & (is_better | (np.arange(len(figures)) < k))).any())

    unbeaten = [k for k in range(len(figures)) if not is_beaten(k)]
    return tuple(candidates[k] for k in sorted(unbeaten, key=lambda k: tuple(figures[k])))


# Prices


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
def _listed(grade: Grade, currency: str, offers: tuple[RopePrice, ...]) -> Grade:
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
