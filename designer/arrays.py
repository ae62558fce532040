"""Array types and read-only arrays, shared by all values."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

FloatArray = NDArray[np.float64]
BoolArray = NDArray[np.bool_]
IntArray = NDArray[np.int64]
VerdictArray = NDArray[np.int8]


def frozen_array(values: ArrayLike) -> FloatArray:
    """Return ``values`` as a float array that cannot be written to."""
    array = np.array(values, dtype=np.float64)
    array.setflags(write=False)
    return array
