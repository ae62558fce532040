"""How the kernels are compiled: decorators, and whether the machine code is cached."""

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
    # it contains what the function calls; here any change in these folders makes it stale.
    compiled._cache._cache_file._source_stamp = _stamp("kernel", "physics")
    result: Function = compiled
    return result


def exact(function: Function) -> Function:
    """Compile arithmetic that is rounded as it is written, which proofs rest on."""
    compiled: Function = numba.njit(
        error_model="numpy", no_cfunc_wrapper=True, no_cpython_wrapper=True
    )(function)
    return compiled


def exact_kernel(function: Function) -> Function:
    """Compile a loop over boxes the same way; otherwise as `kernel`."""
    compiled: Any = numba.njit(nogil=True, cache=True, error_model="numpy")(function)
    compiled._cache._cache_file._source_stamp = _stamp("kernel", "physics", "proof/enclosure")
    result: Function = compiled
    return result


@cache
def _stamp(*rooms: str) -> str:
    """Return a digest of all sources in these folders."""
    folders = [Path(__file__).parents[1] / room for room in rooms]
    sources = [source for folder in folders for source in sorted(folder.glob("*.py"))]
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
        if not self._is_told and function.__module__.startswith(
            ("designer.kernel.", "designer.proof.")
        ):
            self._is_told = True
            self._tell()
