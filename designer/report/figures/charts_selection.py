"""What each rope grade needs and what it is sold in, and all sizes that hold, compared."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from designer.arrays import FloatArray
from designer.grades.grade import MATERIAL_CLASSES, Grade
from designer.report import format as fmt
from designer.report.document import MOST_ROWS
from designer.report.figures import canvas, palette
from designer.report.figures.canvas import Style
from designer.selection.candidate import MEANINGS, Candidate
from designer.selection.result import GradeOutcome, SelectionResult
from designer.study import Objective

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_SIZE: Style = {"marker": "o", "markersize": 4.2, "markeredgecolor": palette.INK}
_BEATEN: Style = {"markersize": 2.6, "markeredgewidth": 0.0}
_FRONT: Style = {"markersize": 6.0, "markeredgewidth": 0.9, "markeredgecolor": palette.INK}
_CHOSEN: Style = _FRONT | {"markersize": 9.0, "markeredgewidth": 1.8}
_MOST_GRADES = 18


def candidates_chart(selection: SelectionResult) -> str:
    """Return a row for each grade: range of sizes, need, best size, as SVG.

    Grades that hold come first, the lightest on top; then those that end too thin, the nearest
    first; then those of which no section holds. Where nothing was chosen, the grades outside the
    study's list that would hold follow. The figure says how many more there are than it shows.
    """
    alternatives = rank(selection.alternatives)[: _MOST_GRADES // 2]
    allowed = rank(selection.outcomes)[: _MOST_GRADES - len(alternatives)]
    outcomes = allowed + alternatives
    left_out = len(selection.outcomes) + len(selection.alternatives) - len(outcomes)
    with canvas.drawing():
        figure = canvas.sheet(20.0 + 4.2 * max(len(outcomes), 1))
        axes = figure.subplots()
        right = _right_end(outcomes)
        axes.set(xlim=(0.0, right), ylim=(len(outcomes) - 0.4, -0.6))
        for row, outcome in enumerate(outcomes):
            is_chosen = selection.chosen is not None and outcome.best is selection.chosen
            _row(axes, row, outcome, right)
            _ending(axes, row, outcome, is_chosen=is_chosen)
            if is_chosen:
                axes.axhspan(row - 0.5, row + 0.5, color=palette.SAG, alpha=0.12, linewidth=0)
        names = [o.grade.id for o in allowed] + [f"{o.grade.id} *" for o in alternatives]
        axes.set_yticks(range(len(outcomes)), names)
        axes.tick_params(axis="y", length=0)
        axes.spines["left"].set_visible(False)
        more = f"; {left_out} more grades are not shown" if left_out > 0 else ""
        axes.set_xlabel(f"diameter [mm]{more}")
        canvas.grid_lines(axes, "x")
        _candidates_legend(figure, outcomes)
        return canvas.svg(figure, "candidates", "Sizes of each grade and what it would need")


def rank(outcomes: Sequence[GradeOutcome]) -> list[GradeOutcome]:
    """Return the grades in the order of interest, see `candidates_chart`."""

    def interest(outcome: GradeOutcome) -> tuple[int, float]:
        if outcome.best is not None:
            return 0, outcome.best.total_mass_kg
        if np.isfinite(outcome.continuous_diameter_m):
            return 1, outcome.continuous_diameter_m / outcome.grade.thickest.diameter_m
        return 2, 0.0

    return sorted(outcomes, key=interest)


def _right_end(outcomes: Sequence[GradeOutcome]) -> float:
    """Right end of the axis: thick sizes that nobody needs may run out of the chart [mm]."""
    needs = [o.continuous_diameter_m for o in outcomes if np.isfinite(o.continuous_diameter_m)]
    diameters = [c.size.diameter_m for o in outcomes for c in _marked(o)]
    best = [o.best.size.diameter_m for o in outcomes if o.best is not None]
    sold = [o.grade.thickest.diameter_m for o in outcomes]
    if not needs:
        return 1.05e3 * max(sold, default=1e-3)
    widest = max(2.2 * float(np.median(needs)), 1.1 * max(needs), 1.1 * max(best, default=0.0))
    return 1e3 * min(1.05 * max(needs + diameters + sold), widest)


def _row(axes: Axes, row: int, outcome: GradeOutcome, right: float) -> None:
    low, high = (1e3 * outcome.grade.sizes[k].diameter_m for k in (0, -1))
    bar: Style = {"color": _pale(outcome.grade), "solid_capstyle": "butt"}
    axes.plot([low, min(high, right)], [row, row], linewidth=5.0, **bar)
    if high > right:
        arrow = {"arrowstyle": "-|>", "color": palette.MASSLESS, "linewidth": 0.8}
        axes.annotate("", (right, row), (right * 0.985, row), arrowprops=arrow)
    need = 1e3 * outcome.continuous_diameter_m
    if np.isfinite(need):
        axes.plot([need, need], [row - 0.4, row + 0.4], color=palette.INK, linewidth=1.6, zorder=4)
    for candidate in _marked(outcome):
        diameter = 1e3 * candidate.size.diameter_m
        if diameter <= right:
            colour = palette.INK if candidate.verified else "white"
            axes.plot(diameter, row, **_SIZE, zorder=5, markeredgewidth=1.0, color=colour)


def _pale(grade: Grade) -> str:
    """Return the colour of the grade's material, mixed with white so that marks stand out."""
    from matplotlib.colors import to_hex, to_rgb

    colour = np.array(to_rgb(palette.CLASS_COLOURS[grade.material_class]))
    return to_hex(1.0 - 0.45 * (1.0 - colour))


