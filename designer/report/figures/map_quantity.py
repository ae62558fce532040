"""What a map is coloured by: its name, its unit, and how it is taken from a field."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from designer.analysis.field import Field
from designer.analysis.maps import Focus
from designer.arrays import FloatArray
from designer.report import format as fmt

_KILONEWTON = 1e3


@dataclass(frozen=True, slots=True)
class MapQuantity:
    """One of the quantities that can be mapped.

    Parameters
    ----------
    key : str
        Short name, used in the ids of a drawing.
    title, unit : str
        Name and unit on the axis; no unit for a pure number.
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

    def text_of(self, focus: Focus) -> str:
        """Return what the pose is that figures turn to, and its value where it has one."""
        value = float(self.of(focus.field))
        if not np.isfinite(value):
            return focus.label
        digits = 4 if self.unit in ("N", "kN") else 3
        return f"{focus.label}, {fmt.number(value, digits)} {self.unit}".strip()


DIAMETER = MapQuantity("diameter", "needed diameter", "mm", 1e3)
TENSION = MapQuantity("tension", "largest tension", "kN", 1e-3)
RATIO = MapQuantity("ratio", "tension with sag over tension without", "", 1.0)


def tension_of(field: Field) -> MapQuantity:
    """Return the largest tension in the unit that suits the values of a field, kN or N."""
    if np.nanmax(field.tension_N, initial=0.0) < _KILONEWTON and np.isfinite(field.tension_N).any():
        return replace(TENSION, unit="N", scale=1.0)
    return TENSION
