"""Every mistake in a config gives its own line; all of them come out together."""

from __future__ import annotations

import random
from collections.abc import Callable
from pathlib import Path

import pytest

from designer.errors import Fault, InputError
from designer.io.config import read_study
from designer.study import Study, require_enough_cables

FaultsOf = Callable[[str], list[Fault]]
StudyOf = Callable[[str], Study]
Mistake = tuple[str, str, int, str, str, str]

SIX = """\
robot:
  anchors: [[0, 0, 9], [9, 0, 9], [9, 9, 9], [0, 9, 9], [4, 0, 9], [4, 9, 9]]
  platform:
    mass: 100
    attachments: [[1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 1, 0], [0, 0, 0], [0, 0, 0]]
cable: {density: 7800, youngs_modulus: 200 GPa, allowable_stress: 180 MPa}
"""

# what is replaced, by what, and the fault: line, field, problem, expected
MISTAKES: list[Mistake] = [
    ("180 kg", "180 m", 8, "robot.platform.mass", "'180 m' has the unit meter", "a mass"),
    ("180 kg", "180 kgg", 8, "robot.platform.mass", "has the unknown unit 'kgg'", "'kg'?"),
    ("180 kg", "-180 kg", 8, "robot.platform.mass", "is out of range", "more than 0 kg"),
    ("180 kg", "0", 8, "robot.platform.mass", "0 is out of range", "more than 0 kg"),
    ("180 kg", ".nan", 8, "robot.platform.mass", "nan is not a finite number", "a mass"),
    ("180 kg", "-.inf", 8, "robot.platform.mass", "'-.inf' is not a finite", "a mass"),
    ("180 kg", "true", 8, "robot.platform.mass", "true is not a number", "a mass"),
    ("180 kg", "", 8, "robot.platform.mass", "an empty value is not a number", "a mass"),
    ("180 kg", "[180]", 8, "robot.platform.mass", "a list is not a number", "a mass"),
    ("5290 kg/m^3", "5290 kg/m", 10, "cable.density", "the unit kilogram/meter", "a density"),
    ("5290 kg/m^3", "0", 10, "cable.density", "0 is out of range", "more than 0"),
    ("62.7 GPa", "200", 11, "cable.youngs_modulus", "200 is out of range", "number is in Pa"),
    ("62.7 GPa", "-1 GPa", 11, "cable.youngs_modulus", "is out of range", "more than 0 Pa"),
    ("198 MPa", "198", 12, "cable.allowable_stress", "198 is out of range", "number is in Pa"),
    ("[15, 2600 cm, 12]", "[60, 0, 12]", 3, "robot.anchors", "on one line when seen", "an area"),
    ("[15, 2600 cm, 12]", "[0, 0, 9]", 3, "robot.anchors", "on one line when seen", "an area"),
    ("[15, 2600 cm, 12]", "[15, 26]", 6, "robot.anchors[2]", "has 2 values", "[x, y, z]"),
    ("[15, 2600 cm, 12]", "[15, 26 s, 12]", 6, "robot.anchors[2][1]", "unit second", "a length"),
    ("[15, 2600 cm, 12]", "[15, 1e9, 12]", 6, "robot.anchors[2][1]", "out of range", "at most"),
    ("[15, 2600 cm, 12]", "east", 6, "robot.anchors[2]", "'east' is not a list", "[x, y, z]"),
    ("[15, 2600 cm, 12]", "[0, 0, 12]", 6, "robot.anchors[2]", "same point as", "distinct"),
    ("    - [15, 2600 cm, 12]\n", "", 3, "robot.anchors", "the list has 2 values", "at least 3"),
    ("anchors:", "anchrs:", 3, "robot.anchrs", "unknown field 'anchrs'", "mean 'anchors'?"),
    ("  samples", "  colour", 16, "workspace.colour", "unknown field 'colour'", "one of region"),
    ("    mass: 180 kg", "    {}", 7, "robot.platform.mass", "is missing", "'4000 kg'"),
    ("[15, 9, 4]", "[15, 9]", 13, "pose", "the list has 2 values", "three lengths"),
    ("[15, 9, 4]", "[15, 9, 4 kg]", 13, "pose[2]", "the unit kilogram", "a length"),
    ("[15, 9, 4]", "here", 13, "pose", "'here' is not a mapping", "position, rotation_vector"),
    (
        "[15, 9, 4]",
        "{position: [1, 2, 3], rotation_vector: [0, 0, 1 m]}",
        13,
        "pose.rotation_vector[2]",
        "the unit meter",
        "an angle",
    ),
    (
        "[15, 9, 4]",
        "{position: [1, 2, 3], rotation_vector: [0, 0, 1]}",
        13,
        "pose.rotation_vector",
        "has no meaning for a point mass",
        "attachments",
    ),
    (
        "[15, 9, 4]",
        "{position: [1, 2, 3], rotation_vector: [0, 0, 90]}",
        13,
        "pose.rotation_vector[2]",
        "90 is out of range",
        "at most 6.283185307 rad: a turn is 2 pi; a bare number is in rad",
    ),
    (
        "198 MPa",
        "98 GPa",
        12,
        "cable.allowable_stress",
        "stretches the cable by 156%",
        "at most 50%; check the unit",
    ),
    ("180 kg", "1e-300 kg", 8, "robot.platform.mass", "out of range", "at least 1e-06 kg: from a"),
    (
        "180 kg",
        "180 kg\n    wrench: {force: [0, 0, 1765.8]}",
        9,
        "robot.platform.wrench.force",
        "cancels the platform's weight",
        "a load that is left",
    ),
    (
        "    mass: 180 kg",
        "    mass: 180 kg\n    wrench: {force: [0, 0, 1863.9 N]}\neffects: {platform_mass: "
        "{offset_kg: 10}}",
        9,
        "robot.platform.wrench.force",
        "cancels the platform's weight",
        "a load that is left",
    ),
    ("prism: anchors", "prsm: anchors", 15, "workspace.region.prsm", "unknown field", "'prism'?"),
    ("prism: anchors", "prism: masts", 15, "workspace.region.prism", "is not known", "'anchors'"),
    ("prism: anchors, ", "", 15, "workspace.region", "none of the kinds", "exactly one"),
    ("inset: 3 m", "box: []", 15, "workspace.region", "has prism and box", "exactly one"),
    ("3 m", "-3 m", 15, "workspace.region.inset", "'-3 m' is out of range", "at least 0 m"),
    ("3 m", "30 m", 15, "workspace.region.inset", "is left inside an inset", "a smaller inset"),
    (", z: [1, 8]", "", 15, "workspace.region.z", "is missing", "[lower, upper]"),
    ("[1, 8]", "[8, 1]", 15, "workspace.region.z", "lower end 8 m is not below", "[lower, upper]"),
    ("[1, 8]", "[8, 8]", 15, "workspace.region.z", "lower end 8 m is not below", "[lower, upper]"),
    ("[1, 8]", "[1 kg, 8]", 15, "workspace.region.z[0]", "the unit kilogram", "a length"),
    (
        "prism: anchors",
        "prism: [[0, 0], [1, 1], [2, 2]]",
        15,
        "workspace.region.prism",
        "all corners lie on one line",
        "span an area",
    ),
    ("{prism: anchors, inset: 3 m, z: [1, 8]}", "all", 15, "workspace.region", "'all' is not", ""),
    (
        "{prism: anchors, inset: 3 m, z: [1, 8]}",
        "{box: [[0, 1], [0, 1], [2, 1]]}",
        15,
        "workspace.region.box[2]",
        "lower end 2 m is not below",
        "[lower, upper]",
    ),
    (
        "{prism: anchors, inset: 3 m, z: [1, 8]}",
        "{points: []}",
        15,
        "workspace.region.points",
        "the list has 0 values",
        "positions",
    ),
    (
        "prism: anchors, inset: 3 m, z: [1, 8]",
        "box: [[0, 1], [0, 1], [0, 1]], inset: 1",
        15,
        "workspace.region.inset",
        "unknown field 'inset'",
        "one of box",
    ),
    ("500", "0", 16, "workspace.samples", "0 is out of range", "from 1 to 10000000"),
    ("500", "1e9", 16, "workspace.samples", "is out of range", "from 1 to 10000000"),
    ("500", "2.5", 16, "workspace.samples", "2.5 is not a whole number", "from 1"),
    ("500", "500 m", 16, "workspace.samples", "the unit meter", "a whole number"),
    ("500", "500\n  hangs_below: no", 17, "workspace.hangs_below", "'no' is not", "'include' or"),
    ("500", "500\n  sampling: random", 17, "workspace.sampling", "'random' is not", "or 'grid'"),
    ("500", "500\n  seed: -1", 17, "workspace.seed", "-1 is out of range", "from 0"),
    ("factor: 4", "factor: 0.5", 18, "selection.safety_factor", "is out of range", "at least 1"),
    ("factor: 4", "factor: 4 kN", 18, "selection.safety_factor", "kilonewton", "a plain number"),
    ("safety_factor: 4", "objectives: mass", 18, "selection.objectives", "not a list", "[mass"),
    ("safety_factor: 4", "objectives: [weight]", 18, "selection.objectives[0]", "known", "'mass'"),
    ("safety_factor: 4", "objectives: [cost, cost]", 18, "selection.objectives", "twice", "once"),
    (
        "safety_factor: 4",
        "termination_efficiency: 1.2",
        18,
        "selection.termination_efficiency",
        "out of range",
        "at most 1",
    ),
    (
        "safety_factor: 4",
        "termination_efficiency: 90 %",
        18,
        "selection.termination_efficiency",
        "the unit percent",
        "a fraction such as 0.9",
    ),
    (
        "safety_factor: 4",
        "sheave_diameter: 0 mm",
        18,
        "selection.sheave_diameter",
        "out of range",
        "more than 0",
    ),
    ("safety_factor: 4", "grades: some", 18, "selection.grades", "'some' is not", "grade ids"),
    ("safety_factor: 4", "grades: []", 18, "selection.grades", "0 values", "grade ids"),
    ("safety_factor: 4", "grades: [7]", 18, "selection.grades[0]", "7 is not a text", "quotes"),
    ("name: A crane", "name: 7", 1, "name", "7 is not a text", "quotes"),
    ("name: A crane", "name: ''", 1, "name", "the text has 0 characters", "1 to"),
    ("name: A crane", "effects: [creep]", 1, "effects", "a list is not a mapping", "{}"),
    ("name: A crane", "catalogues: mine", 1, "catalogues", "'mine' is not a list", "a list"),
    ("name: A crane", "catalogues: [no]", 1, "catalogues[0]", "there is no 'no'", "relative"),
    ("name: A crane", "name: A\nname: B", 2, "name", "is given twice, first in line 1", "once"),
    ("name: A crane", "measurements: {}", 1, "measurements.file", "is missing", "CSV file"),
    (
        "name: A crane",
        "measurements: {file: a.csv, cable: {linear_mass: 1, axial_stiffness: 3 MPa}}",
        1,
        "measurements.cable.axial_stiffness",
        "the unit megapascal",
        "a force",
    ),
    (
        "name: A crane",
        "measurements: {file: a, settled: yes, cable: {linear_mass: 1, axial_stiffness: 9}}",
        1,
        "measurements.settled",
        "'yes' is not a truth value",
        "true or false",
    ),
]


