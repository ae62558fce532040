"""What may go onto the cables: a size of a grade as it would be there, and what is known of it."""

from __future__ import annotations

import math
import re
from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from designer import checked
from designer.effects.design import AsBuilt
from designer.grades.grade import Grade, Size
from designer.model.cable import Cable, SizeUnits
from designer.model.load_case import STATIC
from designer.model.verdict import Requirement
from designer.selection.cases import CaseResult, governing
from designer.selection.efficiency import Allowance
from designer.selection.objectives import UNKNOWN, CandidateFigures
from designer.selection.verify import NOT_TRIED, Sampled, Verification
from designer.study import Objective, Selection

Standing = Literal[
    "chosen", "undominated", "dominated", "not_comparable", "rejected", "too_thin", "not_held"
]
"""What became of a candidate; those of the first two span the Pareto set."""
_INCHES = ("in", "inch", "ft", "foot", "feet")
_IN_INCHES = re.compile(r"\d\s*(in\.?|inch|inches|[\"″])$")


@dataclass(slots=True, eq=False, repr=False)
class Candidate(checked.Shown):
    """One size of one grade as it would be on the machine; what is known of it grows.

    First its figures alone, then what it meets over the samples, then between them; last whether
    it is chosen, and why.

    Parameters
    ----------
    grade, size
        The product.
    cable : Cable
        Its figures as the solver takes them, efficiency and safety factor applied.
    efficiency : float
        Share of the breaking load that end fittings, bending and sheaves leave.
    verification : Verification
        What it meets in the load case that governs.
    cases : tuple of CaseResult
        What it meets in each direction of each load case, of each case in the worst one where its
        standing is known; up to the first that it does not hold.
    figures : CandidateFigures
        What it is compared by.
    rejected_by : Requirement or None
        A requirement beside strength that it is known to fail.
    standing : str
        What became of it; empty where it was not compared.
    reason : str
        Why, for the reader of a report: decided once, read by all pages and files.
    dominated_by : Candidate or None
        A candidate that is as good in everything it is compared by and better in something.
    preferred_to : Candidate or None
        The best one, where this one is as good and is chosen for the units of its size.
    requirements : tuple of Requirement
        All that the study asks of it; empty where that was not evaluated in full.
    """

    grade: Grade
    size: Size
    cable: Cable
    efficiency: float = 1.0
    verification: Verification = NOT_TRIED
    cases: tuple[CaseResult, ...] = ()
    figures: CandidateFigures = UNKNOWN
    rejected_by: Requirement | None = None
    standing: Standing | Literal[""] = ""
    reason: str = ""
    dominated_by: Candidate | None = None
    preferred_to: Candidate | None = None
    requirements: tuple[Requirement, ...] = ()

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
    figures = np.array([_burdens(c.cable, c.size, by_price) for c in candidates]).reshape(-1, 4)
    softest, stiffest = figures.copy(), figures.copy()
    if at_any_tension:
        ranges = [_stiffness_range_N(candidate.cable) for candidate in candidates]
        softest[:, 2], stiffest[:, 2] = np.array(ranges).reshape(-1, 2).T

    def is_beaten(k: int) -> bool:
        beats = (stiffest <= softest[k]).all(axis=1)
        is_better = (stiffest < softest[k]).any(axis=1)
        return bool((beats & (is_better | (np.arange(len(figures)) < k))).any())

    unbeaten = [k for k in range(len(figures)) if not is_beaten(k)]
    return tuple(candidates[k] for k in sorted(unbeaten, key=lambda k: tuple(figures[k])))


def _burdens(cable: Cable, size: Size, by_price: bool) -> tuple[float, float, float, float]:
    """Return what a rope is to have little of."""
    price = (size.price_per_m or 0.0) if by_price else 0.0
    weight, strength = cable.mean_density_kg_per_m, cable.allowable_tension_N
    return weight, -strength, cable.axial_stiffness_N, price


def _stiffness_range_N(cable: Cable) -> tuple[float, float]:
    """Return the least and the largest EA that a rope can have [N]."""
    law = cable.stiffening
    stiffnesses = (cable.axial_stiffness_N,) if law is None else law.axial_stiffness_N
    return min(stiffnesses), max(stiffnesses)
