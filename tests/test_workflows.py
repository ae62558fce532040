"""What the workflows run is what the metadata promise."""

from __future__ import annotations

import tomllib
from pathlib import Path

import yaml

ROOT = Path(__file__).parents[1]
SYSTEMS = {
    "ubuntu": "POSIX :: Linux",
    "windows": "Microsoft :: Windows",
    "macos": "MacOS :: MacOS X",
}


def declared(prefix: str) -> set[str]:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    found = {one.removeprefix(prefix) for one in project["classifiers"] if one.startswith(prefix)}
    return found - {"3 :: Only"}


def test_the_tests_run_on_every_python_and_system_that_is_declared() -> None:
    text = (ROOT / ".github/workflows/checks.yml").read_text(encoding="utf-8")
    matrix = yaml.safe_load(text)["jobs"]["tests"]["strategy"]["matrix"]
    assert set(matrix["python"]) == declared("Programming Language :: Python :: ")
    systems = {SYSTEMS[name.removesuffix("-latest")] for name in matrix["system"]}
    assert systems == declared("Operating System :: ")
