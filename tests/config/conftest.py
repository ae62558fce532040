"""A valid config to spoil, and what the reader says about it."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from designer.errors import Fault, InputError
from designer.io.config import read_study
from designer.study import Study

VALID = """\
name: A crane
robot:
  anchors:
    - [0, 0, 12]
    - ["30 m", 0, 12]
    - [15, 2600 cm, 12]
  platform:
    mass: 180 kg
cable:
  density: 5290 kg/m^3
  youngs_modulus: 62.7 GPa
  allowable_stress: 198 MPa
pose: [15, 9, 4]
workspace:
  region: {prism: anchors, inset: 3 m, z: [1, 8]}
  samples: 500
selection:
  safety_factor: 4
"""


@pytest.fixture
def valid() -> str:
    return VALID


@pytest.fixture
def study_of(tmp_path: Path) -> Callable[[str], Study]:
    """Return a function that reads a config given as text."""

    def read(text: str) -> Study:
        path = tmp_path / "crane.yaml"
        path.write_text(text, encoding="utf-8")
        return read_study(path)

    return read


@pytest.fixture
def faults_of(study_of: Callable[[str], Study]) -> Callable[[str], list[Fault]]:
    """Return a function that gives all faults of a config given as text."""

    def read(text: str) -> list[Fault]:
        with pytest.raises(InputError) as caught:
            study_of(text)
        return list(caught.value.faults)

    return read
