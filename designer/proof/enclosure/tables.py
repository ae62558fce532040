"""What is known of a box of poses while it is bounded: tables of intervals, and their names."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from designer.arrays import FloatArray, IntArray
from designer.kernel.compiling import inner
from designer.proof.enclosure.interval import Interval

# Of a cable over the box: vector to the exit point and lever, by components.
EX, EY, EZ, RX, RY, RZ = range(6)
# Of a cable over the box: l, v and t with their slopes in p, X² and D; then p.
L, L_P, L_X2, L_D, V, V_P, V_X2, V_D, T, T_P, T_X2, T_D, PULL = range(13)
# What is told of a box.
BOUND, ESTIMATE, CUT, CABLE, SPARE = range(5)
TOLD = 5
"""Then, from here on, where in the box the estimate is met, one number a coordinate."""


class Scene(NamedTuple):
    """What is the same of all boxes: of unit weight per length, upright frame.

    Parameters
    ----------
    rows : array (m,)
        Which components of force and moment, 0 … 5, are balanced.
    kappa, strength, least : float
        Weight over stiffness [1/m]; allowable tension and least tension over weight [m].
    sag : float
        Largest sag over chord; infinite for any.
    inverse_weight : float
        1 / weight per length [m/N].
    reach : float
        Size of the levers, that moments are measured by; 1 for a point mass [m].
    fuzz : float
        Bound on what rounding did to vectors and levers [m].
    axes : array (3, 3)
        How the position moves with each of its three coordinates.
    level : float
        Utilisation to be proved.
    """

    rows: IntArray
    kappa: float
    strength: float
    least: float
    sag: float
    inverse_weight: float
    reach: float
    fuzz: float
    axes: FloatArray
    level: float


class Boxes(NamedTuple):
    """Boxes of poses (n_boxes,), with three coordinates of position, then three or none of turn.

    Parameters
    ----------
    half : array (n_boxes, k)
        Half of their sizes.
    corners : array (n_boxes, n_corners, 2)
        Corners of what of the box lies in the region, first two coordinates, from the middle.
    vectors, levers : array (n_boxes, n, 3)
        From attachment to exit point, and from the platform's origin to the attachment, in the
        middle [m].
    turns : array (n_boxes, n, 3, k - 3)
        Slopes of the levers with the turn there.
    load : array (n_boxes, 6)
        What the cables have to pull with there [N, N·m].
    load_turns : array (n_boxes, 3, k - 3)
        Slopes of its moment with the turn.
    bent : array (n_boxes, n + 1)
        Bound on how far slopes of levers, and of the moment, from the middle are from these.
    pull : array (n_boxes, n)
        p₀.
    follow : array (n_boxes, n, k)
        What P should be, as far as balance lets it.
    """

    half: FloatArray
    corners: FloatArray
    vectors: FloatArray
    levers: FloatArray
    turns: FloatArray
    load: FloatArray
    load_turns: FloatArray
    bent: FloatArray
    pull: FloatArray
    follow: FloatArray


class Work(NamedTuple):
    """Arrays of one box; the last axis of size two holds the ends of intervals."""

    at: FloatArray  # (n, 6, 2)
    start_at: FloatArray  # (n, 6, 2), the same in the middle of the box
    mean: FloatArray  # (n, 6, 2), half the sum of both
    slope: FloatArray  # (n, 6, k, 2), of the same, from the middle
    cable: FloatArray  # (n, 13, 2)
    share: FloatArray  # (n, 2), μ of a point mass on three cables
    level: FloatArray  # (n, 6, 2), wrench of a unit pull
    lift: FloatArray  # (n, 6, 2), wrench of a unit upward pull
    start_level: FloatArray  # (n, 6, 2), the same in the middle of the box
    start_lift: FloatArray  # (n, 6, 2)
    of_x: FloatArray  # (m, k, 2), slopes of the balance
    of_u: FloatArray  # (m, m, 2), identity less slopes
    start: FloatArray  # (m,), size of the balance in the middle
    P: FloatArray  # (n, k)
    Z: FloatArray  # (n, m)
    U: FloatArray  # (m,)
    trial: FloatArray  # (m,)
    G: FloatArray  # (n, m), slopes of the balance in the pulls, moments over the reach
    weight: FloatArray  # (n,), how free the pulls are
    start_t: FloatArray  # (n,), largest tension in the middle
    start_low: FloatArray  # (n, 2), squares of least tension and level force there
    tilt: FloatArray  # (k,), middles of the slopes of a tension
    spread: FloatArray  # (k,), and how far from them the slopes may be
    system: FloatArray  # (m, m + 1)
    solution: FloatArray  # (m,)


@inner
def new_work(n: int, m: int, k: int) -> Work:
    """Return the arrays for n cables, m balanced directions and k coordinates."""
    return Work(
        np.zeros((n, 6, 2)),
        np.zeros((n, 6, 2)),
        np.zeros((n, 6, 2)),
        np.zeros((n, 6, k, 2)),
        np.zeros((n, 13, 2)),
        np.zeros((n, 2)),
        np.zeros((n, 6, 2)),
        np.zeros((n, 6, 2)),
        np.zeros((n, 6, 2)),
        np.zeros((n, 6, 2)),
        np.zeros((m, k, 2)),
        np.zeros((m, m, 2)),
        np.zeros(m),
        np.zeros((n, k)),
        np.zeros((n, m)),
        np.zeros(m),
        np.zeros(m),
        np.zeros((n, m)),
        np.zeros(n),
        np.zeros(n),
        np.zeros((n, 2)),
        np.zeros(k),
        np.zeros(k),
        np.zeros((m, m + 1)),
        np.zeros(m),
    )


@inner
def get(table: FloatArray) -> Interval:
    """Return an interval (2,) of a table."""
    return table[0], table[1]


@inner
def put(table: FloatArray, a: Interval) -> None:
    """Put an interval into a table."""
    table[0], table[1] = a
