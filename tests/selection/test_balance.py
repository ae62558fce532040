"""Bounds on which the choice for groups rests, against catenaries; and what its programme tells."""

from __future__ import annotations

from typing import Any

import cvxpy as cp
import numpy as np
import pytest
from scipy.optimize import brentq

from designer.selection.groups import Master
from designer.selection.refutation import _least_moment_m2


def moment_of_catenary(X: float, D: float, c: float) -> float:
    """Moment about the exit point of an inextensible cable of unit weight; c = H / w.

    With x from the exit point and z downward, z = c cosh(x0 / c) - c cosh((x - x0) / c).
    """

    def drop(x0: float) -> float:
        return c * (np.cosh(x0 / c) - np.cosh((X - x0) / c))

    far = c * 20.0 + X
    x0 = brentq(lambda x0: drop(x0) - D, -far, far, xtol=1e-14 * far)
    x = np.linspace(0.0, X, 4001)
    return float(np.trapezoid(x * np.cosh((x - x0) / c), x))


@pytest.mark.parametrize("slope", [0.01, 0.1, 0.3, 1.0, 3.0])
def test_least_moment_is_below_that_of_every_cable_that_pulls_as_much(slope: float) -> None:
    X = 100.0
    D = slope * X
    for pull in (55.0, 60.0, 100.0, 300.0, 3000.0):
        least = float(_least_moment_m2(*map(np.array, (X, D, pull, 1.0))))
        for more in (1.0, 1.3, 3.0, 30.0):
            assert 0.0 <= least <= moment_of_catenary(X, D, more * pull)
    # Of a cable that is nearly straight, it is that of its chord.
    assert least == pytest.approx(0.5 * X * np.hypot(X, D), rel=0.05)


def test_least_moment_is_that_of_the_formula_where_it_is_proved() -> None:
    """m c = c X / 2 - sin α S, S = W X² / 8 H, W = w (X + D) / (1 - w X / 2 H)."""
    X, D, H, w = 30.0, 40.0, 90.0, 2.0
    weight = w * 70.0 / (1.0 - 60.0 / 180.0)
    area = weight * 900.0 / (8.0 * 90.0)
    expected = 0.5 * 50.0 * 30.0 - 0.8 * area
    assert float(_least_moment_m2(*map(np.array, (X, D, H, w)))) == pytest.approx(expected)
    assert float(_least_moment_m2(*map(np.array, (X, D, 29.0, w)))) == 0.0


@pytest.mark.filterwarnings("ignore:Solution may be inaccurate")
def test_a_programme_that_ends_without_an_answer_is_no_proof(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    solve = cp.Problem.solve

    def without_time(problem: cp.Problem, **options: Any) -> Any:
        options["highs_options"] = options["highs_options"] | {"time_limit": 0.0}
        return solve(problem, **options)

    master = Master(np.random.default_rng(0).uniform(1.0, 2.0, (6, 40)), 2)
    assert master.propose() is not None
    monkeypatch.setattr(cp.Problem, "solve", without_time)
    with pytest.raises(RuntimeError, match="mixed-integer solver ended with"):
        master.propose()