@pytest.mark.parametrize("mistake", MISTAKES)
def test_mistake(valid: str, faults_of: FaultsOf, mistake: Mistake) -> None:
    old, new, line, field, problem, expected = mistake
    assert valid.count(old) == 1
    found = [fault for fault in faults_of(valid.replace(old, new)) if fault.field == field]
    assert len(found) == 1
    assert found[0].line == line
    assert problem in found[0].problem
    assert expected in found[0].expected


@pytest.mark.parametrize("mistake", [one for one in MISTAKES if one[3] != "measurements.file"])
def test_one_mistake_is_one_line(valid: str, faults_of: FaultsOf, mistake: Mistake) -> None:
    assert len(faults_of(valid.replace(mistake[0], mistake[1]))) == 1


def test_the_line_reads_as_documented(valid: str, study_of: StudyOf, tmp_path: Path) -> None:
    with pytest.raises(InputError) as caught:
        study_of(valid.replace("180 kg", "180 mm"))
    assert str(caught.value) == (
        f"{tmp_path / 'crane.yaml'}:8: robot.platform.mass: '180 mm' has the unit millimeter "
        "(expected a mass such as '4000 kg')"
    )


def test_all_faults_come_out_at_once_in_the_order_of_lines(valid: str, faults_of: FaultsOf) -> None:
    text = valid
    for old, new in [
        ("[15, 2600 cm, 12]", "[60, 0, 12]"),  # geometry
        ("180 kg", "-180 kg"),  # range
        ("62.7 GPa", "62.7 Gpa"),  # unit
        ("pose:", "poze:"),  # name
        ("z: [1, 8]", "z: [1 kg, 8]"),  # dimension
        ("  safety_factor: 4", "  safety_factor: 4\n  safety_factor: 5\n  grades: [x, 3]"),
    ]:
        assert old in text
        text = text.replace(old, new)
    assert [(fault.line, fault.field) for fault in faults_of(text)] == [
        (3, "robot.anchors"),
        (8, "robot.platform.mass"),
        (11, "cable.youngs_modulus"),
        (13, "poze"),
        (15, "workspace.region.z[0]"),
        (19, "selection.safety_factor"),
        (20, "selection.grades[1]"),
    ]


