"""The residual before and after, and the test for structure in it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from designer.diagnosis.result import Diagnosis
from designer.diagnosis.statistics import SIGNIFICANCE
from designer.diagnosis.structure import Carrier
from designer.report import format as fmt
from designer.report.blocks import MOST_ROWS, Column, Picture, Row, Section, Table
from designer.report.diagnosis import carriers, words
from designer.report.pictures import chart


def section(diagnosis: Diagnosis) -> Section:
    """Return what the residual goes with, and the residual itself."""
    return Section.of(
        "residual",
        "The residual",
        "The residual is what was measured less what the model foretells, in units of the noise of "
        "one reading. It is held against the pose, the lengths and tensions of the model, the "
        "direction of each cable since the row before (+1 paying out, −1 hauling in), in a motion "
        "also the speeds, time, and every other column.",
        _structure(diagnosis),
        carriers.before(diagnosis),
        _rows(diagnosis),
    )


def _rows(diagnosis: Diagnosis) -> Picture:
    from designer.report.figures.diagnosis import rows_chart

    stages = (diagnosis.residual_before, diagnosis.residual_after)
    shares = [np.mean(np.abs(r[np.isfinite(r)]) < 2.0) for r in stages]
    before, after = (fmt.percent(float(share), 2) for share in shares)
    was = f", {before} before" if diagnosis.findings else ""
    return chart(
        f"Residual of every reading in units of noise{carriers.when(diagnosis)}. {after} lie "
        f"within ± 2 times the noise{was}; of plain noise 95\u00a0% would.",
        "Clouds of points over the rows, which the better model brings to the band of noise",
        rows_chart(diagnosis),
    )


def _structure(diagnosis: Diagnosis) -> Table | None:
    """Return the test for structure, before and after; None where nothing could be tested."""
    before = {c.name: c for c in diagnosis.structure_before.carriers}
    after = {c.name: c for c in diagnosis.structure_after.carriers}
    stages = {"before": before, "after": after} if diagnosis.findings else {"": after}
    names = list(dict.fromkeys(n for pair in zip(before, after, strict=False) for n in pair))
    if not names:
        return None
    heads = (f"{title} {stage}".strip() for stage in stages for title in ("Share", "Chance"))
    shown = names[:MOST_ROWS]
    rest = f" The {len(shown)} strongest of {len(names)}." if len(names) > len(shown) else ""
    return Table.of(
        "What the residual goes with: share of the variance that a parabola in each covariate "
        "explains where it explains most, and the chance that the strongest of all would look so "
        f"by accident, by permutation; below {words.chance(SIGNIFICANCE)} it counts as structure."
        f"{rest}",
        ("Covariate", *map(Column, heads)),
        *(_row(name, tuple(stages.values())) for name in shown),
    )


def _row(name: str, stages: Sequence[Mapping[str, Carrier]]) -> Row:
    cells = [words.covariate_axis(name)]
    for found in stages:
        carrier = found.get(name)
        cells.append(fmt.percent(carrier.fraction_of_variance, 2) if carrier else fmt.MISSING)
        cells.append(words.chance(carrier.chance) if carrier else fmt.MISSING)
    last = stages[-1].get(name)
    return Row(tuple(cells), "bad" if last and last.chance < SIGNIFICANCE else "")
