"""Optimisation files: what they come to, and mistakes in them."""

from __future__ import annotations

from pathlib import Path

import pytest
from optimum_cases import OF_POSE, OF_YARD, STUDY, YARD, plan_of, written

from designer.errors import InputError
from designer.optimum.optimise import optimised_text
from designer.optimum.read import read_optimisation
from designer.resources import example_file, example_names


def lines(path: Path) -> list[str]:
    with pytest.raises(InputError) as caught:
        read_optimisation(path, with_plugins=False)
    return [str(fault).replace(f"{path}:", "") for fault in caught.value.faults]


def test_fields_go_with_their_variable_and_keep_their_units(tmp_path: Path) -> None:
    plan = plan_of(tmp_path)
    shift, height = plan.variables
    assert shift.fields == tuple(f"robot.anchors[{k}][0]" for k in range(3))
    assert (shift.given, height.given) == (0.0, 10.0)
    assert plan.given == (0.0, 10.0)
    robot = plan.base.study(plan.changes((2.0, 11.5))).robot
    assert robot.exit_points_m.tolist() == [[2, 0, 11.5], [22, 0, 11.5], [12, 17, 11.5]]
    text = optimised_text(plan, (2.0, 11.5))
    assert "[[2, 0, 11.5], [22, 0, 11.5 m], [12, 17, 11.5]]  # mast tops" in text
    assert text.startswith("# a small crane\n")


def test_a_factor_and_another_unit_are_counted(tmp_path: Path) -> None:
    spec = "shift: {fields: {robot.anchors.0.0: -2, pose.1: 1}, offset: [-40 cm, 60 cm]}"
    plan = plan_of(tmp_path, OF_POSE.replace(OF_POSE.splitlines()[3].strip(), spec))
    study = plan.base.study(plan.changes((50.0, 9.0)))
    assert study.robot.exit_points_m[0].tolist() == [-1.0, 0.0, 9.0]
    assert study.pose is not None
    assert study.pose.position_m.tolist() == [10.0, 6.5, 4.0]


def test_a_value_stands_in_round_steps_within_its_bounds(tmp_path: Path) -> None:
    shift = plan_of(tmp_path).variables[0]
    assert [shift.at(x) for x in (0.0, 0.12345, 1.0)] == [-4.0, -2.77, 6.0]
    assert [shift.bound_at(x) for x in (-4.0, 0.0, 6.0)] == ["lower", "", "upper"]


@pytest.mark.parametrize("region", ["stays", "follows"])
def test_the_region_stays_when_anchors_move(tmp_path: Path, region: str) -> None:
    plan = plan_of(tmp_path, f"{OF_YARD}region: {region}\n", YARD)
    before, after = (
        plan.base.study(plan.changes((value,))).workspace.region.bounds_m  # type: ignore[union-attr]
        for value in (0.0, 1.0)
    )
    assert (before == after).all() == (region == "stays") == plan.region_stays
    own = plan_of(tmp_path, OF_YARD, YARD).base.study().workspace
    assert own is not None
    assert own.region.bounds_m == pytest.approx(before)


@pytest.mark.parametrize(
    ("old", "new", "line"),
    [
        ("*][2]", "*][3]", "5: variables.robot.anchors[*][3]: robot.anchors[0][3]: the study has"),
        ("*][2]: [6 m", "*][2]: [6 kg", "its bounds are in 'kg' and 'm' (expected both in one un"),
        ("[6 m, 12 m]", "[6 kg, 12 kg]", "robot.anchors[0][2]: '6 kg' has the unit kilogram"),
        ("[6 m, 12 m]", "[12 m, 6 m]", "the lower bound 12 m is not below 6 m (expected [lower,"),
        ("[6 m, 12 m]", "[6 m]", "variables.robot.anchors[*][2]: a list is no range (expected [l"),
        ("[6 m, 12 m]", "[6 m, high]", "is no range"),
        ("[6 m, 12 m]", "[6 m, 1e9 m]", "robot.anchors[0][2]: '1000000000 m' is out of range"),
        ("offset: [", "bound: [", "4: variables.shift: unknown field 'bound' (expected one of fi"),
        (", offset: [-4 m, 6 m]", "", "4: variables.shift: has not one of bounds and offset"),
        ("[robot.anchors.*.0]", "{pose.0: m}", "4: variables.shift.fields: 'm' is no factor"),
        ("[robot.anchors.*.0]", "[robot.drums.*.0]", "robot.drums.*.0: the study has no list the"),
        ("[robot.anchors.*.0]", "[robot.anchors.0.2]", "robot.anchors[0][2] is set by 'shift' al"),
        ("[robot.anchors.*.0]", "[robot.platform.drag.area]", "the study has no number there"),
        ("{minimise: pose.sagging.max_tension_N}", "rope_mas", "did you mean 'rope_mass'?)"),
        ("{minimise: pose.sagging.max_tension_N}", "rope_mass", "2: objective: the study has no"),
        ("max_tension_N", "max_tension", "did you mean 'max_tension_N'?"),
        ("evaluations: 150", "evaluations: 0", "6: budget.evaluations: 0 is out of range (expect"),
        ("evaluations: 150", "time: 0 s", "6: budget.time: '0 s' is out of range (expected more"),
        ("budget", "budgets", "6: budgets: unknown field 'budgets'"),
        ("max_tension_N", "status", "pose.sagging.status is a text (expected a number of result"),
        ("max_tension_N", "lengths_m", "pose.sagging.lengths_m is a list (expected a number of r"),
        ("budget", "constraints: {diameter: 2 kg}\nbudget", "constraints.diameter: '2 kg' has th"),
        ("budget", "constraints: {diameter: [2 mm]}\nbudget", "diameter: a list is no limit (exp"),
        ("crane.yaml", "none.yaml", "none.yaml: there is no such file"),
    ],
)  # fmt: skip
def test_a_mistake_gets_one_line(tmp_path: Path, old: str, new: str, line: str) -> None:
    assert old in OF_POSE
    found = lines(written(tmp_path, OF_POSE.replace(old, new)))
    assert any(line in one for one in found), found


def test_a_price_is_asked_of_grades_that_have_none(tmp_path: Path) -> None:
    path = written(tmp_path, OF_YARD.replace("rope_mass", "rope_cost"), YARD)
    expected = "(expected grades with price_per_m, or rope_mass)"
    assert lines(path) == [f"2: objective: no grade of the study has prices {expected}"]


def test_the_shipped_example_reads() -> None:
    plan = read_optimisation(example_file("optimise/yard"), with_plugins=False)
    assert plan.given == (0.0, 0.0, 26.0)
    assert plan.limits[0].most == 4500.0
    assert "optimise/yard" not in example_names()


def test_no_variables_and_a_study_that_is_none(tmp_path: Path) -> None:
    assert lines(written(tmp_path, "study: crane.yaml\nobjective: diameter\nvariables: {}\n"))[
        0
    ] == ("3: variables: the mapping is empty (expected at least one field of the study)")
    path = written(tmp_path, OF_POSE, STUDY.replace("100 kg", "-1 kg"))
    assert "robot.platform.mass: '-1 kg' is out of range" in lines(path)[0]
