r"""What excludes assignments of ropes to groups of cables: balance, witnesses, and blocks of them.

**By balance.** What every assignment must meet in a pose, as linear constraints: a relaxation of
the statics. Of a cable, H is the horizontal force, v its pull upward on the platform, w its weight
per length, W its weight, A what it may carry, X and D its horizontal distance and drop, c its
chord, α the angle of the chord. With M the moment of its weight about the exit point,

.. math::

    v X = H D - M, \quad m \le M \le W X / 2, \quad W \ge w c / (1 + A / EA), \quad
    H \cos\theta + (v + W) \sin\theta \le A

for every angle θ, v + W being the vertical force at the exit point. M is at most W X / 2 since the
upper half of a catenary is the heavier one, elastic or not, where the exit point lies above the
attachment. Its least value m comes from the length along the chord, ds ≥ cos α dx + sin α dz:

.. math::

    m = \frac{w}{1 + A / EA} \left(\frac{c X}{2} - \sin\alpha\, S\right), \quad
    S \le \frac{W X^2}{8 H}, \quad W \le \frac{w (X + D)}{1 - w X / (2 H)}

where S is the area between chord and cable, hence the area under the bending moment of the weight
over H; that moment is at most W X / 4, which bounds the sag and so the length. H counts with the
least value that balance allows, whatever the cables weigh.

Together with the platform's balance, Riehl et al., ICRA 2010, eq. (9), all this is true of every
assignment that holds in the pose. So none of those is excluded; what is let pass has yet to be
verified.

**By trial at witnesses**, the poses that have refuted others before: quick, and conclusive. A pose
that an assignment cannot hold refutes it for good; one that it can hold proves nothing, so what
passes there still has to be verified over the whole workspace, group by group.

**Blocks.** From one assignment that fails to a block of them: the larger, the fewer have to be
tried. *By weight:* three cables on a point mass, exit points above it. In a pose the horizontal
forces on it are λ h_i with h fixed by geometry, since three vectors in a plane balance in one ratio
only; λ follows from Σ V_i = m g, V_i being the pull of cable i upward. On Irvine's catenary V_i
rises with H_i = λ h_i, falls as the cable gets heavier and falls as it gets stiffer. So λ, and with
it every H_i, rises with the weight and the stiffness of any cable; and the largest tension of a
given cable rises with its H_i as long as it does not hang below the platform. Hence: what overloads
a cable there overloads it with all others as heavy and as stiff, or more so. One solve at the
lightest corner of a block proves the block.

*By trial:* any other robot: every assignment of the block is solved and fails, but for those that
would not be cheaper than what is known to hold.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from itertools import product
from math import prod
from typing import Any

import numpy as np

from designer.arrays import BoolArray, FloatArray, IntArray
from designer.model.cable import Cable, Cables
from designer.model.robot import Poses, Robot
from designer.model.workspace import Workspace
from designer.selection.assignment import GroupVerification
from designer.selection.candidate import Candidate
from designer.statics.geometry import cable_geometry, load_wrench_N, structure_matrix
from designer.statics.inverse import Statics, solve_sagging
from designer.workspace.demand import is_left_out, length_demand
from designer.workspace.refine import Pool, refine

Members = Sequence[IntArray]
"""Of each group the indices of its cables."""
Combination = tuple[int, ...]
"""Of each group the index of its rope among those on offer."""
Block = tuple[frozenset[int], ...]
"""Of each group a set of products, all of whose combinations are excluded together."""
_NUDGE = 1e-3
"""Relative step in the weight of a rope: the slope guides, and need not be exact."""
_MOST_WITNESSES = 120
"""The latest are kept: each is solved in every trial."""


def singleton_block(combination: Combination) -> Block:
    """Return the block of this combination and no other."""
    return tuple(frozenset({p}) for p in combination)


# Balance


def is_sound(robot: Robot, workspace: Workspace) -> bool:
    """Tell whether the constraints may be used: no pulleys, and every pose of the region counts."""
    return robot.pulley_radius_m == 0.0 and workspace.hangs_below == "include"


@dataclass(frozen=True, slots=True, eq=False)
class Balance:
    """The constraints of one pose; forces are in units of the platform's weight."""

    structure: FloatArray
    """(dof, 2 n_cables), from the forces on the cables to the wrench that they hold, see
    `designer.statics.geometry.structure_matrix`; moments over the reach of the attachments."""
    load: FloatArray  #: (dof,) the wrench
    distance: FloatArray  #: (n_cables,) X over the chord
    drop: FloatArray  #: (n_cables,) D over the chord
    # From the assignment, each (n_cables, n_groups, n_products):
    strength: FloatArray  #: to what each cable may carry
    weight: FloatArray  #: to what each cable weighs at least
    moment: FloatArray  #: to the least moment of that weight over the chord, m / c

    def constraints(self, x: Any) -> list[Any]:
        """Return the constraints on the assignment x (n_groups n_products), for CVXPY."""
        import cvxpy as cp

        n = len(self.drop)
        H, W, v = cp.Variable(n, nonneg=True), cp.Variable(n, nonneg=True), cp.Variable(n)
        X, D = self.distance, self.drop
        may_carry = self.strength.reshape(n, -1) @ x
        slope = np.arctan2(D, X)
        return [
            self.structure[:, 0::2] @ H - self.structure[:, 1::2] @ v == self.load,
            cp.multiply(X, v) <= cp.multiply(D, H) - self.moment.reshape(n, -1) @ x,
            cp.multiply(X, v) >= cp.multiply(D, H) - cp.multiply(0.5 * X, W),
            self.weight.reshape(n, -1) @ x <= W,
            *(
                cp.multiply(np.cos(theta), H) + cp.multiply(np.sin(theta), v + W) <= may_carry
                for theta in (slope + np.radians(turn) for turn in (0.0, 4.0, 12.0, 30.0))
            ),
        ]


