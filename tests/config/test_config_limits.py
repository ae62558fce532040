"""What the chosen rope is checked against beyond its strength, in the config."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from designer.errors import Fault
from designer.study import RopeLimits, Study

STUDY = """\
robot: {anchors: [[0, 0, 9], [9, 0, 9], [4, 9, 9]], platform: {mass: 100}}
cable: {density: 7800, youngs_modulus: 200 GPa, allowable_stress: 180 MPa}
workspace: {region: {box: [[3, 4], [3, 4], [1, 2]]}}
selection: {limits: %s}
"""


def test_limits_with_units(study_of: Callable[[str], Study]) -> None:
    given = "{stiffness: 5 kN/m, excitation: [500 mHz, 3 Hz], drum_capacity: 60 m}"
    selection = study_of(STUDY % given).selection
    assert selection is not None
    limits = selection.limits
    assert limits.stiffness_N_per_m == pytest.approx(5000.0)
    assert limits.excitation_Hz == pytest.approx((0.5, 3.0))
    assert limits.drum_capacity_m == pytest.approx(60.0)


def test_left_out_nothing_is_asked_for(study_of: Callable[[str], Study]) -> None:
    selection = study_of(STUDY % "{}").selection
    assert selection is not None
    assert selection.limits == RopeLimits()


@pytest.mark.parametrize(
    ("limits", "field", "problem"),
    [
        ("{stiffness: 0}", "stiffness", "0 is out of range"),
        ("{stiffness: 5 kN}", "stiffness", "has the unit kilonewton"),
        ("{excitation: 2 Hz}", "excitation", "is not a list"),
        ("{excitation: [1 Hz]}", "excitation", "has 1 value"),
        ("{excitation: [3 Hz, 1 Hz]}", "excitation", "is not below the upper 1 Hz"),
        ("{excitation: [1 m, 3 Hz]}", "excitation[0]", "has the unit meter"),
        ("{drum_capacity: -1 m}", "drum_capacity", "is out of range"),
        ("{drum: 60 m}", "drum", "unknown field"),
    ],
)
def test_mistakes(
    faults_of: Callable[[str], list[Fault]], limits: str, field: str, problem: str
) -> None:
    (fault,) = faults_of(STUDY % limits)
    assert fault.field == f"selection.limits.{field}"
    assert problem in fault.problem


@pytest.mark.parametrize("band_Hz", [(0.0, 1.0), (2.0, 2.0), (3.0, 1.0)])
def test_no_band_in_python(band_Hz: tuple[float, float]) -> None:
    with pytest.raises(ValueError, match="excitation_Hz"):
        RopeLimits(excitation_Hz=band_Hz)
