"""The residual against covariates, as the first page and two sections show it."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

from designer.diagnosis.result import Diagnosis
from designer.diagnosis.structure import Carrier
from designer.report.blocks import Picture
from designer.report.pictures import chart

if TYPE_CHECKING:
    from designer.report.figures.diagnosis import Layout

_MOST = 4
_MOST_ON_FIRST_PAGE = 3
_RINGS = "Rings are held-out rows, the line is the running median, the band ± 2 times the noise."


def strongest(diagnosis: Diagnosis) -> Picture | None:
    """Return the residual against what it goes with most, for the first page."""
    structure = diagnosis.structure_after
    carriers, conclusion = diagnosis.structure_before.carriers, ""
    if diagnosis.is_unexplained:
        carriers = structure.present or structure.carriers
        conclusion = "No effect explains this trend. "
    elif diagnosis.findings:
        conclusion = "The trend before is gone after. "
    return _against(
        diagnosis,
        carriers[:_MOST_ON_FIRST_PAGE],
        "diagnosis-first",
        "overlaid" if diagnosis.findings else "after",
        f"Residual against what it goes with most{when(diagnosis)}. {conclusion}{_RINGS}",
    )


def before(diagnosis: Diagnosis) -> Picture | None:
    """Return the residual against what it went with before."""
    return _against(
        diagnosis,
        diagnosis.structure_before.carriers[:_MOST],
        "diagnosis-carriers",
        "stacked" if diagnosis.findings else "after",
        f"Residual against the covariates that it goes with most{when(diagnosis)}. {_RINGS}",
    )


def left(diagnosis: Diagnosis) -> Picture | None:
    """Return what is left; None without findings, as that is the whole residual, shown already."""
    if not diagnosis.findings:
        return None
    carriers = diagnosis.structure_after.carriers[:_MOST]
    caption = f"What is left, against the covariates that it goes with. {_RINGS}"
    return _against(diagnosis, carriers, "diagnosis-left", "after", caption)


def when(diagnosis: Diagnosis) -> str:
    """Return the words of a caption for both stages; empty where there is one only."""
    return ", before (grey) and after (blue)" if diagnosis.findings else ""


def _against(
    diagnosis: Diagnosis, carriers: Iterable[Carrier], key: str, layout: Layout, caption: str
) -> Picture | None:
    from designer.report.figures.diagnosis import carriers_chart

    names = [carrier.name for carrier in carriers]
    if not names:
        return None
    drawing = carriers_chart(diagnosis, names, key, layout)
    return chart(caption, "Clouds of points with a line through their middle", drawing)
