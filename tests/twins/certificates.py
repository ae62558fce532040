"""What proves that no taut cables hold a pose, checked again by interval arithmetic.

The search of `designer.kernel.feasible` is run by itself, without any start for an equilibrium; of
each part that it refuses, the ranges and the wrench are taken, and

    Σᵢ max over the range of (α p + β v(p)) < c y · load

is bounded anew, piece by piece, with rounding outward (`designer.proof.enclosure`).
"""

from __future__ import annotations

import numba
import numpy as np

from designer.kernel.calling import CableFigures, Situation, plain
from designer.kernel.feasible import (
    MOST_PARTS,
    REFUSED,
    UNDECIDED,
    bound_part,
    cut_part,
    new_parts,
    set_ranges,
)
from designer.kernel.least_pull import least_pulls
from designer.kernel.pose import FORCE, asked, limit_sag, new_pose, place
from designer.kernel.table import CHORD, KAPPA, LEVEL, LIFT, SHARE, X2, D
from designer.model.cable import Cable, Material
from designer.model.robot import Poses, Robot
from designer.proof.enclosure.cable import LARGEST_THETA, enclose, sag
from designer.proof.enclosure.interval import add, divide, multiply, scale, subtract
from designer.statics.task import situation_at

MOST_PIECES = 40000
_STACK = 200


@numba.njit(error_model="numpy")
def _beside_straight(p, drop, kappa, length):
    """Enclose v - p D = p D (C - 1) g / (1 + κ l p (C - 1)) - l/2, which does not cancel.

    C and g = 2 θ p as in `designer.kernel.unit_cable`; θ falls with the pull.
    """
    stretched = scale(length, kappa)
    theta = scale(subtract(divide((1.0, 1.0), p), stretched), 0.5)
    if not (theta[0] > 0.0 and theta[1] <= LARGEST_THETA):
        return -np.inf, np.inf
    C1 = sag(theta[0])[1][0], sag(theta[1])[1][1]
    g = subtract((1.0, 1.0), multiply(stretched, p))
    bent = multiply(p, C1)
    share = divide(multiply(bent, g), add((1.0, 1.0), multiply(stretched, bent)))
    return subtract(multiply(drop, share), scale(length, 0.5))


@numba.njit(error_model="numpy")
def _largest(c, i, alpha, beta, low, high, within):
    """Bound α p + β v(p) between two pulls from above, to within a margin of the largest seen."""
    starts, ends = np.empty(_STACK), np.empty(_STACK)
    starts[0], ends[0], count = low, high, 1
    X, drop, kappa = (c[X2, i], c[X2, i]), (c[D, i], c[D, i]), c[KAPPA, i]
    seen, bound = -np.inf, -np.inf
    for _ in range(MOST_PIECES):
        if count == 0:
            return bound
        count -= 1
        p, ahead = starts[count], ends[count]
        whole = enclose((p, ahead), X, drop, kappa)
        middle = np.sqrt(p * ahead)
        there = enclose((middle, middle), X, drop, kappa)
        if not (whole[0] and there[0]):
            if ahead <= p * (1.0 + 1e-6) or count + 2 > _STACK:
                return np.inf
            starts[count], ends[count] = p, middle
            starts[count + 1], ends[count + 1] = middle, ahead
            count += 2
            continue
        v, v_p, at = whole[5], whole[6], there[5]
        slope_0, slope_1 = alpha + beta * v_p[0], alpha + beta * v_p[1]
        # By the mean value, and by the two intervals by themselves.
        rise = max(slope_0, slope_1) * (ahead - middle)
        fall = min(slope_0, slope_1) * (p - middle)
        mean = alpha * middle + max(beta * at[0], beta * at[1]) + max(rise, fall, 0.0)
        rough = max(alpha * p, alpha * ahead) + max(beta * v[0], beta * v[1])
        beside = _beside_straight((p, ahead), drop, kappa, whole[1])
        along = add((alpha, alpha), multiply((beta, beta), drop))
        tight = multiply(along, (p, ahead))[1] + max(beta * beside[0], beta * beside[1])
        most = min(mean, rough, tight)
        seen = max(seen, alpha * middle + min(beta * at[0], beta * at[1]))
        is_small = ahead <= p * (1.0 + 1e-6)
        if most <= seen + within or is_small or count + 2 > _STACK:
            bound = max(bound, most)
        else:
            starts[count], ends[count] = p, middle
            starts[count + 1], ends[count + 1] = middle, ahead
            count += 2
    return np.inf


