"""What each rope grade needs and what it is sold in."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from designer.report.figures import canvas, palette
from designer.report.material_class import CLASSES, class_of
from designer.selection.result import Candidate, GradeOutcome, SelectionResult

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_MOST = 25
_ROW_MM = 4.6
_PALE = 0.45


def candidates_chart(selection: SelectionResult, most: int = _MOST) -> str:
    """Return a row for each grade: range of sizes, need, best size, as SVG.

    Grades that hold come first, the lightest on top; then those that end too thin, the nearest
    first; then those of which no section holds.

    Parameters
    ----------
    selection : SelectionResult
        Where nothing was chosen, the grades outside the study's list that would hold follow.
    most : int
        How many rows to show; the figure says how many more there are.
    """
    others = rank(selection.alternatives)[: most // 2]
    shown = rank(selection.outcomes)[: most - len(others)] + others
    left_out = len(selection.outcomes) + len(selection.alternatives) - len(shown)
    with canvas.drawing():
        figure = canvas.sheet(20.0 + _ROW_MM * max(len(shown), 1))
        axes = figure.subplots()
        right = _right_end(shown)
        axes.set(xlim=(0.0, right), ylim=(len(shown) - 0.4, -0.6))
        for row, outcome in enumerate(shown):
            _row(axes, row, outcome, right)
            if selection.chosen is not None and outcome.best is selection.chosen:
                axes.axhspan(row - 0.5, row + 0.5, color=palette.SAG, alpha=0.12, linewidth=0)
        _names(axes, shown, selection)
        _legend(axes, shown)
        if left_out > 0:
            axes.set_xlabel(f"diameter [mm]; {left_out} more grades are not shown")
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
    tried = [c.size.diameter_m for o in outcomes for c in marked(o)]
    best = [o.best.size.diameter_m for o in outcomes if o.best is not None]
    sold = [o.grade.thickest.diameter_m for o in outcomes]
    if not needs:
        return 1.05e3 * max(sold, default=1e-3)
    typical = float(np.median(needs))
    wanted = max(2.2 * typical, 1.1 * max(needs), 1.1 * max(best, default=0.0))
    return 1e3 * min(1.05 * max(needs + tried + sold), wanted)


def _row(axes: Axes, row: int, outcome: GradeOutcome, right: float) -> None:
    low, high = (1e3 * outcome.grade.sizes[k].diameter_m for k in (0, -1))
    axes.plot(
        [low, min(high, right)],
        [row, row],
        color=_pale(outcome),
        linewidth=5.0,
        solid_capstyle="butt",
    )
    if high > right:
        axes.annotate(
            "",
            (right, row),
            (right * 0.985, row),
            arrowprops={"arrowstyle": "-|>", "color": palette.MASSLESS, "linewidth": 0.8},
        )
    need = 1e3 * outcome.continuous_diameter_m
    if np.isfinite(need):
        axes.plot([need, need], [row - 0.4, row + 0.4], color=palette.INK, linewidth=1.6, zorder=4)
    for candidate in marked(outcome):
        _size(axes, row, candidate, right)


def _pale(outcome: GradeOutcome) -> str:
    """Return the colour of the grade's material, mixed with white so that marks stand out."""
    from matplotlib.colors import to_hex, to_rgb

    colour = np.array(to_rgb(palette.CLASS_COLOURS[class_of(outcome.grade)]))
    return to_hex(1.0 - _PALE * (1.0 - colour))


def marked(outcome: GradeOutcome) -> list[Candidate]:
    """Return the best size of a grade and the next thinner one that does not hold."""
    best = [] if outcome.best is None else [outcome.best]
    limit_m = best[0].size.diameter_m if best else np.inf
    fails = [
        c for c in outcome.candidates if not c.verification.holds and c.size.diameter_m < limit_m
    ]
    return [*fails[-1:], *best]


def _size(axes: Axes, row: int, candidate: Candidate, right: float) -> None:
    diameter = 1e3 * candidate.size.diameter_m
    if diameter > right:
        return
    axes.plot(
        diameter,
        row,
        marker="o",
        markersize=4.2,
        zorder=5,
        markeredgewidth=1.0,
        color=palette.INK if candidate.verified else "white",
        markeredgecolor=palette.INK,
    )


def _names(axes: Axes, shown: Sequence[GradeOutcome], selection: SelectionResult) -> None:
    """Grades on the left, the outcome of each on the right."""
    own = {outcome.grade.id for outcome in selection.outcomes}
    names = [o.grade.id + ("" if o.grade.id in own else " *") for o in shown]
    axes.set_yticks(range(len(shown)), names)
    axes.tick_params(axis="y", length=0)
    axes.spines["left"].set_visible(False)
    axes.set_xlabel("diameter [mm]")
    axes.grid(axis="x", color=palette.FAINT, linewidth=0.4, alpha=0.6)
    axes.set_axisbelow(True)
    for row, outcome in enumerate(shown):
        is_chosen = selection.chosen is not None and outcome.best is selection.chosen
        axes.annotate(
            _ending(outcome),
            (1.0, row),
            (5, 0),
            xycoords=("axes fraction", "data"),
            textcoords="offset points",
            va="center",
            annotation_clip=False,
            color=palette.INK if outcome.best is not None else palette.WARNING,
            fontweight="bold" if is_chosen else "normal",
            fontsize=palette.FONT_POINTS - 0.5,
        )


def _ending(outcome: GradeOutcome) -> str:
    if outcome.best is not None:
        return f"{outcome.best.size.id}, {_mass(outcome.best.total_mass_kg)} kg"
    if np.isfinite(outcome.continuous_diameter_m):
        return f"ends at {outcome.grade.thickest.id}"
    return "no section holds"


def _mass(mass_kg: float) -> str:
    return canvas.significant(mass_kg, max(3, len(f"{mass_kg:.0f}")))


def _one_of_each_class(shown: Sequence[GradeOutcome]) -> list[tuple[str, GradeOutcome]]:
    found = {class_of(outcome.grade): outcome for outcome in shown}
    return [(kind, found[kind]) for kind in CLASSES if kind in found]


def _legend(axes: Axes, shown: Sequence[GradeOutcome]) -> None:
    from matplotlib.lines import Line2D

    mark: dict[str, Any] = {
        "linestyle": "none",
        "marker": "o",
        "markersize": 4.2,
        "markeredgecolor": palette.INK,
    }
    entries = [
        *(
            Line2D([], [], color=_pale(outcome), linewidth=5.0, label=f"sizes sold, {kind}")
            for kind, outcome in _one_of_each_class(shown)
        ),
        Line2D(
            [],
            [],
            color=palette.INK,
            linestyle="none",
            marker="|",
            markersize=8,
            markeredgewidth=1.6,
            label="continuous optimum",
        ),
        Line2D([], [], color=palette.INK, label="best size that holds", **mark),
        Line2D([], [], color="white", label="next thinner, does not hold", **mark),
    ]
    axes.figure.legend(handles=entries, loc="outside upper center", ncols=4, frameon=False)
