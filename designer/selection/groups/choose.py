"""Which product for which group of cables: propose the best, verify, cut off, propose again.

A mixed-integer programme proposes the assignment with the least mass (or cost) that nothing speaks
against yet. It is solved at the poses that have refuted others, then over the whole workspace, with
each cable's own figures. One that fails is cut off with all others that the same pose refutes (see
`designer.selection.groups.blocks`). First a linearisation of the tensions guides the proposals, to
find a good answer soon; then proposals go on without it, until none is left below that answer. So
the linearisation decides how fast the answer is found, and only cuts decide what it is.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from math import prod

import numpy as np

from designer.arrays import FloatArray
from designer.effects.design import AsBuilt
from designer.grades.grade import Grade
from designer.model.robot import Robot
from designer.model.workspace import Workspace
from designer.progress import SILENT, Reporter
from designer.selection.assignment import NOT_ASSIGNED, Assignment, GroupVerification
from designer.selection.candidate import Candidate, candidates_of, offered, priced, undominated
from designer.selection.groups.balance import balance_at, is_sound
from designer.selection.groups.blocks import block_by_trial, block_by_weight, is_monotone
from designer.selection.groups.master import Block, Combination, Guide, Master, alone
from designer.selection.groups.result import (
    GroupChoice,
    GroupObjective,
    Outcome,
    Proof,
    TriedAssignment,
)
from designer.selection.groups.trials import Refutation, Trials, verify_groups
from designer.study import CableGroup, Selection

MOST_PROPOSALS = 100
"""Where to stop and report a gap."""
_MOST_GUIDED = 30
"""Proposals with the linearisation: it is to find a good answer soon, not to prove it."""
_MOST_BALANCES = 6
"""Poses whose balance is in the programme: each makes it larger, and slower to solve."""
_MOST_TRIALS = 100_000
"""Of combinations at the witnesses, so that growing blocks does not take without end."""
_EQUAL = 1e-9
"""Relative difference in mass or cost that is rounding."""
_MOST_ROUNDS, _STILL = 6, 1e-4
"""Of choices with ropes whose stiffness depends on the tension: how many, and when it stays."""


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
        for _ in range(_MOST_ROUNDS):
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
            if abs(tension_N - before_N) <= _STILL * tension_N:
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
            self.master.cut(alone(combination))
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
        block = alone(combination)
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
            if block != alone(combination):
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
                    self.master.cut(alone(neighbour))
        return self.master.n_cuts - before

    def _is_no_better(self, combination: Combination) -> bool:
        """Tell whether the lengths at the far poses alone cost as much as what is known to hold."""
        if not (self.best.is_found and self.lengths_are_bounds):
            return False
        least = self._total(combination, self.trials.least_length_m(combination))
        return least >= self.best_total * (1.0 - _EQUAL)

    def _could_be_better(self, combination: Combination) -> bool:
        if not self.master.is_allowed(combination):
            return False
        return self.master.cost_of(combination) < self.best_total * (1.0 - _EQUAL)

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
