"""What is told of a quantity that is held against a limit."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from designer.selection.criteria import ROUNDING, Criterion

NAN = math.nan
AT_MOST = Criterion("a", "A", "a ≤ 4", "a test", "N", lambda _, __: np.empty(0), (4.0,), "at_most")
BAND = replace(AT_MOST, kind="outside", limits=(2.0, 8.0))
AT_LEAST, ABOVE = replace(AT_MOST, kind="at_least"), replace(AT_MOST, kind="above")


@pytest.mark.parametrize(
    ("criterion", "quantity", "demand", "capacity", "utilisation", "holds"),
    [
        (AT_MOST, 3.0, 3.0, 4.0, 0.75, True),
        (AT_MOST, 5.0, 5.0, 4.0, 1.25, False),
        (AT_MOST, 4.0 * (1.0 + 0.5 * ROUNDING), 4.0, 4.0, 1.0, True),
        (AT_LEAST, 5.0, 4.0, 5.0, 0.8, True),
        (AT_LEAST, 2.0, 4.0, 2.0, 2.0, False),
        (AT_LEAST, 0.0, 4.0, 0.0, math.inf, False),
        (AT_LEAST, 4.0 * (1.0 - 0.5 * ROUNDING), 4.0, 4.0, 1.0, True),
        (replace(AT_LEAST, has_ratio=False), 5.0, 4.0, 5.0, NAN, True),
        (ABOVE, 5.0, 4.0, 5.0, NAN, True),
        (ABOVE, 4.0, 4.0, 4.0, NAN, False),
        (BAND, 1.0, 1.0, 2.0, 0.5, True),
        (BAND, 16.0, 8.0, 16.0, 0.5, True),
        (BAND, 3.0, 3.0, 2.0, 1.5, False),
        (BAND, 6.0, 8.0, 6.0, 4.0 / 3.0, False),
    ],
)
def test_figures(
    criterion: Criterion,
    quantity: float,
    demand: float,
    capacity: float,
    utilisation: float,
    holds: bool,
) -> None:
    figures = criterion.figures(quantity)
    assert figures[:3] == pytest.approx((demand, capacity, utilisation), nan_ok=True)
    assert figures[3] is holds


def test_what_is_nearer_to_failing_is_more_severe() -> None:
    for criterion, better in ((AT_MOST, 3.0), (AT_LEAST, 5.0), (ABOVE, 5.0), (BAND, 1.0)):
        severity = criterion.severity(np.array([better, 4.0, NAN]))
        assert severity[0] < severity[1]
        assert np.isnan(severity[2])
