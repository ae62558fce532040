"""Optimisation files: what they come to, and mistakes in them."""

from __future__ import annotations

from pathlib import Path

import pytest
from optimum_cases import OF_POSE, OF_YARD, STUDY, YARD, plan_of, written

from designer.errors import InputError
from designer.optimum.optimise import optimised_text
from designer.optimum.plan import demand_sense, read_optimisation
from designer.resources import example_file, example_names

WINDY = YARD.replace("galvanised]", "galvanised], safety_factor: 5")
WINDY = WINDY.replace("100 kg}", "100 kg, drag: {area: 1 m^2, coefficient: 1}}")
WINDY = WINDY.replace("200 MPa}", "200 MPa, drag_coefficient: 1.2}")
WINDY += "load_cases: [{name: gale, wind: {speed: 20 m/s}}]\n"


def lines(path: Path) -> list[str]:
    with pytest.raises(InputError) as caught:
        read_optimisation(path, with_plugins=False)
    return [str(fault).replace(f"{path}:", "") for fault in caught.value.faults]


@pytest.mark.parametrize(
    ("field", "sense"),
    [
        ("selection.safety_factor", 1),
        ("workspace.inset", -1),
        ("workspace.interference.clearance", 1),
        ("selection.limits.sag", -1),
        ("selection.limits.drum_capacity", -1),
        ("robot.platform.mass", 1),
        ("selection.sheave_diameter", None),
        ("robot.winches.tension_max", -1),
        ("robot.winches.tension_max.2", -1),
        ("robot.winches.gear_ratio", None),
        ("workspace.height", 0),
        ("robot.pulley_radius", None),
    ],
)
def test_what_asks_for_more_is_known(field: str, sense: int | None) -> None:
    assert demand_sense(tuple(field.split("."))) == sense


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


@pytest.mark.parametrize(
    ("field", "bounds", "expected"),
    [
        ("workspace.samples", "[100, 300]", "1 to "),
        ("workspace.seed", "[0, 9]", "0 to 4294967295"),
        ("load_cases.0.wind.directions", "[4, 16]", "1 to 72"),
        ("selection.max_distinct_products", "[1, 3]", "a whole number"),
    ],
)
def test_a_whole_number_is_no_variable(
    tmp_path: Path, field: str, bounds: str, expected: str
) -> None:
    """Its bounds are whole, what lies between them is not."""
    plan = f"study: crane.yaml\nobjective: rope_mass\nvariables:\n  {field}: {bounds}\n"
    (line,) = lines(written(tmp_path, plan, WINDY))
    assert line.startswith("4: variables.")
    assert "is not a whole number" in line
    assert expected in line


@pytest.mark.parametrize(
    ("field", "bounds", "value", "asks"),
    [
        ("selection.safety_factor", "[3, 6]", 4.0, "less"),
        ("selection.safety_factor", "[3, 6]", 6.0, "more"),
        ("selection.safety_factor", "[3, 6]", 5.0, ""),
        ("workspace.region.inset", "[1 m, 4 m]", 3.0, "less"),
        ("load_cases.0.wind.speed", "[5 m/s, 20 m/s]", 10.0, "less"),
        ("robot.platform.mass", "[50 kg, 100 kg]", 60.0, "less"),
        ("workspace.region.z.0", "[1 m, 4 m]", 2.0, "other"),
        ("robot.anchors.0.2", "[8 m, 12 m]", 9.0, ""),
        ("cable.density", "[5000 kg/m^3, 8000 kg/m^3]", 6000.0, ""),
    ],
)
def test_a_demand_as_a_variable_is_known_for_one(
    tmp_path: Path, field: str, bounds: str, value: float, asks: str
) -> None:
    plan = f"study: crane.yaml\nobjective: rope_mass\nvariables:\n  {field}: {bounds}\n"
    (variable,) = plan_of(tmp_path, plan, WINDY).variables
    assert variable.asks_for(value) == asks


def test_a_price_is_asked_of_grades_that_have_none(tmp_path: Path) -> None:
    path = written(tmp_path, OF_YARD.replace("rope_mass", "rope_cost"), YARD)
    expected = "(expected grades with price_per_m, cost in selection.objectives, or rope_mass)"
    assert lines(path) == [f"2: objective: no grade of the study has prices {expected}"]


def test_borrowed_prices_are_said_to_be_estimated(tmp_path: Path) -> None:
    study = YARD.replace("selection: {", "selection: {objectives: [cost, mass], ")
    plan = plan_of(tmp_path, OF_YARD.replace("rope_mass", "rope_cost"), study)
    assert plan.objective.title == "estimated price of all ropes"


def test_the_shipped_example_reads() -> None:
    plan = read_optimisation(example_file("optimise/yard"), with_plugins=False)
    assert plan.given == (0.0, 0.0, 26.0)
    assert plan.limits[0].value == 4500.0
    assert "optimise/yard" not in example_names()


def test_no_variables_and_a_study_that_is_none(tmp_path: Path) -> None:
    assert lines(written(tmp_path, "study: crane.yaml\nobjective: diameter\nvariables: {}\n"))[
        0
    ] == ("3: variables: the mapping is empty (expected at least one field of the study)")
    path = written(tmp_path, OF_POSE, STUDY.replace("100 kg", "-1 kg"))
    assert "robot.platform.mass: '-1 kg' is out of range" in lines(path)[0]
