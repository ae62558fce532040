"""The paper's robot and cables, for all tests."""

from __future__ import annotations

import gc
import os
import sys
from collections import Counter
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any
from zlib import crc32

import numpy as np
import pytest
from hypothesis import HealthCheck, settings
from xdist.scheduler import LoadFileScheduling

from designer.arrays import frozen_array
from designer.cli import terminal
from designer.io.config.schema import WorkspaceSection
from designer.model.cable import Material
from designer.model.robot import Platform, Poses, Robot
from designer.model.workspace import Workspace
from designer.sizing.newton import size_poses
from designer.statics.inverse import solve_massless

gc.disable()  # until all tests are collected: they stay, and so does what they need
# Workers get it from here. They keep all processors busy: threads of their own would only wait.
os.environ.setdefault("OMP_NUM_THREADS", "1")
# No test asserts an absolute time: a crowded machine is slow, not wrong.
settings.register_profile("untimed", deadline=None, suppress_health_check=[HealthCheck.too_slow])
settings.load_profile("untimed")

_ANCHORS = [[0.0, 0.0, 0.0], [500.0, 0.0, 0.0], [250.0, 433.01, 0.0]]
"""Of the paper's robot."""
TOGETHER = ("tests/report/test_figures_", "tests/report/test_report_")
"""How files begin that share studies which take long to solve: one worker runs them all."""


class _Together(LoadFileScheduling):
    def _split_scope(self, nodeid: str) -> str:
        file = super()._split_scope(nodeid)
        return next((start for start in TOGETHER if file.startswith(start)), file)


def pytest_xdist_make_scheduler(config: pytest.Config, log: Any) -> _Together | None:
    """Share out files, those of `TOGETHER` to one worker."""
    return _Together(config, log) if config.getvalue("dist") == "loadfile" else None


def pytest_addoption(parser: pytest.Parser) -> None:
    """Let a run take a part of the tests alone."""
    parser.addoption("--part", default="1/1", metavar="K/N", help="one part of all tests")


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Make the cases slow that come after those of ``cases_by_default``; keep the part asked for.

    All cases of a test are in one part, which nothing but its name decides; sets of options are
    tests of their own.
    """
    gc.freeze()
    gc.enable()
    part, n_parts = map(int, config.getoption("--part").split("/"))

    def is_in(item: pytest.Item) -> bool:
        name = item.nodeid if "pairs/" in item.nodeid else item.nodeid.partition("[")[0]
        return crc32(name.encode()) % n_parts == part % n_parts

    config.hook.pytest_deselected(items=[item for item in items if not is_in(item)])
    items[:] = filter(is_in, items)
    cases: Counter[str] = Counter()
    for item in items:
        marker = item.get_closest_marker("cases_by_default")
        if marker is not None:
            test = item.nodeid.partition("[")[0]
            cases[test] += 1
            if cases[test] > marker.args[0]:
                item.add_marker(pytest.mark.slow)


@pytest.fixture(scope="session")
def fast_robot() -> Robot:
    """Riehl et al., ICRA 2010, Table I, with 4000 kg."""
    return Robot(frozen_array(_ANCHORS), Platform(4000.0))


@pytest.fixture(scope="session")
def steel() -> Material:
    """The paper's idealised cable."""
    return Material(7800.0, 200e9, 180e6)


@pytest.fixture(scope="session")
def six_cable_robot() -> Robot:
    """Three masts with two cables each, to a triangular platform turned by 60 degrees."""

    def ring(radius: float, degrees: list[float]) -> np.ndarray:
        angle = np.radians(degrees)
        return np.stack([radius * np.cos(angle), radius * np.sin(angle), 0 * angle], axis=1)

    exits = ring(150.0, [0, 0, 120, 120, 240, 240])
    attachments = ring(5.0, [60, -60, 180, 60, 300, 180])
    centre = frozen_array([0.1, -0.2, -1.0])
    return Robot(frozen_array(exits), Platform(4000.0, frozen_array(attachments), centre))


@pytest.fixture(scope="session", autouse=True)
def unproved() -> Iterator[None]:
    """Studies that do not ask for a proof get none: it takes its time on every report."""
    made = WorkspaceSection.workspace

    def without(section: WorkspaceSection, *places: Any) -> Workspace:
        workspace = made(section, *places)
        asks = "proof" in section.model_fields_set
        return workspace if asks else replace(workspace, proof_s=0.0)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(WorkspaceSection, "workspace", without)
        yield


@pytest.fixture(scope="session", autouse=True)
def compiles_without_a_word() -> Iterator[None]:
    """What commands print does not depend on which test is the first that needs a kernel."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(terminal, "announce_compiling", lambda **_: None)
        yield


@pytest.hookimpl(tryfirst=True)
def pytest_collection(session: pytest.Session) -> None:
    """Let the second worker of a run of all tests compile what most of them need.

    The first collects meanwhile, and keeps the files that it has rewritten for the second.
    """
    if _compiles(session.config):
        _size(_ANCHORS)


@pytest.fixture(scope="session", autouse=True)
def compiled_by_one(request: pytest.FixtureRequest) -> None:
    """Let the second worker compile the kernels for more cables, and no other beside it.

    The others begin with files that need none: those of most tests.
    """
    if _compiles(request.config):
        _size([*_ANCHORS, [500.0, 433.01, 0.0]])


def _compiles(config: pytest.Config) -> bool:
    worker = getattr(config, "workerinput", {}).get("workerid")
    return worker == "gw1" and config.args == config.getini("testpaths")


def _size(anchors_m: list[list[float]]) -> None:
    robot = Robot(frozen_array(anchors_m), Platform(4000.0))
    places = np.random.default_rng(0).uniform([-100, -100, -200], [600, 500, 50], (30, 3))
    size_poses(robot, Poses.at(places), Material(7800.0, 200e9, 180e6))
    if robot.is_redundant:
        solve_massless(robot, Poses.at(places))


@pytest.fixture
def site(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """A folder on Python's path, to install plugins into; they are forgotten afterwards."""
    folder = tmp_path / "site"
    folder.mkdir()
    monkeypatch.syspath_prepend(folder)
    yield folder
    for name, module in list(sys.modules.items()):
        if (getattr(module, "__file__", None) or "").startswith(str(folder)):
            del sys.modules[name]
