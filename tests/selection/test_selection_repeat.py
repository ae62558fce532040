"""Every candidate can be proved again with `designer size` on its worst pose, with its own data."""

from __future__ import annotations

import json
import math
import sys
from pathlib import Path

import pytest
from ropes import rope

from designer.cli.commands import main
from designer.model.cable import Material
from designer.model.region import Prism
from designer.model.robot import Poses
from designer.model.workspace import Workspace
from designer.selection.candidate import Candidate
from designer.selection.select import select
from designer.sizing.newton import size_poses
from designer.study import Selection

TRIANGLE = [[0, 0, 0], [500, 0, 0], [250, 433.01, 0]]


@pytest.fixture(scope="module")
def candidates(fast_robot) -> tuple[Candidate, ...]:
    workspace = Workspace(Prism.over(TRIANGLE, 30.0, (-200.0, -50.0)), samples=800)
    grades = [
        rope("steel", [6.0, 12.0, 16.0, 20.0, 24.0, 40.0]),
        rope("light", [8.0, 12.0, 20.0], weight=0.2, stiffness=0.4),
        rope("weak", [20.0, 30.0], strength=0.6),
    ]
    selection = Selection(None, 2.0, termination_efficiency=0.9, sheave_diameter_m=0.5)
    return select(fast_robot, workspace, selection, grades).candidates


def as_material(candidate: Candidate) -> Material:
    """The product as a family whose allowable stress is what it was found to meet.

    Sizing then has to find the product's own diameter.
    """
    area_m2 = candidate.size.nominal_area_m2
    cable = candidate.cable
    return Material(
        density_kg_per_m3=cable.linear_density_kg_per_m / area_m2,
        youngs_modulus_Pa=cable.axial_stiffness_N / area_m2,
        allowable_stress_Pa=candidate.verification.max_tension_N / area_m2,
    )


@pytest.mark.slow
def test_sizing_at_the_worst_pose_finds_the_product_again(candidates, fast_robot) -> None:
    assert len(candidates) == 11
    for candidate in candidates:
        found = candidate.verification
        sizing = size_poses(fast_robot, Poses.at(found.worst_place), as_material(candidate))
        assert float(sizing.diameter_m) == pytest.approx(candidate.size.diameter_m, rel=1e-8)
        tension = float(sizing.statics.largest_tension_N)
        assert tension == pytest.approx(found.max_tension_N, rel=1e-8)
        load = candidate.size.minimum_breaking_load_N
        allowable = load * candidate.efficiency / 2.0
        assert found.utilisation == pytest.approx(tension / allowable, rel=1e-8)


def test_command_line_finds_it_too(candidates, tmp_path: Path, monkeypatch, capsys) -> None:
    candidate = next(c for c in candidates if c.standing == "chosen")
    material, found = as_material(candidate), candidate.verification
    config = tmp_path / "worst.yaml"
    config.write_text(
        "robot:\n"
        "  anchors: [[0, 0, 0], [500, 0, 0], [250, 433.01, 0]]\n"
        "  platform: {mass: 4000 kg}\n"
        f"cable: {{density: {material.density_kg_per_m3!r}, "
        f"youngs_modulus: {material.youngs_modulus_Pa!r}, "
        f"allowable_stress: {material.allowable_stress_Pa!r}}}\n"
        f"pose: {[float(x) for x in found.worst_place]}\n",
        encoding="utf-8",
    )
    monkeypatch.setattr(sys, "argv", ["designer", "size", str(config), "--json"])
    with pytest.raises(SystemExit) as stop:
        main()
    assert not stop.value.code
    pose = json.loads(capsys.readouterr().out)["pose"]
    assert math.isclose(pose["sagging"]["diameter_m"], candidate.size.diameter_m, rel_tol=1e-8)
    assert math.isclose(pose["sagging"]["max_tension_N"], found.max_tension_N, rel_tol=1e-8)