def _marked(outcome: GradeOutcome) -> list[Candidate]:
    """Return the best size of a grade and the next thinner one that does not hold."""
    best = [] if outcome.best is None else [outcome.best]
    limit_m = best[0].size.diameter_m if best else np.inf
    fails = [
        c for c in outcome.candidates if not c.verification.holds and c.size.diameter_m < limit_m
    ]
    return [*fails[-1:], *best]


def _ending(axes: Axes, row: int, outcome: GradeOutcome, *, is_chosen: bool) -> None:
    """Write on the right what comes of a grade."""
    colour = palette.WARNING
    if outcome.best is not None:
        mass_kg, colour = outcome.best.total_mass_kg, palette.INK
        mass = canvas.significant(mass_kg, 3)
        text = f"{outcome.best.size.id}, {mass} kg"
        if outcome.outcome != "fits":
            text, colour = f"{text}; {outcome.brief}", palette.WARNING
    else:
        text = outcome.brief
    canvas.note(
        axes, text, (1.0, row), (5, 0), xycoords=("axes fraction", "data"), va="center",
        annotation_clip=False, color=colour, fontweight="bold" if is_chosen else "normal",
        fontsize=palette.FONT_POINTS - 0.5,
    )  # fmt: skip


def _candidates_legend(figure: Figure, outcomes: Sequence[GradeOutcome]) -> None:
    one_each = {outcome.grade.material_class: outcome.grade for outcome in outcomes}
    need: Style = {"marker": "|", "markersize": 8, "markeredgewidth": 1.6, "linestyle": "none"}
    looks: list[tuple[str, Style]] = [
        (f"sizes sold, {kind}", {"color": _pale(one_each[kind]), "linewidth": 5.0})
        for kind in MATERIAL_CLASSES
        if kind in one_each
    ]
    looks.append(("continuous optimum", need | {"color": palette.INK}))
    looks.append(("best size that holds", canvas.DOTS | _SIZE | {"color": palette.INK}))
    looks.append(("next thinner, does not hold", canvas.DOTS | _SIZE | {"color": "white"}))
    canvas.legend(figure, looks, "outside upper center", ncols=4)


@dataclass(frozen=True, slots=True)
class _Along:
    """What runs along an axis: its name with the unit, and from SI to that unit."""

    objective: Objective
    label: str
    scale: float

    @classmethod
    def of(cls, objective: Objective, selection: SelectionResult) -> _Along:
        """Forces and stiffnesses are in thousands where all are that large."""
        meaning = MEANINGS[objective]
        unit, scale = meaning.unit or selection.currency or "", 1.0
        values = [c.figures.value(objective) for c in _holding(selection)]
        if unit.startswith("N") and min(values, default=0.0) >= 1e3:
            unit, scale = f"k{unit}", 1e-3
        title = meaning.title
        if objective == "cost" and selection.price_estimate is not None:
            title = f"estimated {title}"
        return cls(objective, f"{title} [{unit}]" if unit else title, scale)


