r"""Which product for which group of cables: propose the best, verify, cut off, propose again.

A mixed-integer programme proposes the assignment with the least mass (or cost) that nothing speaks
against yet. It is solved at the poses that have refuted others, then over the whole workspace, with
each cable's own figures. One that fails is cut off with all others that the same pose refutes (see
`designer.selection.refutation`). First a linearisation of the tensions guides the proposals, to
find a good answer soon; then proposals go on without it, until none is left below that answer. So
the linearisation decides how fast the answer is found, and only cuts decide what it is.

In the programme x_gp is one where group g gets product p, y_p where product p is used at all:

.. math::

    \min \sum_{gp} c_{gp} x_{gp}, \quad \sum_p x_{gp} = 1, \quad x_{gp} \le y_p, \quad
    \sum_p y_p \le K

A cut is a block: of each group a set of products B_g, all of whose combinations are out, so Σ_g
Σ_{p ∈ B_g} x_gp ≤ G - 1. A balance excludes what cannot hold a pose by statics alone, see
`designer.selection.refutation`. A guide is a linear constraint that is only believed.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from math import prod
from typing import ClassVar, Literal

import numpy as np

from designer.arrays import FloatArray, IntArray
from designer.effects.design import AsBuilt
from designer.grades.grade import Grade
from designer.model.robot import Robot
from designer.model.workspace import Workspace
from designer.progress import SILENT, Reporter
from designer.selection.assignment import NOT_ASSIGNED, Assignment, GroupVerification
from designer.selection.candidate import Candidate, candidates_of, offered, priced, undominated
from designer.selection.refutation import (
    Balance,
    Block,
    Combination,
    Refutation,
    Trials,
    balance_at,
    block_by_trial,
    block_by_weight,
    is_monotone,
    is_sound,
    singleton_block,
    verify_groups,
)
from designer.spelling import digits
from designer.study import CableGroup, Selection

MOST_PROPOSALS = 100
"""Where to stop and report a gap."""
_MOST_GUIDED = 30
"""Proposals with the linearisation: it is to find a good answer soon, not to prove it."""
_MOST_BALANCES = 6
"""Poses whose balance is in the programme: each makes it larger, and slower to solve."""
_MOST_TRIALS = 100_000
"""Of combinations at the witnesses, so that growing blocks does not take without end."""
_ROUNDING = 1e-9
"""Relative difference in mass or cost that is rounding."""
_MAX_ITERATIONS, _TENSION_RTOL = 6, 1e-4
"""Of choices with ropes whose stiffness depends on the tension: how many, and when it stays."""
Outcome = Literal["holds", "fails", "not_better"]
"""``not_better`` than what was known to hold."""
Proof = Literal["optimal", "stopped", "infeasible"]
"""``stopped`` at the limit of proposals."""
GroupObjective = Literal["mass", "cost"]
Guide = tuple[FloatArray, float]
"""Coefficients (n_groups, n_products) of x, and what their sum may reach."""


@dataclass(frozen=True, slots=True, eq=False)
class TriedAssignment:
    """An assignment that was tried."""

    products: tuple[Candidate, ...] = field(
        metadata={"json": lambda ropes: {"products": [rope.ids for rope in ropes]}}
    )  #: of each group
    bound: float
    """Mass or cost that it cannot fall below: straight cables stretched as far as they may be."""
    total: float | None  #: with the lengths that it needs; None where that was not computed
    outcome: Outcome
    group: CableGroup | None = field(
        metadata={"json": lambda group: {"group": group and group.name}}
    )  #: that is used most; None where its loads decided nothing
    utilisation: float | None  #: of that group
    place: FloatArray | None = field(metadata={"json": "pose"})  #: where (n_coordinates,) [m, rad]
    excluded: int  #: how many assignments the cut excludes, the proposal among them
    guided: bool  #: whether the linearisation had a say in it


@dataclass(frozen=True, slots=True, eq=False)
class GroupChoice:
    """How ropes for groups of cables were sought, and what is proved of the best."""

    groups: tuple[CableGroup, ...] = field(metadata={"json": None})
    most_distinct: int = field(metadata={"json": "max_distinct_products"})
    chosen: Assignment = field(
        metadata={"json": lambda chosen: {"total_mass_kg": chosen.total_mass_kg}}
    )  #: the lightest (or cheapest) that holds; without ropes if none was found
    total: float | None  #: what was minimised, of that: mass, or the cost of the lengths it needs
    single: Assignment = field(
        metadata={"json": lambda single: {"single_product_mass_kg": single.total_mass_kg}}
    )  #: the lightest product for all groups; without ropes where the selection found none
    objective: GroupObjective
    unit: str  #: of the objective: ``kg``, or a currency
    bound: float  #: no assignment of what was offered that holds has less of it
    proof: Proof
    by_balance: bool = field(metadata={"json": None})
    """Whether the balance of poses excluded assignments (`designer.selection.refutation`)."""
    by_weight: bool = field(metadata={"json": None})
    """Whether cuts were proved by weight, else by trial."""
    lengths_are_bounds: bool = field(metadata={"json": None})
    """Whether the bound's lengths cannot be undercut; not so where poses are left out."""
    offered: int  #: products that no other one beats
    catalogued: int = field(metadata={"json": None})  #: all of them
    proposals: tuple[TriedAssignment, ...]  #: what was tried, in order
    trials: int  #: how many times cables were solved at the witnesses

    also_in_files: ClassVar = ("bound_kg", "gap", "proof_sentence", "saving_kg")

    @property
    def bound_kg(self) -> float | None:
        """The bound where it is one on the mass [kg]."""
        return self.bound if self.objective == "mass" else None

    @property
    def gap(self) -> float | None:
        """What was minimised over the bound on it, less one; None if nothing was found."""
        return None if self.total is None else self.total / self.bound - 1.0

    @property
    def proof_sentence(self) -> str:
        """What is proved, and on what condition, for the reader of a report."""
        kind = "cheaper" if self.objective == "cost" else "lighter"
        of = f"the {self.offered} products that no other one beats, out of {self.catalogued},"
        if self.proof == "infeasible":
            return f"No assignment of {of} holds the whole workspace."
        if self.proof == "stopped":
            count = len(self.proposals)
            if not self.chosen.is_found:
                return f"Stopped after {count} proposals, none of which holds."
            return (
                f"Stopped after {count} proposals: no assignment of {of} that holds has less than "
                f"{digits(self.bound)} {self.unit}, so one may be {kind} by up to {self.gap:.2%}."
            )
        means = "by poses that the solver showed they cannot hold"
        if self.by_weight:
            means += ", where heavier company of an overloaded cable does not help it"
        if self.by_balance:
            means += ", by the balance of forces in a pose"
        text = (
            f"No assignment of {of} is {kind} and holds. "
            f"All that would be were excluded {means}, or by the lengths that they need."
        )
        if not self.lengths_are_bounds:
            text += (
                " This is for the lengths of the first answer: which poses count, and so how "
                "long a cable must be, depends on the cables themselves."
            )
        return text

    @property
    def saving_kg(self) -> float | None:
        """What the groups save against one product for all cables [kg]."""
        if not (self.chosen.is_found and self.single.is_found):
            return None
        return self.single.total_mass_kg - self.chosen.total_mass_kg


