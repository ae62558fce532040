"""Point masses on sagging cables by SciPy alone: nothing of the package's solvers is in it."""

from __future__ import annotations

import numpy as np
from scipy.optimize import fsolve

G = 9.81
Rope = tuple[float, float, float]
"""Mass per length [kg/m], EA [N], allowable tension [N]."""


def _ends(pull: np.ndarray, length: np.ndarray, weight: float, ea: float) -> np.ndarray:
    """Return span and rise of elastic catenaries from the pull (n, 2) at their lower ends."""
    h, low = pull.T
    high = low + weight * length
    arc = np.arcsinh(high / h) - np.arcsinh(low / h)
    x = h * length / ea + h / weight * arc
    z = (low * length + weight * length**2 / 2) / ea + (
        np.hypot(h, high) - np.hypot(h, low)
    ) / weight
    return np.stack([x, z])


def utilisation(exits: np.ndarray, place: np.ndarray, load: np.ndarray, rope: Rope) -> float:
    """Return largest over allowable tension of three cables that hold a load (3,) in a place.

    Unknown are the pull at the platform, horizontal and vertical, and the length of each cable;
    known where it ends, and that the pulls hold the load. Infinite where nothing is found.
    """
    density, ea, allowable = rope
    chord = exits - place
    span, rise = np.hypot(chord[:, 0], chord[:, 1]), chord[:, 2]
    out, length = chord[:, :2] / span[:, None], np.linalg.norm(chord, axis=1)
    straight = np.linalg.solve((chord / length[:, None]).T, -load)
    size = float(np.linalg.norm(load))

    def left(unknown: np.ndarray) -> np.ndarray:
        pull, lengths = unknown[:6].reshape(3, 2) * size, unknown[6:] * length
        closure = (_ends(pull, lengths, density * G, ea) - [span, rise]) / length
        held = np.array([*(pull[:, 0] @ out), pull[:, 1].sum()]) + load
        return np.concatenate([closure.ravel(), held / size])

    own = density * G * length / 2
    start = np.column_stack([straight * span / length, straight * rise / length - own]) / size
    start[:, 0] = np.maximum(start[:, 0], 1e-3)
    with np.errstate(all="ignore"):
        found, _, status, _ = fsolve(
            left, [*start.ravel(), *np.ones(3)], full_output=True, xtol=1e-13
        )
    if status != 1 and np.abs(left(found)).max() > 1e-9:
        return np.inf
    pull, lengths = found[:6].reshape(3, 2) * size, found[6:] * length
    top = np.hypot(pull[:, 0], pull[:, 1] + density * G * lengths)
    return float(max(top.max(), np.hypot(*pull.T).max()) / allowable)
