"""How the kernels are called: the one kind of array that they are compiled for, and threads."""

from __future__ import annotations

import os
from concurrent.futures import ThreadPoolExecutor
from functools import cache

import numpy as np
from numpy.typing import ArrayLike

from designer.arrays import FloatArray


def plain(values: ArrayLike) -> FloatArray:
    """Return the array as kernels are compiled for it: contiguous, read-only."""
    array = np.ascontiguousarray(values, dtype=np.float64).view()
    array.setflags(write=False)
    return array


@cache
def pool() -> ThreadPoolExecutor:
    """Return one thread a processor; starting them anew costs as much as some thousand poses."""
    return ThreadPoolExecutor(os.cpu_count())
