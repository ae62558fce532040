"""One pose with more cables than degrees of freedom: geometry and linearised cables."""

from __future__ import annotations

import numpy as np

from designer.arrays import FloatArray, IntArray
from designer.kernel.compiling import element, kernel
from designer.kernel.redundant_layout import (
    CABLE_ROWS,
    CHORD,
    EX,
    EY,
    FORCE,
    HANGS,
    KAPPA,
    L_0,
    L_P,
    LEAST,
    LOWEST,
    LOWEST_P,
    LOWEST_PP,
    REACH,
    RX,
    RY,
    RZ,
    SHARE,
    SIZE,
    STRENGTH,
    T_P,
    T_PP,
    TOP,
    TOP_S,
    UNIT,
    UP,
    V_P,
    V_PP,
    WRENCH,
    X2,
    Ask,
    D,
    L,
    P,
    Pose,
    T,
    V,
)  # fmt: skip
from designer.kernel.redundant_lp import Programme
from designer.kernel.unit_cable import sag_series, unit_cable

_LEAST_SLOPE = 0.3
_ALONG = 1e-5  # relative step of the difference that gives second slopes


@kernel
def new_pose(
    kappa: FloatArray,
    weights: FloatArray,
    strength: FloatArray,
    rows: IntArray,
    least_tension: float,
) -> Pose:
    """Return the arrays of a pose, filled with what is the same for all poses."""
    cables = np.zeros((CABLE_ROWS, kappa.size))
    scale = np.ones(3)
    cables[KAPPA] = kappa
    cables[SHARE] = weights
    cables[STRENGTH] = strength
    cables[LEAST] = least_tension / weights
    scale[FORCE] = np.max(weights * strength)
    return Pose(cables, rows, np.zeros(6), np.zeros(6), scale)


@kernel
def place(
    pose: Pose,
    exit_points: FloatArray,
    attachments: FloatArray,
    Q: FloatArray,
    x: FloatArray,
    force: FloatArray,
    load_point: FloatArray,
    weight: float,
) -> None:
    """Fill geometry and load: force (6,) is force and moment at the origin of the body.

    The weight, which is part of it, acts at `load_point` of the body; its moment comes on top.
    """
    c, load, scale = pose.cables, pose.load, pose.scale
    reach = 0.0
    c[HANGS] = 0.0
    for i in range(c.shape[1]):
        b = attachments[i]
        for axis in range(3):
            r = Q[axis, 0] * b[0] + Q[axis, 1] * b[1] + Q[axis, 2] * b[2]
            c[RX + axis, i] = r
            c[EX + axis, i] = exit_points[i, axis] - x[axis] - r
        c[X2, i] = c[EX, i] ** 2 + c[EY, i] ** 2
        c[CHORD, i] = np.sqrt(c[X2, i] + c[D, i] ** 2)
        c[UNIT, i] = c[STRENGTH, i] / c[CHORD, i]
        reach = max(reach, abs(c[RX, i]) + abs(c[RY, i]) + abs(c[RZ, i]))
    scale[REACH] = reach = reach if reach > 0.0 else 1.0
    s = load_point
    sx = Q[0, 0] * s[0] + Q[0, 1] * s[1] + Q[0, 2] * s[2]
    sy = Q[1, 0] * s[0] + Q[1, 1] * s[1] + Q[1, 2] * s[2]
    for axis in range(3):
        load[axis] = force[axis]
        load[axis + 3] = force[axis + 3] / reach
    load[3] += sy * weight / reach
    load[4] -= sx * weight / reach
    size = 1e-300
    for k in range(6):
        size = max(size, abs(load[k]))
    for k in range(6):
        load[k] /= size
    scale[SIZE] = size


@element
def make_straight(pose: Pose, carried: float) -> None:
    """Straight cables, with this share of their weight at the platform (0 or 1/2)."""
    c = pose.cables
    for i in range(c.shape[1]):
        c[P, i] = 0.0
        c[L, i] = c[CHORD, i]
        c[V, i] = -carried * c[CHORD, i]
        c[V_P, i] = c[D, i]
        c[T, i] = carried * abs(c[D, i])
        c[T_P, i] = c[CHORD, i]
        c[L_0, i] = 0.0
        c[L_P, i] = 0.0
        c[LOWEST, i] = -carried * abs(c[D, i])
        c[LOWEST_P, i] = c[CHORD, i]