def balance_at(
    robot: Robot, place: FloatArray, products: tuple[Candidate, ...], members: Members
) -> Balance | None:
    """Return the constraints of a pose; None if an exit point does not lie above its cable."""
    pose = Poses.at(place)
    geometry = cable_geometry(robot, pose)
    if not (geometry.drop_m > 0.0).all():
        return None
    reach = max(float(np.linalg.norm(robot.attachments_m, axis=1).max()), 1e-9)
    scale = np.array([1.0, 1.0, 1.0] + [reach] * (robot.degrees_of_freedom - 3))
    is_of_group = np.zeros((robot.n_cables, len(members), 1))
    for g, cables in enumerate(members):
        is_of_group[cables, g] = 1.0
    unit = robot.weight_N
    structure = structure_matrix(robot, geometry) / scale[:, None]
    load = load_wrench_N(robot, pose) / unit / scale
    X, D = geometry.horizontal_distance_m, geometry.drop_m
    strength = np.array([candidate.cable.allowable_tension_N for candidate in products]) / unit
    heaviest = np.array([candidate.cable.weight_N_per_m for candidate in products]) / unit
    lightest = heaviest / (1.0 + np.array([candidate.largest_strain for candidate in products]))
    pull = _least_pull(structure, load, X, D)
    moment = lightest * _least_moment_m2(X[:, None], D[:, None], pull[:, None], heaviest)
    chord = geometry.chord_m
    return Balance(
        structure=structure,
        load=load,
        distance=X / chord,
        drop=D / chord,
        strength=is_of_group * strength,
        weight=is_of_group * lightest * chord[:, None, None],
        moment=is_of_group * (moment / chord[:, None])[:, None, :],
    )


def _least_pull(
    structure: FloatArray, load: FloatArray, X: FloatArray, D: FloatArray
) -> FloatArray:
    """Return the least horizontal force of each cable that v X ≤ H D and balance allow."""
    from scipy.optimize import linprog

    n = len(X)
    below_chord = np.hstack([-np.diag(D), np.diag(X)])
    balance = np.hstack([structure[:, 0::2], -structure[:, 1::2]])
    bounds = [(0.0, None)] * n + [(None, None)] * n
    solutions = [
        linprog(row, below_chord, np.zeros(n), balance, load, bounds) for row in np.eye(n, 2 * n)
    ]
    # Rounding must not make it larger than it is.
    return np.array(
        [
            (1.0 - 1e-6) * max(solution.fun, 0.0) if solution.success else 0.0
            for solution in solutions
        ]
    )


