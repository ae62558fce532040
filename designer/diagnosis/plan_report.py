"""The report on a plan of measurements."""

from __future__ import annotations

import math
from functools import cached_property
from pathlib import Path

from designer.analysis.provenance import Provenance
from designer.diagnosis.plan import Plan
from designer.diagnosis.plan_figures import curves_chart, poses_chart
from designer.report import format as fmt
from designer.report.document import Drawing, Report, Section, control_of, vector
from designer.report.render import write_pages


class Drawings:
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
        "drawings": Drawings(plan),
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
