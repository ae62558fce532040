"""The residual before and after, and the test for structure in it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from designer.diagnosis.result import Diagnosis
from designer.diagnosis.structure import SIGNIFICANCE, Carrier
from designer.report import format as fmt
from designer.report.diagnosis import words
from designer.report.parts import MOST_ROWS, Column, Picture, Row, Table


@dataclass(frozen=True, slots=True)
class ResidualSection:
    """The residual.

    Parameters
    ----------
    carriers : Picture or None
        Against what it went with before.
    rows : Picture
        Over the rows.
    structure : Table or None
        The test for structure, before and after; None where nothing could be tested.
    """

    carriers: Picture | None
    rows: Picture
    structure: Table | None


def residual_section(
    diagnosis: Diagnosis, carriers: Picture | None, rows: Picture
) -> ResidualSection:
    """Return the residual before and after."""
    return ResidualSection(carriers, rows, _structure(diagnosis))


def _structure(diagnosis: Diagnosis) -> Table | None:
    before = {c.name: c for c in diagnosis.structure_before.carriers}
    after = {c.name: c for c in diagnosis.structure_after.carriers}
    stages = {"before": before, "after": after} if diagnosis.findings else {"": after}
    names = list(dict.fromkeys(n for pair in zip(before, after, strict=False) for n in pair))
    if not names:
        return None
    columns = [Column("Covariate", is_number=False)]
    for stage in stages:
        columns += [Column(f"{title} {stage}".strip()) for title in ("Share", "Chance")]
    shown = names[:MOST_ROWS]
    rest = f" The {len(shown)} strongest of {len(names)}." if len(names) > len(shown) else ""
    return Table.of(
        "What the residual goes with: share of the variance that a parabola in each covariate "
        "explains where it explains most, and the chance that the strongest of all would look so "
        f"by accident, by permutation; below {words.chance(SIGNIFICANCE)} it counts as structure."
        f"{rest}",
        tuple(columns),
        *(_row(name, tuple(stages.values())) for name in shown),
    )


def _row(name: str, stages: Sequence[Mapping[str, Carrier]]) -> Row:
    cells = [words.covariate_axis(name)]
    for carriers in stages:
        carrier = carriers.get(name)
        cells.append(fmt.percent(carrier.fraction_of_variance, 2) if carrier else fmt.MISSING)
        cells.append(words.chance(carrier.chance) if carrier else fmt.MISSING)
    last = stages[-1].get(name)
    return Row(tuple(cells), "bad" if last and last.chance < SIGNIFICANCE else "")
