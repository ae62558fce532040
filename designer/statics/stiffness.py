r"""Stiffness of the platform with sagging cables, at fixed unstrained lengths.

A small displacement :math:`(δx, δω)` of the platform moves the attachment point with lever b by
:math:`δx + δω × b`; each cable answers with its own tangent stiffness K_i and with its force F_i
about a turned lever, and the weight P about the turned lever c of the centre of mass, as any other
force that acts at a point of the body:

.. math::

    δF_i = K_i (δx + δω × b_i), \qquad
    δM = \sum_i b_i × δF_i + (δω × b_i) × F_i \; - \; (δω × c) × P

F_i acts on the cable, so K is what the platform resists with. In equilibrium K is symmetric; it is
positive definite where the equilibrium is stable. With straight cables of no weight this is the
stiffness of Behzadipour and Khajepour, J. Mech. Des. 128 (2006), pages 303 to 310; here the
cables' own tangents bring in the sag.

The pulls answer to small changes whatever way the load on cables points. With q the load per
unstrained length, the pull F on a cable at its attachment point B and the angle α at which it
leaves its pulley follow from its free length l and

.. math::

    P(α, e) + c(F, l, EA, q) = B, \qquad n(α, e) · (F + q l) = 0

where e is the horizontal unit vector from the exit point toward B, :math:`n = \sin α\, e + \cos α\,
z` the direction from the pulley's centre to the tangent point P (`designer.physics.pulley`), which
stays upright, and c the span of the catenary. Both are made linear here: four equations a cable.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from designer.arrays import BoolArray, FloatArray
from designer.model.robot import Robot
from designer.physics import tangent
from designer.statics.geometry import (
    CableGeometry,
    cable_geometry,
    cross_matrix,
    in_space,
    level_geometry,
    plane_vector,
    upright_poses,
)
from designer.statics.inverse import Statics

_VERTICAL = 1e-12
"""Horizontal distance over the chord of a cable that hangs straight down."""
_END, _LENGTH, _STIFFNESS, _WEIGHT, _TURN = slice(0, 3), 3, 4, 5, slice(6, 9)


@dataclass(frozen=True, slots=True, eq=False)
class PullSlopes:
    """Slopes of the pull F on each cable, at fixed free length, upright frame."""

    by_end: FloatArray  #: (..., n_cables, 3, 3) in the attachment point [N/m]
    by_turn: FloatArray  #: (..., n_cables, 3, 3) in a turn of the load [N]
    by_length: FloatArray  #: (..., n_cables, 3) in the free length [N/m]
    by_stiffness: FloatArray  #: (..., n_cables, 3) in the logarithm of EA [N]
    by_weight: FloatArray  #: (..., n_cables, 3) in that of the load per length [N]
    #: (..., n_cables, 3, 3) in the attachment point while the cable, wound on the pulley as well,
    #: stays as long [N/m]
    by_end_at_total: FloatArray


@dataclass(frozen=True, slots=True, eq=False)
class _Cables:
    """The cables in poses (...), vectors in the upright frame."""

    pull: FloatArray  # (..., n_cables, 3), F [N]
    load: FloatArray  # (..., n_cables, 3), q [N/m]
    length: FloatArray  # (..., n_cables) [m]
    span: FloatArray  # (..., n_cables, 3), c [m]
    flexibility: FloatArray  # (..., n_cables, 3, 3), of c in F [m/N]
    stretch: FloatArray  # (..., n_cables, 3), the elastic part of c [m]
    strain: FloatArray  # (..., n_cables), at the pulley
    slope: FloatArray  # (..., n_cables), α [rad]
    across: FloatArray  # (..., n_cables, 3), along the pulley's axis
    spoke: FloatArray  # (..., n_cables, 3), n
    along: FloatArray  # (..., n_cables, 3), of n in α
    swivel: FloatArray  # (..., n_cables, 3), of the turn of e in B [1/m]

    @property
    def upper(self) -> FloatArray:
        """Force on the rest of each cable where it leaves its pulley (..., n_cables, 3) [N]."""
        return np.asarray(self.pull + self.length[..., None] * self.load)


def pull_slopes(statics: Statics) -> PullSlopes:
    """Return the slopes of cables in poses (...); NaN where not solved, or a cable hangs folded."""
    cables, radius = _cables(statics), statics.robot.pulley_radius_m
    matrix = np.empty((*cables.length.shape, 4, 4))  # slopes of both equations in F and α
    matrix[..., :3, :3], matrix[..., :3, 3] = cables.flexibility, radius * cables.along
    matrix[..., 3, :3], matrix[..., 3, 3] = cables.spoke, _dot(cables.upper, cables.along)
    solved = _solved(matrix, _right(cables, radius))
    pulls, angle = solved[..., :3, :], solved[..., 3, :]
    rolled = _rolled(cables, radius, statics.axial_stiffness_N, pulls, angle)
    by_end, by_length = pulls[..., _END], pulls[..., _LENGTH]
    return PullSlopes(
        by_end=by_end,
        by_turn=pulls[..., _TURN],
        by_length=by_length,
        by_stiffness=pulls[..., _STIFFNESS],
        by_weight=pulls[..., _WEIGHT],
        by_end_at_total=by_end + by_length[..., :, None] * rolled[..., None, :],
    )


def _cables(statics: Statics) -> _Cables:
    robot, chord = statics.robot, statics.geometry()
    length, F_x, F_z, EA, w = np.broadcast_arrays(*statics.catenaries)
    pull = plane_vector(F_x, F_z, chord.outward)
    load = w[..., None] * np.array([0.0, 0.0, -1.0])
    upper = pull + length[..., None] * load
    level = level_geometry(robot, statics.poses)
    toward, up = _ahead(level) @ robot.leaning[:, :2].T, robot.leaning[:, 2]
    across = np.cross(up, toward)
    slope = np.arctan2(-upper @ up, _dot(upper, toward))
    sine, cosine = np.sin(slope)[..., None], np.cos(slope)[..., None]
    plane = tangent.flexibility_m_per_N(length, F_x, F_z, EA, w)
    with np.errstate(invalid="ignore", divide="ignore"):
        swing = np.where(_is_vertical(chord), plane[..., 0, 0], chord.horizontal_distance_m / F_x)
        swivel = across / level.horizontal_distance_m[..., None]
    return _Cables(
        pull=pull,
        load=load,
        length=length,
        span=plane_vector(chord.horizontal_distance_m, -chord.drop_m, chord.outward),
        flexibility=in_space(plane, swing, _ahead(chord)),
        stretch=(length / EA)[..., None] * (pull + 0.5 * length[..., None] * load),
        strain=np.linalg.norm(upper, axis=-1) / EA,
        slope=slope,
        across=across,
        spoke=sine * toward + cosine * up,
        along=cosine * toward - sine * up,
        swivel=np.where(_is_vertical(level)[..., None], 0.0, swivel),
    )


def _right(cables: _Cables, radius_m: float) -> FloatArray:
    """Return less the slopes of both in all else (..., n_cables, 4, 9); columns as above."""
    length, spoke, load = cables.length[..., None], cables.spoke, cables.load
    sine = np.sin(cables.slope)[..., None]
    aside = (radius_m * (1.0 + sine) * cables.across)[..., None]
    unit = cables.upper / np.linalg.norm(cables.upper, axis=-1, keepdims=True)
    # The span does not change where forces, EA and load all grow alike.
    sag = cables.stretch - np.einsum("...ij,...j->...i", cables.flexibility, cables.pull)
    right = np.empty((*cables.length.shape, 4, 9))
    right[..., :3, _END] = np.eye(3) - aside * cables.swivel[..., None, :]
    right[..., 3, _END] = -sine * _dot(cables.upper, cables.across)[..., None] * cables.swivel
    right[..., :3, _LENGTH] = -(1.0 + cables.strain)[..., None] * unit
    right[..., 3, _LENGTH] = -_dot(spoke, load)
    right[..., :3, _STIFFNESS], right[..., 3, _STIFFNESS] = cables.stretch, 0.0
    right[..., :3, _WEIGHT], right[..., 3, _WEIGHT] = -sag, -cables.length * _dot(spoke, load)
    turn_slopes = cross_matrix(cables.span) - cables.flexibility @ cross_matrix(cables.pull)
    right[..., :3, _TURN], right[..., 3, _TURN] = turn_slopes, -length * np.cross(load, spoke)
    return right


def _rolled(
    cables: _Cables,
    radius_m: float,
    axial_stiffness_N: FloatArray,
    pulls: FloatArray,
    angle: FloatArray,
) -> FloatArray:
    """Return what of the total length rolls off as the end moves (..., n_cables, 3).

    What lies on the pulley, R (π/2 + α) / (1 + T/EA), changes with angle and tension there.
    """
    upper_N = np.linalg.norm(cables.upper, axis=-1)
    unit, loose = cables.upper / upper_N[..., None], 1.0 + cables.strain
    tension = np.einsum("...i,...ij->...j", unit, pulls)
    tension[..., _LENGTH] += _dot(unit, cables.load)
    wrap = radius_m * (0.5 * np.pi + cables.slope) / loose
    total = (radius_m / loose)[..., None] * angle
    total -= (wrap / (axial_stiffness_N + upper_N))[..., None] * tension
    total[..., _LENGTH] += 1.0
    return np.asarray(-total[..., _END] / total[..., _LENGTH, None])


def _is_vertical(geometry: CableGeometry) -> BoolArray:
    return np.asarray(geometry.horizontal_distance_m <= _VERTICAL * geometry.chord_m)


def _ahead(geometry: CableGeometry) -> FloatArray:
    """Return the plan of each cable's plane (..., 2), any where it hangs straight down."""
    return np.where(_is_vertical(geometry)[..., None], [1.0, 0.0], geometry.outward)


