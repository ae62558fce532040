r"""How the pulls on cables answer to small changes, whatever way the load on them points.

With q the load per unstrained length, the pull F on a cable at its attachment point B and the angle
α at which it leaves its pulley follow from its free length l and

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
from designer.physics import tangent
from designer.statics.geometry import (
    CableGeometry,
    cross_matrix,
    in_space,
    level_geometry,
    plane_vector,
)
from designer.statics.inverse import Statics

_VERTICAL = 1e-12
"""Horizontal distance over the chord of a cable that hangs straight down."""
_END, _LENGTH, _STIFFNESS, _WEIGHT, _TURN = slice(0, 3), 3, 4, 5, slice(6, 9)


@dataclass(frozen=True, slots=True, eq=False)
class PullSlopes:
    """Slopes of the pull F on each cable (..., n_cables, 3), at fixed free length, upright frame.

    Parameters
    ----------
    by_end, by_turn : array (..., n_cables, 3, 3)
        In the attachment point [N/m], and in a turn of the load [N].
    by_length : array (..., n_cables, 3)
        In the free length [N/m].
    by_stiffness, by_weight : array (..., n_cables, 3)
        In the logarithms of EA and of the load per length [N].
    by_end_at_total : array (..., n_cables, 3, 3)
        In the attachment point while the cable, wound on the pulley as well, stays as long [N/m].
    """

    by_end: FloatArray
    by_turn: FloatArray
    by_length: FloatArray
    by_stiffness: FloatArray
    by_weight: FloatArray
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
    solved = _solved(_matrix(cables, radius), _right(cables, radius))
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


def _matrix(cables: _Cables, radius_m: float) -> FloatArray:
    """Return the slopes of both equations in F and α (..., n_cables, 4, 4)."""
    matrix = np.empty((*cables.length.shape, 4, 4))
    matrix[..., :3, :3], matrix[..., :3, 3] = cables.flexibility, radius_m * cables.along
    matrix[..., 3, :3], matrix[..., 3, 3] = cables.spoke, _dot(cables.upper, cables.along)
    return matrix


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
