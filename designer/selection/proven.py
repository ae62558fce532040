"""Proof that a candidate holds in all poses, in the load case that governs."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import partial

import numpy as np

from designer.model.load_case import STATIC
from designer.progress import Advance
from designer.proof.prove import Budget, Proof, prove
from designer.selection.cases import CaseResult, governing
from designer.workspace.demand import rope_demand
from designer.workspace.refine import LIGHT, refine


def prove_governing(
    cases: Sequence[CaseResult], budget: Budget, progress: Advance
) -> tuple[Proof, tuple[CaseResult, ...]]:
    """Prove that a cable holds in all poses, in the case and direction that ask for most.

    A pose that is worse than the one found before takes its place, after a search from there.

    Returns
    -------
    proof : Proof
        What is proved.
    cases : tuple of CaseResult
        The cases, with that pose.
    """
    worst = governing(cases)
    loaded, workspace = worst.loaded, worst.workspace
    words = (loaded.case.name, loaded.words)
    name = "" if loaded.case is STATIC else ", ".join(filter(None, words))
    reason = _why_not(worst)
    if reason:
        proof = Proof("off", found=worst.utilisation, reason=reason, load_case=name)
        return proof, tuple(cases)
    percent = 0

    def advance_to(share: float) -> None:
        nonlocal percent
        progress(int(100.0 * share) - percent)
        percent = int(100.0 * share)

    space, cable = workspace.space, loaded.cable
    proof = prove(loaded.robot, cable, space, worst.utilisation, budget, progress=advance_to)
    proof = replace(proof, load_case=name)
    if proof.worst is None:
        return proof, tuple(cases)
    place, utilisation = proof.worst[: space.n_coordinates], proof.found
    if np.isfinite(utilisation):
        demand = partial(rope_demand, loaded.robot, cable, workspace.hangs_below)
        refined = refine(space, demand, place[None], LIGHT)[0]
        if refined.demand > utilisation * cable.allowable_tension_N:
            place, utilisation = refined.place, refined.demand / cable.allowable_tension_N
    verification = replace(
        worst.verification,
        worst_place=place,
        max_tension_N=utilisation * cable.allowable_tension_N,
        utilisation=utilisation,
    )
    worse = replace(worst, verification=verification)
    proof = replace(proof, found=utilisation, bound=max(proof.bound, utilisation))
    return proof, tuple(worse if case is worst else case for case in cases)


def _why_not(result: CaseResult) -> str:
    """Return why nothing can be proved of a case; empty where something can."""
    if result.loaded.lost_cable is not None:
        return "what becomes of a platform that loses a cable is not enclosed"
    if result.loaded.keeps_lengths:
        return "what becomes of a platform on lengths that grow is not enclosed"
    if result.workspace.hangs_below == "exclude":
        return "poses are left out, and which ones depends on the rope"
    if not np.isfinite(result.utilisation):
        return "the rope does not hold"
    return ""
