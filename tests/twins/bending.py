"""What flexural rigidity does to the shape of a cable: the stiff elastica by finite differences.

In the cable's plane with tangent angle a(s) and tension vector N(s) of size n and direction b,
moment balance reads  EI a'' = n (1 + strain) sin(a - b),  with the cable clamped along its chord at
both ends. Cosine-spaced nodes resolve the boundary layers of width √(EI/n).
"""

from __future__ import annotations

import numpy as np

POINTS = 257
NEWTON_STEPS = 6


def bending_shift_m(bending_N_m2, stiffness_N, chord, pull, weight, down, length) -> np.ndarray:
    """Return how far bending moves the cable's end from where the limp cable ends (..., 3) [m].

    Parameters
    ----------
    bending_N_m2, stiffness_N : array (rows, cables)
        EI [N m²] and EA [N].
    chord, pull, weight : array (rows, cables, 3)
        From platform to exit [m], tension vector at the platform [N], weight of the cable [N].
    down : array (3,)
        Unit vector along gravity.
    length : array (rows, cables)
        Unstrained length [m].
    """
    level = chord - (chord @ down)[..., None] * down
    level /= np.linalg.norm(level, axis=-1, keepdims=True)
    flat = [(v * level).sum(-1) - 1j * (v @ down) for v in (chord, pull, weight)]
    grid = (1 - np.cos(np.pi * np.arange(POINTS) / (POINTS - 1))) / 2
    tension = flat[1] - flat[2] * grid[:, None, None]  # first axis: nodes
    size, limp = np.abs(tension), np.angle(tension)
    rate = size * (1 + size / stiffness_N) * length**2 / np.maximum(bending_N_m2, 1e-12)
    angle = _stiff_angle(grid, rate, limp, np.angle(flat[0]))
    stiff_unit = np.exp(1j * angle)
    stretch = 1 + (tension * stiff_unit.conj()).real / stiffness_N
    change = stretch * stiff_unit - (1 + size / stiffness_N) * np.exp(1j * limp)
    shift = length * np.trapezoid(change, grid, axis=0)
    return shift.real[..., None] * level - shift.imag[..., None] * down


def _stiff_angle(grid, rate, limp, clamp) -> np.ndarray:
    """Solve a'' = rate sin(a - limp), a = clamp at both ends, over the unit interval."""
    angle = limp.copy()
    angle[0] = angle[-1] = clamp
    before, after = np.diff(grid)[:-1, None, None], np.diff(grid)[1:, None, None]
    lower, upper = 2 / (before * (before + after)), 2 / (after * (before + after))
    for _ in range(NEWTON_STEPS):
        lack = angle[1:-1] - limp[1:-1]
        curve = lower * angle[:-2] - (lower + upper) * angle[1:-1] + upper * angle[2:]
        diagonal = -(lower + upper) - rate[1:-1] * np.cos(lack)
        angle[1:-1] -= _tridiagonal(lower, diagonal, upper, curve - rate[1:-1] * np.sin(lack))
    return angle


def _tridiagonal(lower, diagonal, upper, right) -> np.ndarray:
    """Thomas' elimination along the first axis."""
    diagonal, right = diagonal.copy(), right.copy()
    for k in range(1, len(diagonal)):
        factor = lower[k] / diagonal[k - 1]
        diagonal[k] -= factor * upper[k - 1]
        right[k] -= factor * right[k - 1]
    right[-1] /= diagonal[-1]
    for k in range(len(diagonal) - 2, -1, -1):
        right[k] = (right[k] - upper[k] * right[k + 1]) / diagonal[k]
    return right
