"""Requirements of the chosen rope that only a study with limits has."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from report_cases import SIX
from report_parts import paragraphs, said, table

from designer.analysis.analyse import Analysis
from designer.analysis.result_json import result_dict
from designer.model.robot import Poses
from designer.model.verdict import Requirement
from designer.report.design.drawings import Drawings
from designer.report.design.report import section as section_of
from designer.selection.criteria import criteria_of, evaluate, loads_of
from designer.selection.reeving import drum_of
from designer.statics.inverse import solve_sagging
from designer.statics.modes import (
    cable_frequencies_Hz,
    frequencies_Hz,
    platform_modes,
)
from designer.study import RopeLimits

pytestmark = pytest.mark.slow

YARD = """
name: Yard
robot:
  anchors: [[0, 0, 11.5], [30, 0, 11.5], [15, 26, 11.5]]
  platform: {mass: 180 kg}
cable: {density: 5290 kg/m^3, youngs_modulus: 62.7 GPa, allowable_stress: 198 MPa}
workspace: {region: {box: [[10, 20], [4, 12], [1, 7]]}, samples: 200}
selection:
  grades: [unirope-7x19-galvanised]
  limits: {stiffness: 3 kN/m, excitation: [1 Hz, 2 Hz], drum_capacity: 9 m}