def _dot(first: FloatArray, second: FloatArray) -> FloatArray:
    return np.asarray((first * second).sum(axis=-1))


def _solved(matrix: FloatArray, right: FloatArray) -> FloatArray:
    """Solve systems (..., 4, 4); NaN where they hold what is not finite."""
    finite = np.isfinite(matrix).all(axis=(-2, -1)) & np.isfinite(right).all(axis=(-2, -1))
    good = np.asarray(finite)[..., None, None]
    safe = np.where(good, matrix, np.eye(4))
    return np.where(good, np.linalg.solve(safe, right), np.nan)


_SOFT = 1e-12
"""Over the stiffest, or over the chord: what rounding leaves of nothing."""


def cable_tangent_stiffness_N_per_m(statics: Statics) -> FloatArray:
    """Return how the force on each cable grows as its end moves (..., n_cables, 3, 3) [N/m].

    Upright frame, at fixed unstrained length. In the cable's vertical plane this is the closed form
    of `designer.physics.tangent`; across it a cable swings about the vertical through its exit
    point with the stiffness F_x / X. Over a pulley it does so only where the load is vertical; see
    `pull_slopes` for any other.
    """
    robot = statics.robot
    if robot.pulley_radius_m != 0.0 and robot.cable_load_direction is not None:
        return pull_slopes(statics).by_end_at_total
    if robot.pulley_radius_m == 0.0:
        plane = tangent.stiffness_N_per_m(*statics.catenaries)
    else:
        plane = tangent.stiffness_over_pulley_N_per_m(*statics.catenaries, robot.pulley_radius_m)
    chord = cable_geometry(robot, statics.poses)
    X = chord.horizontal_distance_m
    is_vertical = chord.chord_m * _SOFT >= X
    with np.errstate(invalid="ignore", divide="ignore"):
        swing = np.where(is_vertical, plane[..., 0, 0], statics.force_x_N / X)
    outward = np.where(is_vertical[..., None], [1.0, 0.0], chord.outward)
    return in_space(plane, swing, outward)


