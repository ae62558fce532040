"""Compiling is told; what is compiled is kept on disk, and compiled again if it is damaged."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

import llvmlite.binding
import numba
import numpy as np
import pytest

import designer
from designer.arrays import FloatArray
from designer.kernel import compiling
from designer.kernel.fixed_length import solve_thetas

CODE = """
import numpy as np
from designer.kernel.compiling import tell_of_compiling
from designer.kernel.fixed_length import solve_thetas
tell_of_compiling(lambda: print("compiling"), lambda file: print("damaged"))
for length in ([2.0], [2.0, 3.0]):
    ones = np.ones(len(length))
    solve_thetas(np.array(length), ones, ones, 1e-6 * ones, ones.copy())
"""


def told(sources: Path | None = None, **environment: str) -> list[str]:
    return subprocess.run(
        [sys.executable, "-c", CODE],
        cwd=sources,
        env={**os.environ, **environment},
        check=True,
        capture_output=True,
        text=True,
    ).stdout.split()


@pytest.mark.slow
def test_once_where_nothing_is_cached_and_never_after(tmp_path: Path) -> None:
    assert [told(NUMBA_CACHE_DIR=str(tmp_path)) for _ in range(2)] == [["compiling"], []]


def _twice(x: float) -> float:
    return 2.0 * x


@pytest.mark.parametrize("suffix", ["nbi", "nbc"])
@pytest.mark.parametrize("damage", ["empty", "cut off", "another byte", "a folder"])
def test_a_damaged_file_is_compiled_again(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, suffix: str, damage: str
) -> None:
    damaged: list[str] = []
    monkeypatch.setattr(compiling._Damage, "tell", staticmethod(damaged.append))
    monkeypatch.setattr(numba.config, "CACHE_DIR", str(tmp_path))

    def is_found() -> bool:
        function = compiling.kernel(_twice)
        assert function(21.0) == 42.0
        return bool(function.stats.cache_hits)  # type: ignore[attr-defined]

    assert [is_found(), is_found()] == [False, True]
    (file,) = tmp_path.rglob(f"*.{suffix}")
    whole = file.read_bytes()
    half = len(whole) // 2
    other = whole[:half] + bytes([whole[half] ^ 255]) + whole[half + 1 :]
    file.unlink()
    if damage == "a folder":  # as a file that nobody may read, also for root
        file.mkdir()
    else:
        file.write_bytes({"empty": b"", "cut off": whole[:half], "another byte": other}[damage])
    assert not is_found()
    if damage != "a folder":
        assert damaged
        assert is_found()


def _assign(target: FloatArray, source: FloatArray) -> None:
    target[0] = source


@pytest.mark.slow
def test_no_kernel_holds_messages_about_shapes(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Formatted strings are compiled for seconds: hence `designer.kernel.linear.copy`.

    Looks at all kernels that these sources have been compiled to so far.
    """
    solve_thetas(*np.full((4, 1), 2.0), np.empty(1))  # one of them at least
    folder = Path(compiling._Locator(_assign, __file__).get_cache_path()).parent
    kept = [file for file in folder.rglob("*.nbc") if not file.name.startswith("test_")]
    assert kept
    assert [file.name for file in kept if b"unicode" in file.read_bytes()] == []
    monkeypatch.setattr(numba.config, "CACHE_DIR", str(tmp_path))
    compiling.kernel(_assign)(np.ones((2, 3)), np.ones(3))
    (file,) = tmp_path.rglob("*.nbc")
    assert b"unicode" in file.read_bytes()


@pytest.mark.slow
@pytest.mark.skipif(sys.platform != "linux", reason="XDG folders")
def test_a_copy_of_the_sources_finds_what_another_compiled(tmp_path: Path) -> None:
    environment = {"NUMBA_CACHE_DIR": "", "XDG_CACHE_HOME": str(tmp_path)}
    assert [told(**environment) for _ in range(2)] == [["compiling"], []]
    (folder,) = (tmp_path / "cdpr-designer").iterdir()
    processor = llvmlite.binding.get_host_cpu_name()
    assert folder.name.startswith(f"{processor}-numba-{numba.__version__}-")
    copy = tmp_path / "elsewhere"
    shutil.copytree(Path(designer.__file__).parent, copy / "designer")
    assert told(copy, **environment) == []
    with (copy / "designer" / "kernel" / "linear.py").open("a", encoding="utf-8") as source:
        source.write("# Another source.\n")
    assert told(copy, **environment) == ["compiling"]


def test_where_no_folder_takes_it_each_process_compiles(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(compiling._Implementation, "_locator_classes", ())
    assert compiling.kernel(_twice)(21.0) == 42.0