def _least_moment_m2(X: FloatArray, D: FloatArray, H: FloatArray, w: FloatArray) -> FloatArray:
    """Return the least moment about the exit point of a cable of unit weight per strained length.

    Horizontal distance, drop, least horizontal force and weight per length broadcast; zero where
    the bound on the sag says nothing.
    """
    chord = np.hypot(X, D)
    with np.errstate(divide="ignore", invalid="ignore"):
        slack = 1.0 - w * X / (2.0 * H)
        area = w * (X + D) / slack * X**2 / (8.0 * H)
        moment = 0.5 * chord * X - D / chord * area
    return np.where((slack > 0.0) & (moment > 0.0), moment, 0.0)


# Trials


def utilisation_of(statics: Statics, cables: Cables, left_out: BoolArray) -> FloatArray:
    """Return largest over allowable tension of each cable (..., n_cables).

    Infinite where a pose is not solved, minus infinity where it does not count.
    """
    used = statics.cable_tension_N / cables.allowable_tension_N
    used = np.where(statics.is_solved[..., None], used, np.inf)
    return np.where(left_out[..., None], -np.inf, used)


def verify_groups(
    robot: Robot, workspace: Workspace, cables: Cables, members: Members
) -> GroupVerification:
    """Solve every sample with these cables, then search between them for each group's worst."""
    space = workspace.space
    demand = partial(_demand, robot, workspace, cables, members)
    pools = [Pool(space) for _ in members]
    utilisation = np.full(len(members), -np.inf)
    at = np.full((len(members), space.n_coordinates), np.nan)
    longest = np.zeros(robot.n_cables)
    for batch in workspace.places():
        demands, lengths = np.split(demand(batch), [len(members)], axis=1)
        for g, pool in enumerate(pools):
            pool.add(batch, demands[:, g])
        best = demands.argmax(axis=0)
        highest = demands[best, np.arange(len(members))]
        at = np.where((highest > utilisation)[:, None], batch[best], at)
        utilisation = np.maximum(utilisation, highest)
        longest = np.maximum(longest, lengths.max(axis=0))
    if np.isneginf(utilisation).any():  # every sample is left out: nothing is served
        utilisation = np.full(len(members), np.inf)
    if utilisation.max() > 1.0:
        return GroupVerification(at, utilisation, longest, np.full_like(longest, np.nan), False)
    starts = np.unique(np.concatenate([pool.places for pool in pools]), axis=0)
    worst = refine(space, demand, starts)
    demands = np.array([extreme.demand for extreme in worst])
    at = np.array([extreme.place for extreme in worst[: len(members)]])
    groups, lengths = np.split(demands, [len(members)])
    return GroupVerification(at, groups, lengths, np.full_like(lengths, np.nan), True)


def _demand(
    robot: Robot,
    workspace: Workspace,
    cables: Cables,
    members: Members,
    places: FloatArray,
) -> FloatArray:
    """What cables meet (n, n_groups + n_cables): utilisation of each group, lengths [m]."""
    statics = solve_sagging(robot, Poses.at(places), cables)
    left_out = is_left_out(statics, workspace.hangs_below)
    utilisation = utilisation_of(statics, cables, left_out)
    groups = np.column_stack([utilisation[:, cable].max(axis=1) for cable in members])
    counts = np.isfinite(groups).all(axis=1)
    length = length_demand(statics, counts)[:, : robot.n_cables]
    return np.column_stack([groups, length])


@dataclass(frozen=True, slots=True, eq=False)
class Load:
    """What cables meet at the witnesses, each (n_witnesses, n_cables)."""

    utilisation: FloatArray  #: largest over allowable tension; inf: not solved, -inf: left out
    tension_N: FloatArray  #: largest tension [N]; NaN where not solved
    length_m: FloatArray  #: unstrained length [m]; NaN where not solved
    hangs: BoolArray  #: whether the cable hangs below the platform


@dataclass(frozen=True, slots=True, eq=False)
class Refutation:
    """A pose that an assignment cannot hold."""

    group: int  #: the group that is overloaded most there
    utilisation: float  #: by how much; inf if the pose cannot be held at all
    place: FloatArray  #: (n_coordinates,) where, see `designer.model.space` [m, rad]


