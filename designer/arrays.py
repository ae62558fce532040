"""Array types and read-only arrays, shared by all values."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

FloatArray = NDArray[np.float64]
BoolArray = NDArray[np.bool_]
IntArray = NDArray[np.int64]
VerdictArray = NDArray[np.int8]


def frozen_array(values: ArrayLike, name: str = "an array") -> FloatArray:
    """Return ``values`` as a float array that cannot be written to; ``name`` is for the message."""
    try:
        array = np.array(values, dtype=np.float64)
    except (TypeError, ValueError):
        raise ValueError(f"{name} must be numbers, not {values!r:.60}") from None
    array.setflags(write=False)
    return array


def finite_array(name: str, values: ArrayLike, *shape: int | None) -> FloatArray:
    """Return values as floats, after a look at their shape and that they are finite.

    Parameters
    ----------
    name : str
        What they are, for the message.
    values : array
        Kept as they are if they are an array of floats already.
    shape : int or None
        Length of each axis; None for any but zero.

    Raises
    ------
    ValueError
        With one sentence.
    """
    is_array = isinstance(values, np.ndarray) and values.dtype == np.float64
    array = np.asarray(values) if is_array else frozen_array(values, name)
    require_shape(name, array, *shape)
    if not np.isfinite(array).all():
        raise ValueError(f"{name} must be finite, and some are not")
    return array


def require_shape(name: str, array: NDArray[Any], *shape: int | None) -> None:
    """Raise ValueError unless an array has this shape; None stands for any length but zero."""
    fits = array.ndim == len(shape) and all(
        have > 0 if want is None else have == want
        for have, want in zip(array.shape, shape, strict=True)
    )
    if not fits:
        expected = ", ".join("n" if size is None else str(size) for size in shape)
        raise ValueError(f"{name} must have the shape ({expected}), not {array.shape}")
