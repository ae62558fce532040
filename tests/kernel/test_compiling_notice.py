"""The note that the solver is being compiled comes when it is, and only then."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

CODE = """
import numpy as np
from designer.kernel.compiling import tell_of_compiling
from designer.kernel.linear import solve_small
tell_of_compiling(lambda: print("compiling"))
solve_small(np.eye(2), np.ones(2))
solve_small(np.eye(3), np.ones(3))
"""


def test_once_where_nothing_is_cached_and_never_after(tmp_path: Path) -> None:
    environment = {**os.environ, "NUMBA_CACHE_DIR": str(tmp_path)}
    said = [
        subprocess.run(
            [sys.executable, "-c", CODE],
            env=environment,
            check=True,
            capture_output=True,
            text=True,
        ).stdout.split()
        for _ in range(2)
    ]
    assert said == [["compiling"], []]
