"""The command: where no window can be opened it says so in one line."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from designer.explore.desktop import display
from designer.resources import example_file


def run(*arguments: str, **environment: str) -> subprocess.CompletedProcess[str]:
    """Run the command without a display, unless the environment names one."""
    kept = {k: v for k, v in os.environ.items() if k not in ("DISPLAY", "WAYLAND_DISPLAY")}
    command = [sys.executable, "-m", "designer", "explore", *arguments]
    return subprocess.run(
        command, env=kept | environment, capture_output=True, text=True, check=False, timeout=900
    )


def test_a_missing_library_is_told_with_its_remedy(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(display, "find_spec", lambda _: None)
    assert "pip install 'cdpr-designer[desktop]'" in display.why_no_library()


@pytest.mark.cases_by_default(1)
@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="other systems have a display")
@pytest.mark.parametrize("environment", [{}, {"DISPLAY": ":77"}])
def test_no_display_is_one_line_and_status_2(environment: dict[str, str]) -> None:
    pytest.importorskip("PySide6", reason="PySide6 is not installed")
    done = run(str(example_file("yard")), **environment)
    assert done.returncode == 2
    assert done.stderr.count("\n") == 1
    assert "there is no display" in done.stderr


def test_a_file_that_is_not_there_is_told(tmp_path: Path) -> None:
    pytest.importorskip("PySide6", reason="PySide6 is not installed")
    done = run(str(tmp_path / "none.yaml"))
    assert done.returncode == 2
    assert "there is no such file" in done.stderr


@pytest.mark.slow
def test_a_screenshot_of_the_whole_window_is_saved(tmp_path: Path) -> None:
    if not os.environ.get("DISPLAY"):
        pytest.skip("no display; run under xvfb-run -a")
    from PIL import Image

    picture = tmp_path / "window.png"
    done = run(
        str(example_file("yard")), "--screenshot", str(picture), DISPLAY=os.environ["DISPLAY"]
    )
    assert (done.returncode, done.stderr) == (0, "")
    with Image.open(picture) as image:
        assert image.width >= 1000
        assert len(image.convert("RGB").getcolors(1_000_000)) > 200
