"""Do the readings that stand off have something in common? Then they are no accidents."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np

from designer.arrays import BoolArray, FloatArray, IntArray
from designer.diagnosis.errors_of import without_outliers
from designer.diagnosis.problem import channel_names
from designer.diagnosis.structure import SIGNIFICANCE, Event

_LEAST = 5
_END = 0.25

Common = tuple[float, float, str]
"""Chance by accident, share of the readings that stand off, what they have in common."""


def find_common(
    residual: FloatArray, covariates: Mapping[str, FloatArray], rows: IntArray
) -> Event | None:
    """Return what readings that stand off have in common; None where they are scattered.

    They may be of one sensor, in one range of rows, or at one end of a covariate. Chances are
    binomial, times the number of places that were looked at.

    Parameters
    ----------
    residual : array (n_rows, 2 n_cables)
        In units of noise; NaN where not measured.
    covariates : mapping
        From `designer.diagnosis.structure.covariates_of`.
    rows : array (n_rows,)
        Numbers of the rows in the file.
    """
    gone = np.isnan(without_outliers(residual)) & ~np.isnan(residual)
    count = int(gone.sum())
    if count < _LEAST:
        return None
    off = np.asarray(gone.any(axis=1))
    kinds = (_of_a_sensor(gone, residual), _in_a_range(off, rows), _at_an_end(off, covariates))
    common = [c for c in (min(kind, default=None) for kind in kinds) if c and c[0] < SIGNIFICANCE]
    if not common:
        return None
    text = ", ".join(text for _, _, text in common)
    return Event(
        f"the {count} readings that stand off: {text}",
        max(share for _, share, _ in common),
        min(chance for chance, _, _ in common),
    )


def _of_a_sensor(gone: BoolArray, residual: FloatArray) -> Iterator[Common]:
    known = ~np.isnan(residual)
    for channel, name in enumerate(channel_names(gone.shape[1] // 2)):
        inside, total = int(gone[:, channel].sum()), int(gone.sum())
        chance = _chance(inside, total, known[:, channel].sum() / known.sum(), gone.shape[1])
        yield chance, inside / total, f"{inside} are of {name}"


def _in_a_range(off: BoolArray, rows: IntArray) -> Iterator[Common]:
    where = np.flatnonzero(off)
    n = len(where)
    first, last = np.triu_indices(n, 1)
    width = (where[last] - where[first] + 1) / len(off)
    inside = last - first + 1
    # Its two ends are where they are by choice.
    chance = _chances(inside - 2, n - 2, width, n * n // 2)
    best = int(np.argmin(chance)) if n > 1 else None
    if best is not None:
        ends = f"{rows[where[first[best]]]} to {rows[where[last[best]]]}"
        text = f"{inside[best]} of {n} rows from {ends}"
        yield float(chance[best]), float(inside[best]) / n, text


def _at_an_end(off: BoolArray, covariates: Mapping[str, FloatArray]) -> Iterator[Common]:
    n = int(off.sum())
    for name, column in covariates.items():
        for sign, end in ((1.0, "lower"), (-1.0, "upper")):
            edge = np.nanquantile(sign * column, _END)
            inside = int(np.sum(off & (sign * column <= edge)))
            share = float(np.mean(sign * column <= edge))
            chance = _chance(inside, n, share, 2 * len(covariates))
            yield chance, inside / n, f"{inside} of {n} rows in the {end} quarter of {name}"


def _chance(inside: int, total: int, share: float, looks: int) -> float:
    return float(_chances(np.array([inside]), total, np.array([share]), looks)[0])


def _chances(inside: IntArray, total: int, share: FloatArray, looks: int) -> FloatArray:
    from scipy.stats import binom

    return np.asarray(np.minimum(1.0, looks * binom.sf(inside - 1, total, share)))