@kernel
def linearise(pose: Pose) -> None:
    """Condense each cable's length: pull and top tension as linear functions of the step in p."""
    c = pose.cables
    for i in range(c.shape[1]):
        F, F_p, F_l, v, v_p, v_l, t, t_p, t_l = unit_cable(
            c[P, i], c[L, i], c[X2, i], c[D, i], c[KAPPA, i]
        )
        l0 = -F / F_l
        lp = -F_p / F_l
        c[V, i] = v + v_l * l0
        c[V_P, i] = v_p + v_l * lp
        c[T, i] = t + t_l * l0
        c[T_P, i] = t_p + t_l * lp
        c[L_0, i] = l0
        c[L_P, i] = lp
        if c[LEAST, i] > 0.0:
            c[LOWEST, i], c[LOWEST_P, i] = lowest_tension(
                c[P, i], c[L, i] + l0, lp, c[V, i], c[V_P, i], c[X2, i], c[D, i]
            )


@element
def lowest_tension(
    p: float, length: float, length_p: float, v: float, v_p: float, X2: float, D: float
) -> tuple[float, float]:
    """Return the least tension anywhere in a cable over its weight, and its slope in the pull.

    Where the cable hangs below both of its ends that is the horizontal force, else the tension at
    its lower end. It rises with the pull, ever faster: its tangents never promise too much.
    """
    up, up_p = (v, v_p) if D >= 0.0 else (-length - v, -length_p - v_p)
    if up < 0.0:
        up, up_p = 0.0, 0.0
    tension = np.sqrt(p * p * X2 + up * up)
    if not tension > 0.0:
        return 0.0, np.sqrt(X2 + D * D)
    return tension, (p * X2 + up * up_p) / tension


@element
def settled_length(p: float, X2: float, D: float, kappa: float) -> float:
    """Return the length that closes the cable at this pull.

    Starts from the inextensible cable, and solves the closure by Newton.
    """
    theta = 0.5 / p
    straight = np.sqrt(D * D + X2 * (1.0 + theta * theta * sag_series(theta * theta)))
    length = straight / (1.0 + kappa * p * straight)
    for _ in range(3):
        F, _, F_l, _, _, _, _, _, _ = unit_cable(p, length, X2, D, kappa)
        length -= F / F_l
    return float(length)


@kernel
def bend(pose: Pose) -> None:
    """Close each cable at its present pull; first and second slopes along the closure."""
    c = pose.cables
    for i in range(c.shape[1]):
        p = c[P, i]
        c[L, i] = settled_length(p, c[X2, i], c[D, i], c[KAPPA, i])
    linearise(pose)
    for i in range(c.shape[1]):
        step = _ALONG * c[P, i]
        _, F_p, F_l, v, v_p, v_l, _, t_p, t_l = unit_cable(
            c[P, i] + step, c[L, i] + step * c[L_P, i], c[X2, i], c[D, i], c[KAPPA, i]
        )
        lp = -F_p / F_l
        c[V_PP, i] = (v_p + v_l * lp - c[V_P, i]) / step
        c[T_PP, i] = (t_p + t_l * lp - c[T_P, i]) / step
        if c[LEAST, i] > 0.0:
            _, slope = lowest_tension(
                c[P, i] + step, c[L, i] + step * c[L_P, i], lp, v, v_p + v_l * lp, c[X2, i], c[D, i]
            )
            c[LOWEST_PP, i] = (slope - c[LOWEST_P, i]) / step


@element
def write_wrenches(pose: Pose) -> None:
    """Write each cable's scaled wrench per unit of scaled pull, its length following."""
    c, scale = pose.cables, pose.scale
    for i in range(c.shape[1]):
        factor = c[SHARE, i] * c[UNIT, i] / scale[FORCE]
        c[WRENCH, i] = factor * c[EX, i]
        c[WRENCH + 1, i] = factor * c[EY, i]
        c[WRENCH + 2, i] = factor * c[V_P, i]
        factor /= scale[REACH]
        c[WRENCH + 3, i] = factor * (c[RY, i] * c[V_P, i] - c[RZ, i] * c[EY, i])
        c[WRENCH + 4, i] = factor * (c[RZ, i] * c[EX, i] - c[RX, i] * c[V_P, i])
        c[WRENCH + 5, i] = factor * (c[RX, i] * c[EY, i] - c[RY, i] * c[EX, i])


