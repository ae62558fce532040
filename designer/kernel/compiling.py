"""How the kernels are compiled: decorators, and whether the machine code is cached."""

from __future__ import annotations

import pickle
from collections.abc import Callable
from contextlib import suppress
from functools import cache
from hashlib import sha256
from pathlib import Path
from typing import Any, TypeVar, cast

import llvmlite.binding
import numba
from filelock import FileLock
from numba.core.caching import CompileResultCacheImpl, FunctionCache, _CacheLocator
from numba.core.codegen import JITCodeLibrary
from numba.core.compiler import Compiler
from platformdirs import user_cache_path

Function = TypeVar("Function", bound=Callable[..., Any])

# No `fastmath`: functions that several kernels call are compiled into each of them, and the first
# copy that a process loads serves all. Only where every operation is rounded as it is written do
# these copies agree, and with them fresh code and kept code, one processor and another.
_OPTIONS: dict[str, Any] = {"error_model": "numpy"}
_CALLED_FROM_PYTHON = {**_OPTIONS, "no_cfunc_wrapper": True, "nogil": True}

_LONGEST_COMPILING_S = 300.0


class _Inner(JITCodeLibrary):  # type: ignore[misc]
    """What kernels alone call: linked into each as it was lowered, and optimised there.

    Machine code of its own would never run. It has therefore no place for its environment either,
    which Numba's functions need to print and to raise errors with values: these do neither.
    """

    @property
    def codegen(self) -> _Inner:
        """What is told of the environment."""
        return self

    def set_env(self, name: str, environment: object) -> None:
        pass

    def get_pointer_to_function(self, name: str) -> int:
        return 0

    def _optimize_final_module(self) -> None:
        pass

    def _finalize_final_module(self) -> None:
        self._finalize_dynamic_globals()
        self._verify_declare_only_symbols()
        self._finalized = True


class _InnerCompiler(Compiler):  # type: ignore[misc]
    """Numba's compiler, which puts its code into such a library."""

    def __init__(self, typing: Any, target: Any, library: Any, *rest: Any) -> None:
        super().__init__(typing, target, library or _Inner(target.codegen(), "inner"), *rest)


_MAKES_ARRAYS = {
    "_nrt": True,
    **_OPTIONS,
    "no_cfunc_wrapper": True,
    "no_cpython_wrapper": True,
    "pipeline_class": _InnerCompiler,
}
# What is handed to them outlives the call, so no references are counted: that is a sixth of what
# compiling takes, and a fifth of the time of a pose. Numba refuses those that make an array.
_CALLED_BY_KERNELS = {**_MAKES_ARRAYS, "_nrt": False}


def element(function: Function) -> Function:
    """Compile scalar physics that is inlined into the loop that calls it, so that it vectorises."""
    compiled: Function = numba.njit(forceinline=True, **_CALLED_BY_KERNELS)(function)
    return compiled


def inner(function: Function) -> Function:
    """Compile what kernels alone call, not inlined; it has no entry for a call from Python."""
    compiled: Function = numba.njit(**_CALLED_BY_KERNELS)(function)
    return compiled


def allocating(function: Function) -> Function:
    """Compile the same where it makes arrays: before the loop of a kernel, for all its turns."""
    compiled: Function = numba.njit(**_MAKES_ARRAYS)(function)
    return compiled


def kernel(function: Function) -> Function:
    """Compile a loop over poses or boxes, which releases the interpreter lock.

    The machine code is kept on disk; where no folder takes it, each process compiles anew.
    """
    compiled: Any = numba.njit(**_CALLED_FROM_PYTHON)(function)
    if not numba.config.DISABLE_JIT:
        with suppress(RuntimeError):
            compiled._cache = _Cache(compiled.py_func)
            compiled._cache._cache_file = _Files(compiled._cache._cache_file)
    return cast("Function", compiled)