def pareto_chart(selection: SelectionResult) -> str | None:
    """Return the first objective over each of the others, a panel each, as SVG.

    Sizes that no other beats have a dark rim. None where there is one objective only, or nothing
    holds.
    """
    first, *further = selection.objectives
    if not further or not selection.front:
        return None
    up = _Along.of(first, selection)
    with canvas.drawing():
        figure = canvas.sheet(60.0)
        panels = figure.subplots(1, len(further), sharey=True, squeeze=False)[0]
        for axes, objective in zip(panels, further, strict=True):
            _panel(axes, selection, _Along.of(objective, selection), up)
        panels[0].set_title(up.label, loc="left")
        _pareto_legend(figure, selection)
        return canvas.svg(figure, "pareto", "Sizes that hold, by what they are compared by")


def _holding(selection: SelectionResult) -> list[Candidate]:
    return [c for c in selection.candidates if c.verification.holds]


def _panel(axes: Axes, selection: SelectionResult, across: _Along, up: _Along) -> None:
    holding, front = _holding(selection), list(selection.front)
    size = _BEATEN["markersize"] * (1.5 if len(holding) < 60 else 1.0)
    for group, style in (
        ([c for c in holding if c not in front], _BEATEN | {"markersize": size}),
        (front[1:], _FRONT),
        (front[:1], _CHOSEN),
    ):
        for kind in MATERIAL_CLASSES:
            points = _points([c for c in group if c.grade.material_class == kind], across, up)
            axes.plot(*points.T, **palette.look_of(kind), **style)
    axes.set_xlabel(across.label)
    _scales(axes, [*_points(holding, across, up).T])
    if len(front) > 1:
        _number(axes, front, across, up)


def _number(axes: Axes, front: list[Candidate], across: _Along, up: _Along) -> None:
    """Write the row of the table beside each point, as far as there is room."""
    label_places: list[FloatArray] = []
    for number, candidate in enumerate(front[:MOST_ROWS], start=1):
        for x, y in _points([candidate], across, up):
            place = axes.transData.transform((x, y))
            if any(np.hypot(*(place - label_place)) < 14.0 for label_place in label_places):
                continue
            label_places.append(place)
            style = {"ha": "right", "fontweight": "bold", "path_effects": canvas.halo()}
            canvas.note(axes, f"{number}", (x, y), (-5, 5), **style)


def _points(candidates: list[Candidate], across: _Along, up: _Along) -> FloatArray:
    values = [[c.figures.value(axis.objective) for axis in (across, up)] for c in candidates]
    points = np.array(values, dtype=np.float64).reshape(-1, 2) * [across.scale, up.scale]
    return points[np.isfinite(points).all(axis=1) & (points > 0.0).all(axis=1)]


def _scales(axes: Axes, values: list[FloatArray]) -> None:
    """Make an axis logarithmic where its values span decades."""
    from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

    for axis, which, along in zip((axes.xaxis, axes.yaxis), "xy", values, strict=True):
        span = float(along.max() / along.min()) if len(along) else 1.0
        if span > 6.0:
            axes.set(**{f"{which}scale": "log"})
            subs = (1.0,) if span > 30.0 else (1.0, 2.0, 5.0)
            axis.set_major_locator(LogLocator(subs=subs))
            axis.set_minor_formatter(NullFormatter())
        axis.set_major_formatter(FuncFormatter(lambda value, _: fmt.trimmed(float(value), 6)))
    axes.margins(0.08)
    canvas.grid_lines(axes, "both")


def _pareto_legend(figure: Figure, selection: SelectionResult) -> None:
    classes = {c.grade.material_class for c in _holding(selection)}
    looks: list[tuple[str, Style]] = [
        (kind, _BEATEN | palette.look_of(kind) | {"markersize": 5.0})
        for kind in MATERIAL_CLASSES
        if kind in classes
    ]
    looks.append(("chosen", _CHOSEN | palette.look_of(selection.front[0].grade.material_class)))
    if len(selection.front) > 1:
        looks.append(("no other beats it", canvas.DOTS | _FRONT | {"color": "white"}))
    canvas.legend(figure, looks, "outside upper center", ncols=len(looks))
