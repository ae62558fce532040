r"""The lightest assignment that no cut forbids: a mixed-integer programme.

x_gp is one where group g gets product p, y_p where product p is used at all:

.. math::

    \min \sum_{gp} c_{gp} x_{gp}, \quad \sum_p x_{gp} = 1, \quad x_{gp} \le y_p, \quad
    \sum_p y_p \le K

A cut is a block: of each group a set of products B_g, all of whose combinations are out, so
Σ_g Σ_{p ∈ B_g} x_gp ≤ G - 1. A balance excludes what cannot hold a pose by statics alone, see
`designer.selection.groups.balance`. A guide is a linear constraint that is only believed.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from designer.arrays import FloatArray, IntArray
from designer.selection.groups.balance import Balance

Combination = tuple[int, ...]
"""Of each group the index of its rope among those on offer."""

Block = tuple[frozenset[int], ...]
"""Of each group a set of products."""

Guide = tuple[FloatArray, float]
"""Coefficients (n_groups, n_products) of x, and what their sum may reach."""


def alone(combination: Combination) -> Block:
    """Return the block of this combination and no other."""
    return tuple(frozenset({p}) for p in combination)


@dataclass(slots=True, eq=False)
class Master:
    """The programme and its cuts."""

    # (n_groups, n_products): What each product would add to the objective on each group
    cost: FloatArray
    most_distinct: int  # How many different products there may be
    # Of the poses that have refuted assignments
    balances: list[Balance] = field(default_factory=list)
    _cuts: list[IntArray] = field(default_factory=list)

    @property
    def n_cuts(self) -> int:
        """How many blocks are forbidden."""
        return len(self._cuts)

    def cost_of(self, combination: Combination) -> float:
        """Return the objective of a combination."""
        return float(sum(self.cost[g, p] for g, p in enumerate(combination)))

    def is_allowed(self, combination: Combination) -> bool:
        """Tell whether an assignment has few enough products."""
        return len(set(combination)) <= self.most_distinct

    def cut(self, block: Block) -> None:
        """Forbid every combination of a block."""
        n_products = self.cost.shape[1]
        terms = [g * n_products + p for g, products in enumerate(block) for p in products]
        self._cuts.append(np.array(terms, dtype=np.int64))

    def propose(self, guides: Sequence[Guide] = ()) -> Combination | None:
        """Return the cheapest assignment that neither a cut nor a guide forbids, if any.

        Solved to optimality by HiGHS, Huangfu and Hall, Math. Prog. Comp. 10 (2018) 119-142.

        Raises
        ------
        RuntimeError
            If HiGHS ends without an answer.
        """
        import cvxpy as cp
        from scipy import sparse

        n_groups, n_products = self.cost.shape
        x = cp.Variable(n_groups * n_products, boolean=True)
        scale = float(self.cost.max())
        of_group = sparse.kron(sparse.eye_array(n_groups), np.ones((1, n_products))).tocsr()
        constraints = [of_group @ x == 1]
        if self.most_distinct < n_groups:
            y = cp.Variable(n_products)
            every = sparse.kron(np.ones((n_groups, 1)), sparse.eye_array(n_products)).tocsr()
            constraints += [x <= every @ y, y <= 1, cp.sum(y) <= self.most_distinct]
        if self._cuts:
            terms = np.concatenate(self._cuts)
            ends = np.concatenate([[0], np.cumsum([len(cut) for cut in self._cuts])])
            shape = (len(self._cuts), self.cost.size)
            rows = sparse.csr_array((np.ones(len(terms)), terms, ends), shape=shape)
            constraints.append(rows @ x <= n_groups - 1)
        constraints += [
            *(constraint for balance in self.balances for constraint in balance.constraints(x)),
            *((row.ravel() / abs(bound)) @ x <= bound / abs(bound) for row, bound in guides),
        ]
        problem = cp.Problem(cp.Minimize((self.cost.ravel() / scale) @ x), constraints)
        exact = {"mip_rel_gap": 0.0, "mip_abs_gap": 0.0}
        problem.solve(solver=cp.HIGHS, highs_options=exact)
        if problem.status in {"infeasible", "infeasible_or_unbounded"}:
            return None
        if problem.status != "optimal":
            raise RuntimeError(f"the mixed-integer solver ended with {problem.status}")
        best = np.asarray(x.value).reshape(n_groups, n_products).argmax(axis=1)
        return tuple(int(p) for p in best)
