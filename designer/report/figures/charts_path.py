"""What each cable does along a path: tension, speed and power against time, bends against place."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import cycle, product
from typing import TYPE_CHECKING

import numpy as np

from designer.analysis.path import CableBending, PathCase
from designer.report import format as fmt
from designer.report.figures import canvas
from designer.report.figures.canvas import Style

if TYPE_CHECKING:
    from matplotlib.figure import Figure

# Okabe and Ito again; vermilion stays a warning.
_COLOURS = ("#0072B2", "#E69F00", "#009E73", "#CC79A7", "#56B4E9", "#222222")
_LOOKS: list[Style] = [
    {"linestyle": style, "color": colour, "linewidth": 1.1}
    for style, colour in product(("-", "--", ":"), _COLOURS)
]


def path_chart(case: PathCase) -> str:
    """Return three panels over one axis of time, a line a cable, as SVG."""
    unit, scale = fmt.force_unit(float(np.nanmax(case.tension_N)))
    most_W = float(np.nanmax(np.abs(case.power_W), initial=0.0))
    power_unit, power_scale = ("W", 1.0) if most_W < 2e3 else ("kW", 1e-3)
    panels = (
        (f"tension at the exit point [{unit}]", case.tension_N / scale),
        ("rope speed [m/s], above zero paying out", case.speed_m_per_s),
        (f"power of the motor [{power_unit}], below zero driven", case.power_W * power_scale),
    )
    with canvas.drawing():
        figure = canvas.sheet(118.0)
        every = figure.subplots(len(panels), 1, sharex=True)
        for axes, (title, values) in zip(every, panels, strict=True):
            for column, look in zip(values.T, cycle(_LOOKS)):
                axes.plot(case.motion.time_s, column, **look)
            axes.set_title(title, loc="left")
            canvas.grid_lines(axes)
            axes.set_xlim(case.motion.time_s[0], case.motion.time_s[-1])
        for axes in every[1:]:
            axes.axhline(0.0, color="#222222", linewidth=0.5)
        every[0].set_ylim(bottom=0.0)
        every[-1].set_xlabel("time [s]")
        _legend(figure, values.shape[1])
        return canvas.svg(
            figure, "path", "Tension, rope speed and power of each cable against time"
        )


def bending_chart(cables: Sequence[CableBending]) -> str:
    """Return the bending cycles of a run against the place on the rope, a line a cable, as SVG."""
    with canvas.drawing():
        figure = canvas.sheet(60.0)
        axes = figure.subplots()
        for cable, look in zip(cables, cycle(_LOOKS)):
            axes.plot(cable.places_m, cable.cycles, drawstyle="steps-mid", **look)
        canvas.grid_lines(axes)
        axes.set_ylim(bottom=0.0)
        axes.set_title("bending cycles in a run along the path", loc="left")
        axes.set_xlabel("unstrained rope from the platform's end [m]")
        _legend(figure, len(cables))
        return canvas.svg(figure, "bending", "Bending cycles of each cable along its rope")


def _legend(figure: Figure, count: int) -> None:
    named = zip(range(1, count + 1), cycle(_LOOKS))
    canvas.legend(figure, [(f"cable {k}", look) for k, look in named], "outside right upper")
