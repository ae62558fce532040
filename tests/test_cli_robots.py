"""Robots that cannot be, or cannot hold a pose, as a user meets them: one line, or a verdict."""

from __future__ import annotations

import json
import sys
from pathlib import Path

import pytest

from designer.cli.commands import main
from designer.resources import example_file, example_names

Change = tuple[str, str]


def run_on(
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
    folder: Path,
    example: str,
    changes: tuple[Change, ...],
    *arguments: str,
) -> tuple[int, str, str]:
    """Run ``designer size`` on a shipped study with some of its text replaced."""
    text = example_file(example).read_text(encoding="utf-8")
    for old, new in changes:
        assert text.count(old) == 1
        text = text.replace(old, new)
    monkeypatch.chdir(folder)
    (folder / "study.yaml").write_text(text, encoding="utf-8")
    monkeypatch.setattr(sys, "argv", ["designer", "size", "study.yaml", *arguments])
    status = 0
    try:
        main()
    except SystemExit as stop:
        status = int(stop.code or 0)
    captured = capsys.readouterr()
    return status, captured.out, captured.err


@pytest.mark.parametrize(
    ("example", "old", "new", "field", "problem"),
    [
        (
            "cogiro",
            "      - [0.50316, -0.49282, 0]\n",
            "",
            "robot.platform.attachments",
            "7 attachments for 8 anchors",
        ),
        (
            "stadium",
            "[85, 60, 40], [-85, 60, 40]",
            "[85, 60, 40], [85, 60, 40]",
            "robot.anchors[3]",
            "is the same point as robot.anchors[2]",
        ),
        (
            "cogiro",
            "    - [-7.40830, 5.19141, 5.39874]\n    - [7.22425, 5.36889, 5.40799]\n",
            "    - [-7.40830, 5.19141, 5.39874]\n    - [-7.40830, 5.19141, 5.39874]\n",
            None,
            "",
        ),
        (
            "robocrane",
            "rotation_vector: [0, 0, 5 deg]",
            "quaternion: [1, 1, 0, 0]",
            "pose.quaternion",
            "the quaternion has length 1.41421",
        ),
        (
            "facade",
            "anchors: [[-18, 0, 30]",
            "anchors: [[-18, 1, 30]",
            "robot.anchors",
            "do not lie in one vertical plane",
        ),
        ("facade", "pose: [4, 0, 12]", "pose: [4, 1, 12]", "pose", "leaves that plane by 1"),
        (
            "facade",
            "pose: [4, 0, 12]",
            "pose: {position: [4, 0, 12], rotation_vector: [0.1, 0, 0]}",
            "pose",
            "turns the platform out of the plane",
        ),
        (
            "facade",
            "{rectangle: [[-13, 0], [13, 0]], z: [3, 24]}",
            "{box: [[-13, 13], [0, 1], [3, 24]]}",
            "workspace.region.box",
            "is a solid region, but the robot is planar",
        ),
        (
            "facade",
            "rectangle: [[-13, 0], [13, 0]]",
            "rectangle: anchors, inset: 18 m",
            "workspace.region.rectangle",
            "nothing is left inside an inset of 18 m",
        ),
        ("facade", "planar: true", "planar: maybe", "robot.planar", "is not a truth value"),
        (
            "facade",
            "wrench: {force: [100 N, 0, 0]}",
            "wrench: {force: [0, 100 N, 0]}",
            "robot.platform.wrench.force",
            "leaves that plane",
        ),
        (
            "stadium",
            "samples: 5000",
            "samples: 5000\n  orientations: [[0, 0, 1 deg]]",
            "workspace.orientations",
            "has no meaning for a point mass",
        ),
        (
            "stadium",
            "mass: 14 kg",
            "mass: 14 kg\n    wrench: {moment: [0, 1 N*m, 0]}",
            "robot.platform.wrench.moment",
            "has no meaning for a point mass",
        ),
        (
            "stadium",
            "mass: 14 kg",
            "mass: 14 kg\n    wrench: {force: [0, 1 kg, 0]}",
            "robot.platform.wrench.force[1]",
            "has the unit kilogram",
        ),
        (
            "robocrane",
            "  samples: 2000",
            "  orientation: [0, 0, 1 deg]",
            "workspace",
            "has orientation and orientation_range",
        ),
        (
            "robocrane",
            "rx: [-3 deg, 3 deg]",
            "rx: [3 deg, -3 deg]",
            "workspace.orientation_range.rx",
            "is not below the upper",
        ),
        (
            "stadium",
            "  platform:",
            "  gravity: [0, 0, 0]\n  platform:",
            "robot.gravity",
            "the direction is zero",
        ),
        (
            "stadium",
            "  platform:",
            "  gravity: [0, 0, -1e-160]\n  platform:",
            "robot.gravity",
            "the direction is smaller than any that is meant",
        ),
        (
            "stadium",
            "  platform:",
            "  tension_min: -1 N\n  platform:",
            "robot.tension_min",
            "is out of range",
        ),
        (
            "robocrane",
            "  platform:",
            "  tension_min: 100 N\n  platform:",
            "robot.tension_min",
            "6 cables and 6 degrees of freedom leave no tension to choose",
        ),
        (
            "stadium",
            "[[-85, -60, 40], [85, -60, 40], [85, 60, 40], [-85, 60, 40]]",
            "[[-85, -60, 40], [85, -60, 40]]",
            "robot.anchors",
            "the list has 2 values",
        ),
    ],
)
def test_one_mistake_is_one_line(
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
    tmp_path: Path,
    example: str,
    old: str,
    new: str,
    field: str | None,
    problem: str,
) -> None:
    status, out, err = run_on(capsys, monkeypatch, tmp_path, example, ((old, new),))
    if field is None:  # two cables may leave from one point
        assert status == 0
        return
    assert status == 2
    assert not out
    (line,) = err.splitlines()
    assert line.startswith("study.yaml:")
    assert f" {field}: " in line
    assert problem in line
    assert line.endswith(")")


