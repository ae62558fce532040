"""At which pose, and with which cables, the modes of the platform are."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from designer.analysis.analyse import Analysis
from designer.analysis.governing import modes_of
from designer.io.config import read_study

CRANE = """\
robot: {anchors: [[0, 0, 11.5], [30, 0, 11.5], [15, 26, 11.5]], platform: {mass: 180}}
cable: {density: 5290, youngs_modulus: 62.7 GPa, allowable_stress: 198 MPa}
"""
REGION = "workspace: {region: {points: [[12, 8, 4], [15, 9, 9]]}}\n"


@pytest.mark.parametrize(
    ("rest", "place"),
    [
        ("pose: [15, 9, 4]\n", [15.0, 9.0, 4.0]),
        (REGION, [15.0, 9.0, 9.0]),
        (REGION + "pose: [15, 9, 4]\n", [15.0, 9.0, 4.0]),
        (REGION + "selection: {grades: [unirope-7x19-galvanised]}\n", [15.0, 9.0, 9.0]),
    ],
)
def test_at_the_governing_the_configured_or_the_worst_pose(
    tmp_path: Path, rest: str, place: list[float]
) -> None:
    path = tmp_path / "study.yaml"
    path.write_text(CRANE + rest, encoding="utf-8")
    found = modes_of(Analysis.begin(read_study(path)))
    assert found is not None and len(found.modes) == 3
    assert found.place[:3].tolist() == pytest.approx(place)
    assert found.load_case == "static"
    assert found.cable_frequency_Hz > 0.0
    assert 0.0 < found.modes[0].frequency_Hz < found.modes[2].frequency_Hz
    for mode in found.modes:
        assert np.linalg.norm(mode.shape) == pytest.approx(1.0)


def test_none_of_a_body_without_inertia(tmp_path: Path) -> None:
    path = tmp_path / "study.yaml"
    text = """\
robot:
  anchors: [[9, 0, 9], [9, 1, 9], [-4, 8, 9], [-5, 7, 9], [-4, -7, 9], [-5, -8, 9]]
  platform:
    mass: 100
    attachments: [[1, -.2, 0], [1, .2, 0], [-.3, 1, 0], [-.7, .8, 0], [-.7, -.8, 0], [-.3, -1, 0]]
    %s
cable: {density: 5290, youngs_modulus: 62.7 GPa, allowable_stress: 198 MPa}
pose: [0, 0, 3]
"""
    for inertia, count in (("", 0), ("inertia: [30, 30, 50]", 6)):
        path.write_text(text % inertia, encoding="utf-8")
        analysis = Analysis.begin(read_study(path))
        assert analysis.pose is not None
        assert analysis.pose.sizing.statics.is_solved
        found = modes_of(analysis)
        assert (0 if found is None else len(found.modes)) == count
