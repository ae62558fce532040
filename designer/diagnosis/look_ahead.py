"""Which few effects promise most together, by slopes that were taken without any of them.

Effects that are added one by one may start with one that suits the average of two, and need others
to mend it. Slopes of all candidates at one place tell of every set of a few at little cost.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Sequence
from itertools import pairwise, product
from typing import NamedTuple

import numpy as np

from designer.arrays import FloatArray
from designer.diagnosis.statistics import beside, orthonormal
from designer.effects.effect import Effect, Setting

_WIDTH = 20
"""Sets of each size that another effect is added to. Of pairs all are looked at."""


class View(NamedTuple):
    """An effect where a fit may start: its values, the residual (n,) there, and slopes (n, p)."""

    setting: Setting
    residual: FloatArray
    slopes: FloatArray

    def moved(self, step: FloatArray) -> Setting:
        """Return the values after a step (p,), within bounds."""
        values = {
            p.name: float(np.clip(self.setting.values[p.name] + change, *p.bounds))
            for p, change in zip(self.setting.effect.parameters, step, strict=True)
        }
        return Setting(self.setting.effect, values)


class LinearModel:
    r"""How a residual changes with any set of effects, to first order.

    With r the residual without any of them, r_v that with effect v at its start, J the slopes and W
    the weights, a set leaves min over x of \|√W (r + Σ (r_v - r) + J x)\|², beside what is known.

    Parameters
    ----------
    views : sequence of View
        All effects at all starts, over the same n readings.
    residual : array (n,)
        Without any of them.
    known : array (n, p)
        Slopes of what is in the model anyway.
    weight : array (n,)
        Of each reading's square.
    """

    def __init__(
        self, views: Sequence[View], residual: FloatArray, known: FloatArray, weight: FloatArray
    ) -> None:
        self.views = views
        root = np.sqrt(weight)[:, None]
        sizes = [np.maximum(np.linalg.norm(view.slopes, axis=0), 1e-300) for view in views]
        slopes = [view.slopes / size for view, size in zip(views, sizes, strict=True)]
        shifts = [residual, *(view.residual - residual for view in views)]
        columns = root * np.column_stack([*shifts, *slopes])
        columns = beside(orthonormal(root * known), columns)
        self._products = columns.T @ columns
        ends = len(shifts) + np.cumsum([0, *map(len, sizes)])
        self._places = [np.arange(first, end) for first, end in pairwise(ends)]
        self._sizes = sizes

    @property
    def nothing(self) -> float:
        """What is left without any effect."""
        return float(self._products[0, 0])

    def step(self, members: Sequence[int]) -> tuple[float, FloatArray]:
        """Return what a set of views leaves at least, and the step to there, as scaled inside."""
        at = np.concatenate([self._places[k] for k in members])
        shifted = np.array([0, *(1 + k for k in members)])
        square = self._products[np.ix_(at, at)]
        square.flat[:: len(at) + 1] += 1e-9 * (np.trace(square) + 1e-9)
        pull = self._products[np.ix_(at, shifted)].sum(axis=1)
        step = -np.linalg.solve(square, pull)
        return float(self._products[np.ix_(shifted, shifted)].sum() + pull @ step), step

    def settings(self, members: Sequence[int]) -> tuple[Setting, ...]:
        """Return the values to which the step leads."""
        ends = np.cumsum([len(self._sizes[k]) for k in members])[:-1]
        pairs = zip(members, np.split(self.step(members)[1], ends), strict=True)
        return tuple(self.views[k].moved(step / self._sizes[k]) for k, step in pairs)


def best_sets(
    model: LinearModel,
    penalty: Callable[[Effect], float],
    present: Collection[Effect],
    most: int,
    count: int,
) -> list[tuple[Setting, ...]]:
    """Return the sets of effects of which a linear step promises most.

    Best first, after that step; without those present, and those that add one effect to them, which
    is what a search tries anyway. Of the present ones a step may promise what no fit reaches.

    Parameters
    ----------
    model : LinearModel
        What a set promises.
    penalty : callable
        What a set is to be better by for an effect.
    present : collection of Effect
        The set to replace, if any.
    most : int
        Effects in a set, at most.
    count : int
        Sets to return, at most.
    """
    effects = [view.setting.effect for view in model.views]
    own = frozenset(effect.key for effect in present)
    best: dict[frozenset[str], tuple[float, tuple[int, ...]]] = {}
    starts: list[tuple[int, ...]] = [()]
    for size in range(1, most + 1):
        reached: dict[tuple[int, ...], float] = {}
        for members, k in product(starts, range(len(effects))):
            keys = frozenset(effects[m].key for m in members)
            more = tuple(sorted((*members, k)))
            if effects[k].key in keys or more in reached:
                continue
            score = model.step(more)[0] + sum(penalty(effects[m]) for m in more)
            reached[more] = score
            name = keys | {effects[k].key}
            best[name] = min((score, more), best.get(name, (np.inf, ())))
        starts = sorted(reached, key=reached.__getitem__)[: None if size == 1 else _WIDTH]
    others = [
        promise
        for name, promise in best.items()
        if promise[0] < model.nothing and not (own <= name and len(name) <= len(own) + 1)
    ]
    return [model.settings(members) for _, members in sorted(others)[:count]]
