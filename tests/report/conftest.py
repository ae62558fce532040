"""Small studies with every kind of answer, solved once."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from designer.analysis import Advance, Analysis, analyse
from designer.catalogue.registry import load_catalogue
from designer.config import read_study

FAST = """
name: {name}
robot:
  anchors: [[0, 0, 0], [500, 0, 0], [250, 433.01, 0]]
  platform: {{mass: 4000 kg}}
cable: {{density: 7800 kg/m^3, youngs_modulus: 200 GPa, allowable_stress: 180 MPa}}
pose: {pose}
workspace:
  region: {{prism: anchors, inset: {inset}, z: [-200, -40]}}
  samples: 300
  hangs_below: {hangs_below}
selection: {{grades: {grades}, safety_factor: 2}}
"""
DEFAULTS = {
    "name": "Crane",
    "pose": "[250, 200, -50]",
    "inset": "10.35 m",
    "hangs_below": "include",
    "grades": "[gost-6x19s-iwrc-1960, unirope-7x19-galvanised]",
}
CASES: dict[str, dict[str, str]] = {
    "positive": {},
    "exclude": {"hangs_below": "exclude"},
    "no_finite_cable": {"inset": "0 m"},
    "only_found_by_search": {"inset": "4.5 m"},
    "pose_outside": {"pose": "[250, -60, -50]"},
    "too_thin": {"grades": "[unirope-7x19-galvanised]"},
    "markup": {"name": "'<b>A</b> & <script>alert(1)</script>'"},
}


class Silent:
    """A reporter that shows nothing."""

    @contextmanager
    def task(self, name: str, total: int) -> Iterator[Advance]:
        yield lambda _: None


@pytest.fixture(scope="session")
def solve(tmp_path_factory: pytest.TempPathFactory) -> Callable[[str], Analysis]:
    """Solve a config text."""

    def solved(text: str) -> Analysis:
        folder = tmp_path_factory.mktemp("study")
        config = folder / "study.yaml"
        config.write_text(text, encoding="utf-8")
        study = read_study(config)
        return analyse(study, load_catalogue(with_plugins=False), Path(folder), Silent())

    return solved


@pytest.fixture(scope="session")
def analyses(solve: Callable[[str], Analysis]) -> dict[str, Analysis]:
    """Every case of this file."""
    return {name: solve(FAST.format(**{**DEFAULTS, **case})) for name, case in CASES.items()}


@pytest.fixture(scope="session")
def pose_only(solve: Callable[[str], Analysis]) -> Analysis:
    """A study without a workspace."""
    text = FAST.format(**DEFAULTS)
    return solve(text[: text.index("workspace:")])


@pytest.fixture(scope="session")
def yard(solve: Callable[[str], Analysis]) -> Analysis:
    """The shipped example of a small crane, with few samples."""
    from designer.resources import example_file

    text = example_file("yard").read_text(encoding="utf-8")
    return solve(text.replace("samples: 20000", "samples: 300"))