@pytest.mark.parametrize(
    ("example", "changes", "verdict"),
    [
        # A Gough platform, turned by a quarter, gives way.
        (
            "robocrane",
            (("rotation_vector: [0, 0, 5 deg]", "rotation_vector: [0, 0, 90 deg]"),),
            "rank_deficient",
        ),
        # All cables level: none can carry weight.
        (
            "robocrane",
            (
                ("position: [0.3, -0.2, 0.5]", "position: [0, 0, 3]"),
                ("rotation_vector: [0, 0, 5 deg]", "rotation_vector: [0, 0, 0]"),
            ),
            "rank_deficient",
        ),
        ("stadium", (("pose: [20, 10, 8]", "pose: [20, 10, 41]"),), "outside_hull"),
        ("cogiro", (("pose: [1, 0.5, 1.5]", "pose: [9, 0.5, 1.5]"),), "outside_hull"),
    ],
)
def test_a_pose_that_cannot_be_held_has_its_verdict(
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
    tmp_path: Path,
    example: str,
    changes: tuple[Change, ...],
    verdict: str,
) -> None:
    status, out, _ = run_on(capsys, monkeypatch, tmp_path, example, changes, "--json")
    assert status == 1
    pose = json.loads(out)["pose"]
    assert pose["sagging"]["status"] == verdict
    assert pose["sagging"]["diameter_m"] is None
    assert pose["massless"]["max_tension_N"] is None


def test_a_platform_pushed_up_hangs_on_the_weight_of_its_cables(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """Cables that all come from above pull down by their own weight alone, and that is told."""
    push = (("force: [0, 0, -2 kN]", "force: [0, 0, 2 kN]"),)
    status, out, _ = run_on(capsys, monkeypatch, tmp_path, "cogiro", push, "--json")
    assert status == 0
    pose = json.loads(out)["pose"]
    assert pose["massless"]["max_tension_N"] is None
    assert pose["sagging"]["hangs_below"] is True
    assert pose["sagging"]["equilibrium_residual_N"] < 1e-6


def test_examples_are_listed(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(sys, "argv", ["designer", "init", "--list"])
    with pytest.raises(SystemExit) as stop:
        main()
    assert not stop.value.code
    lines = capsys.readouterr().out.splitlines()
    assert [line.split()[0] for line in lines] == list(example_names())
