"""Small linear systems: many at once, one per lane, and one alone."""

from __future__ import annotations

from designer.arrays import FloatArray, IntArray
from designer.kernel.compiling import element, inner


@element
def copy(source: FloatArray | IntArray, target: FloatArray | IntArray) -> None:
    """Copy numbers (n,); to assign an array would compile messages about shapes, for seconds."""
    for k in range(target.size):
        target[k] = source[k]


@element
def fill(target: FloatArray | IntArray, value: float) -> None:
    """Set all numbers (n,) to a value, as `copy` does to those of an array."""
    for k in range(target.size):
        target[k] = value


@element
def are_below(values: FloatArray, limit: float) -> bool:
    """Tell whether all values (n,) are below a limit; NaN is not."""
    below = True
    for value in values:
        below = below and value < limit
    return below


@inner
def solve_lanes(A: FloatArray, n: int, columns: int) -> None:
    """Solve A x = b in place in every lane by Gauss elimination with pairwise pivoting.

    Parameters
    ----------
    A : array (n + 1, columns, n_lanes)
        The matrix in the first n columns, right-hand sides in the others; these are overwritten by
        the solutions. The last row is scratch. A singular lane ends as infinity or NaN.
    n, columns : int
        Number of unknowns; number of columns with the right-hand sides.
    """
    for k in range(n):
        for r in range(k + 1, n):
            _eliminate(A[k], A[r], k, columns, A[n, 0], A[n, 1])
    for k in range(n - 1, -1, -1):
        for m in range(n, columns):
            target = A[k, m]
            for i in range(k + 1, n):
                factor, solved = A[k, i], A[i, m]
                for j in range(target.size):
                    target[j] -= factor[j] * solved[j]
            for j in range(target.size):
                target[j] /= A[k, k, j]


@inner
def _eliminate(
    upper: FloatArray,
    lower: FloatArray,
    k: int,
    columns: int,
    keep: FloatArray,
    factor: FloatArray,
) -> None:
    """Clear column k of `lower`, after moving the row with the larger entry into `upper`.

    The exchange is arithmetic (`keep` is 1 or 0), so that lanes stay in step.
    """
    for j in range(factor.size):
        a, b = upper[k, j], lower[k, j]
        keeps = abs(a) >= abs(b)
        keep[j] = 1.0 if keeps else 0.0
        # Two zeros need no exchange; the row that has this column may come later.
        pivot = a if keeps else b
        other = b if keeps else a
        factor[j] = other / pivot if pivot != 0.0 else 0.0
    for m in range(k, columns):
        for j in range(factor.size):
            a, b = upper[m, j], lower[m, j]
            keeps = keep[j] > 0.5
            top = a if keeps else b
            bottom = b if keeps else a
            upper[m, j] = top
            lower[m, j] = bottom - factor[j] * top


@inner
def solve_small(A: FloatArray, x: FloatArray) -> bool:
    """Solve one system by elimination with row exchange; False if it is singular.

    Parameters
    ----------
    A : array (m, m + 1)
        The matrix and, in the last column, the right-hand side; overwritten.
    x : array (m,)
        Receives the solution.
    """
    m = x.size
    for k in range(m):
        row = k
        for i in range(k + 1, m):
            if abs(A[i, k]) > abs(A[row, k]):
                row = i
        if not abs(A[row, k]) > 0.0:
            return False
        for j in range(k, m + 1):
            A[k, j], A[row, j] = A[row, j], A[k, j]
        for i in range(k + 1, m):
            factor = A[i, k] / A[k, k]
            for j in range(k, m + 1):
                A[i, j] -= factor * A[k, j]
    for k in range(m - 1, -1, -1):
        total = A[k, m]
        for j in range(k + 1, m):
            total -= A[k, j] * x[j]
        x[k] = total / A[k, k]
    return True
