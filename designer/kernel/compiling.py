"""How the kernels are compiled: two decorators, and whether the machine code is cached."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar

import numba

Function = TypeVar("Function", bound=Callable[..., Any])

# Contraction to fused multiply-add and reciprocals may move the last bit, no more; NaN and
# infinity keep their meaning, for they mark lanes that failed.
_FAST = {"contract", "nsz", "arcp"}


def element(function: Function) -> Function:
    """Compile scalar physics that is inlined into the loop that calls it, so that it vectorises."""
    compiled: Function = numba.njit(forceinline=True, error_model="numpy", fastmath=_FAST)(function)
    return compiled


def kernel(function: Function) -> Function:
    """Compile a loop over poses; releases the interpreter lock and is cached on disk."""
    compiled: Function = numba.njit(nogil=True, cache=True, error_model="numpy", fastmath=_FAST)(
        function
    )
    return compiled


def is_cached(function: Callable[..., Any]) -> bool:
    """Tell whether machine code of a kernel lies on disk, so that the first call is quick."""
    cache = function._cache  # type: ignore[attr-defined]
    stem = f"{Path(cache._py_func.__code__.co_filename).stem}.{function.__name__}-"
    folder = Path(cache.cache_path)
    return folder.is_dir() and any(folder.glob(f"{stem}*.nbc"))
