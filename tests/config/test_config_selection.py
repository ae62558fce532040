"""Groups, limits and uncertainty of the choice of a rope in the config."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from designer.errors import Fault
from designer.model.uncertainty import Normal, Uncertainty, Uniform
from designer.study import CableGroup, RopeLimits, Study

StudyOf = Callable[[str], Study]
FaultsOf = Callable[[str], list[Fault]]

GROUPS = "  groups: {near: [1, 2], far: [3]}\n"


def test_groups_and_their_default_limit(valid: str, study_of: StudyOf) -> None:
    selection = study_of(valid + GROUPS).selection
    assert selection is not None
    assert selection.groups == (CableGroup("near", (1, 2)), CableGroup("far", (3,)))
    assert selection.max_distinct_products is None


def test_limit(valid: str, study_of: StudyOf) -> None:
    selection = study_of(f"{valid}{GROUPS}  max_distinct_products: 1\n").selection
    assert selection is not None
    assert selection.max_distinct_products == 1


def test_preferred_units_and_groups_exclude_each_other(valid: str, faults_of: FaultsOf) -> None:
    (fault,) = faults_of(f"{valid}{GROUPS}  prefer: metric\n")
    assert fault.field == "selection.groups"
    assert fault.expected == "prefer or groups, not both"


@pytest.mark.parametrize("text", ["", "  groups:\n"])
def test_no_groups(valid: str, study_of: StudyOf, text: str) -> None:
    selection = study_of(valid + text).selection
    assert selection is not None
    assert selection.groups == ()


def test_the_table_of_inputs_has_them(valid: str, study_of: StudyOf) -> None:
    entries = {e.field: e.given for e in study_of(valid + GROUPS).source.entries}
    assert entries["selection.groups.near"] == "[1, 2]"
    assert entries["selection.max_distinct_products"] == "default"


@pytest.mark.parametrize(
    ("text", "field", "problem"),
    [
        ("groups: {a: [1, 2], b: [2, 3]}", "a", "cable 2 is in group 'a' already"),
        ("groups: {a: [1, 1], b: [2, 3]}", "a[1]", "cable 1 is in group 'a' already"),
        ("groups: {a: [1, 2]}", "", "cable 3 is in no group"),
        ("groups: {a: [1]}", "", "cables 2 and 3 are in no group"),
        ("groups: {a: [1, 2, 3, 4]}", "a[3]", "there is no cable 4, the robot has 3"),
        ("groups: {a: [1, 2, 3], b: []}", "b", "the list has 0 values"),
        ("groups: {a: [0, 1, 2, 3]}", "a[0]", "0 is out of range"),
        ("groups: {a: [1.5, 2, 3]}", "a[0]", "1.5 is not a whole number"),
        ("groups: {a: [one, 2, 3]}", "a[0]", "'one' is not a number"),
        ("groups: {a: 1, b: [2, 3]}", "a", "1 is not a list"),
        ("groups: {}", "", "the mapping is empty"),
        ("groups: [1, 2, 3]", "", "a list is not a mapping"),
    ],
)
def test_one_line_for_a_mistake(
    valid: str, faults_of: FaultsOf, text: str, field: str, problem: str
) -> None:
    faults = faults_of(f"{valid}  {text}\n")
    assert [fault.problem for fault in faults] == [problem]
    assert faults[0].field.startswith("selection.groups")
    assert field.removeprefix("a") in faults[0].field
    assert faults[0].line == valid.count("\n") + 1
    assert faults[0].expected


@pytest.mark.parametrize("limit", ["0", "two", "1.5", "[1]"])
def test_limit_must_be_a_whole_number(valid: str, faults_of: FaultsOf, limit: str) -> None:
    faults = faults_of(f"{valid}{GROUPS}  max_distinct_products: {limit}\n")
    assert [fault.field for fault in faults] == ["selection.max_distinct_products"]
    assert faults[0].expected == "a whole number from 1 to 64"


def test_limit_without_groups(valid: str, faults_of: FaultsOf) -> None:
    faults = faults_of(f"{valid}  max_distinct_products: 2\n")
    assert [fault.problem for fault in faults] == ["has no meaning without selection.groups"]


def test_a_selection_needs_a_workspace(valid: str, faults_of: FaultsOf) -> None:
    start, end = valid.index("workspace:"), valid.index("selection:")
    (fault,) = faults_of(valid[:start] + valid[end:])
    assert (fault.field, fault.line) == ("selection", valid[:start].count("\n") + 1)
    assert "workspace" in fault.problem


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
        ("{platform_frequency: [1 Hz]}", "platform_frequency", "has 1 value"),
        ("{platform_frequency: [3 Hz, 1 Hz]}", "platform_frequency", "is not below the upper 1 Hz"),
        ("{platform_frequency: 2 m}", "platform_frequency", "has the unit meter"),
        ("{drum_capacity: -1 m}", "drum_capacity", "is out of range"),
        ("{drum: 60 m}", "drum", "unknown field"),
    ],
)
def test_limits_mistakes(
    faults_of: Callable[[str], list[Fault]], limits: str, field: str, problem: str
) -> None:
    (fault,) = faults_of(STUDY % limits)
    assert fault.field == f"selection.limits.{field}"
    assert problem in fault.problem


def test_a_least_frequency_of_the_platform_or_a_band(study_of: Callable[[str], Study]) -> None:
    for given, read in (("500 mHz", (0.5,)), ("[0.5, 2 Hz]", (0.5, 2.0))):
        selection = study_of(STUDY % f"{{platform_frequency: {given}}}").selection
        assert selection is not None
        assert selection.limits.platform_frequency_Hz == pytest.approx(read)
    with pytest.raises(ValueError, match="platform_frequency_Hz"):
        RopeLimits(platform_frequency_Hz=(2.0, 1.0))


BODY = """\
robot:
  anchors: &a [[9, 0, 9], [9, 1, 9], [-4, 8, 9], [-5, 7, 9], [-4, -7, 9], [-5, -8, 9]]
  platform:
    mass: 100
    attachments: [[1, 0, 0], [1, 0.1, 0], [-1, 1, 0], [-1, 1.1, 0], [-1, -1, 0], [-1, -1.1, 0]]
    %s
