"""How the arrays of one pose are laid out, where cables outnumber the degrees of freedom."""

from __future__ import annotations

from typing import NamedTuple

from designer.arrays import FloatArray, IntArray

# Rows of the cable table, one column a cable. The same for all poses: weight over stiffness, weight
# relative to w, allowable tension over weight, smallest allowed tension over relative weight.
KAPPA, SHARE, STRENGTH, LEAST = range(4)
# Of the pose: squared horizontal distance, vector to the exit point, lever, chord; pull of a
# straight cable at its strength, the unit in which pulls are measured.
X2, EX, EY, D, RX, RY, RZ, CHORD, UNIT = range(4, 13)
# State: pull, length; then upward pull on the platform and top tension, with their first and
# second slopes in the pull where the length follows the closure, and change of that length.
P, L, V, V_P, T, T_P, V_PP, T_PP, L_0, L_P = range(13, 23)
# Tension of a straight cable; 1 for a cable left to hang, 0 for one that is pulled.
STRAIGHT, HANGS = 23, 24
# Of the interior point: slack below the strength and above the smallest pull, their multipliers,
# the inverse of the diagonal of the Hessian, right-hand side, coupling with s, step.
ROOM, HEIGHT, MU_ROOM, MU_HEIGHT, FREEDOM, RHS, COUPLING, STEP = range(25, 33)
# Of a linear programme: scaled pull at the strength, its change with s, lift at no pull.
TOP, TOP_S, UP = range(33, 36)
# Scaled wrench per unit of scaled pull, force x, y, z and moment x, y, z: six rows.
WRENCH = 36
# Least tension anywhere in the cable over its weight, with its slopes in the pull, where one is
# asked for.
LOWEST, LOWEST_P, LOWEST_PP = range(42, 45)
CABLE_ROWS = 45


class Pose(NamedTuple):
    """One pose, its forces scaled: over weight per length, and over the strongest cable's strength.

    Parameters
    ----------
    cables : array (CABLE_ROWS, n)
        Rows as above.
    rows : array (m,)
        Which components of force and moment, 0 … 5, are balanced.
    load : array (6,)
        What the cables have to pull with, over its own size; moments over the reach.
    rest : array (6,)
        What is left of the balance.
    scale : array (3,)
        Strength of the strongest cable over w [m], size of the load [N], reach of the attachments
        [m].
    """

    cables: FloatArray
    rows: IntArray
    load: FloatArray
    rest: FloatArray
    scale: FloatArray


FORCE, SIZE, REACH = range(3)


class Ask(NamedTuple):
    """What is asked: the largest s, with c = c_0 + s c_s and load factors up to f_0 + s f_s.

    Sizing asks for the largest inverse weight c at load factor 1; a given cable for the smallest
    largest load factor, so s is its negative.
    """

    c_0: float
    c_s: float
    f_0: float
    f_s: float


class Scratch(NamedTuple):
    """Arrays for intermediate results.

    Parameters
    ----------
    columns : array (n, m)
        Slopes of the balance in the scaled pulls, one row a cable.
    schur : array (m + 1, m + 2)
        A Newton step in the multipliers and s, with its right-hand side.
    step : array (m + 1,)
        Its solution.
    rest, dual : array (m,)
        What is left of the balance, and its multipliers.
    square : array (m, m + 1)
        The system for `value`, with its right-hand side.
    value : array (m,)
        By how much s rises with each component of the scaled wrench.
    """

    columns: FloatArray
    schur: FloatArray
    step: FloatArray
    rest: FloatArray
    dual: FloatArray
    square: FloatArray
    value: FloatArray
