"""Declared effects that add to a cable instead of scaling it, in sizing and selection."""

from __future__ import annotations

import json
import math
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from report_parts import tree

from designer.analysis.analyse import Analysis, analyse
from designer.analysis.pose import analyse_pose
from designer.analysis.result_json import result_dict, selection_dict
from designer.effects.effect import Effect, Parameter, Size, Values
from designer.effects.load import guarded
from designer.effects.registry import SHIPPED, KnownEffects
from designer.errors import EffectError
from designer.grades.registry import load_catalogue
from designer.io.config import read_study
from designer.model.cable import Cable
from designer.model.measurements import Measurements
from designer.model.robot import Machine, Poses
from designer.progress import Silent
from designer.report.design.drawings import Drawings
from designer.report.design.report import section
from designer.sizing.newton import size_poses
from designer.statics.inverse import solve_sagging
from designer.study import Study, as_built_by, rope_effects
from designer.units import LINEAR_DENSITY

ROPE = Cable(0.0085, 0.253, 3.5e6, 8e3)
"""A rope of 7x19 and 8.5 mm."""
STUDY = """\
robot:
  anchors: [[0, 0, 12], [30, 0, 12], [15, 26, 12]]
  platform: {{mass: 180 kg}}
cable: {{density: 5290 kg/m^3, youngs_modulus: 62.7 GPa, allowable_stress: 198 MPa}}
pose: [15, 9, 4]
workspace:
  region: {{prism: anchors, inset: 4 m, z: [1, 7]}}
  samples: 200
selection: {{grades: [unirope-7x19-galvanised], safety_factor: 5}}
{more}
"""
Law = Callable[[Machine, float], Machine]


def added(machine: Machine, value: float) -> Machine:
    cable = machine.cable
    density = cable.linear_density_kg_per_m + value
    return replace(machine, cable=replace(cable, linear_density_kg_per_m=density))


def in_frost(machine: Machine, value: float) -> Machine:
    """Ice as thick as a degree of frost makes it, around the cable."""
    frost_K = max(-machine.surroundings.temperature_C, 0.0)
    return added(machine, value * frost_K * math.pi * machine.cable.diameter_m)


def knowing(law: Law, wrap: Callable[[Effect, str], Effect] | None = None) -> KnownEffects:
    """Return our effects and one that follows a law."""

    def on_machine(machine: Machine, values: Values) -> Machine:
        return law(machine, values["added_kg_per_m"])

    size = Size(0.05, (0.0, 5.0), (0.0, 2.0))
    parameter = Parameter("added_kg_per_m", LINEAR_DENSITY, size, at_least=0.0)
    effect = Effect("ice", "ice", "it adds", "definition", (parameter,), on_machine)
    return KnownEffects((*SHIPPED.effects, wrap(effect, "plugin") if wrap else effect))


def study(folder: Path, more: str = "", law: Law = added) -> Study:
    path = folder / "study.yaml"
    path.write_text(STUDY.format(more=more), encoding="utf-8")
    return read_study(path, knowing(law))


ICE = "effects: {ice: {added_kg_per_m: 0.2}}"


@pytest.fixture(scope="module")
def iced(tmp_path_factory: pytest.TempPathFactory) -> Analysis:
    folder = tmp_path_factory.mktemp("iced")
    return analyse(study(folder, ICE), load_catalogue(with_plugins=False), folder, Silent())


def test_what_is_added_is_added_to_each_rope(tmp_path) -> None:
    built = as_built_by(study(tmp_path, ICE))
    assert built.cable(ROPE).linear_density_kg_per_m == pytest.approx(0.453, rel=1e-12)
    thin = replace(ROPE, linear_density_kg_per_m=0.034)
    assert built.cable(thin).linear_density_kg_per_m == pytest.approx(0.234, rel=1e-12)
    assert built.cable(ROPE).axial_stiffness_N == ROPE.axial_stiffness_N


def test_only_what_scales_leaves_a_family(tmp_path) -> None:
    one = study(tmp_path, "effects: {linear_mass: {scale: 1.5}, elastic_modulus: {scale: 0.8}}")
    built = as_built_by(one)
    assert built.is_family(one.material)
    assert built.material(one.material).density_kg_per_m3 == pytest.approx(1.5 * 5290.0)
    other = study(tmp_path, ICE)
    built = as_built_by(other)
    assert not built.is_family(other.material)
    with pytest.raises(ValueError, match="no section"):
        built.material(other.material)
    family = built.material(other.material, 0.01)
    plain = other.material.cable(0.01).linear_density_kg_per_m
    assert family.cable(0.01).linear_density_kg_per_m == pytest.approx(plain + 0.2, rel=1e-12)


def test_the_pose_is_sized_with_the_mass_of_the_section_found(tmp_path) -> None:
    one = study(tmp_path, ICE)
    pose = analyse_pose(one)
    assert pose is not None and one.pose is not None
    diameter = float(pose.sizing.diameter_m)

    def use(diameter_m: float) -> float:
        cable = added(Machine(one.robot, one.material.cable(diameter_m)), 0.2).cable
        found = solve_sagging(one.robot, one.pose, cable)
        return float(found.largest_tension_N) / cable.allowable_tension_N

    assert use(diameter) == pytest.approx(1.0, abs=1e-6)
    assert use(0.999 * diameter) > 1.0
    bare = size_poses(one.robot, one.pose, one.material)
    assert diameter > 1.01 * float(bare.diameter_m)