cable: {density: 7800, youngs_modulus: 200 GPa, allowable_stress: 180 MPa}
workspace: {region: {points: [[0, 0, 3]]}}
selection: {%s}
load_cases: [{name: static}, {name: loaded, %s}]
"""
LIMIT = "limits: {platform_frequency: 1 Hz}"


def test_inertia_becomes_a_matrix(study_of: Callable[[str], Study]) -> None:
    study = study_of(
        BODY % ("inertia: [20, 30, 40, 1, 2, -3]", LIMIT, "mass: 90, inertia: [9, 9, 9]")
    )
    inertia = study.robot.platform.inertia_kg_m2
    assert inertia is not None and inertia.tolist() == [[20, 1, 2], [1, 30, -3], [2, -3, 40]]
    case = study.load_cases[1].inertia_kg_m2
    assert case is not None and case.tolist() == [[9, 0, 0], [0, 9, 0], [0, 0, 9]]


@pytest.mark.parametrize(
    ("inertia", "limits", "case", "field", "problem"),
    [
        ("", LIMIT, "", "selection.limits.platform_frequency", "inertia of the platform is not"),
        ("inertia: [9, 9, 9]", LIMIT, "mass: 90", "load_cases[1].mass", "with this mass is not"),
        ("inertia: [1, 1]", "", "", "robot.platform.inertia", "has 2 values"),
        ("inertia: [1, 1, 1, 0]", "", "", "robot.platform.inertia", "has 4 values"),
        ("inertia: [1, 1, 3]", "", "", "robot.platform.inertia", "no body has"),
        ("inertia: [1, 1, 0]", "", "", "robot.platform.inertia", "no body has"),
        ("inertia: [1, 1, 1, 2, 0, 0]", "", "", "robot.platform.inertia", "no body has"),
        ("inertia: [1 kg, 1, 1]", "", "", "robot.platform.inertia[0]", "has the unit kilogram"),
    ],
)
def test_mistakes_of_inertia(
    faults_of: Callable[[str], list[Fault]],
    inertia: str,
    limits: str,
    case: str,
    field: str,
    problem: str,
) -> None:
    (fault,) = faults_of(BODY % (inertia, limits, case))
    assert fault.field == field
    assert problem in fault.problem


def test_a_point_has_no_inertia(faults_of: Callable[[str], list[Fault]]) -> None:
    text = STUDY % "{}" + "load_cases: [{name: a, inertia: [1, 1, 1]}]\n"
    given = text.replace("mass: 100", "mass: 100, inertia: [1, 1, 1]")
    assert {fault.field for fault in faults_of(given)} == {
        "robot.platform.inertia",
        "load_cases[0].inertia",
    }


@pytest.mark.parametrize("band_Hz", [(0.0, 1.0), (2.0, 2.0), (3.0, 1.0)])
def test_no_band_in_python(band_Hz: tuple[float, float]) -> None:
    with pytest.raises(ValueError, match="excitation_Hz"):
        RopeLimits(excitation_Hz=band_Hz)


def test_what_it_becomes(valid: str, study_of: StudyOf) -> None:
    block = """
