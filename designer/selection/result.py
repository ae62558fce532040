"""What the choice of a product came to."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from designer.cable import Cable, Material
from designer.catalogue.grade import Grade, Size
from designer.selection.verify import Verification

Outcome = Literal["fits", "too_thin", "no_finite_cable"]


@dataclass(frozen=True, slots=True, eq=False)
class Candidate:
    """One size of one grade, verified over the whole workspace.

    Parameters
    ----------
    grade, size
        The product.
    cable : Cable
        Its figures as the solver takes them, safety factor applied.
    continuous_diameter_m : float
        Optimum in the grade's continuous family [m]; NaN where the family has none.
    verification : Verification
        What it meets.
    total_mass_kg : float
        Mass of all cables at the longest length each needs [kg].
    """

    grade: Grade
    size: Size
    cable: Cable
    continuous_diameter_m: float
    verification: Verification
    total_mass_kg: float

    @property
    def verified(self) -> bool:
        """Whether it holds everywhere with its own mass, stiffness and breaking load."""
        return self.verification.holds


@dataclass(frozen=True, slots=True, eq=False)
class GradeOutcome:
    """What became of a grade.

    Parameters
    ----------
    grade : Grade
        The grade.
    family : Material
        Its continuous family, safety factor applied.
    continuous_diameter_m : float
        The thinnest member of the family that holds everywhere [m]; NaN where none does.
    candidates : tuple of Candidate
        The sizes that were tried, ascending.
    outcome : str
        ``fits``, ``too_thin`` (the thickest size does not hold) or ``no_finite_cable``.
    """

    grade: Grade
    family: Material
    continuous_diameter_m: float
    candidates: tuple[Candidate, ...]
    outcome: Outcome

    @property
    def best(self) -> Candidate | None:
        """The thinnest size that holds everywhere."""
        return next((c for c in self.candidates if c.verified), None)

    @property
    def sentence(self) -> str:
        """Why the grade is in or out, for the reader of a report."""
        if self.outcome == "no_finite_cable":
            return "no section of this rope can hold the workspace: its own weight is too much"
        need = f"{1e3 * self.continuous_diameter_m:.1f} mm needed"
        if self.outcome == "too_thin":
            return f"ends at {self.grade.thickest.id}, {need}"
        assert self.best is not None
        return f"{self.best.size.id} holds everywhere, {need}"


@dataclass(frozen=True, slots=True, eq=False)
class SelectionResult:
    """The choice, and why.

    Parameters
    ----------
    outcomes : tuple of GradeOutcome
        Every grade that the study allows.
    chosen : Candidate or None
        The lightest product that holds everywhere.
    reason : str or None
        Why none was chosen.
    alternatives : tuple of GradeOutcome
        Where none was chosen: grades outside the study's list that would hold.
    """

    outcomes: tuple[GradeOutcome, ...]
    chosen: Candidate | None
    reason: str | None
    alternatives: tuple[GradeOutcome, ...] = ()

    @property
    def candidates(self) -> tuple[Candidate, ...]:
        """All sizes that were tried."""
        return tuple(c for outcome in self.outcomes for c in outcome.candidates)
