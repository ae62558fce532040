r"""What every assignment must meet in a pose, as linear constraints: a relaxation of the statics.

Of a cable, H is the horizontal force, v its pull upward on the platform, w its weight per length, W
its weight, A what it may carry, X and D its horizontal distance and drop, c its chord, α the angle
of the chord. With M the moment of its weight about the exit point,

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
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from designer.arrays import FloatArray, IntArray
from designer.model.robot import Poses, Robot
from designer.model.workspace import Workspace
from designer.selection.candidate import Candidate
from designer.statics.geometry import cable_geometry, load_wrench_N, structure_matrix

Members = Sequence[IntArray]
"""Of each group the indices of its cables."""


def is_sound(robot: Robot, workspace: Workspace) -> bool:
    """Tell whether the constraints may be used: no pulleys, and every pose of the region counts."""
    return robot.pulley_radius_m == 0.0 and workspace.hangs_below == "include"


@dataclass(frozen=True, slots=True, eq=False)
class Balance:
    """The constraints of one pose; forces are in units of the platform's weight."""

    # (dof, 2 n_cables): From the forces on the cables to the wrench that they hold, see
    # `designer.statics.geometry.structure_matrix`; moments over the reach of the attachments
    structure: FloatArray
    load: FloatArray  # (dof,): The wrench
    # (n_cables,): X and D over the chord
    distance: FloatArray
    drop: FloatArray
    # (n_cables, n_groups, n_products): From the assignment to what each cable may carry
    strength: FloatArray
    # (n_cables, n_groups, n_products): From the assignment to what each cable weighs at least
    weight: FloatArray
    # (n_cables, n_groups, n_products): From the assignment to the least moment of that weight over
    # the chord, m / c
    moment: FloatArray

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
