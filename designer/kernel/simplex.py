"""A small linear programme by the dual simplex method, one for each pose.

    maximise s   subject to   Σⱼ Aⱼ zⱼ + s h = r,   0 ≤ zⱼ ≤ uⱼ + s u'ⱼ,   u' ≤ 0

There are n unknowns z and m ≤ n equations. At a vertex all z but m - 1 rest on a bound; s and those
m - 1 follow from the equations. As every room shrinks while s grows, any choice of m - 1 unknowns
becomes one from which s cannot grow further by resting the others as the signs in the row of s
tell. So the dual simplex method needs no first phase, and any choice will do as a start.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from designer.arrays import FloatArray, IntArray
from designer.kernel.compiling import allocating, element

OPTIMAL, INFEASIBLE, STALLED = range(3)

_TOLERANCE = 1e-11
"""Violation of a bound that is rounding; bounds are about one."""
_RANK = 1e-9
"""Largest element of a row below which it depends on the others."""
_SMALLEST_PIVOT, _DOUBTFUL_PIVOT = 1e-10, 1e-6
_STEEPEST = 1e9
"""Fall of s at a vertex that hardly depends on it."""
_MOST_PIVOTS = 60
"""And as many again as there are unknowns."""
_NOWHERE, _AT_ZERO, AT_TOP = range(3)


class Programme(NamedTuple):
    """Arrays of one linear programme.

    Parameters
    ----------
    table : array (m, n + 2)
        Columns of z, then h and r; while solving, eliminated so that `basis` has unit columns.
    written : array (m, n + 2)
        The table as it was when elimination began.
    slope : array (m,)
        Column h, kept.
    basis : array (m,)
        The unknown that each row is solved for; s counts as unknown n and is always among them.
    rests : array (n,)
        Where each unknown rests: at zero, at its upper bound, or nowhere, being in the basis.
    room, room_slope : array (n,)
        Upper bounds u and u'.
    z : array (n + 1,)
        The unknowns, s last.
    dual : array (n,)
        By how much s falls where the active bound moves inward by one; negative on upper bounds.
    """

    table: FloatArray
    written: FloatArray
    slope: FloatArray
    basis: IntArray
    rests: IntArray
    room: FloatArray
    room_slope: FloatArray
    z: FloatArray
    dual: FloatArray


@allocating
def new_programme(m: int, n: int) -> Programme:
    """Return the arrays for n unknowns in m equations."""
    return Programme(
        np.zeros((m, n + 2)),
        np.zeros((m, n + 2)),
        np.zeros(m),
        np.zeros(m, dtype=np.int64),
        np.ones(n, dtype=np.int64),
        np.zeros(n),
        np.zeros(n),
        np.zeros(n + 1),
        np.zeros(n),
    )


@element
def choose_basis(lp: Programme) -> bool:
    """Eliminate, choosing the largest element of each row; False if the rows are dependent.

    The other unknowns then rest where s cannot grow.
    """
    table, basis = lp.table, lp.basis
    m, n = basis.size, lp.dual.size
    _copy(table, lp.written)
    for k in range(m):
        best, size = 0, 0.0
        for j in range(n):
            if abs(table[k, j]) > size:
                best, size = j, abs(table[k, j])
        if not size > _RANK:
            return False
        _pivot(table, k, best)
        basis[k] = best
    row, size = 0, 0.0
    for k in range(m):
        if abs(table[k, n]) > size:
            row, size = k, abs(table[k, n])
    if not size > _RANK:
        return False
    _pivot(table, row, n)
    basis[row] = n
    _rest(lp)
    return True


@element
def rebuild(lp: Programme) -> bool:
    """Eliminate the columns of the present basis; False if they are dependent."""
    _copy(lp.table, lp.written)
    return _eliminate(lp)


@element
def _copy(source: FloatArray, target: FloatArray) -> None:
    for k in range(source.shape[0]):
        for j in range(source.shape[1]):
            target[k, j] = source[k, j]


@element
def _eliminate(lp: Programme) -> bool:
    table, basis = lp.table, lp.basis
    m, width = basis.size, table.shape[1]
    for k in range(m):
        column = basis[k]
        row, size = k, abs(table[k, column])
        for i in range(k + 1, m):
            if abs(table[i, column]) > size:
                row, size = i, abs(table[i, column])
        if not size > _SMALLEST_PIVOT:
            return False
        if row != k:
            for j in range(width):
                table[k, j], table[row, j] = table[row, j], table[k, j]
        _pivot(table, k, column)
    return True


@element
def maximise(lp: Programme) -> int:
    """Solve from an eliminated table and where unknowns rest; return `OPTIMAL` or why not."""
    is_fresh = True
    for turn in range(_MOST_PIVOTS + lp.dual.size):
        s_row = _vertex(lp)
        if _has_closed(lp) or (turn == 0 and not _is_summit(lp)):
            # Beyond the s at which some room closes the bounds cross, and where another table was
            # at its summit this one may not be: rest anew, and come down.
            _rest(lp)
            s_row = _vertex(lp)
        row, at_upper, excess = most_violated(lp)
        if excess <= _TOLERANCE:
            return STALLED if _has_closed(lp) else OPTIMAL
        entering = _entering(lp, row, at_upper)
        is_doubtful = entering < 0 or abs(lp.table[row, entering]) < _DOUBTFUL_PIVOT
        if is_doubtful and not is_fresh:  # it may be what rounding has left
            _copy(lp.written, lp.table)
            if not _eliminate(lp):
                return STALLED
            is_fresh = True
            continue
        if entering < 0:
            return INFEASIBLE
        if row == s_row or not abs(lp.table[row, entering]) > _SMALLEST_PIVOT:
            return STALLED
        is_fresh = False
        _pivot(lp.table, row, entering)
        lp.rests[lp.basis[row]] = AT_TOP if at_upper else _AT_ZERO
        lp.rests[entering] = _NOWHERE
        lp.basis[row] = entering
    return STALLED


@element
def _rest(lp: Programme) -> None:
    """Let the unknowns outside the basis rest where s cannot grow."""
    n = lp.dual.size
    s_row = 0
    for k in range(lp.basis.size):
        if lp.basis[k] == n:
            s_row = k
    for j in range(n):
        lp.rests[j] = _AT_ZERO if lp.table[s_row, j] >= 0.0 else AT_TOP
    for k in range(lp.basis.size):
        if k != s_row:
            lp.rests[lp.basis[k]] = _NOWHERE


@element
def _vertex(lp: Programme) -> int:
    """Fill z and dual at the present basis; return the row of s."""
    table, basis, rests, z, dual = lp.table, lp.basis, lp.rests, lp.z, lp.dual
    m, n = basis.size, dual.size
    s_row = 0
    for k in range(m):
        if basis[k] == n:
            s_row = k
    coupling, s = 1.0, table[s_row, n + 1]
    for j in range(n):
        if rests[j] == AT_TOP:
            coupling += table[s_row, j] * lp.room_slope[j]
            s -= table[s_row, j] * lp.room[j]
    s /= coupling
    z[n] = s
    for j in range(n):
        z[j] = lp.room[j] + s * lp.room_slope[j] if rests[j] == AT_TOP else 0.0
        dual[j] = table[s_row, j] / coupling if rests[j] != _NOWHERE else 0.0
    for k in range(m):
        if k != s_row:
            value = table[k, n + 1]
            for j in range(n):
                value -= table[k, j] * z[j] if rests[j] == AT_TOP else 0.0
            z[basis[k]] = value
    return s_row


@element
def _is_summit(lp: Programme) -> bool:
    """Tell whether s falls wherever an unknown leaves its bound."""
    for j in range(lp.dual.size):
        fall = -lp.dual[j] if lp.rests[j] == AT_TOP else lp.dual[j]
        if not 0.0 <= fall < _STEEPEST:
            return False
    return True


@element
def _has_closed(lp: Programme) -> bool:
    """Tell whether s is so large that some unknown has no room left."""
    n = lp.dual.size
    least = np.inf
    for j in range(n):
        least = min(least, lp.room[j] + lp.z[n] * lp.room_slope[j])
    return bool(least < -_TOLERANCE)


@element
def most_violated(lp: Programme) -> tuple[int, bool, float]:
    """Return row, side and amount of the worst violation among the unknowns of the basis."""
    worst_row, at_upper, worst = -1, False, 0.0
    s = lp.z[lp.dual.size]
    for k in range(lp.basis.size):
        j = lp.basis[k]
        if j == lp.dual.size:
            continue
        below = -lp.z[j]
        above = lp.z[j] - lp.room[j] - s * lp.room_slope[j]
        excess = max(below, above)
        if not excess <= worst:
            worst_row, at_upper, worst = k, above > below, excess
    return worst_row, at_upper, worst


@element
def _entering(lp: Programme, row: int, at_upper: bool) -> int:
    """Return the unknown that repairs the violated one at the least cost in s; -1 for none."""
    table, dual = lp.table, lp.dual
    n = dual.size
    couplings = lp.room_slope[lp.basis[row]] if at_upper else 0.0
    for j in range(n):
        if lp.rests[j] == AT_TOP:
            couplings += table[row, j] * lp.room_slope[j]
    best, lowest, size = -1, np.inf, 0.0
    for j in range(n):
        g = table[row, j] - couplings * dual[j]
        rises = -g if lp.rests[j] == _AT_ZERO else g  # of the violated one, as j leaves its bound
        helps = -rises if at_upper else rises
        if lp.rests[j] != _NOWHERE and helps > _SMALLEST_PIVOT:
            ratio = abs(dual[j]) / helps
            if ratio < lowest or (ratio == lowest and helps > size):
                best, lowest, size = j, ratio, helps
    return best


@element
def _pivot(table: FloatArray, row: int, column: int) -> None:
    """Make the column a unit column with its one in this row."""
    m, width = table.shape
    factor = 1.0 / table[row, column]
    for j in range(width):
        table[row, j] *= factor
    for i in range(m):
        if i != row:
            factor = table[i, column]
            for j in range(width):
                table[i, j] -= factor * table[row, j]
