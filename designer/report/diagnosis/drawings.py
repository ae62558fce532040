"""Draws every figure of a diagnosis report and gives it a caption."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from designer.diagnosis.result import Diagnosis
from designer.report import format as fmt
from designer.report.design.drawings import chart
from designer.report.parts import Picture

if TYPE_CHECKING:
    from designer.report.figures.diagnosis import Layout

_MOST_CARRIERS = 4
_FIRST_CARRIERS = 3
_RINGS = "Rings are held-out rows, the line is the running median, the band ± 2 times the noise."


@dataclass(frozen=True, slots=True)
class DiagnosisPictures:
    """All figures; None where there is nothing to draw.

    Parameters
    ----------
    strongest : Picture or None
        The residual against the two covariates it goes with most, for the first page.
    rows : Picture
        Every reading over the rows.
    carriers : Picture or None
        The residual against what it went with before.
    left : Picture or None
        What is unexplained against what it goes with.
    errors : Picture
        Held-out error from stage to stage.
    """

    strongest: Picture | None
    rows: Picture
    carriers: Picture | None
    left: Picture | None
    errors: Picture


def draw(diagnosis: Diagnosis) -> DiagnosisPictures:
    """Return all figures of a diagnosis."""
    from designer.report.figures.diagnosis import errors_chart, rows_chart

    before = [c.name for c in diagnosis.structure_before.carriers]
    after = [c.name for c in diagnosis.structure_after.carriers]
    has_change = bool(diagnosis.findings)
    when = ", before (grey) and after (blue)" if has_change else ""
    first = before
    if diagnosis.is_unexplained:
        first = [c.name for c in diagnosis.structure_after.present] or after
    return DiagnosisPictures(
        strongest=_against(
            diagnosis, first[:_FIRST_CARRIERS], "first", "overlaid" if has_change else "after",
            f"Residual against what it goes with most{when}. {_conclusion(diagnosis)}{_RINGS}",
        ),
        rows=chart(
            f"Residual of every reading in units of noise{when}. {_within(diagnosis)}",
            "Clouds of points over the rows, which the better model brings to the band of noise",
            rows_chart(diagnosis),
        ),
        carriers=_against(
            diagnosis, before[:_MOST_CARRIERS], "carriers", "stacked" if has_change else "after",
            f"Residual against the covariates that it goes with most{when}. {_RINGS}",
        ),
        left=_left(diagnosis, after[:_MOST_CARRIERS]),
        errors=chart(
            "Error on held-out rows at each stage, with 95 % intervals. At the dashed line the "
            "model is as good as the readings.",
            "A row for each stage, a panel for each kind of reading",
            errors_chart(diagnosis),
        ),
    )  # fmt: skip


def _conclusion(diagnosis: Diagnosis) -> str:
    """Say what the picture of the first page shows; empty where there is nothing to see."""
    if diagnosis.is_unexplained:
        return "No effect explains this trend. "
    return "The trend before is gone after. " if diagnosis.findings else ""


def _within(diagnosis: Diagnosis) -> str:
    """Say how many readings lie in the band of noise."""
    stages = (diagnosis.residual_before, diagnosis.residual_after)
    shares = [np.mean(np.abs(r[np.isfinite(r)]) < 2.0) for r in stages]
    before, after = (fmt.percent(float(share), 2) for share in shares)
    was = f", {before} before" if diagnosis.findings else ""
    return f"{after} lie within ± 2 times the noise{was}; of plain noise 95\u00a0% would."


def _left(diagnosis: Diagnosis, names: list[str]) -> Picture | None:
    if not diagnosis.is_unexplained or not diagnosis.findings:
        return None  # without findings, what is left is the whole residual, shown already
    caption = f"What is left, against the covariates that it goes with. {_RINGS}"
    return _against(diagnosis, names, "left", "after", caption)


def _against(
    diagnosis: Diagnosis, names: list[str], key: str, layout: Layout, caption: str
) -> Picture | None:
    from designer.report.figures.diagnosis import carriers_chart

    if not names:
        return None
    drawing = carriers_chart(diagnosis, names, f"diagnosis-{key}", layout)
    return chart(caption, "Clouds of points with a line through their middle", drawing)
