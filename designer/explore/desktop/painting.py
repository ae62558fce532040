"""From an answer and a quantity to colours and their legend."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from designer.arrays import BoolArray, FloatArray, IntArray
from designer.explore.desktop import theme
from designer.explore.quantities import category_labels
from designer.explore.question import cables_words
from designer.model.verdict import Verdict
from designer.report.figures.colours import Steps, steps_for
from designer.report.figures.palette import DIFFERENCES

if TYPE_CHECKING:
    from designer.explore.map import MapAnswer
    from designer.explore.quantities import Quantity

CATEGORIES = (
    "#0072B2", "#E69F00", "#009E73", "#CC79A7", "#56B4E9", "#D55E00", "#F0E442", "#7F7F7F",
)  # fmt: skip
"""Told apart by every kind of colour vision; M. Okabe and K. Ito, Color Universal Design, 2008."""
_LUMINANCE = np.array([0.2126, 0.7152, 0.0722])
"""Of red, green and blue; ITU-R BT.709."""


@dataclass(frozen=True, slots=True)
class Key:
    """A colour and what it means; hatched where there is a second colour."""

    colour: str
    meaning: str
    stripes: str = ""


@dataclass(frozen=True, slots=True, eq=False)
class Values:
    """Of points (n,): the quantity in the unit of the legend, and which points are set apart."""

    scaled: FloatArray
    is_unserved: BoolArray
    is_left_out: BoolArray

    def at(self, points: IntArray) -> Values:
        """Return those of some points alone."""
        return Values(self.scaled[points], self.is_unserved[points], self.is_left_out[points])


@dataclass(frozen=True, slots=True, eq=False)
class Painting:
    """A quantity or its difference to A, and its scale: steps, or colours of categories.

    Grey where it ``is_old``: of an older state of the study.
    """

    quantity: Quantity
    steps: Steps | None
    is_difference: bool = False
    is_old: bool = False

    @classmethod
    def over(cls, answer: MapAnswer, quantity: Quantity, fixed: Steps | None = None) -> Painting:
        """Return what paints an answer; with the steps of another one, where they are held."""
        if answer.before is not None:
            return cls._of_difference(answer, quantity)
        plain = cls(quantity, None)
        if quantity.is_category:
            return plain
        values = plain.of(answer)
        counts = ~(values.is_unserved | values.is_left_out)
        return cls(quantity, fixed if fixed is not None else steps_for(values.scaled[counts]))

    @classmethod
    def _of_difference(cls, answer: MapAnswer, quantity: Quantity) -> Painting:
        plain = cls(quantity, None, is_difference=True)
        values = plain.of(answer).scaled
        steps = steps_for(np.abs(values))
        if steps is None or not np.nanmax(np.abs(values)) > 0.0:
            return cls(quantity, Steps(np.array([-1.0, 0.0, 1.0]), "neither", DIFFERENCES), True)
        largest = steps.levels[-1]
        width = steps.levels[1] - steps.levels[0]
        count = max(round(largest / width), 1)
        levels = np.linspace(-count * width, count * width, 2 * count + 1)
        return cls(quantity, Steps(levels, "neither", DIFFERENCES), is_difference=True)

    @property
    def is_category(self) -> bool:
        """Whether the values are whole numbers that stand for something."""
        return self.quantity.is_category and not self.is_difference

    @property
    def title(self) -> str:
        """The quantity with its unit."""
        unit = self.quantity.unit
        title = f"{self.quantity.title} [{unit}]" if unit else self.quantity.title
        return f"{title}, now less A" if self.is_difference else title

    def note(self, answer: MapAnswer) -> str:
        """Return which cables the values are of, and whether of an older state."""
        cables = cables_words(None if self.quantity.key == "diameter" else answer.rope)
        if answer.before is not None and answer.rope != answer.before.rope:
            cables = f"{cables}; A: {cables_words(answer.before.rope)}"
        return f"{cables}; of an older state" if self.is_old else cables

    @property
    def span(self) -> tuple[float, float]:
        """Of the values that have a colour of their own."""
        if self.is_category:
            return -0.5, len(CATEGORIES) - 0.5
        if self.steps is None:
            return 0.0, 1.0
        return float(self.steps.edges[0]), float(self.steps.edges[-1])

    @property
    def table(self) -> Any:
        """A VTK table of the colours."""
        import matplotlib
        import pyvista
        from matplotlib.colors import ListedColormap

        if self.is_category:
            colours: Any = ListedColormap(list(CATEGORIES))
        elif self.steps is None:
            colours = matplotlib.colormaps["viridis"].resampled(2)
        else:
            colours = self.steps.colormap
        if self.is_old:
            shares = colours(np.arange(colours.N))[:, :3] @ _LUMINANCE
            colours = ListedColormap(np.repeat(shares[:, None], 3, axis=1))
        return pyvista.LookupTable(colours, n_values=colours.N)

    def of(self, answer: MapAnswer) -> Values:
        """Return what an answer has at its points."""
        values = answer.values
        change = answer.difference(self.quantity.key) if self.is_difference else None
        scaled = values[self.quantity.key] if change is None else change
        if self.is_category:
            scaled = np.where(np.isfinite(scaled), np.mod(scaled, len(CATEGORIES)), np.nan)
        else:
            scaled = scaled * self.quantity.scale
        left_out = values["left_out"] > 0.5
        unserved = (values["verdict"] != Verdict.SOLVED) & ~left_out
        if "unserved" in values:
            unserved |= values["unserved"] > 0.5
        return Values(scaled, unserved, left_out)

    def colours(self, values: Values) -> NDArray[np.uint8]:
        """Return red, green and blue (n, 3) of single points."""
        low, high = self.span
        count = self.table.n_values
        step = np.clip((np.nan_to_num(values.scaled) - low) / (high - low) * count, 0, count - 1)
        colours = np.asarray(self.table.values)[step.astype(int), :3].copy()
        colours[~np.isfinite(values.scaled)] = rgb(theme.current().muted)
        colours[values.is_left_out] = rgb(theme.current().left_out)
        colours[values.is_unserved] = rgb(theme.current().hatch[1])
        return colours

    def keys(self, answer: MapAnswer) -> list[Key]:
        """Return what beside the scale has to be explained, where it occurs."""
        values = self.of(answer)
        keys: list[Key] = []
        if self.is_category:
            labels = category_labels(self.quantity.key, len(CATEGORIES))
            present = np.unique(values.scaled[np.isfinite(values.scaled)]).astype(int)
            for code, meaning in labels.items():
                if code % len(CATEGORIES) in present:
                    keys.append(Key(CATEGORIES[code % len(CATEGORIES)], meaning))
        if values.is_unserved.any():
            hatch = theme.current().hatch
            keys.append(Key(hatch[0], "no rope serves", hatch[1]))
        if values.is_left_out.any():
            keys.append(Key(theme.current().left_out, "left out: a cable hangs below"))
        return keys


def rgb(colour: str) -> NDArray[np.uint8]:
    """Return red, green and blue (3,) of a colour such as ``#0072B2``."""
    from matplotlib.colors import to_rgb

    return np.round(255.0 * np.array(to_rgb(colour))).astype(np.uint8)
