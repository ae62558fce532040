r"""What share of a rope's breaking load a design may use: end fittings, bending, safety factor.

Noble Denton, 0027/ND "Guidelines for Marine Lifting & Lowering Operations", rev. 11 (2016), 7.6 to
7.8, which takes the bending of wire rope from IMCA M 179: over a body of diameter D, a wire rope of
diameter d breaks at

.. math::

    E_B = 1 - \frac{1}{2 \sqrt{D/d}}, \qquad D \ge d

times its breaking load. Bending and the end fitting weaken different places, so the smaller of
the two efficiencies counts and not their product. A fibre rope loses nothing by bending as long
as D is not below what its maker asks for; below that, nothing is known. One whose maker gives no
least diameter is taken for a wire rope here, which is on the safe side.

Typical efficiencies of end fittings: poured socket 1.0, steel ferrule 0.89, hand splice 0.8
(0027/ND, 7.7.1, as factors 1.00, 1.12 and 1.25); swaged socket 0.95, clips 0.8, wedge socket 0.75
to 0.95 (US Army TM 5-3810-305-10, table 4).

Between exit point and drum a rope that is hauled in bears the tension at the exit point over the
efficiency of the sheaves, where it is bent and has no fitting: there :math:`E_B` counts times that
efficiency. Of a cable that rises from its exit point the tension at the platform is larger than at
the exit point, and this on the safe side.

The allowable tension is the minimum breaking load times that efficiency over the safety factor.
The rule is for a rope at rest; fatigue of a rope that runs over sheaves is another matter.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from designer.grades.grade import Grade, Size
from designer.model.cable import Cable, Material
from designer.model.winches import Winches
from designer.study import Selection


@dataclass(frozen=True, slots=True)
class Allowance:
    """How much of a breaking load may be used."""

    safety_factor: float  # On what is left of the breaking load
    termination_efficiency: float = 1.0  # Share of the breaking load that the end fitting keeps
    # Diameter that the rope is bent over [m]; None leaves bending out
    sheave_diameter_m: float | None = None
    # Tension at the exit point over that at the drum, of a rope that is hauled in
    reeving_efficiency: float = 1.0

    @classmethod
    def of(cls, selection: Selection, winches: Winches) -> Allowance:
        """Return what a study asks for."""
        return cls(
            selection.safety_factor,
            selection.termination_efficiency,
            selection.sheave_diameter_m,
            winches.reeving_efficiency,
        )

    def bending_efficiency(self, grade: Grade, diameter_m: float) -> float:
        """Return the share of the breaking load that bending leaves; NaN outside the rule."""
        if self.sheave_diameter_m is None:
            return 1.0
        ratio = self.sheave_diameter_m / diameter_m
        least = _least_of_fibre(grade)
        if least is not None:
            return 1.0 if ratio >= least else math.nan
        return bending_efficiency(ratio)

    def efficiency(self, grade: Grade, diameter_m: float) -> float:
        """Return the share of the breaking load that counts; NaN outside the rule."""
        bending = self.bending_efficiency(grade, diameter_m) * self.reeving_efficiency
        return math.nan if math.isnan(bending) else min(bending, self.termination_efficiency)

    def cable(self, grade: Grade, size: Size) -> Cable:
        """Return a size with its allowable tension [N]."""
        return grade.cable(size, self._factor(grade, size.diameter_m))

    def family(self, grade: Grade, diameter_m: float) -> Material:
        """Return the continuous family of a grade, as strong as its member of this diameter."""
        return grade.family(self._factor(grade, diameter_m))

    def _factor(self, grade: Grade, diameter_m: float) -> float:
        """Return minimum breaking load over allowable tension."""
        return self.safety_factor / self.efficiency(grade, diameter_m)


def _least_of_fibre(grade: Grade) -> float | None:
    """Return the least D/d of a fibre rope by its maker; None for wire, or where none is given."""
    is_fibre = grade.material not in ("steel", "stainless steel", None)
    return grade.sheave_ratio.minimum if grade.sheave_ratio and is_fibre else None


def why_not_bent(grade: Grade) -> str:
    """Return why the rule has no efficiency for a size of a grade."""
    least = _least_of_fibre(grade)
    if least is None:
        return "the sheave is thinner than the rope"
    return f"the sheave is thinner than {least:g} times the rope, the least of its grade"


def bending_efficiency(sheave_ratio: float) -> float:
    """Return E_B of a wire rope over a body D/d times as thick; NaN below 1."""
    return 1.0 - 0.5 / math.sqrt(sheave_ratio) if sheave_ratio >= 1.0 else math.nan
