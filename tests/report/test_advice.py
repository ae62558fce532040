"""What is advised where the answer is not yes: done as it says, the answer gets better."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from copy import deepcopy
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml
from report_cases import CLEARANCE_NOT_KEPT, DEFAULTS, FAST, PRISM, SIX
from report_parts import said

from designer.analysis.analyse import Analysis
from designer.model.robot import Poses
from designer.model.verdict import Requirement, Verdict
from designer.report.design.drawings import Drawings
from designer.report.design.report import section
from designer.resources import example_file
from designer.sizing.newton import size_poses

Solve = Callable[[str], Analysis]
Edit = dict[str, Any]
CRANE: dict[str, Any] = {
    "name": "Crane",
    "robot": {
        "anchors": [[0, 0, 30], [100, 0, 30], [50, 80, 30]],
        "platform": {"mass": 300},
    },
    "cable": {"grade": "unirope-6x36-iwrc-1960", "safety_factor": 5},
    "workspace": {
        "region": {"box": [[30, 70], [15, 45], [10, 24]]},
        "samples": 40,
        "proof": "0 s",
    },
    "selection": {"grades": ["unirope-6x36-iwrc-1960"], "safety_factor": 5},
}
BODY = yaml.safe_load(
    SIX.format(region=PRISM, clearance="1 mm", selection="").replace("samples: 60", "samples: 40")
) | {"selection": {"grades": ["lg-7x19-wsc-galvanised-2070"], "safety_factor": 2}}
SMALLER = {"workspace.region": {"box": [[45, 55], [25, 35], [10, 14]]}}
LIGHTER = {"robot.platform.mass": 150}
DRUM = {"robot.winches.drum_diameter": 0.3, "robot.winches.layers": 2}
SPOOLED = DRUM | {"robot.winches.drum": {"length": 0.1, "dead_turns": 3, "rope_oversize": 0.0}}
FLEET = DRUM | {"robot.winches.layers": 5}
FLEET |= {"robot.winches.drum": {"length": 2.0, "sheave_distance": 5, "fleet_angle_max": "1.5 deg"}}
MOTOR = DRUM | {"robot.winches.motor": {"torque": 100}}
WINCH = {"robot.winches.drum_diameter": 0.3, "robot.winches.layers": 1}
LIFE = {
    "b0": 1.2, "b1": -2.5, "b2": 5.5, "b3": -1.7, "wire_strength": "1770 MPa",
    "source": "made up for a test", "runs_per_day": 30, "days_min": 1e6,
}  # fmt: skip
ALONG_A_PATH: dict[str, tuple[Edit, list[Edit]]] = {
    "winch_speed": ({"robot.winches.speed_max": 0.1}, [{"robot.winches.speed_max": 20}]),
    "motor_speed": (
        WINCH
        | {
            "robot.winches.gear_ratio": 50,
            "robot.winches.motor": {"torque": 1e6, "speed": "60 rpm"},
        },
        [{"robot.winches.gear_ratio": 5}, {"robot.winches.drum_diameter": 1.5}],
    ),
    "motor_power": (
        WINCH | {"robot.winches.motor": {"torque": 1e6, "power": 100}},
        [{"robot.winches.motor": {"torque": 1e6, "power": 1e6}}, LIGHTER],
    ),
    "rope_life": (
        {"selection.sheave_diameter": 0.3, "selection.rope_life": LIFE},
        [
            {"selection.sheave_diameter": 0.6},
            {"selection.safety_factor": 8},
            {"selection.rope_life": LIFE | {"days_min": 1.0}},
        ],
    ),
}
HANGING: Edit = {
    "robot.platform.mass": 30,
    "workspace.region": {"box": [[30, 70], [15, 45], [20, 26]]},
    "workspace.floor": 19.9,
}
REQUIREMENTS: dict[str, tuple[Edit, list[Edit]]] = {
    "sheave_ratio": (
        {"selection.sheave_diameter": 0.15},
        [{"selection.sheave_diameter": 0.5}, {"selection.grades": ["lg-7x19-wsc-galvanised-2070"]}],
    ),
    "sag": (
        {"workspace.sag": 0.02},
        [SMALLER, {"robot.platform.mass": 1200}, {"workspace.sag": 0.3}],
    ),
    "floor": (
        HANGING,
        [
            {"workspace.floor": 15.0},
            {"workspace.region": {"box": [[45, 55], [25, 35], [20, 21]]}},
        ],
    ),
    "winch_tension": (
        {"robot.winches.tension_max": 3000},
        [{"robot.winches.tension_max": 30000}, LIGHTER],
    ),
    "winch_torque": (
        MOTOR,
        [
            {"robot.winches.gear_ratio": 20},
            {"robot.winches.drum_diameter": 0.15},
            {"robot.winches.motor": {"torque": 1e5}},
            LIGHTER,
        ],
    ),
    "stiffness": (
        {"selection.limits": {"stiffness": 1e6}},
        [SMALLER, {"selection.safety_factor": 15}],
    ),
    "platform_frequency": (
        {"selection.limits": {"platform_frequency": 50}},
        [SMALLER, LIGHTER],
    ),
    "excitation": (
        {"selection.limits": {"excitation": [0.1, 100]}},
        [{"selection.limits": {"excitation": [900, 1000]}}],
    ),
    "drum_capacity": (
        {"selection.limits": {"drum_capacity": 10}},
        [{"selection.limits": {"drum_capacity": 100}}, SMALLER],
    ),
    "spooling": (
        SPOOLED,
        [
            {"robot.winches.drum.length": 3},
            {"robot.winches.drum_diameter": 3},
            {"robot.winches.layers": 9},
            SMALLER,
        ],
    ),
    "fleet_angle": (
        FLEET,
        [
            {"robot.winches.drum.sheave_distance": 50},
            {"robot.winches.drum.length": 0.2, "robot.winches.drum_diameter": 3},
        ],
    ),
}


def edited(base: dict[str, Any], edit: Edit) -> str:
    """Return a study with fields by their dotted paths."""
    study = deepcopy(base)
    for path, value in edit.items():
        *parents, last = path.split(".")
        part = study
        for parent in parents:
            part = part.setdefault(parent, {})
        part[last] = value
    return str(yaml.safe_dump(study))


def advice(analysis: Analysis) -> str:
    """Return the page's words from what could be done on."""
    words = said(section(Drawings(analysis), "answer"))
    return words.partition("What could be done ")[2].partition("How sure this is")[0]


