"""The time that a proof may take."""

from __future__ import annotations

from pathlib import Path

import pytest

from designer.errors import InputError
from designer.io.config import read_study
from designer.resources import example_file


def _read(folder: Path, line: str) -> float:
    text = example_file("yard").read_text(encoding="utf-8")
    file = folder / "yard.yaml"
    file.write_text(text.replace("workspace:\n", f"workspace:\n{line}"), encoding="utf-8")
    workspace = read_study(file).workspace
    assert workspace is not None
    return workspace.proof_s


@pytest.mark.parametrize(("line", "time_s"), [("  proof: 0 s\n", 0.0), ("  proof: 2 min\n", 120.0)])
def test_the_time_is_read(tmp_path: Path, line: str, time_s: float) -> None:
    assert _read(tmp_path, line) == time_s


@pytest.mark.parametrize(
    ("given", "problem"),
    [("-1 s", "'-1 s' is out of range (expected at least 0 s"), ("5 m", "5 m"), ("soon", "soon")],
)
def test_what_is_no_time_is_refused(tmp_path: Path, given: str, problem: str) -> None:
    with pytest.raises(InputError, match=r"workspace\.proof") as caught:
        _read(tmp_path, f"  proof: {given}\n")
    assert problem in str(caught.value)
