"""The largest sag of the workspace, in the config."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from designer.errors import Fault
from designer.study import Study, as_built_by

STUDY = """\
robot:
  anchors: [[0, 0, 9], [9, 0, 9], [9, 9, 9], [0, 9, 9]]
  platform: {mass: 100}
cable: {density: 7800, youngs_modulus: 200 GPa, allowable_stress: 180 MPa}
workspace: {region: {box: [[3, 4], [3, 4], [1, 2]]}%s}
"""
ROPES = "selection: {grades: all}\n"


@pytest.mark.parametrize(
    ("given", "limit"),
    [("", 0.2), (", sag: 20 %", 0.2), (", sag: 0.05", 0.05), (", sag: 50 %", 0.5)],
)
def test_sag_limits_products_and_the_family(
    study_of: Callable[[str], Study], given: str, limit: float
) -> None:
    for selection in ("", ROPES):
        study = study_of(STUDY % given + selection)
        assert study.workspace is not None
        assert study.workspace.sag_max == as_built_by(study).robot.sag_max == limit


@pytest.mark.parametrize(
    ("given", "problem"),
    [("0", "out of range"), ("51 %", "out of range"), ("2 m", "has the unit"), ("none", "is not")],
)
def test_what_is_no_sag_is_refused(
    faults_of: Callable[[str], list[Fault]], given: str, problem: str
) -> None:
    (fault,) = faults_of(STUDY % f", sag: {given}")
    assert fault.field == "workspace.sag"
    assert problem in fault.problem