def asked(analysis: Analysis, name: str) -> Requirement:
    """Return a requirement where it is nearest to failing, or fails."""
    same = [each for each in analysis.requirements if each.id == name]
    return min(same, key=lambda each: (each.holds, -np.nan_to_num(each.utilisation)))


def is_better(before: Requirement, after: Requirement) -> bool:
    """Tell whether a requirement is nearer to holding."""
    if after.holds or after.utilisation < before.utilisation:
        return True
    return after.capacity - after.demand > before.capacity - before.demand


@pytest.mark.cases_by_default(2)
@pytest.mark.parametrize("name", REQUIREMENTS)
def test_advice_for_a_requirement_betters_it(solve: Solve, name: str) -> None:
    base, remedies = REQUIREMENTS[name]
    before = solve(edited(CRANE, base))
    assert not asked(before, name).holds
    assert advice(before).strip()
    for remedy in remedies:
        after = solve(edited(CRANE, base | remedy))
        assert is_better(asked(before, name), asked(after, name)), remedy


@pytest.mark.parametrize("name", ALONG_A_PATH)
def test_advice_for_a_requirement_along_a_path_betters_it(
    solve: Solve, tmp_path: Path, name: str
) -> None:
    def moving(edit: Edit, pace: float = 1.0) -> Analysis:
        rows = [(0, 40, 25, 10), (5, 50, 30, 20), (10, 60, 28, 12), (15, 45, 25, 14)]
        lines = [f"{pace * t},{x},{y},{z}" for t, x, y, z in rows]
        path = tmp_path / f"{pace}.csv"
        path.write_text("\n".join(["time_s,x_m,y_m,z_m", *lines]), encoding="utf-8")
        base = {**CRANE, "workspace": {"path": str(path)}}
        return solve(edited(base, edit))

    base, remedies = ALONG_A_PATH[name]
    before = moving(base)
    assert not asked(before, name).holds
    assert advice(before).strip()
    for remedy in remedies:
        after = moving(base | remedy)
        assert is_better(asked(before, name), asked(after, name)), remedy
    if name != "rope_life":
        assert is_better(asked(before, name), asked(moving(base, pace=3.0), name))


