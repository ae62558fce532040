"""The report on a plan of measurements."""

from __future__ import annotations

import math
from functools import cached_property
from pathlib import Path

import numpy as np

from designer.analysis.provenance import Provenance
from designer.diagnosis.plan import Plan
from designer.report import format as fmt
from designer.report.document import Drawing, Report, Section, control_of, vector
from designer.report.figures import canvas, palette
from designer.report.render import write_pages


class PlanDrawings:
    """Figures by name."""

    def __init__(self, plan: Plan) -> None:
        self._plan = plan

    @cached_property
    def poses(self) -> Drawing | None:
        """Where to measure."""
        return vector(poses_chart(self._plan))

    @cached_property
    def curves(self) -> Drawing | None:
        """Deviations over the number of poses."""
        return vector(curves_chart(self._plan))


def deviation(std: float, unit: str) -> str:
    """Return a deviation as text, lengths in millimetres; a dash where there is none."""
    if not math.isfinite(std):
        return fmt.MISSING
    scaled, name = (1e3 * std, "mm") if unit == "m" else (std, unit)
    return f"{fmt.number(scaled, 3)}\u00a0{name}".strip()


def write_plan_report(plan: Plan, cable: str, folder: Path, templates: Path | None = None) -> None:
    """Write ``plan.html`` and ``plan.pdf`` into an existing folder."""
    provenance = Provenance.now()
    rows = [
        (e.label, deviation(e.std, e.parameter.unit), deviation(e.std_random, e.parameter.unit))
        for e in plan.expected
    ]
    noises = (plan.noise.length_m, "m", "length"), (plan.noise.tension_N, "N", "tension")
    noise = ", ".join(
        f"{deviation(size, unit)} of a {name}" for size, unit, name in noises if size < math.inf
    )
    context = {
        "plan": plan,
        "rows": rows,
        "cable": cable,
        "noise": noise,
        "drawings": PlanDrawings(plan),
        "provenance": provenance,
    }
    report = Report.of(
        "plan",
        plan.study.name,
        "Plan of measurements",
        provenance.created,
        [Section(name, context=context) for name in ("answer", "provenance")],
        version=provenance.version,
        control=control_of(plan.study),
    )
    write_pages(report, folder, templates)


# Where to measure, and what more poses would bring, as SVG.


def poses_chart(plan: Plan) -> str:
    """Return the poses from above and from the side, as SVG."""
    exits_m = plan.statics.robot.exit_points_m
    workspace = plan.study.workspace
    assert workspace is not None
    with canvas.drawing():
        figure = canvas.sheet(55.0)
        for axes, plane in zip(figure.subplots(1, 2), ([0, 1], [0, 2]), strict=True):
            canvas.region(axes, workspace.region, plane)
            axes.plot(*exits_m[:, plane].T, "s", color=palette.INK, markersize=3.5)
            axes.plot(*plan.places[:, plane].T, "-", color=palette.FAINT, linewidth=0.6)
            axes.plot(*plan.places[:, plane].T, "o", color=palette.SAG, markersize=3.0)
            for number, place in enumerate(plan.places[:, plane], start=1):
                canvas.note(axes, str(number), tuple(place), (2.0, 2.0), fontsize=6)
            axes.set_xlabel(f"{'xyz'[plane[0]]} [m]")
            axes.set_ylabel(f"{'xyz'[plane[1]]} [m]")
            axes.set_aspect("equal")
        return canvas.svg(figure, "plan-poses", "Poses to measure")


def curves_chart(plan: Plan) -> str | None:
    """Return deviations over the number of poses, as SVG; None where nothing is told."""
    curves = [curve for curve in plan.curves if np.isfinite(curve.std).any()]
    if not curves:
        return None
    with canvas.drawing():
        figure = canvas.sheet(60.0)
        axes = figure.subplots()
        for k, curve in enumerate(curves):
            scale, unit = (1e3, "mm") if curve.unit == "m" else (1.0, curve.unit)
            std = np.where(np.isfinite(curve.std), scale * curve.std, np.nan)
            label = f"{curve.effect_id.replace('_', ' ')} [{unit or '–'}]"
            axes.plot(plan.sizes, std, "o-", color=f"C{k}", markersize=3.0, label=label)
        axes.axvline(len(plan.places), color=palette.FAINT, linewidth=0.6)
        axes.set_yscale("log")
        for formatted in (axes.yaxis.set_major_formatter, axes.yaxis.set_minor_formatter):
            formatted(lambda value, _: fmt.number(value, 2))
        axes.set_xlabel("poses")
        axes.set_ylabel("largest deviation")
        canvas.grid_lines(axes, "both")
        axes.legend()
        return canvas.svg(figure, "plan-curves", "Deviations over the number of poses")
