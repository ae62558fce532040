"""How a cable's sag over its chord follows its length, its stiffness, its load and its ends."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from designer.arrays import FloatArray
from designer.physics import catenary

_STEP = 1e-6
"""Relative, of central differences: the rest is about its square."""


@dataclass(frozen=True, slots=True, eq=False)
class SagSlopes:
    """Slopes of the sag over the chord of each cable (n,), its forces following.

    Parameters
    ----------
    by_length, by_stiffness : array (n,)
        In the unstrained length [1/m], and in the logarithm of EA.
    by_load, by_chord : array (n, 3)
        In the load per length [m/N], and in the vector from exit point to attachment [1/m].
    """

    by_length: FloatArray
    by_stiffness: FloatArray
    by_load: FloatArray
    by_chord: FloatArray


def sag_slopes(
    length_m: FloatArray, chord_m: FloatArray, EA_N: FloatArray, load_N_per_m: FloatArray
) -> SagSlopes:
    """Return the slopes for lengths and EA (n,), chords and loads per length (n, 3)."""
    state = np.column_stack([length_m, np.log(EA_N), load_N_per_m, chord_m])
    load, chord = (np.linalg.norm(v, axis=1) for v in (load_N_per_m, chord_m))
    sizes = np.column_stack([length_m, np.ones_like(load), *[load] * 3, *[chord] * 3])
    slopes = np.empty_like(state)
    for k in range(state.shape[1]):
        step = np.zeros_like(state)
        step[:, k] = _STEP * sizes[:, k]
        slopes[:, k] = (_sag_ratio(state + step) - _sag_ratio(state - step)) / (2.0 * step[:, k])
    return SagSlopes(slopes[:, 0], slopes[:, 1], slopes[:, 2:5], slopes[:, 5:])


def _sag_ratio(state: FloatArray) -> FloatArray:
    length, EA, load, vector = state[:, 0], np.exp(state[:, 1]), state[:, 2:5], state[:, 5:]
    weight, chord = np.linalg.norm(load, axis=1), np.linalg.norm(vector, axis=1)
    D = np.einsum("nk,nk->n", vector, load) / weight
    X = np.linalg.norm(vector - (D / weight)[:, None] * load, axis=1)
    force_x, force_z = catenary.forces_from_length(length, X, D, EA, weight)
    return np.asarray(catenary.sag_m(length, force_x, force_z, EA, weight, X, D) / chord)
