"""Values that cannot be are refused where they are made, in one sentence."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import fields, replace
from pathlib import Path
from types import UnionType
from typing import Any, Union, get_args, get_origin, get_type_hints

import numpy as np
import pytest

import designer
from designer.arrays import frozen_array
from designer.kernel.batch import solve_batch
from designer.kernel.calling import situation_of
from designer.model.cable import Cable, Cables, Material
from designer.model.load_case import LoadCase
from designer.model.measurements import Measurements
from designer.model.region import PointList, Prism, Rectangle
from designer.model.robot import Platform, Poses, Robot
from designer.model.space import Orientations
from designer.model.workspace import Workspace
from designer.statics.inverse import solve_sagging
from designer.study import CableGroup, DeclaredEffect, Selection, Study

EXITS = frozen_array([[0, 0, 9], [9, 0, 9], [9, 9, 9], [0, 9, 9], [4, 0, 9], [4, 9, 9]])
BODY = frozen_array([[-1, -1, 0], [1, -1, 0], [1, 1, 1], [-1, 1, 0], [0, -1, 1], [0, 1, 1]])
ROBOT = Robot(EXITS, Platform(100.0, BODY))
ROPE = Cable(0.01, 0.4, 6e6, 1e4)
STEEL = Material(7800.0, 200e9, 180e6)
BOX = Prism.box((0.0, 1.0), (0.0, 1.0), (0.0, 1.0))
ONE = Poses.at([4.0, 4.0, 3.0])
SOME = Workspace(BOX, samples=8)
STUDY = Study("s", ROBOT, STEEL, pose=ONE)
HALVES = (CableGroup("front", (1, 2, 3)), CableGroup("back", (4, 5, 6, 7)))
nan, inf = np.nan, np.inf

WRONG = {
    "five attachments of six": (lambda: Robot(EXITS, Platform(1.0, BODY[:5])), "6 exit points and"),
    "exit points in a plane": (lambda: Robot(EXITS[:, :2], Platform(1.0)), r"\(n, 3\)"),
    "no exit points": (lambda: Robot(EXITS[:0], Platform(1.0)), r"\(n, 3\)"),
    "an exit point nowhere": (lambda: Robot(EXITS * nan, Platform(1.0)), "finite"),
    "a pulley": (lambda: replace(ROBOT, pulley_radius_m=nan), "pulley_radius_m"),
    "a tilt": (lambda: replace(ROBOT, tilt_rad=np.zeros(3)), "tilt_rad"),
    "a least tension": (lambda: replace(ROBOT, tension_min_N=nan), "tension_min_N"),
    "no gravity": (lambda: replace(ROBOT, gravity_direction=np.zeros(3)), "gravity"),
    "a mass": (lambda: Platform(-1.0), "mass_kg"),
    "no mass": (lambda: Platform(nan), "mass_kg"),
    "a wrench": (lambda: Platform(1.0, wrench_N=np.zeros(3)), r"wrench_N .*\(6\)"),
    "a centre of mass": (lambda: Platform(1.0, centre_of_mass_m=np.array([inf, 0, 0])), "finite"),
    "a hull": (lambda: Platform(1.0, hull_m=np.zeros((0, 3))), "hull_m"),
    "a diameter": (lambda: replace(ROPE, diameter_m=0.0), "diameter_m"),
    "a weightless cable": (lambda: replace(ROPE, linear_density_kg_per_m=0.0), "linear_density"),
    "a stiffness": (lambda: replace(ROPE, axial_stiffness_N=nan), "axial_stiffness_N"),
    "a strength": (lambda: replace(ROPE, allowable_tension_N=-1.0), "allowable_tension_N"),
    "no cables": (lambda: Cables(()), "at least"),
    "a density": (lambda: replace(STEEL, density_kg_per_m3=-1.0), "density"),
    "a modulus": (lambda: replace(STEEL, youngs_modulus_Pa=0.0), "youngs_modulus_Pa"),
    "a stress": (lambda: replace(STEEL, allowable_stress_Pa=inf), "allowable_stress_Pa"),
    "a position": (lambda: Poses(np.zeros(2), np.eye(3)), r"\(…, 3\)"),
    "a rotation": (lambda: Poses(np.zeros(3), np.eye(2)), r"\(…, 3, 3\)"),
    "no rotation": (lambda: Poses(np.zeros(3), 2.0 * np.eye(3)), "rotation matrices"),
    "two of three": (lambda: Poses(np.zeros((3, 3)), np.stack([np.eye(3)] * 2)), "do not fit"),
    "a clockwise base": (lambda: Prism(BOX.polygon_m[::-1], (0.0, 1.0)), "counter-clockwise"),
    "a dented base": (
        lambda: Prism(frozen_array([[0, 0], [4, 0], [1, 1], [0, 4]]), (0.0, 1.0)),
        "convex",
    ),
    "a line": (lambda: Prism(BOX.polygon_m[:2], (0.0, 1.0)), "convex"),
    "upside down": (lambda: replace(BOX, z_m=(1.0, 0.0)), "above the highest"),
    "a height": (lambda: replace(BOX, z_m=(nan, 0.0)), "lowest z"),
    "a rectangle of no width": (lambda: Rectangle(np.ones((2, 2)), (0.0, 1.0)), "same point"),
    "no points": (lambda: PointList(np.zeros((0, 3))), "points_m"),
    "no turns": (lambda: Orientations(np.zeros((0, 3))), "turns_rad"),
    "a range": (lambda: Orientations(np.zeros((1, 3)), np.array([[1.0] * 3, [0.0] * 3])), "lowest"),
    "no samples": (lambda: Workspace(BOX, samples=0), "samples"),
    "a seed": (lambda: Workspace(BOX, seed=-1), "seed"),
    "a sampling": (lambda: Workspace(BOX, sampling="random"), "low_discrepancy, grid"),
    "a policy": (lambda: Workspace(BOX, hangs_below="perhaps"), "include, exclude"),
    "a clearance": (lambda: Workspace(BOX, clearance_m=nan), "clearance_m"),
    "a box upside down": (lambda: Prism.box((1.0, 0.0), (0.0, 1.0), (0.0, 1.0)), "lowest x"),
    "a corner nowhere": (lambda: Prism.over(BOX.polygon_m * nan, 0.0, (0.0, 1.0)), "finite"),
    "an inset": (lambda: Prism.over(BOX.polygon_m, nan, (0.0, 1.0)), "inset_m"),
    "a line in space": (lambda: Rectangle.over(np.zeros(3), 0.0, (0.0, 1.0)), r"\(n, 2\)"),
    "a range of two": (lambda: Orientations.within([0.0, 0.0], [1.0, 1.0]), r"low_rad .*\(3\)"),
    "a range of nothing": (lambda: Orientations.within([0.0] * 3, [0.0] * 3), "above it"),
    "a range from above": (lambda: Orientations.within([0.0] * 3, [1.0, -1.0, 0.0]), "below"),
    "a floor": (lambda: Workspace(BOX, floor_m=inf), "floor_m"),
    "a safety factor": (lambda: Selection(safety_factor=0.5), "safety_factor .*below 1"),
    "an efficiency": (lambda: Selection(termination_efficiency=1.2), "not be above 1"),
    "a sheave": (lambda: Selection(sheave_diameter_m=0.0), "sheave_diameter_m"),
    "an objective": (lambda: Selection(objectives=("beauty",)), "'beauty' is none of mass"),
    "an objective twice": (lambda: Selection(objectives=("mass", "mass")), "given twice"),
    "no objective": (lambda: Selection(objectives=()), "at least"),
    "one grade": (lambda: Selection(grades="rope-a"), "several ids"),
    "no products": (lambda: Selection(groups=HALVES, max_distinct_products=0), "max_distinct"),
    "a limit on one": (lambda: Selection(max_distinct_products=1), "no meaning"),
    "an empty group": (lambda: CableGroup("back", ()), "'back' has no cable"),
    "a cable before the first": (lambda: CableGroup("back", (0,)), "not be below 1"),
    "a cable in two groups": (
        lambda: Selection(groups=(CableGroup("a", (1, 2)), CableGroup("b", (2,)))),
        "cable 2 is in group 'a'",
    ),
    "a cable too many": (
        lambda: Study("s", ROBOT, STEEL, workspace=SOME, selection=Selection(groups=HALVES)),
        "wrong is 7",
    ),
    "many poses": (
        lambda: Study("s", ROBOT, STEEL, pose=Poses(np.zeros((2, 3)), np.eye(3))),
        "one pose",
    ),
    "a choice for nothing": (
        lambda: Study("s", ROBOT, STEEL, selection=Selection()),
        "needs the workspace",
    ),
    "a measured cable": (lambda: Measurements(Path("rows.csv"), -1.0, 1e6), "linear_density"),
    "a noise": (lambda: Measurements(Path("a.csv"), 1.0, 1e6, length_noise_m=0.0), "length_noise"),
    "a cable of an effect": (lambda: DeclaredEffect("creep", 0, {}), "cable"),
    "a parameter": (lambda: DeclaredEffect("creep", None, {"strain": nan}), "strain"),
    "two cables for six": (lambda: solve_sagging(ROBOT, ONE, Cables((ROPE,) * 2)), "2 cables"),
}


@pytest.mark.parametrize("what", WRONG)
def test_what_cannot_be_is_refused_in_one_sentence(what) -> None:
    make, why = WRONG[what]
    with pytest.raises(ValueError, match=why) as caught:
        make()
    assert "\n" not in str(caught.value)


MADE = {
    kind.__name__: kind
    for kind in (getattr(designer, name) for name in designer.__all__)
    if isinstance(kind, type) and getattr(kind.__init__, "__wrapped__", None)
}
RIGHT = {
    "Robot": {"exit_points_m": EXITS, "platform": Platform(100.0, BODY)},
    "Study": {"name": "s", "robot": ROBOT, "material": STEEL, "workspace": SOME},
    "Workspace": {"region": BOX},
    "Platform": {"mass_kg": 1.0},
    "LoadCase": {"name": "case"},
    "Prism": {"polygon_m": BOX.polygon_m, "z_m": (0.0, 1.0)},
    "Rectangle": {"ends_m": np.eye(2), "z_m": (0.0, 1.0)},
    "DeclaredEffect": {"id": "creep", "cable": None, "parameters": {}},
    "CableGroup": {"name": "front", "cables": (1, 2)},
    "Wind": {"speed_m_per_s": 3.0, "cable_drag_coefficient": 1.2},
    "Cable": {
        "diameter_m": 0.01, "linear_density_kg_per_m": 0.4, "axial_stiffness_N": 6e6,
        "allowable_tension_N": 1e4,
    },
    "Poses": {"position_m": np.zeros(3), "rotation": np.eye(3)},
    "Measurements": {
        "file": Path("rows.csv"), "linear_density_kg_per_m": 1.0, "axial_stiffness_N": 1e6,
    },
}  # fmt: skip


@pytest.mark.parametrize("name", MADE)
def test_wrong_values_are_input_errors_that_name_the_field(name: str) -> None:
    """Each field that is an array, a number or a value of its own, with what is none of them."""
    kind = MADE[name]
    texts = {str, bool, Path, dict, list, tuple}
    tried = 0
    for field in fields(kind):
        hint = get_type_hints(kind)[field.name]
        union = get_args(hint) if get_origin(hint) in (Union, UnionType) else (hint,)
        parts = {get_origin(part) or part for part in union}
        if parts & texts or field.name == "z_m":
            continue
        for wrong in ("rubbish", object()):
            with pytest.raises(designer.InputError) as caught:
                kind(**{**RIGHT.get(name, {}), field.name: wrong})
            assert caught.value.faults[0].field == field.name, (field.name, wrong)
            assert caught.value.faults[0].file == name
        tried += 1
    assert tried or name == "CableGroup"
    with pytest.raises(designer.InputError, match="nonsense is no field"):
        kind(**RIGHT.get(name, {}), nonsense=1)


@pytest.mark.parametrize(
    ("make", "field"),
    [
        (lambda: Selection(safety_factor=0.5), "safety_factor"),
        (lambda: replace(STEEL, youngs_modulus_Pa=-1.0), "youngs_modulus_Pa"),
        (lambda: Prism.over(BOX.polygon_m, nan, (0.0, 1.0)), "inset_m"),
        (lambda: Poses.at("here"), "position_m"),
        (lambda: Study("s", ROBOT, STEEL, load_cases=({"name": "wind"},)), "load_cases"),
        (lambda: designer.lengths(STUDY, [[0.0, 1.0]]), "poses"),
        (lambda: designer.find_poses(STUDY, [[1.0, 2.0]]), "length_m"),
        (lambda: designer.follow(STUDY, [[0, 0, 0], [1, 0, 0]]), "time_s"),
        (lambda: designer.follow(STUDY, [["a"]], [0.0]), "places"),
        (lambda: designer.export(STUDY, "dxf", "a.dxf"), "to"),
        (lambda: designer.export(STUDY, "csv", "a.txt"), "path"),
    ],
)
def test_field_of_a_wrong_value(make: Callable[[], object], field: str) -> None:
    with pytest.raises(designer.InputError) as caught:
        make()
    assert caught.value.faults[0].field == field


@pytest.mark.parametrize(
    ("kind", "called", "meant"),
    [
        (Platform, "mass", "mass_kg"),
        (Robot, "anchors", "exit_points_m"),
        (Robot, "tension_min", "tension_min_N"),
        (Material, "density", "density_kg_per_m3"),
        (Selection, "sheave_diameter", "sheave_diameter_m"),
        (LoadCase, "acceleration", "acceleration_m_per_s2"),
        (Workspace, "clearance", "clearance_m"),
        (Workspace, "simples", "samples"),
    ],
)
def test_names_of_a_study_lead_to_those_of_python(kind: type, called: str, meant: str) -> None:
    with pytest.raises(designer.InputError, match=f"{called} is no field .expected {meant},"):
        kind(**{called: 1.0})


@pytest.mark.parametrize("what", ["exits", "kappa", "force", "rotation"])
def test_arrays_of_another_length_do_not_enter_compiled_code(what) -> None:
    poses = Poses(np.tile([4.0, 4.0, 3.0], (3, 1)), np.eye(3))
    exits, kappa, force = EXITS, np.full(6, 1e-6), np.zeros((3, 3))
    if what == "exits":
        exits = np.stack([EXITS] * 2)
    elif what == "kappa":
        kappa = kappa[:5]
    elif what == "force":
        force = force[:2]
    else:
        object.__setattr__(poses, "rotation", np.stack([np.eye(3)] * 2))
    with pytest.raises(ValueError, match=r"fit|shape"):
        situation = situation_of(ROBOT, poses, exits, force)
        solve_batch(ROBOT, situation, kappa, np.ones(6), np.full(6, 2e3), None, sag_max=0.2)


def test_lists_are_taken_and_what_is_right_stays_as_it_is() -> None:
    robot = Robot([[0, 0, 9], [9, 0, 9], [4, 9, 9]], Platform(100.0))  # type: ignore[arg-type]
    assert robot.exit_points_m.dtype == np.float64
    assert ROBOT.exit_points_m is EXITS
    assert replace(ROPE, axial_stiffness_N=inf).axial_stiffness_N == inf
    assert np.isnan(Poses.at([nan, 0.0, 0.0]).position_m[0])
    assert Poses([1, 2, 3], np.eye(3).tolist()).shape == ()  # type: ignore[arg-type]
    assert Poses(ONE.position_m, ONE.rotation).position_m is ONE.position_m


@pytest.mark.parametrize(
    "wrong",
    [
        {"mass_kg": 0.0},
        {"dynamic_factor": 0.99},
        {"acceleration_m_per_s2": -0.1},
        {"safety_factor": 0.99},
        {"termination_efficiency": 0.0},
        {"termination_efficiency": 1.01},
        {"cable_lost": 0},
        {"cable_lost": "all"},
    ],
)
def test_a_load_case_refuses_what_cannot_be(wrong: dict[str, Any]) -> None:
    with pytest.raises(ValueError, match=next(iter(wrong))):
        LoadCase("case", **wrong)
    LoadCase("case", 1.0, dynamic_factor=1.0, safety_factor=1.0, termination_efficiency=1.0)
