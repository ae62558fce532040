"""How the kernels are compiled: two decorators, and whether the machine code is cached."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from hashlib import sha256
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
    options = {"nogil": True, "cache": True, "error_model": "numpy", "fastmath": _FAST}
    compiled: Any = numba.njit(**options)(function)
    # Numba takes cached code for fresh as long as the function's own file is unchanged, although
    # it contains what the function calls; here any change in this folder makes it stale.
    compiled._cache._cache_file._source_stamp = _stamp()
    result: Function = compiled
    return result


@cache
def _stamp() -> str:
    """Return a digest of all sources in this folder."""
    sources = sorted(Path(__file__).parent.glob("*.py"))
    return sha256(b"".join(source.read_bytes() for source in sources)).hexdigest()


def tell_of_compiling(tell: Callable[[], None]) -> None:
    """Call ``tell`` once, as soon as a kernel has to be compiled in this process.

    It is not called where the machine code of all that is used lies on disk.
    """
    from numba.core import event

    event.Listener.register(_FirstCompile)
    event.register("numba:compile", _FirstCompile(tell))


class _FirstCompile:
    """Hears when Numba begins or ends to compile; a virtual subclass of its `Listener`."""

    def __init__(self, tell: Callable[[], None]) -> None:
        self._tell = tell
        self._is_told = False

    def notify(self, event: Any) -> None:
        function = event.data["dispatcher"].py_func
        if not self._is_told and function.__module__.startswith(__package__):
            self._is_told = True
            self._tell()