uncertainty:
  payload: {standard_deviation: 2 %}
  modulus: {uniform: 0.15}
  linear_mass: {uniform: [-1 %, 0.03]}
  exit_points: {standard_deviation: 20 mm}
  samples: 1000
  seed: 7
"""
    assert study_of(valid + block).uncertainty == Uncertainty(
        payload=Normal(0.02),
        modulus=Uniform(-0.15, 0.15),
        linear_mass=Uniform(-0.01, 0.03),
        exit_points_m=Normal(0.02),
        samples=1000,
        seed=7,
    )
    points = study_of(valid + "uncertainty: {exit_points: {uniform: [-1 cm, 2 cm]}}").uncertainty
    assert points == Uncertainty(exit_points_m=Uniform(-0.01, 0.02))


@pytest.mark.parametrize("block", ["", "uncertainty:\n"])
def test_none(valid: str, study_of: StudyOf, block: str) -> None:
    assert study_of(valid + block).uncertainty is None


def test_the_table_of_inputs_has_it(valid: str, study_of: StudyOf) -> None:
    study = study_of(valid + "uncertainty: {payload: {uniform: [-2 %, 5 %]}}\n")
    entries = {one.field: one for one in study.source.entries}
    assert entries["uncertainty.payload.uniform"].given == "[-2 %, 5 %]"
    assert entries["uncertainty.payload.uniform"].value_SI == "[-0.02, 0.05]"
    assert entries["uncertainty.samples"].value_SI == "4096"


@pytest.mark.parametrize(
    ("block", "field", "problem"),
    [
        ("{payload: {standard_deviation: -2 %}}", "payload.standard_deviation", "'-2 %' is out of"),
        ("{payload: {standard_deviation: 2}}", "payload.standard_deviation", "2 is out of range"),
        ("{payload: {standard_deviation: 2 kg}}", "payload.standard_deviation", "unit kilogram"),
        ("{payload: {uniform: .nan}}", "payload.uniform", "not a finite number"),
        ("{payload: {uniform: [5 %, 1 %]}}", "payload.uniform", "not below the upper"),
        ("{payload: {uniform: [1 %, 2 %, 3 %]}}", "payload.uniform", "the list has 3 values"),
        ("{payload: {gauss: 2 %}}", "payload", "the distribution 'gauss' is not known"),
        ("{payload: 2 %}", "payload", "'2 %' is not a distribution"),
        ("{payload: {}}", "payload", "names no distribution"),
        ("{modulus: {standard_deviation: 1 %, uniform: 2 %}}", "modulus", "two distributions"),
        ("{exit_points: {standard_deviation: 2 %}}", "exit_points.standard_deviation", "percent"),
        ("{exit_points: {standard_deviation: 20}}", "exit_points.standard_deviation", "out of"),
        ("{paylod: {uniform: 2 %}}", "paylod", "unknown field"),
        ("{samples: 3}", "samples", "out of range"),
        ("{samples: 0.5}", "samples", "not a whole number"),
        ("{seed: -1}", "seed", "out of range"),
    ],
)
def test_uncertainty_mistakes(
    valid: str, faults_of: FaultsOf, block: str, field: str, problem: str
) -> None:
    (fault,) = faults_of(valid + f"uncertainty: {block}\n")
    assert fault.field == f"uncertainty.{field}"
    assert problem in fault.problem
    assert fault.line == valid.count("\n") + 1


def test_it_needs_one_rope_to_choose(valid: str, faults_of: FaultsOf) -> None:
    block = "uncertainty: {payload: {uniform: 2 %}}\n"
    (fault,) = faults_of(valid[: valid.index("selection:")] + block)
    assert (fault.field, fault.problem) == ("uncertainty", "there is no selection")
    groups = valid + "  groups: {a: [1], b: [2, 3]}\n" + block
    (fault,) = faults_of(groups)
    assert fault.field == "selection.groups"
