"""Cables and poses in 60 digits: Riehl's equations as they stand, solved by Newton with mpmath.

A row of unknowns per cable is (l, F_x, F_z). Nothing of the package's formulation is in here, only
the paper's equations (7) and (8) and the platform's balance; `mpmath` carries digits enough for all
that cancels in them.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import mpmath
import numpy as np
from mpmath import mpf

DIGITS = 60
EPS = float(np.finfo(float).eps)


@dataclass(frozen=True)
class Exact:
    """What Newton found, and how far one rounding of the data can move it."""

    values: np.ndarray
    moves: np.ndarray
    """Bound of the change of each value by one rounding of each term of each equation."""


def _closure(s, F, V, X, D, EA, w):
    """Return both misses, their slopes in (s, F, V), and the sizes of their terms."""
    low = V - w * s
    top, tail = mpmath.hypot(F, V), mpmath.hypot(F, low)
    arc = mpmath.asinh(V / F) - mpmath.asinh(low / F)
    turn = V / top - low / tail
    miss_x = F * s / EA + F / w * arc - X
    miss_z = V * s / EA - w * s * s / (2 * EA) + (top - tail) / w + D
    across = F / w * (1 / top - 1 / tail)
    slopes = (
        (F / EA + F / tail, s / EA + (arc - turn) / w, across),
        ((V - w * s) / EA + low / tail, across, s / EA + turn / w),
    )
    sizes = (
        abs(X) + abs(F * s / EA) + abs(F / w * arc) + abs(F * s / tail),
        abs(D) + abs(V * s / EA) + abs(w * s * s / EA) + abs(top - tail) / w + abs(low * s / tail),
    )
    return (miss_x, miss_z), slopes, sizes


def _newton(start: Sequence[float], equations) -> Exact:
    """Solve; ``equations`` returns misses, slopes and sizes of terms at the unknowns."""
    with mpmath.workdps(DIGITS):
        found = mpmath.matrix([mpf(float(one)) for one in start])
        scale = mpmath.norm(found, mpmath.inf)
        for _ in range(30):
            misses, slopes, sizes = equations(found)
            step = mpmath.lu_solve(slopes, misses)
            found = found - step
            if max(abs(s) / (abs(v) or scale) for s, v in zip(step, found, strict=True)) < 1e-25:
                break
        else:
            raise ArithmeticError("the reference does not settle")
        inverse = slopes**-1
        moves = [
            sum(abs(inverse[i, k]) * sizes[k] for k in range(len(sizes))) for i in range(len(found))
        ]
        return Exact(np.array([float(v) for v in found]), np.array([float(m) for m in moves]))


def forces(start, length, X, D, EA, w) -> Exact:
    """Return F_x and F_z of a cable of this length, from a start near by."""
    data = [mpf(float(one)) for one in (length, X, D, EA, w)]

    def equations(u):
        misses, slopes, sizes = _closure(data[0], u[0], u[1], *data[1:])
        return mpmath.matrix(misses), mpmath.matrix([row[1:] for row in slopes]), sizes

    return _newton(start, equations)


def length_and_force(start, force_x, X, D, EA, w) -> Exact:
    """Return l and F_z of a cable with this horizontal force, a number or a product of two."""
    with mpmath.workdps(DIGITS):
        force = mpmath.fprod(mpf(float(one)) for one in force_x)
    data = [mpf(float(one)) for one in (X, D, EA, w)]

    def equations(u):
        misses, slopes, sizes = _closure(u[0], force, u[1], *data)
        columns = [(row[0], row[2]) for row in slopes]
        # The force is given, so that its own rounding counts as well.
        moved = [size + abs(row[1]) * force for size, row in zip(sizes, slopes, strict=True)]
        return mpmath.matrix(misses), mpmath.matrix(columns), moved

    return _newton(start, equations)


def pose(start, exits, ends, arms, load_N, EA, w) -> Exact:
    """Return (l, F_x, F_z) of all cables of a balanced pose.

    ``exits``, ``ends`` and ``arms`` (n, 3) are exit points, attachment points, and the latter from
    the origin of the platform, where ``load_N`` hangs; no arms for a point mass.
    """
    n = len(exits)
    is_point = arms is None
    with mpmath.workdps(DIGITS):
        gap = [[mpf(float(b)) - mpf(float(a)) for a, b in zip(*pair, strict=True)]
               for pair in zip(exits, ends, strict=True)]  # fmt: skip
        X = [mpmath.hypot(g[0], g[1]) for g in gap]
        out = [(g[0] / x, g[1] / x) for g, x in zip(gap, X, strict=True)]
        reach = None if is_point else [[mpf(float(c)) for c in arm] for arm in arms]
        EA, w, load = mpf(float(EA)), mpf(float(w)), mpf(float(load_N))

    def equations(u):
        count = 3 * n
        misses, slopes = mpmath.matrix(count, 1), mpmath.matrix(count, count)
        sizes = [mpf(0)] * count
        for i in range(n):
            s, F, V = u[3 * i], u[3 * i + 1], u[3 * i + 2]
            miss, rows, size = _closure(s, F, V, X[i], -gap[i][2], EA, w)
            for k in range(2):
                misses[2 * i + k], sizes[2 * i + k] = miss[k], size[k]
                for column in range(3):
                    slopes[2 * i + k, 3 * i + column] = rows[k][column]
            parts = [(out[i][0], mpf(0)), (out[i][1], mpf(0)), (mpf(0), mpf(1))]
            if not is_point:
                a, b, c = reach[i]
                ex, ey = out[i]
                parts += [(-c * ey, b), (c * ex, -a), (a * ey - b * ex, mpf(0))]
            for k, (by_F, by_V) in enumerate(parts):
                row = 2 * n + k
                misses[row] += by_F * F + by_V * V
                slopes[row, 3 * i + 1], slopes[row, 3 * i + 2] = by_F, by_V
                sizes[row] += abs(by_F * F) + abs(by_V * V)
        misses[2 * n + 2] += load
        sizes[2 * n + 2] += load
        return misses, slopes, sizes

    return _newton(start, equations)
