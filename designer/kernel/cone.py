r"""Which poses no cables whatever can hold, straight or sagging: the cone of all their wrenches.

Gravity is all that acts on a cable between its ends, so that in its vertical plane it is a convex
curve: where it holds the platform it never rises more steeply toward the exit point than its chord.
Whatever its section, its elasticity and its length, its wrench is therefore

    a · (wrench of the straight cable) + b · (wrench of a force straight down at its attachment)

with a ≥ 0 and b ≥ 0; a is the tension where it runs parallel to its chord, hence no less than the
smallest allowed tension. What the cables can do lies in the cone of these 2 n rays, behind the
wrench of the smallest tensions. If the load lies outside, the shortest way from the cone to the
load is a wrench y that separates them (Farkas' lemma): y · ray ≤ 0 for every ray, y · load > 0.

What is proved. The nearest point of the cone is found by non-negative least squares (Lawson and
Hanson, Solving Least Squares Problems (1974), chapter 23); whoever found y, the two inequalities
are then evaluated for unit rays and a unit load. In doubles the first hold to rounding, so that
the statement is: cables that held the pose would pull with more than `_BEYOND` times the load.

A pulley moves the point where a cable leaves it. As long as the attachment is farther from the exit
point than the pulley is wide, all of the pulley lies below the straight cable's line as seen from
the platform, and a cable that sags leaves at a point from which its chord rises less: the ray of
the straight cable over the pulley still bounds it. Nearer ones are left without a claim.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from designer.arrays import FloatArray, IntArray, VerdictArray
from designer.kernel.answer import NOT_CONVERGED, NOT_FOUND, OUTSIDE_HULL, RANK_DEFICIENT
from designer.kernel.calling import CableFigures, Situation
from designer.kernel.compiling import allocating, element, inner, kernel
from designer.kernel.linear import copy
from designer.kernel.pose import (
    LEAST,
    SIZE,
    WRENCH,
    Pose,
    make_straight,
    new_pose,
    place,
    write_wrenches,
)
from designer.kernel.table import LIFT

_BEYOND = 1e6
_ROUNDING = 1e-15
_LEAST_SEPARATION = 1e-8
_RANK = 1e-9
"""Length of what is left of a unit ray, others taken out, below which it depends on them."""
_ENTERS = 1e-12
"""Product of a ray with what is left of the load above which it can still help."""
_MOST_TURNS = 40


class Cone(NamedTuple):
    """Arrays for the search of the nearest point of a cone.

    Parameters
    ----------
    rays : array (n_rays, m)
        Unit rays; here those of the straight cables, then those of forces straight down.
    load, rest : array (m,)
        What is to be reached, and what is left of it: the separating wrench.
    share, trial : array (n_rays,)
        Of each ray, before and in a turn.
    used : array (n_rays,)
        The rays in use, in the order in which they came.
    basis : array (m + 1, m)
        Orthonormal basis of those rays.
    triangle : array (m + 1, m + 2)
        The rays in that basis, and the load in the last column.
    """

    rays: FloatArray
    load: FloatArray
    rest: FloatArray
    share: FloatArray
    trial: FloatArray
    used: IntArray
    basis: FloatArray
    triangle: FloatArray


@allocating
def new_cone(m: int, n_rays: int) -> Cone:
    """Return the arrays for so many rays and m balanced components."""
    return Cone(
        np.zeros((n_rays, m)),
        np.zeros(m),
        np.zeros(m),
        np.zeros(n_rays),
        np.zeros(n_rays),
        np.zeros(n_rays, dtype=np.int64),
        np.zeros((m + 1, m)),
        np.zeros((m + 1, m + 2)),
    )


@kernel
def refuse_range(
    start: int,
    stop: int,
    situation: Situation,
    figures: CableFigures,
    out_wrench: FloatArray,
    out_separation: FloatArray,
    out_verdict: VerdictArray,
) -> None:
    """Say of the poses `start` to `stop`, which nothing has solved, what is proved of them.

    Rank deficient: straight cables leave some wrench without any tension. Outside the hull: the
    cone does not hold the load; then with the separating wrench, and its product with the load,
    both of unit length, moments over the reach of the attachments. Not found: the cone of straight
    cables alone does not hold the load. Not converged: nothing is proved.
    """
    n = situation.attachments.shape[0]
    pose = new_pose(situation, figures)
    cone = new_cone(situation.rows.size, 2 * n)
    for at in range(start, stop):
        place(pose, situation, figures, at)
        out_verdict[at] = NOT_CONVERGED
        out_separation[at] = np.nan
        out_wrench[at] = np.nan
        if not _set_rays(pose, cone):
            continue
        if not _spans(cone, n):
            out_verdict[at] = RANK_DEFICIENT
        elif _separation(cone, n) > 0.0:
            out_verdict[at] = NOT_FOUND
            separation = _separation(cone, 2 * n)
            if separation > 0.0:
                out_verdict[at] = OUTSIDE_HULL
                out_separation[at] = separation
                copy(cone.rest, out_wrench[at])


@inner
def _set_rays(pose: Pose, cone: Cone) -> bool:
    """Fill rays and load; False where some cable has no length, hence no direction, or no load."""
    c, rows = pose.cables, pose.rows
    n = c.shape[1]
    make_straight(pose, 0.0)
    write_wrenches(pose)
    for k in range(rows.size):
        cone.load[k] = pose.load[rows[k]]
        for i in range(n):
            cone.rays[i, k] = c[WRENCH + rows[k], i]
            cone.rays[n + i, k] = -c[LIFT + rows[k], i]
            cone.load[k] -= c[LEAST, i] / pose.scale[SIZE] * cone.rays[i, k]
    for i in range(n):
        normalise(cone.rays[n + i])
        if not 0.0 < normalise(cone.rays[i]) < np.inf:
            return False
    return 0.0 < normalise(cone.load) < np.inf


@element
def product(a: FloatArray, b: FloatArray) -> float:
    """Return the product of two vectors (n,)."""
    total = 0.0
    for q in range(a.size):
        total += a[q] * b[q]
    return total


@inner
def normalise(vector: FloatArray) -> float:
    """Bring a vector to unit length, unless it has none; return what it had."""
    size = math.sqrt(product(vector, vector))
    for q in range(vector.size):
        vector[q] /= size if size > 0.0 else 1.0
    return size


@inner
def _spans(cone: Cone, n: int) -> bool:
    """Tell whether straight cables span all wrenches: elimination, the longest remainder first."""
    for k in range(cone.rest.size):
        best = 0.0
        for i in range(n):
            copy(cone.rays[i], cone.rest)
            size = _clear(cone.rest, cone.basis, k)
            if size > best:
                best = size
                copy(cone.rest, cone.basis[k])
        if not best > _RANK:
            return False
        normalise(cone.basis[k])
    return True


@inner
def _clear(vector: FloatArray, basis: FloatArray, count: int) -> float:
    """Take its share in the first rows of a basis from a vector, twice; return what is left."""
    for _ in range(2):
        for k in range(count):
            share = product(basis[k], vector)
            for q in range(vector.size):
                vector[q] -= share * basis[k, q]
    return math.sqrt(product(vector, vector))


@inner
def restart(cone: Cone) -> None:
    """Use no ray."""
    cone.share[:] = 0.0
    copy(cone.load, cone.rest)


@inner
def reach(cone: Cone, n_rays: int, count: int) -> int:
    """Find the point of the first rays' cone that is nearest to the load.

    From where `count` rays are in use; returns how many then are, -1 if it fails.
    """
    rays, share, used = cone.rays, cone.share, cone.used
    for _ in range(_MOST_TURNS + n_rays):
        best, entering = _ENTERS, -1
        for j in range(n_rays):
            gain = product(rays[j], cone.rest)
            if gain > best and share[j] == 0.0:
                best, entering = gain, j
        if entering < 0:
            return count
        if count == cone.rest.size:
            return -1
        used[count] = entering
        count = _settle(cone, count + 1)
        if count < 0:
            return -1
    return -1


@inner
def _settle(cone: Cone, count: int) -> int:
    """Go toward the nearest point of the rays in use, and drop those that would have to push.

    Returns how many stay, -1 if they depend on each other.
    """
    share, trial, used = cone.share, cone.trial, cone.used
    while _project(cone, count):
        step, leaves = 1.0, -1
        for k in range(count):
            j = used[k]
            if trial[j] <= 0.0 and share[j] < step * (share[j] - trial[j]):
                step, leaves = share[j] / (share[j] - trial[j]), k
        for k in range(count):
            share[used[k]] += step * (trial[used[k]] - share[used[k]])
        if leaves < 0:
            return count
        share[used[leaves]] = 0.0
        count -= 1
        for k in range(leaves, count):
            used[k] = used[k + 1]
    return -1


@inner
def _project(cone: Cone, count: int) -> bool:
    """Fill the shares that bring the rays in use nearest to the load, and what is left of it.

    False if those rays depend on each other.
    """
    basis, triangle = cone.basis, cone.triangle
    for k in range(count):
        copy(cone.rays[cone.used[k]], basis[k])
        if not _clear(basis[k], basis, k) > _RANK:
            return False
        normalise(basis[k])
    for k in range(count):
        for j in range(k, count):
            triangle[k, j] = product(basis[k], cone.rays[cone.used[j]])
        triangle[k, count] = product(basis[k], cone.load)
    for k in range(count - 1, -1, -1):
        total = triangle[k, count]
        for j in range(k + 1, count):
            total -= triangle[k, j] * cone.trial[cone.used[j]]
        cone.trial[cone.used[k]] = total / triangle[k, k]
    copy(cone.load, cone.rest)
    _clear(cone.rest, basis, count)
    return True


@inner
def _separation(cone: Cone, n_rays: int) -> float:
    """Return the product of the wrench that separates the first rays from the load with the load.

    Both of unit length; 0 where the load is not proved to lie outside.
    """
    restart(cone)
    if reach(cone, n_rays, 0) < 0:
        return 0.0
    if not normalise(cone.rest) > 0.0:
        return 0.0
    largest = _ROUNDING
    for j in range(n_rays):
        largest = max(largest, product(cone.rays[j], cone.rest))
    separation = product(cone.rest, cone.load)
    return separation if separation > max(_LEAST_SEPARATION, _BEYOND * largest) else 0.0