"""


@pytest.fixture(scope="module")
def found(solve: Callable[[str], Analysis]) -> Analysis:
    return solve(YARD)


def with_limits(found: Analysis, limits: RopeLimits) -> dict[str, Requirement]:
    chosen, workspace = found.chosen, found.study.workspace
    assert chosen is not None and workspace is not None
    assert found.study.selection is not None
    selection = replace(found.study.selection, limits=limits)
    criteria = criteria_of(found.built.robot, workspace, selection)
    evaluations = evaluate(loads_of(chosen.cases), criteria)
    lengths = chosen.verification.longest_m, chosen.verification.shortest_m
    requirements = [*(each.requirement for each in evaluations), *drum_of(*lengths, selection)]
    return {requirement.id: requirement for requirement in requirements}


def test_result_has_the_limits(found: Analysis) -> None:
    rows = {row["id"]: row for row in result_dict(found)["checks"]}
    assert rows["stiffness"]["demand"] == pytest.approx(3000.0)
    assert rows["stiffness"]["utilisation"] == pytest.approx(3000.0 / rows["stiffness"]["capacity"])
    assert rows["drum_capacity"]["capacity"] == pytest.approx(9.0)
    assert rows["drum_capacity"]["unit"] == "m"
    assert rows["excitation"]["unit"] == "Hz"
    assert len(rows["excitation"]["pose"]) == 3


def test_stroke_is_that_between_the_farthest_poses(found: Analysis) -> None:
    assert found.selection is not None
    assert found.selection.chosen is not None
    drum = with_limits(found, RopeLimits(drum_capacity_m=9.0))["drum_capacity"]
    assert drum.cable is not None
    exit_point = found.study.robot.exit_points_m[drum.cable - 1]
    box = np.array([[10.0, 4.0, 1.0], [20.0, 12.0, 7.0]])
    farthest = np.linalg.norm(np.abs(box - exit_point).max(axis=0))
    nearest = np.linalg.norm(np.clip(exit_point, *box) - exit_point)
    assert drum.demand == pytest.approx(farthest - nearest, rel=0.01)
    assert drum.holds == (drum.demand <= 9.0)
    assert with_limits(found, RopeLimits(drum_capacity_m=30.0))["drum_capacity"].holds


def test_excitation_is_held_against_the_nearest_mode(found: Analysis) -> None:
    assert found.chosen is not None
    cable = found.chosen.cable
    low = with_limits(found, RopeLimits(excitation_Hz=(0.01, 0.02)))["excitation"]
    assert low.holds
    assert low.place is not None
    assert low.cable is None
    statics = solve_sagging(found.study.robot, Poses.at(low.place[None]), cable)
    mass = found.study.robot.platform, cable.linear_density_kg_per_m
    lowest = min(
        float(cable_frequencies_Hz(statics, mass[1]).min()),
        float(frequencies_Hz(statics, *mass).min()),
    )
    assert 0.9 * lowest < low.capacity <= lowest * (1.0 + 1e-6)
    assert low.demand == 0.02
    assert low.utilisation == pytest.approx(0.02 / low.capacity)


def test_overtones_of_cables_within_the_band_do_not_hold(found: Analysis) -> None:
    low = with_limits(found, RopeLimits(excitation_Hz=(0.01, 0.02)))["excitation"].capacity
    around = with_limits(found, RopeLimits(excitation_Hz=(0.9 * low, 1.1 * low)))["excitation"]
    assert not around.holds
    assert around.utilisation > 1.0
    for band_Hz in ((4.9 * low, 5.3 * low), (5e3, 6e3)):
        above = with_limits(found, RopeLimits(excitation_Hz=band_Hz))["excitation"]
        assert not above.holds
        assert above.utilisation > 1.0


def test_the_lowest_frequency_is_that_of_the_worst_pose(found: Analysis) -> None:
    rng = np.random.default_rng(8)
    assert found.chosen is not None and found.qualities is not None
    cable, robot = found.chosen.cable, found.study.robot
    density = cable.linear_density_kg_per_m
    asked = with_limits(found, RopeLimits(platform_frequency_Hz=(0.01,)))["platform_frequency"]
    assert asked.holds and asked.place is not None and asked.cable is None
    dense = Poses.at(rng.uniform([10.0, 4.0, 1.0], [20.0, 12.0, 7.0], (3000, 3)))
    statics = solve_sagging(robot, dense, cable)
    lowest = frequencies_Hz(statics, robot.platform, density).min()
    assert 0.98 * lowest <= asked.capacity <= lowest
    survey = found.qualities.stiffness
    assert survey is not None and survey.lowest_frequency_Hz is not None
    assert survey.lowest_frequency_Hz == pytest.approx(asked.capacity, rel=1e-3)
    above = with_limits(found, RopeLimits(platform_frequency_Hz=(2.0 * asked.capacity,)))
    assert not above["platform_frequency"].holds
    band = (0.9 * asked.capacity, 1.2 * asked.capacity)
    within = with_limits(found, RopeLimits(platform_frequency_Hz=band))["platform_frequency"]
    assert not within.holds and within.utilisation > 1.0
    below = with_limits(found, RopeLimits(platform_frequency_Hz=(1e-3, 2e-3)))
    assert below["platform_frequency"].holds


def test_modes_stand_in_file_and_report(found: Analysis) -> None:
    result = result_dict(found)
    governing = found.governing
    assert governing is not None
    density = governing.case.loaded.moving_density_kg_per_m
    at = governing.equilibrium
    modes = platform_modes(at, found.study.robot.platform, density)
    expected = np.array([mode.frequency_Hz for mode in modes])
    assert [row["frequency_Hz"] for row in result["modes"]] == pytest.approx(expected.tolist())
    assert all(np.linalg.norm(row["shape"]) == pytest.approx(1.0) for row in result["modes"])
    slowest = cable_frequencies_Hz(at, density).min()
    assert result["modes_at"]["cable_frequency_Hz"] == pytest.approx(slowest)
    assert result["workspace"]["stiffness"]["lowest_frequency_Hz"] <= expected[0] * 1.001
    section = section_of(Drawings(found), "modes")
    assert section is not None
    rows = table(section, "Modes").groups[0].rows
    assert [float(row.cells[0]) for row in rows] == pytest.approx(expected.tolist(), rel=0.01)


def test_the_report_tells_what_is_checked_and_what_not(found: Analysis) -> None:
    section = section_of(Drawings(found), "checks")
    assert section is not None
    rows = table(section, "Requirements of the study").groups[0].rows
    assert {"Stiffness", "Excitation", "Drum"} <= {row.cells[0] for row in rows}
    assert "Not evaluated: D/d" in said(section)
    assert not any("excitation" in text for text in paragraphs(section))


def test_a_study_that_asks_for_every_check_lacks_none(solve: Callable[[str], Analysis]) -> None:
    selection = """selection:
  grades: [lg-7x19-wsc-galvanised-2070]
  sheave_diameter: 400 mm
  limits: {stiffness: 1 kN/m, excitation: [1 Hz, 2 Hz], drum_capacity: 90 m}
"""
    region = "{points: [[0, 0, 3], [1, 1, 4]]}"
    analysis = solve(SIX.format(region=region, clearance="0.1 m", selection=selection))
    done = {row["id"] for row in result_dict(analysis)["checks"]}
    assert {"sheave_ratio", "clearance", "stiffness", "excitation", "drum_capacity"} <= done
    section = section_of(Drawings(analysis), "checks")
    assert section is not None
    lacking = said(section).partition("Not evaluated: ")[2].partition(".")[0]
    assert lacking == (
        "tension of winches (no largest is given), torque of motors (none is given), speed of "
        "winches (none is given), speed of motors (none is given), power of motors (none is "
        "given), height over a floor (none is given), natural frequencies of the platform (no "
        "limit is given), layers on the drums (their length is not given), fleet angle (none "
        "is given) and life of the rope (no days are asked for)"
    )
