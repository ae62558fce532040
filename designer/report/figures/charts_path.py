"""Tension, rope speed and power of each cable against time along a path."""

from __future__ import annotations

from itertools import cycle, product

import numpy as np

from designer.analysis.path import PathCase
from designer.report import format as fmt
from designer.report.figures import canvas
from designer.report.figures.canvas import Style

# Okabe and Ito again; vermilion stays a warning.
_COLOURS = ("#0072B2", "#E69F00", "#009E73", "#CC79A7", "#56B4E9", "#222222")


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
    looks: list[Style] = [
        {"linestyle": style, "color": colour, "linewidth": 1.1}
        for style, colour in product(("-", "--", ":"), _COLOURS)
    ]
    with canvas.drawing():
        figure = canvas.sheet(118.0)
        every = figure.subplots(len(panels), 1, sharex=True)
        for axes, (title, values) in zip(every, panels, strict=True):
            for column, look in zip(values.T, cycle(looks)):
                axes.plot(case.motion.time_s, column, **look)
            axes.set_title(title, loc="left")
            canvas.grid_lines(axes)
            axes.set_xlim(case.motion.time_s[0], case.motion.time_s[-1])
        for axes in every[1:]:
            axes.axhline(0.0, color="#222222", linewidth=0.5)
        every[0].set_ylim(bottom=0.0)
        every[-1].set_xlabel("time [s]")
        named = zip(range(1, values.shape[1] + 1), cycle(looks))
        canvas.legend(figure, [(f"cable {k}", look) for k, look in named], "outside right upper")
        return canvas.svg(
            figure, "path", "Tension, rope speed and power of each cable against time"
        )
