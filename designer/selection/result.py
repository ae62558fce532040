"""What the choice of a product came to: why each size is in or out, what the sizes serve."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import ClassVar, Literal

import numpy as np

from designer import checked
from designer.arrays import BoolArray, FloatArray
from designer.grades.grade import Grade, Size
from designer.model.cable import Cable, Material, Preference, PriceList
from designer.model.load_case import STATIC
from designer.model.robot import Poses, Robot
from designer.model.verdict import Verdict
from designer.model.workspace import Workspace
from designer.proof.prove import Proof
from designer.selection.candidate import Candidate, PriceEstimate, Standing
from designer.selection.compare import AS_GOOD, changed_figures, preference_words, rejection_words
from designer.statics.inverse import solve_sagging
from designer.statics.sizes import has_fast_solver
from designer.study import Objective
from designer.workspace.demand import is_counted
from designer.workspace.effort import SLOW_COVERAGE, slow_positions

Outcome = Literal["fits", "rejected", "too_thin", "no_finite_cable", "open"]
"""``rejected``: sizes are strong enough, but fail another requirement; ``too_thin``: no size holds;
``no_finite_cable``: proved; ``open``: a pose was neither solved nor proved to be impossible."""
WHY: Mapping[Standing, str] = {
    "undominated": "holds and is Pareto-optimal, but not the best in the first objective",
    "dominated": "holds, but another one is as good in every objective and better in one",
    "rejected": "is strong enough, but rejected by the requirement: {}",
    "not_comparable": "holds, but its figure of the first objective is not known",
    "too_thin": "exceeds its allowable tension",
    "not_held": "no equilibrium was found somewhere",
}
"""Why sizes of a standing were not chosen; ``{}`` stands for the title of a requirement."""
_BY_ID = {"json": lambda grade: {"grade": grade.id}}


@dataclass(frozen=True, slots=True, eq=False)
class NotTried:
    """A grade, or one size of it, that was not solved, and why; ``size`` is None for the grade."""

    grade: Grade = field(metadata=_BY_ID)
    size: Size | None = field(metadata={"json": lambda size: {"size_id": size and size.id}})
    reason: str

    @property
    def sizes(self) -> tuple[Size, ...]:
        """The size, or all of the grade."""
        return self.grade.sizes if self.size is None else (self.size,)


@dataclass(frozen=True, slots=True, eq=False)
class Exclusion:
    """Sizes that were not chosen for the same reason."""

    standing: Standing | Literal["not_tried"]  #: ``not_tried`` where they were not solved
    why: str  #: in words for all of them
    sizes: int  #: how many
    grades: int  #: of how many grades
    example: str  #: the one nearest to its limit, and its own reason


@dataclass(frozen=True, slots=True, eq=False)
class GradeOutcome:
    """What became of a grade."""

    grade: Grade = field(metadata=_BY_ID)
    family: Material = field(metadata={"json": None})
    """Its continuous family, efficiency and safety factor applied."""
    continuous_diameter_m: float
    """The thinnest member of the family that holds everywhere [m]; NaN where none does."""
    candidates: tuple[Candidate, ...] = field(metadata={"json": None})  #: its sizes, ascending
    outcome: Outcome
    best: Candidate | None = field(
        metadata={"json": lambda best: {"best_size_id": best and best.size.id}}
    )
    """By the objective that decides, of the sizes that meet all requirements; where no size of any
    grade does, of those that are strong enough."""
    verdict: Verdict | None = field(default=None, metadata={"json": None})
    """Of the pose that no member of the family holds; None where there is none."""

    also_in_files: ClassVar = ("sentence",)

    @property
    def fails_in(self) -> str:
        """The load case in which the size that comes furthest fails; empty without load cases."""
        if not self.candidates:
            return ""
        best = max(self.candidates, key=lambda c: (len(c.cases), -c.verification.utilisation))
        return "" if best.governing.case is STATIC else best.governing.case.name

    @property
    def sentence(self) -> str:
        """Why the grade is in or out, for the reader of a report."""
        need = f"{1e3 * self.continuous_diameter_m:.1f} mm needed"
        if self.best is not None and self.outcome == "fits":
            return f"{self.best.size.id} holds everywhere, {need}"
        if self.outcome == "rejected":
            nearest = self.nearest_rejected
            if nearest.rejected_by is None:
                return f"holds, but is not compared: {nearest.reason}"
            words = rejection_words(nearest)
            return f"has no size that meets every requirement: {nearest.size.id}, {words}"
        if self.outcome == "no_finite_cable" and self.verdict is Verdict.NO_FINITE_CABLE:
            return (
                "no section of this rope, however thick, holds a pose within its allowable stress"
            )
        if self.outcome in ("no_finite_cable", "open"):
            return "no pose counts" if self.verdict is None else f"in a pose {self.verdict.clause}"
        return self._too_thin(need)

    @property
    def brief(self) -> str:
        """The same in two or three words, where the grade does not fit."""
        if self.outcome == "rejected":
            failed = self.nearest_rejected.rejected_by
            return "not compared" if failed is None else f"{failed.title.lower()} not met"
        if self.outcome == "too_thin":
            thickest = self.grade.thickest
            is_thin = not self.fails_in and self.continuous_diameter_m > thickest.diameter_m
            return f"{thickest.id} insufficient" if is_thin else "no size holds"
        if self.verdict is None:
            return "no pose counts"
        is_heavy = self.verdict is Verdict.NO_FINITE_CABLE
        return "no section holds" if is_heavy else self.verdict.reason

    @property
    def nearest_rejected(self) -> Candidate:
        """Of the sizes that are strong enough, the one nearest to meeting all requirements."""
        holding = [c for c in self.candidates if c.verification.holds]
        return min(reversed(holding), key=_excess)  # the thickest, where nothing tells them apart

    def _too_thin(self, need: str) -> str:
        if self.fails_in:
            return f"has no size that holds in the load case '{self.fails_in}'"
        sold = [c.size for c in self.candidates] or [self.grade.thickest]
        if self.continuous_diameter_m < sold[0].diameter_m:
            return f"is too heavy even in its smallest size sold, {sold[0].id}, {need}"
        if self.continuous_diameter_m <= sold[-1].diameter_m:
            return f"has no size that holds, {need} by the law fitted to its sizes"
        return f"is insufficient in its largest size sold, {self.grade.thickest.id}, {need}"


def _excess(candidate: Candidate) -> float:
    """Return the utilisation of what a candidate is rejected by; the worst where that is none."""
    failed = candidate.rejected_by
    return math.inf if failed is None or math.isnan(failed.utilisation) else failed.utilisation


@dataclass(frozen=True, slots=True, eq=False)
class CoveredSize:
    """What one size serves."""

    size: Size = field(metadata={"json": lambda s: {"size_id": s.id, "diameter_m": s.diameter_m}})
    cable: Cable = field(metadata={"json": None})  #: as the solver takes it
    fraction: float  #: share of the samples at which it stays within its allowable tension
    volume_m3: float | None  #: that share of the region [m³]; None for a list of points
    lost_fraction: float = 0.0
    """Share of the samples that a thinner size of the grade serves and this one does not: it may be
    weaker, or too heavy for what it bears."""


@dataclass(frozen=True, slots=True, eq=False)
class SizeCoverage:
    """What the sizes of a grade serve, thinnest first; by so many sample positions."""

    grade: Grade
    sizes: tuple[CoveredSize, ...]
    samples: int

    @property
    def differs(self) -> bool:
        """Whether some sizes serve more than others."""
        return len({size.fraction for size in self.sizes}) > 1

    @property
    def is_nested(self) -> bool:
        """Whether each size serves all that thinner ones serve."""
        return all(size.lost_fraction == 0.0 for size in self.sizes)

    @property
    def first_for_good(self) -> int | None:
        """Index of the size from which on all serve everything; None where the last does not."""
        partly = [k for k, size in enumerate(self.sizes) if size.fraction < 1.0]
        index = partly[-1] + 1 if partly else 0
        return index if index < len(self.sizes) else None


def serves(robot: Robot, workspace: Workspace, cable: Cable, places: FloatArray) -> BoolArray:
    """Tell which places (n, n_coordinates) count and keep a cable within its allowable tension."""
    statics = solve_sagging(robot, Poses.at(places), cable)
    counts = is_counted(statics, workspace.hangs_below)
    with np.errstate(invalid="ignore"):
        return np.asarray(counts & (statics.largest_tension_N <= cable.allowable_tension_N))


def usable(
    robot: Robot, workspace: Workspace, grade: Grade, cables: Sequence[tuple[Size, Cable]]
) -> SizeCoverage:
    """Find at how many samples each size of a grade, thinnest first, serves with its own figures.

    A position is served where the size holds it in every orientation that the study asks for. One
    that the study leaves out because a cable hangs below the platform is not served. On robots that
    are slow to solve only a part of the samples is asked, fairly drawn.
    """
    samples = 0
    served, lost = np.zeros((2, len(cables)))
    if has_fast_solver(robot):
        batches = workspace.places()
    else:
        count = slow_positions(workspace, SLOW_COVERAGE)
        batches = iter([workspace.thinned(count * workspace.orientations.count)])
    for batch in batches:
        is_served = np.stack([serves(robot, workspace, cable, batch) for _, cable in cables])
        at = is_served.reshape(len(cables), -1, workspace.orientations.count).all(axis=2)
        samples += at.shape[1]
        served += at.sum(axis=1)
        lost += (np.logical_or.accumulate(at, axis=0) & ~at).sum(axis=1)
    volume_m3 = workspace.region.volume_m3
    return SizeCoverage(
        grade,
        tuple(
            CoveredSize(size, cable, share, None if volume_m3 is None else share * volume_m3, gone)
            for (size, cable), share, gone in zip(
                cables, (served / samples).tolist(), (lost / samples).tolist(), strict=True
            )
        ),
        samples,
    )


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class SelectionResult(checked.Shown):
    """The choice, and why."""

    outcomes: tuple[GradeOutcome, ...]  #: of every grade that the study allows
    chosen: Candidate | None  #: best by the objective that decides, of those that hold everywhere
    reason: str | None  #: why none was chosen
    alternatives: tuple[GradeOutcome, ...] = ()
    """Where none was chosen: grades outside the study's list that would hold."""
    objectives: tuple[Objective, ...] = ("mass",)  #: the one that decides first
    prefer: Preference = "none"
    """Units of the sizes that take the place of others as good as they are."""
    currency: str | None = None  #: of the costs; None where nothing has a price
    price_estimate: PriceEstimate | None = None  #: what the prices are, where they are borrowed
    price_list: PriceList | None = None  #: the study's own, which come before those of grades
    not_tried: tuple[NotTried, ...] = ()  #: what was not solved, and why
    usable: SizeCoverage | None = None
    """What the sizes of the chosen grade serve; where none was chosen, of the grade that serves
    most. None where nothing was tried."""
    proof: Proof | None = None
    """Of the chosen product, in the load case that governs; None where nothing was to be proved."""
    untrusted: Candidate | None = None
    """The best of what is excluded for the trust of its figures alone, where it would hold and be
    better than the chosen product."""

    @property
    def candidates(self) -> tuple[Candidate, ...]:
        """All sizes that were solved."""
        return tuple(c for outcome in self.outcomes for c in outcome.candidates)

    @property
    def preference(self) -> str:
        """What the preference of units came to; empty where the best has them, or none is set."""
        chosen = self.chosen
        if chosen is None or chosen.preferred_to is not None:
            return "" if chosen is None else preference_words(chosen, self.objectives)
        fitting = [o.best for o in self.outcomes if o.best is not None and o.outcome == "fits"]
        others = [best for best in fitting if best.units == self.prefer != chosen.units]
        if not others:
            return ""
        best = min(others, key=lambda candidate: candidate.key(self.objectives))
        changes = changed_figures(best, chosen, self.objectives)
        as_good = f"no {self.prefer} size is as good within {AS_GOOD:.0%}".replace("%", " %")
        return f"{as_good}; the best is {best.label}: {changes}"

    @property
    def exclusions(self) -> tuple[Exclusion, ...]:
        """Why sizes were not chosen: each but the chosen one counts in one row."""
        groups: dict[tuple[Standing | Literal["not_tried"], str], list[tuple[Grade, str]]] = {}
        for standing, why in WHY.items():
            same = [c for c in self.candidates if c.standing == standing]
            is_rejected = standing == "rejected"
            same.sort(key=_excess if is_rejected else lambda c: c.verification.utilisation)
            for c in same:
                title = c.rejected_by.title.lower() if c.rejected_by and is_rejected else ""
                group = groups.setdefault((standing, why.format(title)), [])
                group.append((c.grade, f"{c.name}: {c.reason}"))
        for left in self.not_tried:
            group = groups.setdefault(("not_tried", f"not solved: {left.reason}"), [])
            group += [(left.grade, f"{left.grade.id}, {size.id}") for size in left.sizes]
        return tuple(
            Exclusion(standing, why, len(group), len({grade.id for grade, _ in group}), group[0][1])
            for (standing, why), group in groups.items()
        )

    @property
    def front(self) -> tuple[Candidate, ...]:
        """The verified candidates that no other dominates, the chosen one first."""
        members = [c for c in self.candidates if c.standing in ("chosen", "undominated")]
        decides = self.objectives[0]
        rank = [(c.standing != "chosen", c.figures.burden(decides)) for c in members]
        return tuple(members[k] for k in sorted(range(len(members)), key=rank.__getitem__))

    def best_of_materials(self, own: str | None) -> list[Candidate]:
        """Return the best size that holds of each material: of a study's own one, then the best."""
        decides = self.objectives[0]
        best: dict[str | None, Candidate] = {}
        holding = [outcome.best for outcome in self.outcomes if outcome.best is not None]
        for candidate in sorted(holding, key=lambda c: c.figures.burden(decides)):
            best.setdefault(candidate.grade.material, candidate)
        return sorted(best.values(), key=lambda c: c.grade.material != own)

    def beside(self, candidate: Candidate) -> list[Candidate]:
        """Return a size with those beside it in its grade, if any, the thinnest first."""
        of_grade = next(o.candidates for o in self.outcomes if o.grade is candidate.grade)
        by_diameter = sorted(of_grade, key=lambda size_of_grade: size_of_grade.size.diameter_m)
        at = by_diameter.index(candidate)
        return by_diameter[max(at - 1, 0) : at + 2]
