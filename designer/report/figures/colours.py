"""What a map is coloured by: a quantity of the field, and the round steps of its colour scale."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import NDArray

from designer.analysis.maps import Focus, RegionField
from designer.arrays import FloatArray, IntArray
from designer.report.figures import canvas, palette

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.colors import BoundaryNorm, Colormap

_MUCH = 6.0
_KILONEWTON = 1e3


@dataclass(frozen=True, slots=True)
class MapQuantity:
    """One of the quantities that can be mapped.

    ``key`` is used in the ids of a drawing; ``scale`` leads from SI to the unit on the axis, which
    is empty for a pure number.
    """

    key: str
    title: str
    unit: str
    scale: float

    @property
    def label(self) -> str:
        """Text of an axis or a colour bar."""
        return f"{self.title} [{self.unit}]" if self.unit else self.title

    def of(self, field: RegionField) -> FloatArray:
        """Return the values in the unit of the axis; NaN where the pose does not count."""
        return np.where(field.counts, self.everywhere(field), np.nan)

    def everywhere(self, field: RegionField) -> FloatArray:
        """Return the values where the study leaves the pose out as well."""
        values = {
            "diameter": field.diameter_m,
            "tension": field.tension_N,
            "ratio": field.tension_N / field.massless_tension_N,
            "utilisation": field.utilisation,
        }[self.key]
        assert values is not None
        return np.asarray(values * self.scale)

    def text_of(self, focus: Focus) -> str:
        """Return what the pose is that figures turn to, and its value where it has one."""
        value = float(self.of(focus.field))
        if not np.isfinite(value):
            return focus.label
        digits = 4 if self.unit in ("N", "kN") else 3
        return f"{focus.label}, {canvas.significant(value, digits)} {self.unit}".strip()


DIAMETER = MapQuantity("diameter", "needed diameter", "mm", 1e3)
TENSION = MapQuantity("tension", "largest tension", "kN", 1e-3)
UTILISATION = MapQuantity("utilisation", "utilisation", "%", 100.0)
RATIO = MapQuantity("ratio", "tension, with over without sag", "", 1.0)


def tension_of(field: RegionField) -> MapQuantity:
    """Return the largest tension in the unit that suits the values of a field, kN or N."""
    if np.nanmax(field.tension_N, initial=0.0) < _KILONEWTON and np.isfinite(field.tension_N).any():
        return replace(TENSION, unit="N", scale=1.0)
    return TENSION


@dataclass(frozen=True, slots=True, eq=False)
class Steps:
    """Round boundaries (n,) of the steps of a colour scale, ascending.

    ``extend`` is ``max`` if there are values above the last boundary; ``table`` names the colours.
    """

    levels: FloatArray
    extend: Literal["max", "neither"]
    table: str = palette.COLORMAP

    @property
    def edges(self) -> FloatArray:
        """Boundaries of all steps; one above the scale is as wide as its neighbours."""
        if self.extend == "neither":
            return self.levels
        return np.append(self.levels, 2.0 * self.levels[-1] - self.levels[-2])

    @property
    def colormap(self) -> Colormap:
        """One colour a step."""
        import matplotlib

        steps = len(self.levels) - (1 if self.extend == "neither" else 0)
        return matplotlib.colormaps[self.table].resampled(max(steps, 2))

    @property
    def norm(self) -> BoundaryNorm:
        """From values to steps."""
        from matplotlib.colors import BoundaryNorm

        return BoundaryNorm(self.levels, self.colormap.N, extend=self.extend)

    def fill(self, axes: Axes, x: FloatArray, y: FloatArray, values: FloatArray) -> None:
        """Colour a grid (rows, columns) of values."""
        scale: dict[str, Any] = {"cmap": self.colormap, "norm": self.norm, "extend": self.extend}
        surface = axes.contourf(x, y, values, levels=self.levels, **scale)
        surface.set_edgecolor("face")  # closes the hairlines between neighbouring steps
        surface.set_linewidth(0.3)

    @property
    def ticks(self) -> FloatArray:
        """Boundaries to label: all, or the rounder half where there are many."""
        if len(self.levels) <= 9:
            return self.levels
        number = np.round(self.levels / (self.levels[1] - self.levels[0])).astype(int)
        return np.asarray(self.levels[number % 2 == 0])

    def colours_of(self, step: IntArray) -> NDArray[np.uint8]:
        """Return red, green and blue (n, 3) of steps (n,), counted from 0."""
        return np.round(255.0 * self.colormap(step)[:, :3]).astype(np.uint8)

    def bar(self, axes: Axes, label: str, *, is_level: bool = False, **style: Any) -> None:
        """Draw the scale as a bar that fills axes, upright or level."""
        from matplotlib.cm import ScalarMappable

        is_even = np.allclose(np.diff(self.levels, 2), 0.0)
        layout = {
            "orientation": "horizontal" if is_level else "vertical",
            "spacing": "proportional" if is_even else "uniform",  # the same then, and cheaper
            "ticks": self.ticks,
            "extendfrac": 0.04,
            "label": label,
        }
        mappable = ScalarMappable(self.norm, self.colormap)
        bar = axes.figure.colorbar(mappable, cax=axes, **layout | style)
        bar.minorticks_off()
        bar.outline.set_linewidth(0.4)
        axes.tick_params(length=2)


def steps_over_decades(values: FloatArray) -> Steps | None:
    """Return steps 1, 2, 5, 10, … where the bulk of the values spans much, else `steps_for`."""
    finite = values[np.isfinite(values)]
    if len(finite) == 0 or finite.min() <= 0.0:
        return steps_for(values)
    low, high = np.quantile(finite, [0.05, 0.95])
    if high < _MUCH * low:
        return steps_for(values)
    decades = np.arange(np.floor(np.log10(finite.min())), np.ceil(np.log10(high)) + 1.0)
    marks = np.sort(np.outer(10.0**decades, [1.0, 2.0, 5.0]).ravel())
    lowest = np.searchsorted(marks, finite.min(), side="right") - 1
    last = np.searchsorted(marks, high, side="left")
    levels = marks[lowest : last + 1]
    return Steps(levels, "max" if finite.max() > levels[-1] else "neither")


def steps_for(values: FloatArray, most: int = 14) -> Steps | None:
    """Return round steps over the values; None if no value is finite.

    Near a pose that no cable can hold the values grow without bound. They would squeeze all
    others into one colour, so the scale ends where nearly all of them lie, and says that it does.
    """
    from matplotlib.ticker import MaxNLocator

    finite = values[np.isfinite(values)]
    if len(finite) == 0:
        return None
    low, high = float(finite.min()), float(finite.max())
    tenth, ninetieth = np.quantile(finite, [0.1, 0.9])
    cap = float(ninetieth + 1.5 * (ninetieth - tenth))
    capped = cap < high and ninetieth > tenth
    top = cap if capped else high
    if top - low < 1e-3 * abs(top):
        low, top = 0.9 * low, 1.1 * top
    locator = MaxNLocator(nbins=most, steps=[1, 2, 2.5, 5, 10])
    levels = np.asarray(locator.tick_values(low, top), dtype=np.float64)
    return Steps(levels, "max" if high > levels[-1] * (1.0 + 1e-9) else "neither")