class _Locator(_CacheLocator):  # type: ignore[misc]
    """Finds machine code by what the sources say, not by where they lie.

    Numba takes cached code for fresh as long as the function's own file is unchanged, although it
    contains what the function calls; here any change of what is compiled makes it stale. So every
    environment finds what another has compiled from the same sources.
    """

    def __init__(self, py_func: Any, py_file: str) -> None:
        self._py_file = py_file
        self._lineno = py_func.__code__.co_firstlineno
        kept = numba.config.CACHE_DIR or user_cache_path("cdpr-designer", appauthor=False)
        self._cache_path = str(Path(kept) / _compiler_and_sources() / Path(py_file).parent.name)

    @classmethod
    def from_function(cls, py_func: Any, py_file: str) -> _Locator | None:
        locator = cls(py_func, py_file)
        try:
            locator.ensure_cache_path()
        except OSError:
            return None
        return locator

    def get_cache_path(self) -> str:
        return self._cache_path

    def get_source_stamp(self) -> str:
        return sha256(Path(self._py_file).read_bytes()).hexdigest()

    def get_disambiguator(self) -> str:
        return str(self._lineno)


class _Implementation(CompileResultCacheImpl):  # type: ignore[misc]
    _locator_classes = (_Locator,)


class _Cache(FunctionCache):  # type: ignore[misc]
    _impl_class = _Implementation


@cache
def _compiler_and_sources() -> str:
    """Return a name of the compiler, the processor and all sources that hold compiled functions."""
    rooms = ("kernel", "physics", "proof/enclosure")
    folders = [Path(__file__).parents[1] / room for room in rooms]
    sources = [source for folder in folders for source in sorted(folder.glob("*.py"))]
    digest = sha256(b"".join(source.read_bytes() for source in sources)).hexdigest()
    return f"{llvmlite.binding.get_host_cpu_name()}-numba-{numba.__version__}-{digest[:16]}"


class _Files:
    """Numba's files of one kernel: written once, and anew where they are damaged.

    While a process compiles, others that want the same kernel wait for its code. Each file has a
    digest: object code with a byte wrong would end the process.
    """

    def __init__(self, files: Any) -> None:
        self._files = files
        self._compiling = FileLock(files._index_path + ".lock", timeout=_LONGEST_COMPILING_S)

    def load(self, key: object) -> Any:
        """Return what is kept under a key; None if this process is to compile it and `save` it."""
        cached = self._read(key)
        if cached is None:
            with suppress(OSError, NotImplementedError):  # also where the others take too long
                self._compiling.acquire()
            cached = self._read(key)
            if cached is not None:
                self._compiling.release()
        return cached

    def _read(self, key: object) -> Any:
        try:
            cached = self._files.load(key)
            return None if cached is None else _checked(*cached)
        except Exception:  # whatever a damaged file makes of its reader
            _Damage.tell(self._files._index_path)
            with suppress(OSError):
                self._files.flush()
            return None

    def save(self, key: object, data: object) -> None:
        """Keep data under a key, if the disk takes them."""
        from numba.core.serialize import dumps

        packed = dumps(data)
        with suppress(OSError):
            self._files.save(key, (sha256(packed).digest(), packed))
        self._compiling.release(force=True)


def _checked(digest: bytes, packed: bytes) -> Any:
    if sha256(packed).digest() != digest:
        raise ValueError("the digest is another")
    return pickle.loads(packed)


class _Damage:
    """Who is told of damaged files."""

    tell: Callable[[str], None] = staticmethod(lambda _: None)


def tell_of_compiling(tell: Callable[[], None], damaged: Callable[[str], None]) -> None:
    """Call ``tell`` once, as soon as a kernel has to be compiled in this process.

    It is not called where the machine code of all that is used lies on disk. ``damaged`` is called
    with each file of it that cannot be read.
    """
    from numba.core import event

    _Damage.tell = staticmethod(damaged)

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