# The programme


@dataclass(slots=True, eq=False)
class Master:
    """The programme and its cuts."""

    cost: FloatArray
    """(n_groups, n_products) what each product would add to the objective on each group."""
    most_distinct: int  #: how many different products there may be
    balances: list[Balance] = field(default_factory=list)
    """Of the poses that have refuted assignments."""
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


# The search


def choose_groups(
    robot: Robot,
    workspace: Workspace,
    groups: Sequence[CableGroup],
    products: Sequence[Candidate],
    *,
    most_distinct: int | None = None,
    objective: GroupObjective = "mass",
    single: Candidate | None = None,
    progress: Callable[[], None] = lambda: None,
    most_proposals: int = MOST_PROPOSALS,
) -> GroupChoice:
    """Choose a product for each group of cables, of which every cable is in exactly one.

    Parameters
    ----------
    most_distinct : int, optional
        How many different products there may be; one for each group if left out.
    objective : str
        ``mass``, or ``cost`` of the products that have a price.
    single : Candidate, optional
        The best product for all cables together: where the search starts from.
    progress : callable
        Called after each proposal.
    """
    by_price = objective == "cost"
    products = priced(products) if by_price else tuple(products)
    offered = undominated(products, by_price=by_price)
    if single is not None and single not in offered:
        offered = (*offered, single)
    distinct = min(most_distinct or len(groups), len(groups))
    search = _GroupSearch(robot, workspace, groups, offered, distinct, by_price, progress)
    if offered:
        search.start(single)
        search.run(most_proposals)
    return GroupChoice(
        groups=tuple(groups),
        most_distinct=distinct,
        chosen=search.best,
        total=search.best_total if search.best.is_found else None,
        single=search.single,
        objective=objective,
        unit=(products[0].grade.currency or "") if by_price and products else "kg",
        bound=search.bound,
        proof=search.proof,
        by_balance=search.has_balances,
        by_weight=search.by_weight,
        lengths_are_bounds=search.lengths_are_bounds,
        offered=len(offered),
        catalogued=len(products),
        proposals=tuple(search.proposals),
        trials=search.trials.count,
    )


