"""Two effects are found together where one that suits the average of both is better than either."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from designer.diagnosis.fit import StartingPoint
from designer.diagnosis.search import LinearModel, best_sets
from designer.effects.effect import Setting


def view(key: str, residual, slopes) -> StartingPoint:
    names = [f"p{k}" for k in range(slopes.shape[1])]
    parameters = tuple(SimpleNamespace(name=name, bounds=(-1e6, 1e6)) for name in names)
    effect = SimpleNamespace(key=key, parameters=parameters)
    return StartingPoint(Setting(effect, dict.fromkeys(names, 0.5)), residual, slopes)


def test_what_a_set_leaves_is_that_of_weighted_least_squares() -> None:
    rng = np.random.default_rng(71)
    residual, weight, known = (
        rng.normal(size=40),
        rng.uniform(0.2, 1.0, 40),
        rng.normal(size=(40, 2)),
    )
    views = [
        view(str(p), residual + rng.normal(size=40), rng.normal(size=(40, p))) for p in (1, 3, 2)
    ]
    model = LinearModel(views, residual, known, weight)
    root = np.sqrt(weight)
    start = views[0].residual + views[1].residual - residual
    columns = np.hstack([views[0].slopes, views[1].slopes, known]) * root[:, None]
    step, (left,), *_ = np.linalg.lstsq(columns, -root * start, rcond=None)
    assert model.step((0, 1))[0] == pytest.approx(left, rel=1e-6)
    reached = [value for s in model.settings((0, 1)) for value in s.values.values()]
    assert reached == pytest.approx(0.5 + step[:4], abs=1e-6)


def test_a_pair_is_best_though_another_is_better_than_each_of_it() -> None:
    rng = np.random.default_rng(72)
    first, second, between, *others = np.linalg.qr(rng.normal(size=(60, 9)))[0].T
    residual = 30.0 * (first + second)
    columns = {"first": first, "second": second, "average": first + second + 0.5 * between}
    columns |= {f"other {k}": column for k, column in enumerate(others)}
    views = [view(key, residual, column[:, None]) for key, column in columns.items()]
    model = LinearModel(views, residual, np.empty((60, 0)), np.ones(60))

    def best_beside(*present: str) -> list[set[str]]:
        own = [v.setting.effect for v in views if v.setting.effect.key in present]
        sets = best_sets(model, lambda _: 2.0, own, 2, 4)
        return [{setting.effect.key for setting in together} for together in sets]

    assert best_beside("average")[0] == {"first", "second"}
    assert {"first", "second"} not in best_beside("first", "second")
    assert best_beside()[0] == {"first", "second"}
    assert {"average"} not in best_beside()  # which adds one to none