@numba.njit(error_model="numpy")
def _is_certified(pose, parts, part, scaled_c):
    """Whether the wrench separates cables and load, at both of two scaled c."""
    c, y = pose.cables, parts.wrench
    of_load, size = 0.0, 0.0
    for i in range(c.shape[1]):
        size += c[SHARE, i] * c[CHORD, i]
    for k in range(y.size):
        of_load += y[k] * pose.load[pose.rows[k]]
    size += abs(scaled_c[0] * pose.scale[FORCE] * of_load)
    borne = min(scaled_c[0] * of_load, scaled_c[1] * of_load) * pose.scale[FORCE]
    within = 1e-2 * size
    while within > 1e-10 * size:  # only as closely as it takes
        bound = 0.0
        for i in range(c.shape[1]):
            alpha, beta = 0.0, 0.0
            for k in range(y.size):
                alpha += y[k] * c[LEVEL + pose.rows[k], i] * c[SHARE, i]
                beta += y[k] * c[LIFT + pose.rows[k], i] * c[SHARE, i]
            low, high = parts.ranges[part, 0, i], parts.ranges[part, 1, i]
            bound += _largest(c, i, alpha, beta, low, high, within / c.shape[1])
        if bound + 1e-13 * size < borne:
            return True
        within *= 0.1
    return False


@numba.njit(error_model="numpy")
def _search(situation, figures, inverse_weight, out):
    m, n = situation.rows.size, situation.attachments.shape[0]
    pose = new_pose(situation, figures)
    parts, bodies = new_parts(m, n)
    for at in range(out.shape[0]):
        place(pose, situation, figures, at)
        limit_sag(pose)
        ask = asked(pose, inverse_weight)
        status = set_ranges(pose, parts, ask, False)
        count = 1 if status == UNDECIDED else 0
        out[at, 0], out[at, 1], out[at, 2] = status == REFUSED, 0, 0
        for _ in range(MOST_PARTS):
            if count == 0:
                break
            status, apart = bound_part(pose, parts, count - 1, bodies, ask)
            if status == REFUSED:
                count -= 1
                ends = parts.ranges[count, :, n]
                # A part whose ranges have closed needs no wrench.
                closed = False
                for i in range(n):
                    closed = closed or not parts.ranges[count, 0, i] < parts.ranges[count, 1, i]
                closed = closed or not ends[0] <= ends[1]
                out[at, 1] += 1
                out[at, 2] += closed or _is_certified(pose, parts, count, ends)
                out[at, 0] = count == 0
            elif cut_part(pose, parts, count - 1, ask, apart):
                count += 1
            else:
                break


def figures_of(robot: Robot, cable: Cable | Material) -> tuple[CableFigures, float]:
    """What the kernels are told of a given cable, or of a family, and 1/w [m/N], -1 of a family."""
    ones = np.ones((1, robot.n_cables))
    if isinstance(cable, Material):
        kappa, strength, inverse = cable.elastic_compliance_per_m, cable.strength_length_m, -1.0
    else:
        weight = cable.weight_N_per_m
        kappa, strength = weight / cable.axial_stiffness_N, cable.allowable_tension_N / weight
        inverse = 1.0 / weight
    least_N = robot.tension_min_N if robot.is_redundant else 0.0
    shares = plain(kappa * ones), plain(ones), plain(strength * ones)
    return CableFigures(*shares, least_N, least_pulls(robot.sag_max)), inverse


def refused(robot: Robot, poses: Poses, cable: Cable | Material) -> np.ndarray:
    """Whether poses are refused, in how many parts, and how many of these are certified (n, 3).

    Without pulleys.
    """
    figures, inverse = figures_of(robot, cable)
    out = np.zeros((len(poses.position_m), 3), dtype=np.int64)
    situation: Situation = situation_at(robot, poses)
    _search(situation, figures, inverse, out)
    return out
