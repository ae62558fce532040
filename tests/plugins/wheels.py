"""Builds and installs plugin projects without network."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest


def pip(*arguments: str | Path) -> None:
    subprocess.run(
        [sys.executable, "-m", "pip", "--disable-pip-version-check", *map(str, arguments)],
        check=True,
        capture_output=True,
    )


def install(project: Path, site: Path) -> None:
    """Build the wheel of a project and install it into ``site``, both without network."""
    pytest.importorskip("hatchling")
    pytest.importorskip("pip")
    wheels = site.parent / "wheels"
    pip("wheel", "--no-deps", "--no-build-isolation", "--no-index", "-w", wheels, project)
    pip("install", "--no-deps", "--no-index", "--target", site, *wheels.glob("*.whl"))