def platform_stiffness(statics: Statics) -> FloatArray:
    """Return the stiffness of the platform in poses (...), (..., dof, dof) [N/m, N, N·m].

    Rows are force and moment about the origin of the body frame, columns displacement and turn,
    along the axes of the base frame; 3×3 for a point mass. For a planar robot, what its cables
    balance: along x and z of the upright frame and, for a body, about y. NaN where the pose is not
    solved.
    """
    robot = statics.robot
    K = upright_stiffness(statics)
    if robot.is_planar or robot.is_upright:
        return K
    rotation = np.kron(np.eye(K.shape[-1] // 3), robot.upright)
    return np.asarray(rotation.T @ K @ rotation)


def upright_stiffness(statics: Statics) -> FloatArray:
    """Return `platform_stiffness` along the axes of the upright frame, (..., dof, dof)."""
    robot = statics.robot
    K = cable_tangent_stiffness_N_per_m(statics)
    if robot.is_point_mass:
        return _balanced(robot, K.sum(axis=-3))
    geometry = statics.geometry()
    B = cross_matrix(geometry.lever_m)
    F = cross_matrix(plane_vector(statics.force_x_N, statics.force_z_N, geometry.outward))
    by_rotation = -K @ B
    moment = B @ K
    moment_by_rotation = (B @ by_rotation + F @ B).sum(axis=-3)
    rotation = upright_poses(robot, statics.poses).rotation
    for point_m, pull_N in robot.turning_pulls_N:
        moment_by_rotation = moment_by_rotation + cross_matrix(pull_N) @ cross_matrix(
            rotation @ point_m
        )
    by_displacement = np.concatenate([K.sum(axis=-3), moment.sum(axis=-3)], axis=-2)
    by_rotations = np.concatenate([by_rotation.sum(axis=-3), moment_by_rotation], axis=-2)
    return _balanced(robot, np.concatenate([by_displacement, by_rotations], axis=-1))


def is_stable(robot: Robot, stiffness: FloatArray) -> BoolArray:
    """Tell where a stiffness (..., dof, dof) of the robot is positive definite."""
    return np.asarray(least_eigenvalue_N_per_m(robot, stiffness) > 0.0)


def least_eigenvalue_N_per_m(robot: Robot, stiffness: FloatArray) -> FloatArray:
    """Return the lowest eigenvalue of stiffnesses (..., dof, dof), turns at `reach_m` (...) [N/m].

    Zero where rounding leaves no more of it, or they are not finite.
    """
    K = scaled(robot, stiffness)
    K = np.where(np.isfinite(K).all(axis=(-2, -1), keepdims=True), K, 0.0)
    eigenvalues = np.linalg.eigvalsh(0.5 * (K + np.swapaxes(K, -1, -2)))
    least = eigenvalues[..., 0]
    return np.where(np.abs(least) <= _SOFT * np.abs(eigenvalues).max(axis=-1), 0.0, least)


def scaled(robot: Robot, stiffness: FloatArray) -> FloatArray:
    """Return a stiffness [N/m], or mass, with turns as displacements at `reach_m`: in one unit."""
    scale = per_reach(robot)
    return np.asarray(stiffness * scale * scale[:, None])


def per_reach(robot: Robot) -> FloatArray:
    """Return the factors (dof,) that make forces of a wrench's moments: one over `reach_m`."""
    return np.where(robot.balance_rows < 3, 1.0, 1.0 / reach_m(robot))


def reach_m(robot: Robot) -> float:
    """Return the distance of the farthest attachment from the origin of the body frame [m]."""
    farthest = float(np.linalg.norm(robot.attachments_m, axis=-1).max())
    return farthest if farthest > 0.0 else 1.0


def compliance(statics: Statics) -> FloatArray:
    """Return the displacement under a unit wrench (..., dof, dof) [m/N, 1/N, 1/(N·m)].

    The inverse of `platform_stiffness`; NaN where the pose is not solved or not stable.
    """
    K = platform_stiffness(statics)
    good = statics.is_solved & is_stable(statics.robot, K)
    safe = np.where(good[..., None, None], K, np.eye(K.shape[-1]))
    return np.where(good[..., None, None], np.linalg.inv(safe), np.nan)


def largest_displacement_m_per_N(statics: Statics) -> FloatArray:
    """Return how far a unit force at the origin of the body frame can move it (...) [m/N].

    The force may point anywhere, and the platform may turn; the inverse of this is the smallest
    translational stiffness. NaN where the pose is not solved or not stable.
    """
    n = int((statics.robot.balance_rows < 3).sum())
    C = compliance(statics)[..., :n, :n]
    good = np.asarray(np.isfinite(C).all(axis=(-2, -1)))
    C = np.where(good[..., None, None], C, 0.0)  # symmetric, as an equilibrium has it
    largest = np.linalg.eigvalsh(0.5 * (C + np.swapaxes(C, -1, -2)))[..., -1]
    return np.where(good, largest, np.nan)


def _balanced(robot: Robot, stiffness: FloatArray) -> FloatArray:
    """Return the rows and columns that the cables balance."""
    rows = robot.balance_rows
    return np.asarray(stiffness[..., rows[:, None], rows])
