r"""Does a cable hold in a whole box of poses: existence of an equilibrium, and a bound on tensions.

Let x be the coordinates of a pose as seen from the middle of the box, |x_k| ≤ h_k, and F(p, x) the
balance of the platform where the cables pull by p, with lengths that close them (see `cable`).
Pulls are tried that follow the pose, and are mended by as many numbers u as there are balanced
directions,

    p(x, u) = p₀ + P x + Z u,      F(x, u) = F(p(x, u), x).

p₀ solves the middle, nearly; Z is such that ∂F/∂u is nearly the identity, and P such that ∂F/∂x is
nearly zero. Where there are more cables than directions, the rest of P is free: internal forces.
None of that has to be exact. Let S and N enclose *slopes from the middle* over the box,

    F(x, u) - F(0, 0) = S x + (1 - N) u      for some S ∈ 𝐒, N ∈ 𝐍, of each x and u.

They are narrower than derivatives, since of each product only one factor changes at a time:
p a - p₀ a₀ = (p - p₀) a₀ + p (a - a₀), of a product of two that are known alike with the mean of
both ends of each; and a cable's force follows its pull where its ends stand in the middle, by the
mean value theorem, then its ends. So

    |u - F(x, u)|_j ≤ |F(0, 0)|_j + Σ_k |𝐒|_jk h_k + Σ_l |𝐍|_jl U_l,    |u_l| ≤ U_l.

If the right side is at most U_j for all j, then u ↦ u - F(x, u) maps the box |u| ≤ U into itself,
for every x; it is continuous, so it has a fixed point (Brouwer), and there F = 0. **So in each pose
of the box there is an equilibrium with pulls p(x, u), |u| ≤ U**: the test of Krawczyk with poses as
parameters. That it is stable, or the only one, is not claimed.

Its tensions have slopes of the same kind; since both residual and slopes' widths shrink with the
box, what this adds to the tension shrinks with the square of it. The linear part is taken at the
corners of what of the box lies in the region.
"""

from __future__ import annotations

import numpy as np

from designer.arrays import FloatArray
from designer.kernel.compiling import inner, kernel
from designer.kernel.linear import copy, solve_small
from designer.proof.enclosure.cable import enclose
from designer.proof.enclosure.interval import (
    Interval,
    add,
    around,
    middle,
    multiply,
    negate,
    point,
    scale,
    size,
    square,
    subtract,
    up,
)
from designer.proof.enclosure.tables import (
    BOUND,
    CABLE,
    CUT,
    ESTIMATE,
    EX,
    EY,
    EZ,
    L_D,
    L_P,
    L_X2,
    PULL,
    RX,
    RY,
    RZ,
    SPARE,
    T_D,
    T_P,
    T_X2,
    V_D,
    V_P,
    V_X2,
    Boxes,
    L,
    Scene,
    T,
    V,
    Work,
    get,
    new_work,
    put,
)
from designer.proof.enclosure.tension import along, bound_tension, level_square, lowest
from designer.proof.enclosure.three import bound_three, is_three

_MOST_TURNS = 5
_LARGER = 1.1
_HOPELESS = 3.0
"""Growth of U from one turn to the next after which it is given up."""
_NEAR = 1.1
"""Of the level that is asked for: bounds of three cables below which the general one is tried."""


@kernel
def bound_range(start: int, stop: int, scene: Scene, boxes: Boxes, out: FloatArray) -> None:
    """Fill what is told of the boxes `start` to `stop`.

    `BOUND` is a bound on the largest tension over the allowable one in an equilibrium that exists
    in every pose of the box, infinite where none was proved; `ESTIMATE` the same at its corners
    without what encloses it, at the coordinates from `TOLD` on; `CUT` the coordinate to halve,
    `CABLE` the cable that meets the bound, and `SPARE` by how much least tensions and pulls are
    exceeded at least, relative, NaN where that is not known.
    """
    n, k = boxes.follow.shape[1], boxes.half.shape[1]
    work = new_work(n, scene.rows.size, k)
    for at in range(start, stop):
        out[at] = 0.0
        out[at, BOUND], out[at, ESTIMATE], out[at, SPARE] = np.inf, np.nan, np.nan
        out[at, CUT] = np.argmax(boxes.half[at])
        if is_three(scene, boxes, at):
            _place(scene, boxes, at, 1.0, work)
            out[at, BOUND] = up(bound_three(scene, boxes, at, work) / scene.strength)
            if not scene.level < out[at, BOUND] < _NEAR * scene.level:
                continue
        if not _prepare(scene, boxes, at, work):
            continue
        if _exists(scene, boxes, at, work):
            bound_tension(scene, boxes, at, work, out[at])
        _choose_cut(boxes, at, work, out[at])


