"""Rings come in by the plugin door: without one, the core gives the same and says what lacks."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
from test_cli import STUDY, WORKSPACE, designer

import designer as package
from designer import plugins
from designer.cli.commands import app
from designer.plugins import RINGS, Ring

__all__ = ["designer"]
INSTALLED = Path(package.__file__).parent


def copy_without(site: Path, rings: tuple[Ring, ...]) -> Path:
    """Return a folder for Python's path that has this program without the rooms of some rings."""
    shutil.copytree(INSTALLED, site / "designer")
    for name in ("catalog", "reports", "plugins"):
        if (INSTALLED.parent / name).is_dir():  # a checkout; a wheel has them inside
            (site / name).symlink_to(INSTALLED.parent / name)
    for room in (room for ring in rings for room in ring.rooms):
        shutil.rmtree(site / "designer" / room)
    return site


def run(site: Path, folder: Path, *arguments: str) -> subprocess.CompletedProcess[str]:
    done = subprocess.run(
        [sys.executable, "-P", "-m", "designer", *arguments],
        cwd=folder, capture_output=True, text=True, check=False,
        env={**os.environ, "PYTHONPATH": str(site)},
    )  # fmt: skip
    assert "Traceback" not in done.stderr
    return done


def refusal(ring: Ring, command: str) -> str:
    folders = ", ".join(f"designer/{room}" for room in ring.rooms)
    place = f"the ring '{ring.name}' ({folders})"
    return f"designer {command}: comes with {place}, which is not installed here\n"


def result_of(site: Path, folder: Path, study: str) -> dict[str, Any]:
    """Return what `designer report` finds out, but for when it was."""
    (folder / "study.yaml").write_text(study, encoding="utf-8")
    done = run(site, folder, "report", "study.yaml", "-o", "report", "--no-plugins")
    assert done.returncode == 0, done.stderr
    result: dict[str, Any] = json.loads((folder / "report" / "result.json").read_text("utf-8"))
    del result["provenance"]["created"]
    return result


@pytest.fixture(scope="module")
def of_a_pose(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    return result_of(INSTALLED.parent, tmp_path_factory.mktemp("whole"), STUDY)


@pytest.mark.slow
@pytest.mark.parametrize("ring", RINGS, ids=lambda ring: ring.name)
def test_a_report_is_the_same_without_a_ring(tmp_path, of_a_pose, ring) -> None:
    site = copy_without(tmp_path / "site", (ring,))
    assert result_of(site, tmp_path, STUDY) == of_a_pose
    for command in ring.commands:
        done = run(site, tmp_path, *command.split())
        assert (done.returncode, done.stderr) == (2, refusal(ring, command))


@pytest.mark.slow
def test_a_selection_is_the_same_without_any_ring(tmp_path) -> None:
    (folder := tmp_path / "whole").mkdir()
    whole = result_of(INSTALLED.parent, folder, STUDY + WORKSPACE)
    assert result_of(copy_without(tmp_path / "site", RINGS), tmp_path, STUDY + WORKSPACE) == whole


def test_a_pose_is_sized_without_any_ring(tmp_path, designer) -> None:
    site = copy_without(tmp_path / "site", RINGS)
    Path("study.yaml").write_text(STUDY, encoding="utf-8")
    alone = run(site, tmp_path, "size", "study.yaml", "--json")
    assert (alone.returncode, alone.stdout) == (0, designer("size", "study.yaml", "--json").out)


@pytest.mark.parametrize("ring", RINGS, ids=lambda ring: ring.name)
def test_the_command_of_a_missing_ring_names_it(monkeypatch, designer, ring) -> None:
    find_spec = plugins.find_spec
    absent = {f"designer.{room}" for room in ring.rooms[:1]}
    monkeypatch.setattr(
        plugins, "find_spec", lambda name: None if name in absent else find_spec(name)
    )
    for command in ring.commands:
        done = designer(*command.split(), "--help")
        assert (done.status, done.out, done.err) == (2, "", refusal(ring, command))
        *group, name = command.split()
        assert f"│ {name} " not in designer(*group, "--help").out


def test_each_ring_registers_the_commands_that_it_names() -> None:
    loaded = {plugin.name: plugin for plugin in plugins.find_plugins(with_plugins=False).loaded}
    for ring in RINGS:
        hooks = loaded[ring.name].hooks
        names = [
            f"{prefix}{plugins.command_name(function)}"
            for hook, prefix in (("commands", ""), ("catalog_commands", "catalog "))
            for function in hooks.get(f"register_{hook}", list)()
        ]
        assert tuple(names) == ring.commands
    assert not {info.name for info in app.registered_commands} & {
        command for ring in RINGS for command in ring.commands
    }


def test_the_window_needs_no_other_ring() -> None:
    rooms = {room for ring in RINGS if ring.name != "window" for room in ring.rooms}
    code = (
        "import sys, designer.explore.worker, designer.explore.export\n"
        f"print(sorted({rooms} & {{name.split('.')[1] for name in sys.modules if "
        "name.startswith('designer.')}))"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout == "[]\n"