def choose_groups_of(
    workspace: Workspace,
    selection: Selection,
    grades: Sequence[Grade],
    built: AsBuilt,
    single: Candidate | None,
    reporter: Reporter = SILENT,
) -> GroupChoice:
    """Choose a product for each group of a study, among the grades that it allows.

    Cost is minimised where it is the first objective, mass otherwise; ``selection.grades`` narrows
    the catalogue; ``single`` is the best product for all cables.

    A rope whose stiffness depends on its tension has that at the largest tension of any group, so
    that all assignments are compared with the same ropes: the choice is made again until the
    tension that it meets stays.
    """
    catalogued = candidates_of(selection, offered(grades, selection), built)
    tension_N = math.nan if single is None else single.verification.max_tension_N
    with reporter.task("groups", MOST_PROPOSALS) as advance:
        for _ in range(_MAX_ITERATIONS):
            products = [replace(c, cable=c.cable.at_tension(tension_N)) for c in catalogued]
            is_single = (c for c in products if single and c.size is single.size)
            choice = choose_groups(
                built.robot,
                workspace,
                selection.groups,
                products,
                most_distinct=selection.max_distinct_products,
                objective="cost" if selection.objectives[0] == "cost" else "mass",
                single=next(is_single, None),
                progress=lambda: advance(1),
            )
            chosen, before_N = choice.chosen, tension_N
            if all(rope.cable.stiffening is None for rope in chosen.ropes):
                break
            tension_N = chosen.max_tension_N
            if abs(tension_N - before_N) <= _TENSION_RTOL * tension_N:
                break
    return choice


