"""The scrambled Sobol sequence and that of Halton, number for number those of SciPy.

SciPy has them in `scipy.stats`, which takes longer to import than a whole workspace to solve.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from designer.arrays import FloatArray

_BITS = 30
_POLYNOMIALS = ((1, 0, (1,)), (2, 1, (1, 3)))
"""Degree, coefficients and first numbers of the second and third dimension (Joe, Kuo 2008)."""


def sobol(dimensions: int, seed: int, chunk: int) -> Iterator[FloatArray]:
    """Yield a sequence in the unit square or cube (``chunk``, dimensions), for ever.

    ``chunk`` is a power of two: then all chunks are the first one with the same bits turned over.
    Scrambled by a random lower triangular matrix and a shift; Matousek, On the L2-discrepancy for
    anchored boxes, J. Complexity 14 (1998).
    """
    rng = np.random.default_rng(seed).spawn(1)[0]  # as SciPy does
    powers = 2 ** np.arange(_BITS)
    shift = rng.integers(0, 2, (dimensions, _BITS), np.uint32) @ powers
    scramble = np.tril(rng.integers(0, 2, (dimensions, _BITS, _BITS), np.uint32), -1)
    scramble += np.eye(_BITS, dtype=np.uint32)
    bits = _directions(dimensions)[..., None] >> powers.size - 1 - np.arange(_BITS) & 1
    scrambled = np.einsum("dij,dkj->dki", scramble, bits) % 2 @ powers[::-1]
    scrambled[:, 1:] ^= scrambled[:, :-1]  # what each bit of a number turns over in its Gray code
    points = shift[None]
    for flip in scrambled.T[: chunk.bit_length() - 1]:
        points = np.concatenate([points, points ^ flip])
    for number in range(2**_BITS // chunk):
        first = scrambled[:, number * chunk >> np.arange(_BITS) & 1 == 1]
        yield (points ^ np.bitwise_xor.reduce(first, axis=1)) / 2.0**_BITS


def halton(dimensions: int, count: int) -> FloatArray:
    """Return the first numbers of the sequence but 0 (count, dimensions), up to three dimensions.

    The digits of 1, 2, 3 … to the base of a prime, mirrored at the point; Halton, Numerische
    Mathematik 2 (1960).
    """
    number = np.arange(1, count + 1)[:, None] + np.zeros((1, dimensions), int)
    base, points = np.array([2, 3, 5])[:dimensions], np.zeros(number.shape)
    share = np.ones(dimensions)
    while number.any():
        share = share / base
        points += number % base * share
        number //= base
    return points


def _directions(dimensions: int) -> np.ndarray[tuple[int, int], np.dtype[np.int64]]:
    """Return the direction numbers (dimensions, bits)."""
    rows = [[1] * _BITS]
    for degree, coefficients, first in _POLYNOMIALS[: dimensions - 1]:
        row = list(first)
        for k in range(degree, _BITS):
            number = row[k - degree] ^ row[k - degree] << degree
            for i in range(1, degree):
                number ^= (coefficients >> degree - 1 - i & 1) * row[k - i] << i
            row.append(number)
        rows.append(row)
    return np.array(rows) << _BITS - 1 - np.arange(_BITS)
