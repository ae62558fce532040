"""From one assignment that fails to a block of them: the larger, the fewer have to be tried.

**By weight.** Three cables on a point mass, exit points above it. In a pose the horizontal forces
on it are λ h_i with h fixed by geometry, since three vectors in a plane balance in one ratio only;
λ follows from Σ V_i = m g, V_i being the pull of cable i upward. On Irvine's catenary V_i rises
with H_i = λ h_i, falls as the cable gets heavier and falls as it gets stiffer. So λ, and with it
every H_i, rises with the weight and the stiffness of any cable; and the largest tension of a given
cable rises with its H_i as long as it does not hang below the platform. Hence: what overloads a
cable there overloads it with all others as heavy and as stiff, or more so. One solve at the
lightest corner of a block proves the block.

**By trial.** Any other robot: every assignment of the block is solved and fails, but for those
that would not be cheaper than what is known to hold.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from itertools import product
from math import prod

import numpy as np

from designer.model.cable import Cable
from designer.model.robot import Robot
from designer.model.workspace import Workspace
from designer.selection.groups.master import Block, Combination, alone
from designer.selection.groups.trials import Trials


def is_monotone(robot: Robot, workspace: Workspace) -> bool:
    """Tell whether blocks may be proved by weight.

    A pose that is left out when a cable hangs lower would break the argument, and so would exit
    points that move along pulleys, and a wrench that pulls sideways.
    """
    return (
        robot.is_point_mass
        and robot.degrees_of_freedom == robot.n_cables == 3
        and not robot.platform.wrench_N.any()
        and robot.pulley_radius_m == 0.0
        and workspace.hangs_below == "include"
    )


def block_by_weight(trials: Trials, combination: Combination, culprit: int) -> Block:
    """Return the block of a failing combination, see the module; it alone, if nothing is proved."""
    corner = [trials.products[p].cable for p in combination]
    company = [g for g in range(len(corner)) if g != culprit]
    proved = (g for g in (culprit, *company) if _overloads(trials, corner, g))
    culprit = next(proved, -1)
    if culprit < 0:
        return alone(combination)
    for g in range(len(corner)):
        if g != culprit:
            corner = _lowered(trials, corner, g, culprit)

    def at_least(cable: Cable) -> frozenset[int]:
        return frozenset(
            p
            for p, candidate in enumerate(trials.products)
            if candidate.cable.linear_density_kg_per_m >= cable.linear_density_kg_per_m
            and candidate.cable.axial_stiffness_N >= cable.axial_stiffness_N
        )

    sets = [at_least(cable) for cable in corner]
    sets[culprit] = frozenset(
        p
        for p, candidate in enumerate(trials.products)
        if p == combination[culprit]
        or _overloads(trials, _with(corner, culprit, candidate.cable), culprit)
    )
    return tuple(sets)


def _overloads(trials: Trials, of_groups: Sequence[Cable], culprit: int) -> bool:
    """Tell whether a witness shows, by the argument on weight, that the group is too weak."""
    load = trials.load(trials.on_groups(of_groups))
    cables = trials.members[culprit]
    utilisation, hangs = load.utilisation[:, cables], load.hangs[:, cables]
    counts = np.isfinite(utilisation) & ~hangs & trials.stands_above()[:, None]
    return bool((counts & (utilisation > 1.0)).any())


def _lowered(trials: Trials, corner: list[Cable], g: int, culprit: int) -> list[Cable]:
    """Return the corner with group g as light and as soft as the argument reaches."""
    softest = min(candidate.cable.axial_stiffness_N for candidate in trials.products)
    soft = _with(corner, g, replace(corner[g], axial_stiffness_N=softest))
    corner = soft if _overloads(trials, soft, culprit) else corner
    weights = sorted({candidate.cable.mean_density_kg_per_m for candidate in trials.products})
    low = 0
    high = int(np.searchsorted(weights, corner[g].mean_density_kg_per_m))
    for _ in range(8):
        if low >= high:
            break
        # The lightest first: as a rule the product is too weak whatever the others weigh.
        middle = low if high == len(weights) or low == 0 else (low + high) // 2
        lighter = replace(corner[g], linear_density_kg_per_m=weights[middle])
        trial = _with(corner, g, lighter)
        if _overloads(trials, trial, culprit):
            corner, high = trial, middle
        else:
            low = middle + 1
    return corner


def _with(corner: Sequence[Cable], g: int, cable: Cable) -> list[Cable]:
    return [*corner[:g], cable, *corner[g + 1 :]]


def block_by_trial(
    trials: Trials,
    combination: Combination,
    culprit: int,
    matters: Callable[[Combination], bool],
    most_trials: int,
) -> Block:
    """Return the block of a failing combination, grown product by product while all of it fails.

    ``culprit`` is the group that is grown last. An assignment that does not ``matter``, because it
    could not be the answer, needs no trial.
    """
    sets: list[set[int]] = [{p} for p in combination]
    last = trials.count + most_trials
    order = [g for g in range(len(sets)) if g != culprit] + [culprit]
    for g in order:
        count = prod(len(s) for k, s in enumerate(sets) if k != g)
        distance = np.abs(np.arange(len(trials.products)) - combination[g])
        for p in np.argsort(distance, kind="stable").tolist():
            if p in sets[g]:
                continue
            if trials.count + count > last:
                break
            grown = product(*({p} if k == g else s for k, s in enumerate(sets)))
            if all(trials.is_refuted(a) for a in grown if matters(a)):
                sets[g].add(p)
    return tuple(frozenset(s) for s in sets)
