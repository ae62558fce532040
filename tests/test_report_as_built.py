"""`designer report` with declared effects, against physics that shares nothing with it."""

from __future__ import annotations

import json
import math
import sys
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from twins import physics
from twins.robots import FAST3

from designer.analysis.analyse import analyse
from designer.analysis.result_json import result_dict
from designer.cli.commands import main
from designer.grades.registry import load_catalogue
from designer.io.config import read_study
from designer.progress import Silent

pytestmark = pytest.mark.slow

DENSITY, MODULUS, STRESS = 7800.0, 200e9, 180e6
GRADE = "unirope-6x36-iwrc-1960"
STUDY = f"""
name: as built
robot:
  anchors: {[list(point) for point in FAST3.exit_m]}
  platform: {{mass: {FAST3.mass_kg} kg}}
cable: {{density: {DENSITY}, youngs_modulus: {MODULUS:.0f}, allowable_stress: {STRESS:.0f}}}
pose: {list(FAST3.pose_m)}
workspace:
  region: {{box: {[list(side) for side in FAST3.box_m]}}}
  samples: 120
selection: {{grades: [{GRADE}], safety_factor: 2}}
"""
EFFECTS = {
    "nothing": "",
    "pulley_radius": "effects: {pulley_radius: {radius_m: 0.8}}",
    "elastic_modulus": "effects: {elastic_modulus: {scale: 0.6}}",
    "linear_mass": "effects: {linear_mass: {scale: 1.15}}",
}


def machine(effect: str, linear_mass: float, stiffness_N: float) -> physics.Machine:
    """Return the independent model with the effect."""
    mass_scale = 1.15 if effect == "linear_mass" else 1.0
    stiffness_scale = 0.6 if effect == "elastic_modulus" else 1.0
    return replace(
        FAST3.machine(),
        linear_mass=np.full((1, 3), linear_mass * mass_scale),
        stiffness_N=np.full((1, 3), stiffness_N * stiffness_scale),
        pulley_radius_m=0.8 if effect == "pulley_radius" else 0.0,
    )


@pytest.fixture(scope="module")
def results(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    """Return what ``result.json`` holds for each effect."""
    found = {}
    for effect, declared in EFFECTS.items():
        folder = tmp_path_factory.mktemp(effect)
        config = folder / "study.yaml"
        config.write_text(STUDY + declared + "\n", encoding="utf-8")
        catalogue = load_catalogue(with_plugins=False)
        analysis = analyse(read_study(config), catalogue, folder, Silent())
        found[effect] = json.loads(json.dumps(result_dict(analysis)))
    return found


def test_the_command_writes_the_same(
    results: dict[str, Any], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    config = tmp_path / "study.yaml"
    config.write_text(STUDY + EFFECTS["pulley_radius"] + "\n", encoding="utf-8")
    arguments = ["report", str(config), "-o", str(tmp_path / "out"), "--no-plugins"]
    monkeypatch.setattr(sys, "argv", ["designer", *arguments])
    with pytest.raises(SystemExit) as stop:
        main()
    assert not stop.value.code
    written = json.loads((tmp_path / "out" / "result.json").read_text(encoding="utf-8"))
    for part in ("pose", "workspace", "selection"):
        assert written[part] == results["pulley_radius"][part]


@pytest.mark.parametrize("effect", EFFECTS)
def test_the_pose_is_what_the_other_physics_gives(effect: str, results: dict[str, Any]) -> None:
    """The optimum's own cable, with the effect, has these lengths and tensions and no margin."""
    sagging = results[effect]["pose"]["sagging"]
    area = math.pi / 4.0 * sagging["diameter_m"] ** 2
    other = physics.solve(
        machine(effect, DENSITY * area, MODULUS * area), np.array([FAST3.pose_m]), np.eye(3)[None]
    )
    assert sagging["tensions_N"] == pytest.approx(other.exit_tension_N[0], rel=1e-6)
    assert sagging["lengths_m"] == pytest.approx(other.length_m[0], rel=1e-6)
    assert other.exit_tension_N.max() == pytest.approx(STRESS * area, rel=1e-6)


@pytest.mark.parametrize("effect", EFFECTS)
def test_the_worst_pose_is_what_the_other_physics_gives(
    effect: str, results: dict[str, Any]
) -> None:
    worst = results[effect]["workspace"]["sagging"]
    area = math.pi / 4.0 * worst["diameter_m"] ** 2
    other = physics.solve(
        machine(effect, DENSITY * area, MODULUS * area),
        np.array([worst["pose"][:3]]),
        np.eye(3)[None],
    )
    assert other.exit_tension_N.max() == pytest.approx(worst["max_tension_N"], rel=1e-6)


@pytest.mark.parametrize("effect", EFFECTS)
def test_the_product_is_verified_with_the_effect(effect: str, results: dict[str, Any]) -> None:
    """At the region's worst pose the chosen rope has nearly its own largest tension.

    Effects of the configured family's rope, its modulus and mass, are not of the chosen one.
    """
    chosen = results[effect]["selection"]["chosen"]
    grade = load_catalogue(with_plugins=False).grade(GRADE)
    size = next(size for size in grade.sizes if size.id == chosen["size_id"])
    has_effect = effect if effect == "pulley_radius" else "nothing"
    rope = machine(has_effect, size.linear_density_kg_per_m, grade.axial_stiffness_N(size))
    pose = np.array([results[effect]["workspace"]["sagging"]["pose"][:3]])
    tension = physics.solve(rope, pose, np.eye(3)[None]).exit_tension_N.max()
    assert tension <= chosen["max_tension_N"] * (1.0 + 1e-6)
    assert tension == pytest.approx(chosen["max_tension_N"], rel=0.01)
    assert chosen["as_built_linear_mass_kg_per_m"] == size.linear_density_kg_per_m
    assert chosen["axial_stiffness_N"] == grade.axial_stiffness_N(size)


def test_each_effect_moves_the_numbers_its_own_way(results: dict[str, Any]) -> None:
    """Heavier cables pull harder, softer ones are paid out shorter, pulleys carry some length."""
    plain = results["nothing"]["pose"]["sagging"]

    def of(effect: str) -> dict[str, Any]:
        found: dict[str, Any] = results[effect]["pose"]["sagging"]
        return found

    assert of("linear_mass")["max_tension_N"] > 1.01 * plain["max_tension_N"]
    assert of("linear_mass")["diameter_m"] > 1.005 * plain["diameter_m"]
    assert sum(of("elastic_modulus")["lengths_m"]) < sum(plain["lengths_m"])
    assert sum(of("pulley_radius")["lengths_m"]) > sum(plain["lengths_m"]) + 0.8
