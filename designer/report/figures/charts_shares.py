"""What share of the workspace is served: by any diameter, by each size of a grade, by verdict."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from designer.analysis.maps import CoverageCurve
from designer.arrays import FloatArray
from designer.model.verdict import Verdict
from designer.report import format as fmt
from designer.report.figures import canvas, palette
from designer.report.figures.canvas import Style
from designer.selection.candidate import Candidate
from designer.selection.result import SizeCoverage
from designer.workspace.sweep import Census

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_CHARACTER = 0.0098  # width of a character over the width of the figure


def served_chart(served: CoverageCurve) -> str:
    """Return the cumulative share of the workspace over the diameter, as SVG."""
    title = "Share of the workspace that a cable serves, over its diameter"
    with canvas.drawing():
        figure = canvas.sheet(62.0, width_mm=palette.HALF_WIDTH_MM)
        axes = figure.subplots()
        axes.set(ylim=(0.0, 104.0), xlim=_served_range(served))
        sag, straight = (palette.SAG, 1), (palette.MASSLESS, -1)
        _curve(axes, served.massless_diameter_m, served.massless_share, "massless", *straight)
        _curve(axes, served.diameter_m, served.share, "with sag", *sag)
        low, high = axes.get_xlim()
        is_apart = 1e3 * (served.needed_m - served.massless_needed_m) > 0.15 * (high - low)
        side = 1 if is_apart else -1  # on the other a curve has its name
        _needed(axes, served.massless_needed_m, "massless", palette.MASSLESS, side)
        _needed(axes, served.needed_m, "serves all", *sag)
        _unserved(axes, served)
        canvas.grid_lines(axes)
        axes.set_yticks(range(0, 101, 20))
        axes.set_title("share of the poses that the cable serves [%]", loc="left")
        axes.set_xlabel("diameter of the cable [mm]")
        return canvas.svg(figure, "served", title)


def _served_range(served: CoverageCurve) -> tuple[float, float]:
    """Horizontal limits [mm]; the last few poses near the boundary may need any diameter."""
    sag = served.needed_m, served.diameter_m, served.share
    straight = served.massless_needed_m, served.massless_diameter_m, served.massless_share
    diameters = np.concatenate([sag[1], straight[1]])
    if len(diameters) == 0:
        return 0.0, 1.0
    needed = [served.needed_m, served.massless_needed_m]
    for k, (needed_m, diameter_m, share) in enumerate((sag, straight)):
        if not np.isfinite(needed_m) and len(diameter_m) > 0:
            needed[k] = 1.4 * float(diameter_m[np.searchsorted(share, 0.97 * share[-1])])
    low, high = 1e3 * float(diameters.min()), 1e3 * float(np.nanmax(needed))
    room = max(0.06 * (high - low), 0.01 * high)
    return max(low - 3.0 * room, 0.0), high + room


def _curve(
    axes: Axes, diameter_m: FloatArray, share: FloatArray, name: str, colour: str, side: int
) -> None:
    """A staircase, since a pose is served by its diameter and by all above; its name at a side."""
    if len(diameter_m) == 0:
        return
    right = max(axes.get_xlim()[1], 1e3 * diameter_m[-1])
    x = np.concatenate([[0.0], 1e3 * diameter_m, [right]])
    axes.step(x, 100.0 * np.concatenate([[0.0], share, share[-1:]]), where="post", color=colour)
    at = int(np.searchsorted(share, 0.45 * share[-1]))
    place = (1e3 * diameter_m[at], 45.0 * share[-1])
    ha, va = ("left", "top") if side > 0 else ("right", "bottom")
    style: Style = {"ha": ha, "va": va, "color": colour, "path_effects": canvas.halo()}
    canvas.note(axes, name, place, (6 * side, -4 * side), **style)


def _needed(axes: Axes, needed_m: float, label: str, colour: str, side: int) -> None:
    if np.isfinite(needed_m):
        axes.axvline(1e3 * needed_m, color=colour, linewidth=0.9, linestyle=canvas.DASHES)
        text = f"{label}: {canvas.significant(1e3 * needed_m, 3)} mm"
        style: Style = {"ha": "left" if side > 0 else "right", "va": "bottom", "color": colour}
        canvas.note(axes, text, (1e3 * needed_m, 3.0), (3 * side, 0), rotation=90, **style)


def _unserved(axes: Axes, served: CoverageCurve) -> None:
    if served.samples == 0:
        axes.text(0.5, 50.0, "every pose is left out", ha="center", va="center")
    if served.unserved == 0.0:
        return
    low = 100.0 * (1.0 - served.unserved)
    axes.axhspan(low, 100.0, **canvas.HATCHED, linewidth=0)
    text = f"not served {canvas.significant(100.0 * served.unserved, 2)} %"
    style = {"va": "top", "color": palette.WARNING, "bbox": canvas.paper(0.8, 0.85)}
    frame = ("axes fraction", "data")
    canvas.note(axes, text, (0.0, max(low, 20.0)), (6, -3), xycoords=frame, **style)


def usable_chart(usable: SizeCoverage, chosen: Candidate | None) -> str:
    """Return the share of the workspace over the diameter of the sizes, as SVG."""
    with canvas.drawing():
        figure = canvas.sheet(52.0)
        axes = figure.subplots()
        x = 1e3 * np.array([one.size.diameter_m for one in usable.sizes])
        y = 100.0 * np.array([one.fraction for one in usable.sizes])
        low = 75.0 if y.min() > 75.0 else 0.0  # where the axis begins
        room = 100.0 - low
        axes.set(ylim=(low - 0.02 * room, 100.0 + 0.16 * room), xlim=_usable_range(usable, x))
        axes.plot(x, y, color=palette.SAG, linewidth=1.0, alpha=0.6)
        axes.plot(x, y, **canvas.DOTS, markersize=4.2, color=palette.SAG)
        _name_sizes(axes, usable, x, y)
        for k, size in enumerate(usable.sizes):
            if chosen is not None and size.size is chosen.size:
                ring = canvas.RING | {"markerfacecolor": "none", "markeredgewidth": 1.2}
                axes.plot(x[k], y[k], **ring, markersize=8.0)
                style = {"ha": "center", "va": "bottom", "fontweight": "bold"}
                canvas.note(axes, "chosen", (x[k], y[k]), (0, 6), **style)
        canvas.grid_lines(axes)
        axes.set_yticks(np.linspace(low, 100.0, 6))
        axes.set_title("share of the workspace that the size serves [%]", loc="left")
        axes.set_xlabel(f"nominal diameter of the sizes of {usable.grade.id} [mm]")
        return canvas.svg(figure, "usable", "Share of the workspace that each size serves")


def _usable_range(usable: SizeCoverage, diameters: FloatArray) -> tuple[float, float]:
    """From the last size before any serves to a few above the one from which on all serve all."""
    serving = [k for k, size in enumerate(usable.sizes) if size.fraction > 0.0]
    low = diameters[max(serving[0] - 1, 0)] if serving else diameters[0]
    serves_all = usable.first_for_good
    high = diameters[-1] if serves_all is None else min(1.5 * diameters[serves_all], diameters[-1])
    room = max(0.05 * (high - low), 0.02 * high)
    return low - room, high + room


def _name_sizes(axes: Axes, usable: SizeCoverage, x: FloatArray, y: FloatArray) -> None:
    """Name the sizes along the curve, as far as there is room."""
    left, right = axes.get_xlim()
    last = -1.0
    for size, at, share in zip(usable.sizes, x, y, strict=True):
        place = (at - left) / (right - left)
        if not 0.0 <= place <= 1.0 or place - last < 0.03:
            continue
        last = place
        side, va = (-1, "top") if share > 50.0 else (1, "bottom")
        canvas.note(
            axes, size.size.id, (at, share), (3, 4 * side), rotation=60 * side, ha="left", va=va,
            rotation_mode="anchor", fontsize=palette.FONT_POINTS - 1.0, path_effects=canvas.halo(),
        )  # fmt: skip


@dataclass(frozen=True, slots=True)
class Part:
    """One part of the bar of verdicts: its label, how many poses, its colour and hatch."""

    label: str
    count: int
    colour: str
    hatch: str = ""


def parts(census: Census) -> tuple[Part, ...]:
    """Return the parts of the bar that are not empty; together they hold every sample."""
    status = dict(census.statuses)
    above = status["solved"] - census.hangs_below
    below, label, colour = census.hangs_below, "held, a cable hangs below", palette.SAG_PALE
    if census.excluded > 0:
        below += status.pop("no_finite_cable")
        label, colour = "left out: a cable hangs below", palette.LEFT_OUT
    everything = [Part("held", above, palette.SAG), Part(label, below, colour)]
    everything += [
        Part(v.reason, status.get(v.label, 0), getattr(palette, v.colour), v.hatch)
        for v in Verdict
        if v is not Verdict.SOLVED
    ]
    return tuple(part for part in everything if part.count > 0)


def verdict_chart(census: Census) -> str:
    """Return all samples by their verdict as one stacked bar with labels, as SVG."""
    bar_parts = parts(census)
    shares = [part.count / census.samples for part in bar_parts]
    texts = []
    for part, share in zip(bar_parts, shares, strict=True):
        percent = "< 0.1" if share < 0.001 else f"{100.0 * share:.1f}"
        texts.append(f"{part.label}\n{percent} %, {fmt.count(part.count)}")
    starts = [sum(shares[:index]) for index in range(len(shares))]
    with canvas.drawing():
        figure = canvas.sheet(19.0)
        axes = figure.subplots()
        axes.set(xlim=(0.0, 1.0), ylim=(-1.9, 0.5))
        axes.set_axis_off()
        for part, start, share in zip(bar_parts, starts, shares, strict=True):
            _bar(axes, part, start, share, 0.0, 0.9)
        for part, at, text in zip(bar_parts, spread(starts, texts), texts, strict=True):
            _bar(axes, part, at, 0.012, -0.98, 0.42)
            axes.text(at + 0.018, -0.78, text, va="top")
        return canvas.svg(figure, "verdicts", "Poses of the workspace by verdict")


def spread(starts: Sequence[float], texts: Sequence[str]) -> list[float]:
    """Return where to begin each text so that none overlaps, near its start, within 0 to 1."""
    widths = [0.03 + _CHARACTER * max(len(line) for line in text.split("\n")) for text in texts]
    places: list[float] = []
    for start in starts:
        before = places[-1] + widths[len(places) - 1] if places else 0.0
        places.append(max(start, before))
    limit = 1.0
    for index in reversed(range(len(places))):
        places[index] = max(min(places[index], limit - widths[index]), 0.0)
        limit = places[index]
    return places


def _bar(axes: Axes, part: Part, start: float, width: float, middle: float, height: float) -> None:
    rim = palette.WARNING if part.hatch else "white"
    look: Style = {
        "color": part.colour,
        "hatch": part.hatch,
        "edgecolor": rim,
        "linewidth": 0.6,
    }
    axes.barh(middle, width, left=start, height=height, **look)