class Trials:
    """Solves assignments of products to groups at the witnesses.

    ``products`` are what may be assigned, ``members`` the cables of each group.
    """

    def __init__(
        self, robot: Robot, workspace: Workspace, products: Sequence[Candidate], members: Members
    ) -> None:
        self.robot, self.workspace = robot, workspace
        self.products, self.members = products, members
        self.count = 0
        self.reach_m = np.zeros(robot.n_cables)
        """Longest chord of each cable over the samples (n_cables,) [m]."""
        self._farthest = np.zeros((robot.n_cables, workspace.space.n_coordinates))
        for batch in workspace.places():
            chord = cable_geometry(robot, Poses.at(batch)).chord_m
            best = chord.argmax(axis=0)
            far = chord[best, np.arange(robot.n_cables)]
            is_farther = (far > self.reach_m)[:, None]
            self._farthest = np.where(is_farther, batch[best], self._farthest)
            self.reach_m = np.maximum(self.reach_m, far)
        self._found = np.empty((0, workspace.space.n_coordinates))
        self._refuted: set[Combination] = set()

    @property
    def witnesses(self) -> FloatArray:
        """Places (n_witnesses, n_coordinates); the first are samples far from each exit point."""
        return np.concatenate([self._farthest, self._found])

    def add_witnesses(self, places: FloatArray) -> None:
        """Take up places (n, n_coordinates) where assignments have failed, or nearly so."""
        present = {tuple(place) for place in self._found}
        new = [p for p in places if np.isfinite(p).all() and tuple(p) not in present]
        witnesses = np.concatenate([self._found, np.array(new).reshape(-1, self._found.shape[1])])
        self._found = witnesses[-_MOST_WITNESSES:]

    def cables(self, combination: Combination) -> Cables:
        """Return the cables of a combination, in the order of the exit points."""
        return self.on_groups([self.products[p].cable for p in combination])

    def on_groups(self, of_groups: Sequence[Cable]) -> Cables:
        """Return the cables of the robot from those of its groups."""
        of_cable = {int(c): of_groups[g] for g, cables in enumerate(self.members) for c in cables}
        return Cables(tuple(of_cable[c] for c in range(self.robot.n_cables)))

    def load(self, cables: Cables) -> Load:
        """Solve the witnesses."""
        self.count += 1
        statics = solve_sagging(self.robot, Poses.at(self.witnesses), cables)
        left_out = is_left_out(statics, self.workspace.hangs_below)
        return Load(
            utilisation_of(statics, cables, left_out),
            statics.cable_tension_N,
            statics.length_m,
            np.asarray(statics.force_z_N > 0.0),
        )

    def stands_above(self) -> BoolArray:
        """Tell at which witnesses every exit point lies above its attachment."""
        drop = cable_geometry(self.robot, Poses.at(self.witnesses)).drop_m
        return np.asarray((drop > 0.0).all(axis=1))

    def refutation(self, combination: Combination) -> Refutation | None:
        """Return the worst witness against a combination, if there is one."""
        used = self.load(self.cables(combination)).utilisation
        by_group = np.stack([used[:, cables].max(axis=1) for cables in self.members], axis=1)
        at, group = np.unravel_index(int(np.argmax(by_group)), by_group.shape)
        if by_group[at, group] <= 1.0:
            return None
        self._refuted.add(combination)
        return Refutation(int(group), float(by_group[at, group]), self.witnesses[at])

    def is_refuted(self, combination: Combination) -> bool:
        """Tell whether a witness speaks against a combination."""
        return combination in self._refuted or self.refutation(combination) is not None

    def least_length_m(self, combination: Combination) -> FloatArray:
        """Return lengths (n_cables,) that the longest ones of an assignment cannot fall below."""
        length = self.load(self.cables(combination)).length_m[: len(self._farthest)]
        return np.asarray(np.nan_to_num(length).max(axis=0, initial=0.0))

    def slopes(self, combination: Combination) -> tuple[Load, FloatArray]:
        """Return the load, and the slope of each tension in each group's weight.

        The latter (n_groups, n_witnesses, n_cables) by forward differences [N per N/m].
        """
        of_groups = [self.products[p].cable for p in combination]
        base = self.load(self.on_groups(of_groups))
        slopes = []
        for g, cable in enumerate(of_groups):
            density = (1.0 + _NUDGE) * cable.linear_density_kg_per_m
            heavier = replace(cable, linear_density_kg_per_m=density)
            moved = self.load(self.on_groups([*of_groups[:g], heavier, *of_groups[g + 1 :]]))
            slopes.append((moved.tension_N - base.tension_N) / (_NUDGE * cable.weight_N_per_m))
        return base, np.array(slopes)


# Blocks


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
        return singleton_block(combination)
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
