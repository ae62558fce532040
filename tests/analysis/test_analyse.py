"""What is written on the way goes, also after a run that was killed."""

from __future__ import annotations

import subprocess
import sys
import tempfile
from pathlib import Path

import pytest

from designer.analysis.analyse import TemporaryFolder

AT_WORK = """
import tempfile, time
from designer.analysis.analyse import TemporaryFolder
scratch = TemporaryFolder()
(scratch.folder / "workspace.nc").write_text("")
print("at work", flush=True)
time.sleep(600)
"""


def test_folders_of_killed_runs_go_and_those_of_others_stay(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("TMPDIR", str(tmp_path))
    monkeypatch.setattr(tempfile, "tempdir", None)
    (tmp_path / "designer-notes").mkdir()
    (tmp_path / "designer-link").symlink_to(tmp_path / "designer-notes")
    command = [sys.executable, "-c", AT_WORK]
    started = [subprocess.Popen(command, stdout=subprocess.PIPE) for _ in range(2)]
    killed = started[0]
    try:
        for process in started:
            assert process.stdout is not None
            assert process.stdout.readline() == b"at work\n"
        killed.kill()
        killed.wait()
        before = {path.name for path in tmp_path.iterdir()}
        scratch = TemporaryFolder()
        assert scratch.folder.parent == tmp_path
        after = {path.name for path in tmp_path.iterdir()} - {scratch.folder.name}
        assert len(before - after) == 1
        assert len(list(tmp_path.glob("*/workspace.nc"))) == 1
        folder = scratch.folder
        del scratch
        assert not folder.exists()
    finally:
        for process in started:
            process.kill()
            process.communicate()