@inner
def _place(scene: Scene, boxes: Boxes, at: int, share: float, work: Work) -> None:
    """Enclose vectors and levers, and their slopes, over a share of the box (0 for its middle)."""
    n, k = work.P.shape
    half = boxes.half[at]
    for i in range(n):
        bent = boxes.bent[at, i]
        for c in range(3):
            reach, turn = scene.fuzz, scene.fuzz
            for d in range(k):
                if d < 3:
                    lever = point(0.0)
                    vector = point(-scene.axes[c, d])
                else:
                    lever = around(boxes.turns[at, i, c, d - 3], share * bent + scene.fuzz)
                    vector = negate(lever)
                put(work.slope[i, EX + c, d], vector)
                put(work.slope[i, RX + c, d], lever)
                reach = up(reach + up(up(share * half[d]) * size(vector)))
                turn = up(turn + up(up(share * half[d]) * size(lever)))
            put(work.at[i, EX + c], around(boxes.vectors[at, i, c], reach))
            put(work.at[i, RX + c], around(boxes.levers[at, i, c], turn))
        if share == 0.0:
            copy(work.at[i].reshape(-1), work.start_at[i].reshape(-1))
        for c in range(6):
            put(work.mean[i, c], scale(add(get(work.at[i, c]), get(work.start_at[i, c])), 0.5))


@inner
def _bend(scene: Scene, boxes: Boxes, at: int, share: float, work: Work) -> bool:
    """Enclose the cables, and their wrenches; tell whether it worked."""
    n, k = work.P.shape
    half = boxes.half[at]
    for i in range(n):
        reach = 0.0
        for d in range(k):
            reach = up(reach + up(up(share * half[d]) * abs(work.P[i, d])))
        for j in range(work.U.size):
            reach = up(reach + up(work.U[j] * abs(work.Z[i, j])))
        p = around(boxes.pull[at, i], reach)
        ex, ey, ez = get(work.at[i, EX]), get(work.at[i, EY]), get(work.at[i, EZ])
        rx, ry, rz = get(work.at[i, RX]), get(work.at[i, RY]), get(work.at[i, RZ])
        enclosure = enclose(p, add(square(ex), square(ey)), ez, scene.kappa)
        worked, length, l_p, l_X2, l_D, v, v_p, v_X2, v_D, t, t_p, t_X2, t_D = enclosure
        if share > 0.0:  # the pull changes first, while the ends stand in the middle
            start = work.start_at[i]
            X2 = add(square(get(start[EX])), square(get(start[EY])))
            enclosure = enclose(p, X2, get(start[EZ]), scene.kappa)
            l_p, v_p, t_p = enclosure[2], enclosure[6], enclosure[10]
            worked = worked and enclosure[0]
        if not worked:
            return False
        row = work.cable[i]
        put(row[L], length)
        put(row[L_P], l_p)
        put(row[L_X2], l_X2)
        put(row[L_D], l_D)
        put(row[V], v)
        put(row[V_P], v_p)
        put(row[V_X2], v_X2)
        put(row[V_D], v_D)
        put(row[T], t)
        put(row[T_P], t_p)
        put(row[T_X2], t_X2)
        put(row[T_D], t_D)
        put(row[PULL], p)
        put(work.level[i, 0], ex)
        put(work.level[i, 1], ey)
        put(work.level[i, 3], negate(multiply(rz, ey)))
        put(work.level[i, 4], multiply(rz, ex))
        put(work.level[i, 5], subtract(multiply(rx, ey), multiply(ry, ex)))
        put(work.lift[i, 2], point(1.0))
        put(work.lift[i, 3], ry)
        put(work.lift[i, 4], negate(rx))
        if share == 0.0:
            copy(work.level[i].reshape(-1), work.start_level[i].reshape(-1))
            copy(work.lift[i].reshape(-1), work.start_lift[i].reshape(-1))
    return True