@element
def lift(pose: Pose, row: int, i: int) -> float:
    """Return the share of a vertical force at attachment i in a component of the scaled wrench."""
    c, reach = pose.cables, pose.scale[REACH]
    if row == 2:
        return 1.0
    if row == 3:
        return float(c[RY, i] / reach)
    return -float(c[RX, i] / reach) if row == 4 else 0.0


@element
def smallest_pull(pose: Pose, i: int, floor: float) -> tuple[float, float]:
    """Return the smallest scaled pull of a cable, and its rise per scaled c.

    Of the line that touches the least tension in the cable at the present pull.
    """
    c, scale = pose.cables, pose.scale
    if c[LEAST, i] > 0.0:
        slope = c[LOWEST_P, i] * c[UNIT, i]
        low_c = c[LEAST, i] * scale[FORCE] / (scale[SIZE] * slope)
        return c[P, i] / c[UNIT, i] - c[LOWEST, i] / slope, low_c
    return floor / c[UNIT, i], 0.0


@element
def pose_programme(lp: Programme, pose: Pose, ask: Ask, floor: float) -> None:
    """Write the linearised pose as a linear programme in the rooms below the strengths.

    The scaled pulls are y = u + s u' - z with u + s u' the pull at which the linearised top tension
    reaches its limit.
    """
    c, rows, load, _, scale = pose
    table = lp.table
    m, n = lp.basis.size, lp.dual.size
    for i in range(n):
        hangs = c[HANGS, i] > 0.0
        rest, slope = _tension_line(c, i)
        reach = 1.0 / (slope * c[UNIT, i])
        low, low_c = smallest_pull(pose, i, floor)
        top = (ask.f_0 * c[STRENGTH, i] - rest) * reach
        top_s = ask.f_s * c[STRENGTH, i] * reach
        # The pull of a hanging cable is settled elsewhere: here it is a part of the load.
        c[TOP, i] = c[P, i] / c[UNIT, i] if hangs else top
        c[TOP_S, i] = 0.0 if hangs else top_s
        lp.room[i] = 0.0 if hangs else top - low - low_c * ask.c_0
        lp.room_slope[i] = 0.0 if hangs else top_s - low_c * ask.c_s
        c[UP, i] = c[SHARE, i] * (c[V, i] - c[V_P, i] * c[P, i]) / scale[FORCE]
    write_wrenches(pose)
    for k in range(m):
        row = rows[k]
        slope, rest = ask.c_s * load[row], -ask.c_0 * load[row]
        for i in range(n):
            table[k, i] = c[WRENCH + row, i]
            slope -= table[k, i] * c[TOP_S, i]
            rest += table[k, i] * c[TOP, i] + c[UP, i] * lift(pose, row, i)
        lp.slope[k] = table[k, n] = slope
        table[k, n + 1] = rest
    for i in range(n):
        if c[HANGS, i] > 0.0:
            for k in range(m):
                table[k, i] = 0.0


@element
def pull_of(lp: Programme, pose: Pose, ask: Ask, i: int) -> float:
    """Return the pull of a cable in the solution of the linear programme."""
    c = pose.cables
    if c[HANGS, i] > 0.0:
        return float(c[P, i])
    n = lp.dual.size
    limit = (ask.f_0 + lp.z[n] * ask.f_s) * c[STRENGTH, i]
    rest, slope = _tension_line(c, i)
    return float((limit - rest) / slope - lp.z[i] * c[UNIT, i])


@element
def _tension_line(c: FloatArray, i: int) -> tuple[float, float]:
    """Return the linear top tension: its value at no pull, and its slope.

    A cable so slack that its tension falls with the pull is far from its strength, and taken as
    straight; were it to come near, it would be taut.
    """
    if c[T_P, i] > _LEAST_SLOPE * c[CHORD, i]:
        return c[T, i] - c[T_P, i] * c[P, i], c[T_P, i]
    return 0.5 * abs(c[D, i]), c[CHORD, i]
