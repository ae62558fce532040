"""Proof that a candidate holds in all poses, in the load case that governs."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from designer.model.load_case import STATIC
from designer.progress import Advance
from designer.proof.prove import Budget, Proof, prove
from designer.selection.cases import CaseFound, governing
from designer.workspace.demand import rope_demand
from designer.workspace.refine import LIGHT, refine_over_branches


@dataclass(frozen=True, slots=True, eq=False)
class CaseProof:
    """What is proved of a candidate.

    Parameters
    ----------
    found : Proof
        The proof.
    load_case : str
        In which load case, with its direction; empty where the study has none.
    """

    found: Proof
    load_case: str


def prove_governing(
    cases: Sequence[CaseFound], budget: Budget, progress: Advance
) -> tuple[CaseProof, tuple[CaseFound, ...]]:
    """Prove that a cable holds in all poses, in the case and direction that ask for most.

    A pose that is worse than the one found before takes its place, after a search from there.

    Returns
    -------
    proof : CaseProof
        What is proved.
    cases : tuple of CaseFound
        The cases, with that pose.
    """
    most = governing(cases)
    one = most.loaded
    case = "" if one.case is STATIC else ", ".join(filter(None, (one.case.name, one.words)))
    reason = _why_not(most)
    if reason:
        off = Proof("off", found=most.utilisation, reason=reason)
        return CaseProof(off, case), tuple(cases)
    told = 0

    def tell(share: float) -> None:
        nonlocal told
        progress(int(100.0 * share) - told)
        told = int(100.0 * share)

    space = most.workspace.space
    proof = prove(one.robot, one.cable, space, most.utilisation, budget, progress=tell)
    if proof.worst is None:
        return CaseProof(proof, case), tuple(cases)
    place = proof.worst[: space.n_coordinates]
    used = proof.found
    if np.isfinite(used):
        demand_with = partial(rope_demand, one.robot, one.cable, most.workspace.hangs_below)
        worst = refine_over_branches(space, demand_with, place[None], LIGHT)[0]
        if worst.demand > used * one.cable.allowable_tension_N:
            place, used = worst.place, worst.demand / one.cable.allowable_tension_N
    met = replace(
        most.verification,
        worst_place=place,
        max_tension_N=used * one.cable.allowable_tension_N,
        utilisation=used,
    )
    better = replace(most, verification=met)
    proof = replace(proof, found=used, bound=max(proof.bound, used))
    return CaseProof(proof, case), tuple(better if o is most else o for o in cases)


def _why_not(most: CaseFound) -> str:
    """Return why nothing can be proved of a case; empty where something can."""
    if most.loaded.lost_cable is not None:
        return "what becomes of a platform that loses a cable is not enclosed"
    if most.loaded.keeps_lengths:
        return "what becomes of a platform on lengths that grow is not enclosed"
    if most.workspace.hangs_below == "exclude":
        return "poses are left out, and which ones depends on the rope"
    if not np.isfinite(most.utilisation):
        return "the rope does not hold"
    return ""