@inner
def _level_slope(work: Work, i: int, row: int, d: int) -> Interval:
    """Return the slope of a cable's `level` in a coordinate."""
    s, a = work.slope[i, :, d], work.mean[i]
    if row < 2:
        return get(s[row])
    if row == 3:
        return negate(add(multiply(get(s[RZ]), get(a[EY])), multiply(get(a[RZ]), get(s[EY]))))
    if row == 4:
        return add(multiply(get(s[RZ]), get(a[EX])), multiply(get(a[RZ]), get(s[EX])))
    if row == 5:
        moment = add(multiply(get(s[RX]), get(a[EY])), multiply(get(a[RX]), get(s[EY])))
        two = add(multiply(get(s[RY]), get(a[EX])), multiply(get(a[RY]), get(s[EX])))
        return subtract(moment, two)
    return 0.0, 0.0


@inner
def _lift_slope(work: Work, i: int, row: int, d: int) -> Interval:
    if row == 3:
        return get(work.slope[i, RY, d])
    if row == 4:
        return negate(get(work.slope[i, RX, d]))
    return 0.0, 0.0


@inner
def _prepare(scene: Scene, boxes: Boxes, at: int, work: Work) -> bool:
    """Set Z, P, and the balance in the middle; tell whether the middle could be evaluated."""
    n, k = work.P.shape
    m, rows = scene.rows.size, scene.rows
    work.U[:] = 0.0
    for i in range(n):
        copy(boxes.follow[at, i], work.P[i])
    _place(scene, boxes, at, 0.0, work)
    if not _bend(scene, boxes, at, 0.0, work):
        return False
    G, weight = work.G, work.weight
    for j in range(m):
        row = rows[j]
        unit = 1.0 if row < 3 else 1.0 / scene.reach
        rest = scale(point(-boxes.load[at, row]), scene.inverse_weight)
        for i in range(n):
            p, v = get(work.cable[i, PULL]), get(work.cable[i, V])
            level, lift = get(work.level[i, row]), get(work.lift[i, row])
            rest = add(rest, add(multiply(p, level), multiply(v, lift)))
            G[i, j] = unit * (middle(level) + middle(get(work.cable[i, V_P])) * middle(lift))
        work.start[j] = size(rest)
        if row >= 3:  # what rounding did to the arm of the load
            force = abs(boxes.load[at, 0]) + abs(boxes.load[at, 1]) + abs(boxes.load[at, 2])
            work.start[j] = up(work.start[j] + 2.0 * scene.fuzz * force * scene.inverse_weight)
    for i in range(n):
        weight[i] = boxes.pull[at, i] ** 2  # so that slack cables are left nearly alone
        work.start_t[i] = work.cable[i, T, 1]
        work.start_low[i, 0] = lowest(work, i)[0]
        work.start_low[i, 1] = level_square(work, i)[0]
    if not _set_mending(scene, work):
        return False
    _slopes(scene, boxes, at, 0.0, work)
    for d in range(k):
        for i in range(n):
            for j in range(m):
                work.P[i, d] -= work.Z[i, j] * middle(get(work.of_x[j, d]))
    return True


@inner
def _set_mending(scene: Scene, work: Work) -> bool:
    """Set Z = W Gᵀ (G W Gᵀ)⁻¹, column by column; tell whether it worked."""
    G, weight, rows = work.G, work.weight, scene.rows
    n, m = G.shape
    for j in range(m):
        for a in range(m):
            for b in range(m):
                total = 0.0
                for i in range(n):
                    total += G[i, a] * weight[i] * G[i, b]
                work.system[a, b] = total
            work.system[a, m] = 0.0
        work.system[j, m] = 1.0
        if not solve_small(work.system, work.solution):
            return False
        unit = 1.0 if rows[j] < 3 else 1.0 / scene.reach
        for i in range(n):
            total = 0.0
            for a in range(m):
                total += G[i, a] * work.solution[a]
            work.Z[i, j] = weight[i] * total * unit
    return True


