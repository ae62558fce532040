"""The small linear programmes against SciPy's."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import linprog

from designer.kernel.compiling import kernel
from designer.kernel.simplex import (
    INFEASIBLE,
    OPTIMAL,
    choose_basis,
    maximise,
    new_programme,
    rebuild,
)

pytestmark = pytest.mark.slow  # compiles the solver for the tests alone


@kernel
def solve(table, room, room_slope, again):
    """Solve once, and once more from the basis that was found."""
    m, n = table.shape[0], table.shape[1] - 2
    lp = new_programme(m, n)
    lp.room[:] = room
    lp.room_slope[:] = room_slope
    lp.table[:] = table
    if not choose_basis(lp):
        return -1, lp.z, lp.dual
    status = maximise(lp)
    if again and status == 0:
        lp.table[:] = table
        rebuild(lp)
        status = maximise(lp)
    return status, lp.z, lp.dual


def expected(table, room, room_slope):
    """Return status and optimum of SciPy: unknowns z, then s."""
    n = len(room)
    answer = linprog(
        -np.eye(n + 1)[n],
        A_ub=np.hstack([np.eye(n), -room_slope[:, None]]),
        b_ub=room,
        A_eq=table[:, :-1],
        b_eq=table[:, -1],
        bounds=[(0, None)] * n + [(None, None)],
    )
    return answer.status, answer.x


@pytest.mark.parametrize("couples", [False, True])
@pytest.mark.parametrize(("m", "n"), [(2, 3), (3, 4), (6, 7), (6, 8), (3, 8)])
def test_programmes_are_solved_like_scipys(m, n, couples) -> None:
    rng = np.random.default_rng([m, n, couples])
    found = {OPTIMAL: 0, INFEASIBLE: 0}
    for trial in range(200):
        table = rng.normal(size=(m, n + 2))
        room = rng.uniform(0.5, 2.0, n)
        slope = -rng.uniform(0.0, 0.5, n) if couples else np.zeros(n)
        if trial % 2:  # there is a solution
            table[:, -1] = table[:, :-1] @ np.append(room * rng.uniform(0.2, 0.6, n), 0.1)
        status, z, _ = solve(table, room, slope, True)
        there, x = expected(table, room, slope)
        if there == 0:
            # It may give up where rooms close at the optimum; the interior point then takes over.
            if status == OPTIMAL:
                assert z[n] == pytest.approx(x[n], rel=1e-7, abs=1e-7)
                assert np.abs(table[:, :-1] @ z - table[:, -1]).max() < 1e-8 * np.abs(z).max()
                assert np.all(z[:n] > -1e-9)
                assert np.all(z[:n] < room + slope * z[n] + 1e-9)
                found[OPTIMAL] += 1
        elif there == 2:
            assert status != OPTIMAL
            found[INFEASIBLE] += 1
    assert found[OPTIMAL] > 50
    assert found[OPTIMAL] + found[INFEASIBLE] > (160 if couples else 195)


def test_duals_are_the_change_of_the_optimum_with_the_bounds() -> None:
    rng = np.random.default_rng(5)
    table, room, slope = rng.normal(size=(6, 10)), rng.uniform(0.5, 2.0, 8), np.zeros(8)
    _, z, dual = solve(table, room, slope, False)
    for j in range(8):
        moved = room.copy()
        moved[j] += 1e-6
        change = (solve(table, moved, slope, False)[1][8] - z[8]) / 1e-6
        assert change == pytest.approx(-min(dual[j], 0.0), abs=1e-6)


def test_dependent_rows_are_told() -> None:
    table = np.ones((3, 6))
    assert solve(table, np.ones(4), np.zeros(4), False)[0] == -1


def test_a_goal_that_no_equation_contains_is_told() -> None:
    """The rows are independent, but s is in none of them: it has no bound."""
    table = np.random.default_rng(3).normal(size=(3, 6))
    table[:, 4] = 0.0
    assert solve(table, np.ones(4), np.zeros(4), False)[0] == -1