@pytest.mark.slow
def test_the_worst_section_serves_every_pose_with_its_own_mass(iced: Analysis) -> None:
    assert iced.workspace is not None and iced.workspace.sagging is not None
    assert iced.section_m == pytest.approx(iced.workspace.sagging.diameter_m, rel=1e-7)
    robot, material = iced.study.robot, iced.study.material
    cable = added(Machine(robot, material.cable(iced.section_m or 0.0)), 0.2).cable
    assert iced.study.workspace is not None
    region = iced.study.workspace.region
    low, high = region.bounds_m
    points = np.random.default_rng(3).uniform(low, high, (2000, 3))
    inside = points[region.contains(points)]
    found = solve_sagging(robot, Poses.at(inside), cable)
    assert found.is_solved.all()
    assert found.largest_tension_N.max() <= cable.allowable_tension_N * (1.0 + 1e-6)
    at_worst = solve_sagging(robot, iced.workspace.sagging.pose, cable)
    use = float(at_worst.largest_tension_N) / cable.allowable_tension_N
    assert use == pytest.approx(1.0, abs=1e-6)


@pytest.mark.slow
def test_candidates_are_proved_with_the_mass_that_they_have_there(iced: Analysis) -> None:
    assert iced.selection is not None and iced.selection.chosen is not None
    for candidate in iced.selection.candidates:
        own = candidate.size.linear_density_kg_per_m
        assert candidate.cable.linear_density_kg_per_m == pytest.approx(own + 0.2, rel=1e-12)
    chosen = iced.selection.chosen
    found = solve_sagging(iced.study.robot, Poses.at(chosen.verification.worst_place), chosen.cable)
    assert float(found.largest_tension_N) == pytest.approx(chosen.verification.max_tension_N)
    (outcome,) = iced.selection.outcomes
    row = (selection_dict(iced.selection, None, None) or {})["chosen"]
    assert row["linear_mass_kg_per_m"] == chosen.size.linear_density_kg_per_m
    assert row["as_built_linear_mass_kg_per_m"] == chosen.cable.linear_density_kg_per_m
    thinner = outcome.family.cable(outcome.continuous_diameter_m)
    bare = outcome.grade.family(5.0).cable(outcome.continuous_diameter_m)
    expected = bare.linear_density_kg_per_m + 0.2
    assert thinner.linear_density_kg_per_m == pytest.approx(expected, rel=1e-6)


@pytest.mark.slow
def test_the_report_says_what_stands_for_the_family(iced: Analysis) -> None:
    items = [item.text() for item in tree(section(Drawings(iced), "assumptions")).all("li")]
    (words,) = (text for text in items if "that the study declares" in text)
    assert "influence depends on the section" in words
    assert "20\u00a0°C" in words
    result = json.loads(json.dumps(result_dict(iced), allow_nan=False))
    assert result["workspace"]["section_m"] == iced.section_m


def test_a_law_is_given_the_declared_temperature(tmp_path) -> None:
    effects = "effects: {ice: {added_kg_per_m: 0.5}}\n"
    warm = as_built_by(study(tmp_path, effects, in_frost))
    assert warm.cable(ROPE).linear_density_kg_per_m == 0.253
    cold = study(tmp_path, effects + "surroundings: {temperature: -10 degC}", in_frost)
    assert cold.surroundings.temperature_C == pytest.approx(-10.0)
    expected = 0.253 + 0.5 * 10.0 * math.pi * 0.0085
    assert as_built_by(cold).cable(ROPE).linear_density_kg_per_m == pytest.approx(expected)


def test_a_robot_that_depends_on_its_cable_is_refused(tmp_path) -> None:
    def on_its_sheave(machine: Machine, value: float) -> Machine:
        radius = value + 0.5 * machine.cable.diameter_m
        return replace(machine, robot=replace(machine.robot, pulley_radius_m=radius))

    with pytest.raises(EffectError, match="ice: one of them makes the robot depend on its cable"):
        as_built_by(study(tmp_path, ICE, on_its_sheave))


@pytest.mark.parametrize(
    ("law", "words"),
    [
        (
            lambda machine, value: added(machine, -9.0),
            "linear_density_kg_per_m must be above 0, not -",
        ),
        (
            lambda machine, value: added(machine, math.nan),
            "linear_density_kg_per_m must be above 0, not nan",
        ),
    ],
)
def test_a_cable_that_cannot_be_is_told_with_the_plugin(tmp_path, law: Law, words: str) -> None:
    path = tmp_path / "study.yaml"
    path.write_text(STUDY.format(more=ICE), encoding="utf-8")
    with pytest.raises(EffectError, match=words):
        as_built_by(read_study(path, knowing(law, guarded))).cable(ROPE)


def test_what_belongs_to_a_rope_is_not_put_on_another(tmp_path) -> None:
    """Without measurements it is of the configured family, with them of the rope measured."""
    one = study(tmp_path, "effects: {linear_mass: {scale: 1.5}, elastic_modulus: {scale: 0.7}}")
    family, built = one.material.cable(0.01), as_built_by(one)
    assert built.cable(family).axial_stiffness_N == 0.7 * family.axial_stiffness_N
    assert built.of_products.cable(ROPE) == ROPE
    assert rope_effects(one) == ("elastic_modulus", "linear_mass")
    rope = Measurements(tmp_path / "log.csv", 0.253, 3.5e6)
    measured = replace(one, measurements=rope)
    assert as_built_by(measured).cable(family) == family
    assert as_built_by(measured).of_products.cable(ROPE) == ROPE
    mounted = as_built_by(measured, mounted=True).cable(ROPE)
    assert mounted.axial_stiffness_N == pytest.approx(0.7 * ROPE.axial_stiffness_N)
    assert mounted.linear_density_kg_per_m == pytest.approx(1.5 * ROPE.linear_density_kg_per_m)
