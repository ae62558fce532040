"""What a map shows: its name, its unit, and how it is taken from a field."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from designer.arrays import FloatArray
from designer.report.figures import canvas

if TYPE_CHECKING:
    from designer.analysis.field import Field


_KILONEWTON = 1e3


@dataclass(frozen=True, slots=True)
class Quantity:
    """One of the quantities that can be mapped.

    Parameters
    ----------
    key : str
        Short name, used in the ids of a drawing.
    title : str
        Name on the axis.
    unit : str
        Unit on the axis; empty for a pure number.
    scale : float
        From SI to that unit.
    """

    key: str
    title: str
    unit: str
    scale: float

    @property
    def label(self) -> str:
        """Text of an axis or a colour bar."""
        return f"{self.title} [{self.unit}]" if self.unit else self.title

    def of(self, field: Field) -> FloatArray:
        """Return the values in the unit of the axis; NaN where the pose does not count."""
        return np.where(field.counts, self.everywhere(field), np.nan)

    def everywhere(self, field: Field) -> FloatArray:
        """Return the values where the study leaves the pose out as well."""
        values = {
            "diameter": field.diameter_m,
            "tension": field.tension_N,
            "ratio": field.tension_N / field.massless_tension_N,
        }[self.key]
        return np.asarray(values * self.scale)

    def text(self, value: float) -> str:
        """Return a value with its unit, to a few digits."""
        digits = 4 if self.unit in ("N", "kN") else 3
        return f"{canvas.significant(value, digits)} {self.unit}".strip()


DIAMETER = Quantity("diameter", "needed diameter", "mm", 1e3)
TENSION = Quantity("tension", "largest tension", "kN", 1e-3)
RATIO = Quantity("ratio", "tension with sag over tension without", "", 1.0)


def tension_of(field: Field) -> Quantity:
    """Return the largest tension in the unit that suits the values of a field, kN or N."""
    finite = field.tension_N[np.isfinite(field.tension_N)]
    if len(finite) > 0 and float(finite.max()) < _KILONEWTON:
        return replace(TENSION, unit="N", scale=1.0)
    return TENSION