@pytest.mark.slow
def test_advice_for_clearance_and_stability_betters_them(solve: Solve) -> None:
    before = solve(CLEARANCE_NOT_KEPT)
    assert "apart, make the region smaller, or require less clearance" in advice(before)
    after = solve(CLEARANCE_NOT_KEPT.replace("clearance: 0.4 m", "clearance: 1 mm"))
    assert is_better(asked(before, "clearance"), asked(after, "clearance"))
    tipped = solve(edited(BODY, {"robot.platform.centre_of_mass": [0, 0, 6]}))
    assert not asked(tipped, "stability").holds
    assert "Make the region smaller, or move attachments above" in advice(tipped)
    for remedy in (
        {"robot.platform.centre_of_mass": [0, 0, -0.5]},
        {"robot.platform.centre_of_mass": [0, 0, 6], "workspace.region.z": [1, 2]},
    ):
        hung = solve(edited(BODY, remedy))
        assert is_better(asked(tipped, "stability"), asked(hung, "stability"))


def test_sides_moved_inward_serve_more(analyses: Mapping[str, Analysis], solve: Solve) -> None:
    """And raised exit points and a stronger cable hold the pose that is not served."""
    before = analyses["no_finite_cable"]
    unserved, remedies, words = before.findings.unserved, before.findings.remedies, advice(before)
    assert unserved is not None
    assert "Move the sides of the region inward" in words
    inset = f"{1.2 * unserved.depth_m} m"
    after = solve(FAST.format(**DEFAULTS | {"inset": inset}))
    assert before.workspace is not None
    assert after.workspace is not None
    shares = [a.census.fraction("solved") for a in (before.workspace, after.workspace)]
    assert shares[0] < shares[1] == 1.0
    assert remedies is not None
    pose, study = before.workspace.infeasible_pose, before.study
    assert pose is not None
    assert remedies.raised_m is not None or remedies.stronger is not None
    if remedies.raised_m is not None:
        points = np.add(study.robot.exit_points_m, [0.0, 0.0, remedies.raised_m])
        robot = replace(study.robot, exit_points_m=points)
        assert size_poses(robot, pose, study.material).statics.is_solved


EIGHT: dict[str, Any] = {
    "name": "Printer",
    "robot": {
        "anchors": [[x, y, z] for z in (4, 0) for x, y in ((0, 0), (4, 0), (4, 4), (0, 4))],
        "platform": {
            "mass": 6,
            "attachments": [
                [x, y, z]
                for z in (-0.1, 0.1)
                for x, y in ((-0.15, -0.15), (0.15, -0.15), (0.15, 0.15), (-0.15, 0.15))
            ],
        },
        "tension_min": 20,
    },
    "cable": {"grade": "yale-maxibraid-hmpe", "safety_factor": 4},
    "workspace": {
        "region": {"box": [[1.5, 2.5], [1.5, 2.5], [1.2, 2]]},
        "samples": 12,
        "proof": "0 s",
    },
}
CROSSED = [3, 0, 1, 2, 5, 6, 7, 4]
"""Upper cables one way round, lower ones the other."""


def test_platform_like_its_frame_is_told_what_stays_free(solve: Solve) -> None:
    before = solve(edited(EIGHT, {}))
    words = said(section(Drawings(before), "answer"))
    assert "The platform turns freely about the z axis in every pose" in words
    assert "cross them" in advice(before)
    for senseless in (
        "of the sides",
        "Raise the exit points",
        "strength for its weight",
        "smaller",
    ):
        assert senseless not in words
    attachments = EIGHT["robot"]["platform"]["attachments"]
    crossed = [attachments[k] for k in CROSSED]
    offset = [[x, 0.4 * y, z] for x, y, z in attachments]
    for better in (crossed, offset):
        after = solve(edited(EIGHT, {"robot.platform.attachments": better}))
        assert after.free_motion is None
        assert before.workspace is not None
        assert after.workspace is not None
        held = [a.workspace.census.statuses["solved"] for a in (before, after)]  # type: ignore[union-attr]
        assert held[1] > held[0] == 0