def test_missing_sections(faults_of: FaultsOf) -> None:
    assert [str(fault).split(": ", 1)[1] for fault in faults_of("# a note\nname: x\n")] == [
        "cable: is missing (expected {density: …, youngs_modulus: …, allowable_stress: …} or "
        "{grade: ID})",
        "robot: is missing (expected a mapping with anchors and platform)",
    ]


FIVE = SIX.replace(", [4, 9, 9]", "").replace(", [0, 0, 0]]", "]")


@pytest.mark.parametrize(
    ("text", "problem", "expected"),
    [
        (FIVE, "5 cables on a platform with attachments", "6"),
    ],
)
def test_a_robot_with_too_few_cables_can_be_read_but_not_sized(
    study_of: StudyOf, text: str, problem: str, expected: str
) -> None:
    study = study_of(text)
    with pytest.raises(InputError) as caught:
        require_enough_cables(study)
    (fault,) = caught.value.faults
    assert (fault.line, fault.field) == (2, "robot.anchors")
    assert fault.problem.startswith(problem)
    assert "fewer than its 6 degrees of freedom" in fault.problem
    assert fault.expected.startswith(expected)


def test_a_robot_with_more_cables_can_be_sized(study_of: StudyOf) -> None:
    study = study_of(SIX.replace("    attach", "    # attach"))
    require_enough_cables(study)
    assert study.robot.is_redundant