class _GroupSearch:
    """The state of the search; see the module."""

    def __init__(
        self,
        robot: Robot,
        workspace: Workspace,
        groups: Sequence[CableGroup],
        products: tuple[Candidate, ...],
        most_distinct: int,
        by_price: bool,
        progress: Callable[[], None],
    ) -> None:
        self.robot, self.workspace, self.products = robot, workspace, products
        self.members = [np.array(group.cables, dtype=np.int64) - 1 for group in groups]
        self.trials = Trials(robot, workspace, products, self.members)
        self.by_weight = is_monotone(robot, workspace)
        self.per_metre = np.array(  # what a metre adds to the objective
            [
                (c.size.price_per_m or 0.0) if by_price else c.cable.rope_density_kg_per_m
                for c in products
            ]
        )
        # Blocks by weight exclude as much, and a programme without balances is solved faster.
        self.has_balances = is_sound(robot, workspace) and not self.by_weight
        self.lengths_are_bounds = workspace.hangs_below == "include"
        self.master = Master(self._least_cost(self.trials.reach_m), most_distinct)
        self.progress = progress
        self.groups = tuple(groups)
        self.best, self.best_total = NOT_ASSIGNED, np.inf
        self.single = NOT_ASSIGNED
        self.bound = np.inf
        self.proof: Proof = "infeasible"
        self.proposals: list[TriedAssignment] = []
        self._guides: list[Guide] = []
        self._settled: set[Combination] = set()

    def start(self, single: Candidate | None) -> None:
        """Verify one product for all cables: the given one, or else the strongest."""
        strength = [candidate.cable.allowable_tension_N for candidate in self.products]
        at = int(np.argmax(strength)) if single is None else self.products.index(single)
        combination = (at,) * len(self.members)
        verification = self._verified(combination)
        if not self.lengths_are_bounds and verification.longest_m.all():
            # Which samples count depends on the cables; those of the first answer are a fair guess.
            cost = self._least_cost(verification.longest_m)
            self.master = Master(cost, self.master.most_distinct)
        self._guide(combination)
        if verification.holds:
            self.master.cut(singleton_block(combination))
            self.best = self._assigned(combination, verification)
            self.best_total = self._total(combination, verification.longest_m)
            self.single = self.best if single is not None else NOT_ASSIGNED

    def run(self, most_proposals: int) -> None:
        """Propose with the linearisation while it leads to something better, then without."""
        while len(self.proposals) < min(_MOST_GUIDED, most_proposals):
            combination = self.master.propose(self._guides)
            if combination is None or not self._could_be_better(combination):
                break
            outcome = self._examine(combination, guided=True)
            if outcome == "not_better":
                break
            if outcome == "fails":
                self._guide(combination)
        while True:
            combination = self.master.propose()
            if combination is None or not self._could_be_better(combination):
                self.proof = "optimal" if self.best.is_found else "infeasible"
                self.bound = self.best_total
                return
            self.bound = min(self.master.cost_of(combination), self.best_total)
            if len(self.proposals) >= most_proposals:
                self.proof = "stopped"
                return
            self._examine(combination, guided=False)

    def _examine(self, combination: Combination, *, guided: bool) -> Outcome:
        """Try a proposal, cut it off with what fails with it, and note it."""
        total: float | None = None
        outcome: Outcome = "fails"
        block = singleton_block(combination)
        worst = self.trials.refutation(combination)
        if worst is None and self._is_no_better(combination):
            outcome = "not_better"
        elif worst is None:
            verification = self._verified(combination)
            group = int(np.argmax(verification.utilisation))
            worst = Refutation(
                group, float(verification.utilisation[group]), verification.worst_place[group]
            )
            if verification.holds:
                total = self._total(combination, verification.longest_m)
                outcome = "holds" if total < self.best_total else "not_better"
                if outcome == "holds":
                    self.best, self.best_total = self._assigned(combination, verification), total
        if worst is not None and outcome == "fails":
            block = self._block(combination, worst.group)
        self.master.cut(block)
        excluded = prod(len(products) for products in block)
        if not guided and excluded == 1:
            excluded += self._cut_beside(combination)
        note = TriedAssignment(
            products=tuple(self.products[p] for p in combination),
            bound=self.master.cost_of(combination),
            total=total,
            outcome=outcome,
            group=self.groups[worst.group] if worst else None,
            utilisation=worst.utilisation if worst else None,
            place=worst.place if worst else None,
            excluded=excluded,
            guided=guided,
        )
        self.proposals.append(note)
        self.progress()
        return outcome

    def _block(self, combination: Combination, culprit: int) -> Block:
        """Return what fails with a combination, in which a group is too weak."""
        if self.by_weight:
            block = block_by_weight(self.trials, combination, culprit)
            if block != singleton_block(combination):
                return block
        room = min(300, _MOST_TRIALS - self.trials.count)  # for one block
        return block_by_trial(self.trials, combination, culprit, self._could_be_better, room)

    def _cut_beside(self, combination: Combination) -> int:
        """Cut off those that differ in one group and cannot be the answer; return how many."""
        before = self.master.n_cuts
        for g in range(len(combination)):
            for p in range(len(self.products)):
                neighbour = (*combination[:g], p, *combination[g + 1 :])
                if p == combination[g] or neighbour in self._settled:
                    continue
                if not self._could_be_better(neighbour) or self.trials.count > _MOST_TRIALS:
                    continue
                if self.trials.is_refuted(neighbour) or self._is_no_better(neighbour):
                    self._settled.add(neighbour)
                    self.master.cut(singleton_block(neighbour))
        return self.master.n_cuts - before

    def _is_no_better(self, combination: Combination) -> bool:
        """Tell whether the lengths at the far poses alone cost as much as what is known to hold."""
        if not (self.best.is_found and self.lengths_are_bounds):
            return False
        least = self._total(combination, self.trials.least_length_m(combination))
        return least >= self.best_total * (1.0 - _ROUNDING)

    def _could_be_better(self, combination: Combination) -> bool:
        if not self.master.is_allowed(combination):
            return False
        return self.master.cost_of(combination) < self.best_total * (1.0 - _ROUNDING)

    def _verified(self, combination: Combination) -> GroupVerification:
        """Solve the whole workspace, and remember the worst places of a combination."""
        cables = self.trials.cables(combination)
        verification = verify_groups(self.robot, self.workspace, cables, self.members)
        places = verification.worst_place
        self.trials.add_witnesses(places)
        for place in places[np.isfinite(places).all(axis=1)] if self.has_balances else ():
            balance = balance_at(self.robot, place, self.products, self.members)
            if balance is not None and len(self.master.balances) < _MOST_BALANCES:
                self.master.balances.append(balance)
        return verification

    def _guide(self, combination: Combination) -> None:
        """Add the linearised tension of each cable, where it is used most, as a guide."""
        load, slope = self.trials.slopes(combination)
        weight = np.array([candidate.cable.weight_N_per_m for candidate in self.products])
        allowable = np.array([candidate.cable.allowable_tension_N for candidate in self.products])
        for g, cables in enumerate(self.members):
            for c in cables:
                solved = np.isfinite(load.utilisation[:, c])
                at = int(np.argmax(np.where(solved, load.utilisation[:, c], -np.inf)))
                slopes = slope[:, at, c]
                if not np.isfinite(slopes).all():
                    continue
                row = slopes[:, None] * weight
                row[g] -= allowable
                there_N = float(slopes @ weight[list(combination)])
                self._guides.append((row, there_N - float(load.tension_N[at, c])))

    def _least_cost(self, reach_m: FloatArray) -> FloatArray:
        """Return what each product costs on each group at the least, (n_groups, n_products)."""
        strain = np.array([candidate.largest_strain for candidate in self.products])
        reach = np.array([reach_m[cables].sum() for cables in self.members])
        return np.asarray(reach[:, None] * (self.per_metre / (1.0 + strain)))

    def _assigned(self, combination: Combination, verification: GroupVerification) -> Assignment:
        return Assignment(self.groups, tuple(self.products[p] for p in combination), verification)

    def _total(self, combination: Combination, length_m: FloatArray) -> float:
        pairs = zip(self.members, combination, strict=True)
        return float(sum(self.per_metre[p] * length_m[cables].sum() for cables, p in pairs))
