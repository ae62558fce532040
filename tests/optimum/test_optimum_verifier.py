"""Verification in full: which of the designs of a search is the best that holds."""

from __future__ import annotations

from pathlib import Path

import pytest
from optimum_cases import plan_of

from designer.optimum.optimise import MOST_VERIFIED, Verifier
from designer.optimum.plan import Values
from designer.optimum.search import Trial


def tried(values: Values) -> Trial:
    """Return a design that is better the further its first variable is to the left."""
    return Trial(values, 8.0 + 0.1 * values[0], 0.0, "")


def verified(folder: Path, holds_from: float, step: float = 0.05) -> Verifier:
    """Verify designs from 0 to 5 m, within -4 to 6 m, of which those far to the right hold."""

    def in_full(trial: Trial) -> float | None:
        return trial.value if trial.values[0] >= holds_from else None

    verifier = Verifier(plan_of(folder), in_full, lambda _: None)
    verifier.verify([tried((step * k, 10.0)) for k in range(round(5.0 / step))], tried)
    return verifier


@pytest.mark.parametrize("holds_from", [0.0, 0.33, 1.23, 4.81])
def test_the_best_that_holds_is_where_the_first_design_holds(
    tmp_path: Path, holds_from: float
) -> None:
    """Not only tried: the way to the last that fails is bisected, to a step of 0.01."""
    found = verified(tmp_path, holds_from)
    assert found.best is not None
    assert found.best.values[0] == pytest.approx(holds_from, abs=0.011)
    assert found.best.values[0] >= holds_from
    assert len(found.verified) <= MOST_VERIFIED
    assert all(trial.values[0] < holds_from for trial in found.failed)


@pytest.mark.parametrize("rank", [0, 1, 3])
def test_one_of_the_first_that_holds_is_found_in_a_handful(tmp_path: Path, rank: int) -> None:
    holds_from = 0.05 * rank - 1e-6

    def in_full(trial: Trial) -> float | None:
        return trial.value if trial.values[0] >= holds_from else None

    verifier = Verifier(plan_of(tmp_path), in_full, lambda _: None, most=10)
    verifier.verify([tried((0.05 * k, 10.0)) for k in range(100)], tried)
    assert verifier.best is not None
    assert verifier.best.values[0] == pytest.approx(0.05 * rank, abs=0.01)
    assert len(verifier.verified) <= 8


def test_a_better_design_among_those_that_fail_is_looked_for(tmp_path: Path) -> None:
    """It lies by itself, 0.3 m wide, where the ranks that are bisected pass it by."""

    def in_full(trial: Trial) -> float | None:
        x = trial.values[0]
        return trial.value if x >= 3.0 or 0.45 <= x <= 0.75 - 1e-9 else None

    verifier = Verifier(plan_of(tmp_path), in_full, lambda _: None)
    verifier.verify([tried((0.05 * k, 10.0)) for k in range(100)], tried)
    assert verifier.best is not None and verifier.best.values[0] < 0.75


def test_what_is_left_when_the_budget_is_used_up_is_counted(tmp_path: Path) -> None:
    verifier = Verifier(plan_of(tmp_path), lambda _: None, lambda _: None, most=8)
    ranked = [tried((0.5 * k - 4.0, 10.0)) for k in range(20)]
    verifier.verify(ranked, tried)
    assert verifier.best is None
    assert len(verifier.verified) == len(verifier.failed) == 4
    assert len(verifier.unverified(ranked)) == 16