@pytest.mark.parametrize("is_body", [True, False])
def test_a_square_robot_can_be_sized(valid: str, study_of: StudyOf, is_body: bool) -> None:
    study = study_of(SIX if is_body else valid)
    require_enough_cables(study)
    assert study.robot.n_cables == study.robot.degrees_of_freedom == (6 if is_body else 3)


@pytest.mark.parametrize(
    ("old", "new", "field", "problem"),
    [
        ("[1, 1, 0], ", "", "attachments", "5 attachments for 6 anchors"),
        ("[4, 9, 9]", "[4, 0, 9]", "", "is the same point as robot.anchors[4], and so are"),
        (
            "[[1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 1, 0]",
            "[[0, 0, 0], [0, 0, 0], [0, 0, 0], [0, 0, 0]",
            "attachments",
            "all attachments lie at one point",
        ),
        (
            "[[1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 1, 0]",
            "[[1, 1, 1], [2, 2, 2], [.3, .3, .3], [.1, .1, .1]",
            "attachments",
            "all attachments lie on one line",
        ),
    ],
)
def test_platform_geometry(
    faults_of: FaultsOf, old: str, new: str, field: str, problem: str
) -> None:
    assert SIX.count(old) == 1
    (fault,) = faults_of(SIX.replace(old, new))
    assert fault.field == ("robot.platform.attachments" if field else "robot.anchors[5]")
    assert fault.problem.startswith(problem)


def test_a_wrench_that_lifts_the_weight_but_turns_the_body(study_of: StudyOf) -> None:
    lifted = "wrench: {force: [0, 0, 981], moment: [0, 0, 5]}"
    assert "mass: 100" in SIX
    study = study_of(SIX.replace("mass: 100", f"mass: 100\n    {lifted}"))
    assert study.robot.pull_N[:3] == pytest.approx(0.0, abs=1e-9)


def test_centre_of_mass_of_a_point_mass(valid: str, faults_of: FaultsOf) -> None:
    text = valid.replace("mass: 180 kg", "mass: 180 kg\n    centre_of_mass: [0, 0, 1]")
    (fault,) = faults_of(text)
    assert (fault.line, fault.field) == (9, "robot.platform.centre_of_mass")


def test_huge_file(tmp_path: Path) -> None:
    path = tmp_path / "huge.yaml"
    with path.open("wb") as file:
        file.truncate(100_000_000)
    with pytest.raises(InputError, match="the file has 100 MB"):
        read_study(path)


def test_a_fault_in_each_of_many_lines_is_cut_short(valid: str, faults_of: FaultsOf) -> None:
    text = valid + "".join(f"extra{number}: 1\n" for number in range(20_000))
    assert len(faults_of(text)) == 100


JUNK = ["", "~", "true", "-1", "1e999", ".nan", "[]", "{}", "[[1]]", "{a: {b: 1}}", "x", "'1 kg'"]
PYDANTIC_WORDS = (
    "Input should",
    "pydantic",
    "validation error",
    "value_error",
    "is not valid here",
)


def test_no_spoilt_config_escapes_as_another_error(valid: str, study_of: StudyOf) -> None:
    rng = random.Random(7)
    full = valid + (
        "catalogues: []\neffects: {creep: {strain_per_decade: 1e-4, onset_s: 1 min}}\n"
        "measurements:\n  file: a.csv\n  columns: {a: {to: x_m, unit: mm}, b: y_m}\n"
        "  settled: true\n  unknown: [anchors]\n  cable: {linear_mass: 1, axial_stiffness: 2}\n"
        "  noise: {length: 1, tension: 2}\n"
    )
    places = [
        index for index, letter in enumerate(full) if letter in ":,[" and full[index:].strip()
    ]
    refused = 0
    for _ in range(300):
        start = rng.choice(places) + 1
        end = min(full.index("\n", start), start + rng.choice([0, 2, 5, 80]))
        try:
            study_of(f"{full[:start]} {rng.choice(JUNK)} {full[end:]}")
        except InputError as error:
            refused += 1
            assert not any(word in str(error) for word in PYDANTIC_WORDS)
    assert refused > 100
