"""A plan of measurements in pictures: where to measure, and what more poses would bring."""

from __future__ import annotations

import numpy as np

from designer.diagnosis.plan import Plan
from designer.report import format as fmt
from designer.report.figures import canvas, palette


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