@inner
def _slopes(scene: Scene, boxes: Boxes, at: int, share: float, work: Work) -> None:
    """Enclose the slopes of the balance."""
    n, k = work.P.shape
    m, rows = scene.rows.size, scene.rows
    c = scene.inverse_weight
    for j in range(m):
        row = rows[j]
        for d in range(k):
            total = point(0.0)
            if row >= 3 and d >= 3:
                slope = boxes.load_turns[at, row - 3, d - 3]
                bent = share * boxes.bent[at, n] + scene.fuzz
                total = scale(around(-slope, bent), c)
            for i in range(n):
                cable = work.cable[i]
                level, lift = get(work.start_level[i, row]), get(work.start_lift[i, row])
                term = add(
                    scale(level, work.P[i, d]),
                    multiply(get(cable[PULL]), _level_slope(work, i, row, d)),
                )
                if row >= 2 and row < 5:
                    up_slope = add(scale(get(cable[V_P]), work.P[i, d]), along(work, i, d, V))
                    term = add(term, multiply(up_slope, lift))
                    term = add(term, multiply(get(cable[V]), _lift_slope(work, i, row, d)))
                total = add(total, term)
            put(work.of_x[j, d], total)
        for e in range(m):
            total = point(1.0 if e == j else 0.0)
            for i in range(n):
                cable = work.cable[i]
                level, lift = get(work.start_level[i, row]), get(work.start_lift[i, row])
                slope = add(level, multiply(get(cable[V_P]), lift))
                total = subtract(total, scale(slope, work.Z[i, e]))
            put(work.of_u[j, e], total)


@inner
def _exists(scene: Scene, boxes: Boxes, at: int, work: Work) -> bool:
    """Look for U that the map takes into itself."""
    m, k = scene.rows.size, boxes.half.shape[1]
    _place(scene, boxes, at, 1.0, work)
    for turn in range(_MOST_TURNS):
        if not _bend(scene, boxes, at, 1.0, work):
            return False
        _slopes(scene, boxes, at, 1.0, work)
        is_inside = True
        for j in range(m):
            total = work.start[j]
            for d in range(k):
                total = up(total + up(size(get(work.of_x[j, d])) * boxes.half[at, d]))
            for e in range(m):
                total = up(total + up(size(get(work.of_u[j, e])) * work.U[e]))
            work.trial[j] = total
            is_inside = is_inside and total <= work.U[j]
        if is_inside:
            return True
        if not np.max(work.trial) < 1e300:
            return False
        for j in range(m):
            if turn > 0 and work.trial[j] > _HOPELESS * work.U[j]:
                return False
            work.U[j] = max(_LARGER * work.trial[j], work.U[j])
    return False


@inner
def _choose_cut(boxes: Boxes, at: int, work: Work, out: FloatArray) -> None:
    """Choose the coordinate that adds most to the enclosure, or else that changes pulls most."""
    n, k = work.P.shape
    best = 0.0
    for d in range(k):
        share = 0.0
        if out[BOUND] < np.inf:
            i = int(out[CABLE])
            slope = add(scale(get(work.cable[i, T_P]), work.P[i, d]), along(work, i, d, T))
            share = 0.5 * (slope[1] - slope[0])
            for j in range(work.U.size):
                rest = size(scale(get(work.cable[i, T_P]), work.Z[i, j]))
                share += rest * size(get(work.of_x[j, d]))
        else:
            for i in range(n):
                far = 0.0
                for c in range(3):
                    far += abs(boxes.vectors[at, i, c])
                share += abs(work.P[i, d]) / boxes.pull[at, i]
                for c in range(3):
                    share += size(get(work.slope[i, EX + c, d])) / far
        share *= boxes.half[at, d]
        if share > best:
            best = share
            out[CUT] = d