@pytest.mark.parametrize(
    ("verdict", "pose", "stress"),
    [
        (Verdict.OUTSIDE_HULL, [-20, 30, 10], "200 MPa"),
        (Verdict.OUTSIDE_HULL, [50, 30, 40], "200 MPa"),
        (Verdict.NO_FINITE_CABLE, [50, 27, 29.9], "40 MPa"),
        (Verdict.NO_FINITE_CABLE, [50, 2, 29], "40 MPa"),
        (Verdict.NO_LENGTH, [0, 0, 30], "200 MPa"),
    ],
)
def test_remedies_for_a_pose_hold_it(
    solve: Solve, verdict: Verdict, pose: list[float], stress: str
) -> None:
    text = edited(
        {"name": "Crane", "robot": CRANE["robot"]},
        {
            "cable": {
                "density": "7800 kg/m^3", "youngs_modulus": "200 GPa", "allowable_stress": stress
            },
            "pose": pose,
        },
    )  # fmt: skip
    analysis = solve(text)
    assert analysis.pose is not None
    assert Verdict(int(analysis.pose.sizing.statics.verdict)) is verdict
    remedies, study, words = analysis.findings.remedies, analysis.study, advice(analysis)
    assert remedies is not None
    assert study.pose is not None

    def is_held(robot=study.robot, at=study.pose, material=study.material) -> bool:  # type: ignore[no-untyped-def]
        return bool(size_poses(robot, at, material).statics.is_solved)

    assert not is_held()
    assert (remedies.position_m is None) == ("Move the configured pose" not in words)
    if remedies.position_m is not None:
        assert is_held(at=Poses.at(remedies.position_m))
    assert (remedies.raised_m is None) == ("Raise the exit points" not in words)
    if remedies.raised_m is not None:
        points = np.add(study.robot.exit_points_m, [0.0, 0.0, remedies.raised_m])
        assert is_held(robot=replace(study.robot, exit_points_m=points))
    assert (remedies.stronger is None) == ("strength for its weight" not in words)
    if remedies.stronger is not None:
        stress_Pa = remedies.stronger * study.material.allowable_stress_Pa
        assert is_held(material=replace(study.material, allowable_stress_Pa=stress_Pa))
    assert remedies.position_m is not None


@pytest.mark.slow
def test_no_begins_with_why_it_is_no(solve: Solve) -> None:
    """Four cables from above cannot hold 3 m/s² outward, whatever the rope."""
    corners = [[0, 0, 30], [100, 0, 30], [100, 60, 30], [0, 60, 30]]
    text = edited(
        CRANE,
        {
            "robot": {"anchors": corners, "platform": {"mass": 30}},
            "workspace.region": {"box": [[10, 90], [5, 55], [3, 25]]},
            "load_cases": [{"name": "flight", "acceleration": 3}],
        },
    )
    analysis = solve(text)
    words = said(section(Drawings(analysis), "answer"))
    assert words.startswith("No. In ")
    first = words.partition(". In ")[2].partition(": ")[0]
    assert "straight cables cannot hold the platform in the load case 'flight'" in first
    assert "whatever the rope" in first
    given = advice(analysis)
    assert "accelerate less" in given
    assert "allow more sag" not in given
    assert "more mass" not in given  # the inertia force would grow with it
    (loss,) = analysis.findings.equilibrium_losses
    for remedy in (
        {"load_cases": [{"name": "flight", "acceleration": 0.5}]},
        {
            "load_cases": [
                {
                    "name": "flight",
                    "acceleration": 3,
                    "region": {"box": [[40, 60], [20, 40], [20, 25]]},
                }
            ]
        },
    ):
        after = solve(edited(yaml.safe_load(text), remedy)).findings.equilibrium_losses
        assert sum(each.share for each in after) < loss.share


def test_failed_sag_comes_before_the_strength_of_the_rope(solve: Solve) -> None:
    words = said(section(Drawings(solve(edited(CRANE, {"workspace.sag": 0.02}))), "answer"))
    assert words.startswith("No. Sag does not hold. The ")
    assert "is strong enough for every pose of the workspace" in words


def test_platform_held_by_slack_cables_alone_says_so(solve: Solve) -> None:
    """FAST's cabin level at its rim: no straight cables balance it."""
    text = example_file("fast-as-built").read_text(encoding="utf-8")
    text = text.replace("rotation_vector: [0, -0.24472763, 0]", "rotation_vector: [0, 0, 0]")
    text = re.sub(r"(?m)^  orientation: .*$", "", text)

    def at(points: str) -> Analysis:
        return solve(re.sub(r"(?s)points: \[.*?\]\]", f"points: {points}", text))

    before = at("[[103, 0, 177.56], [0, 0, 140]]")
    words = said(section(Drawings(before), "answer"))
    assert words.startswith("No. Straight cables cannot hold the platform in the worst pose")
    assert "allow more sag" not in words
    assert "heavier" not in advice(before)
    assert is_better(asked(before, "sag"), asked(at("[[0, 0, 140]]"), "sag"))
