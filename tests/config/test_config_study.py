"""What a valid config becomes."""

from __future__ import annotations

import hashlib
import re
from collections.abc import Callable
from dataclasses import fields
from pathlib import Path

import numpy as np
import pytest

from designer.documents.fields import Section
from designer.errors import InputError
from designer.io.config import read_study, schema
from designer.model.measurements import LogColumn
from designer.model.region import PointList, Prism
from designer.model.uncertainty import Uniform
from designer.model.workspace import Workspace
from designer.resources import data_folder, example_file
from designer.study import Entry, Study

StudyOf = Callable[[str], Study]

MEASUREMENTS = """\
measurements:
  file: data/measured.csv
  settled: false
  unknown: [length_offset]
  columns: {L1: {to: length_1_m, unit: mm}}
  cable: {linear_mass: 0.142 kg/m, axial_stiffness: 3.3 MN}
  noise: {length: 1 mm}
  search_time: 2 min
"""


def test_values_are_SI(valid: str, study_of: StudyOf) -> None:
    study = study_of(valid)
    assert study.name == "A crane"
    np.testing.assert_allclose(study.robot.exit_points_m, [[0, 0, 12], [30, 0, 12], [15, 26, 12]])
    assert study.robot.platform.mass_kg == 180.0
    assert study.robot.is_point_mass
    assert study.material.density_kg_per_m3 == 5290.0
    assert study.material.youngs_modulus_Pa == pytest.approx(62.7e9)
    assert study.material.allowable_stress_Pa == pytest.approx(198e6)
    assert study.pose is not None
    np.testing.assert_array_equal(study.pose.position_m, [15, 9, 4])
    assert study.workspace is not None
    assert study.workspace.samples == 500
    assert study.workspace.sampling == "low_discrepancy"
    assert study.workspace.hangs_below == "include"
    assert study.selection is not None
    assert study.selection.grades is None
    assert study.selection.safety_factor == 4.0
    assert study.selection.objectives == ("mass", "drum_diameter", "max_tension")
    assert study.selection.termination_efficiency == 1.0
    assert study.selection.sheave_diameter_m is None
    assert study.measurements is None


def test_region_over_the_anchors_is_moved_inward(valid: str, study_of: StudyOf) -> None:
    workspace = study_of(valid).workspace
    assert workspace is not None
    assert isinstance(workspace.region, Prism)
    assert workspace.region.z_m == (1.0, 8.0)
    assert workspace.region.bounds_m[0, 1] == pytest.approx(3.0)


@pytest.mark.parametrize(
    ("region", "bounds"),
    [
        ("{box: [[1, 2], [3, 400 cm], [5, 6]]}", [[1, 3, 5], [2, 4, 6]]),
        ("{points: [[1, 2, 3], [4, '1 km', -6]]}", [[1, 2, -6], [4, 1000, 3]]),
        ("{prism: [[0, 0], [4, 0], [4, 3], [0, 3]], inset: 1, z: [0, 9]}", [[1, 1, 0], [3, 2, 9]]),
    ],
)
def test_kinds_of_region(
    valid: str, study_of: StudyOf, region: str, bounds: list[list[float]]
) -> None:
    text = valid.replace("{prism: anchors, inset: 3 m, z: [1, 8]}", region)
    workspace = study_of(text).workspace
    assert workspace is not None
    assert isinstance(workspace.region, PointList if "points" in region else Prism)
    np.testing.assert_allclose(workspace.region.bounds_m, bounds, atol=1e-12)


def test_six_cables_and_a_turned_pose(study_of: StudyOf) -> None:
    study = study_of(
        """\
robot:
  anchors: [[0, 0, 9], [9, 0, 9], [9, 9, 9], [0, 9, 9], [4, 0, 9], [4, 9, 9]]
  platform:
    mass: 100
    attachments: [[1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 1, 0], [0, 0, 0], [0, 0, 0]]
    centre_of_mass: [0, 0, -20 cm]
cable: {density: 7800, youngs_modulus: 200 GPa, allowable_stress: 180 MPa}
pose: {position: [4, 4, 2], rotation_vector: [0, 0, 90 deg]}
"""
    )
    assert study.robot.degrees_of_freedom == 6
    np.testing.assert_allclose(study.robot.platform.centre_of_mass_m, [0, 0, -0.2])
    assert study.pose is not None
    quarter_turn = [[0, -1, 0], [1, 0, 0], [0, 0, 1]]
    np.testing.assert_allclose(study.pose.rotation, np.array(quarter_turn, float), atol=1e-15)
    assert study.name == "crane"
    assert study.workspace is None
    assert study.selection is None


def test_empty_options_are_defaults(valid: str, study_of: StudyOf) -> None:
    text = valid.replace("samples: 500", "samples:").replace("[15, 9, 4]", "~")
    study = study_of(text + "catalogues:\nmeasurements:\n")
    assert study.workspace is not None
    assert study.workspace.samples == 20_000
    assert study.pose is None
    assert study.catalogues == ()


def test_catalogues_are_relative_to_the_config(
    valid: str, study_of: StudyOf, tmp_path: Path
) -> None:
    (tmp_path / "ropes").mkdir()
    assert study_of(valid + "catalogues: [ropes]\n").catalogues == (tmp_path / "ropes",)


def test_measurements(valid: str, study_of: StudyOf, tmp_path: Path) -> None:
    measurements = study_of(valid + MEASUREMENTS).measurements
    assert measurements is not None
    assert measurements.file == tmp_path / "data" / "measured.csv"
    assert measurements.linear_density_kg_per_m == 0.142
    assert measurements.axial_stiffness_N == pytest.approx(3.3e6)
    assert measurements.settled is False
    assert measurements.unknown == ("length_offset",)
    assert measurements.columns == (LogColumn("L1", "length_1_m", 1e-3, 0.0, has_unit=True),)
    assert measurements.length_noise_m == pytest.approx(0.001)
    assert measurements.tension_noise_N is None
    assert measurements.search_time_s == 120.0


def test_entries_hold_every_field_as_given_and_in_SI(valid: str, study_of: StudyOf) -> None:
    assert study_of(valid).source.entries == (
        Entry("name", "A crane", "A crane"),
        Entry("robot.anchors[0]", "[0, 0, 12]", "[0, 0, 12] m"),
        Entry("robot.anchors[1]", "[30 m, 0, 12]", "[30, 0, 12] m"),
        Entry("robot.anchors[2]", "[15, 2600 cm, 12]", "[15, 26, 12] m"),
        Entry("robot.platform.mass", "180 kg", "180 kg"),
        Entry("robot.platform.attachments", "default", "none"),
        Entry("robot.platform.centre_of_mass", "default", "[0, 0, 0] m"),
        Entry("robot.platform.inertia", "default", "none"),
        Entry("robot.platform.hull", "default", "none"),
        Entry("robot.platform.wrench.force", "default", "[0, 0, 0] N"),
        Entry("robot.platform.wrench.moment", "default", "[0, 0, 0] N*m"),
        Entry("robot.platform.drag", "default", "none"),
        Entry("robot.gravity", "default", "[0, 0, -1]"),
        Entry("robot.planar", "default", "false"),
        Entry("robot.tension_min", "default", "0 N"),
        Entry("robot.winches.tension_max", "default", "none"),
        Entry("robot.winches.speed_max", "default", "none"),
        Entry("robot.winches.positions", "default", "none"),
        Entry("robot.winches.drum_diameter", "default", "none"),
        Entry("robot.winches.layers", "default", "1"),
        Entry("robot.winches.gear_ratio", "default", "1"),
        Entry("robot.winches.efficiency", "default", "1"),
        Entry("robot.winches.sheave_efficiency", "default", "1"),
        Entry("robot.winches.sheaves", "default", "1"),
        Entry("robot.winches.motor", "default", "none"),
        Entry("robot.winches.drum", "default", "none"),
        Entry("robot.attached", "default", "none"),
        Entry("cable.density", "5290 kg/m^3", "5290 kg/m^3"),
        Entry("cable.youngs_modulus", "62.7 GPa", "6.27e10 Pa"),
        Entry("cable.allowable_stress", "198 MPa", "1.98e8 Pa"),
        Entry("cable.drag_coefficient", "default", "none"),
        Entry("cable.thermal_expansion", "default", "none"),
        Entry("pose.position", "[15, 9, 4]", "[15, 9, 4] m"),
        Entry("pose.rotation_vector", "default", "[0, 0, 0] rad"),
        Entry("pose.quaternion", "default", "none"),
        Entry("pose.euler", "default", "none"),
        Entry("workspace.region.prism", "anchors", "anchors"),
        Entry("workspace.region.inset", "3 m", "3 m"),
        Entry("workspace.region.z", "[1, 8]", "[1, 8] m"),
        Entry("workspace.poses", "default", "none"),
        Entry("workspace.path", "default", "none"),
        Entry("workspace.samples", "500", "500"),
        Entry("workspace.sampling", "default", "low_discrepancy"),
        Entry("workspace.seed", "default", "0"),
        Entry("workspace.hangs_below", "default", "include"),
        Entry("workspace.clearance", "default", "none"),
        Entry("workspace.floor", "default", "none"),
        Entry("workspace.sag", "default", "0.2"),
        Entry("workspace.proof", "default", "none"),
        Entry("workspace.orientation", "default", "none"),
        Entry("workspace.orientations", "default", "none"),
        Entry("workspace.orientation_range", "default", "none"),
        Entry("workspace.orientation_free", "default", "none"),
        Entry("selection.grades", "default", "all"),
        Entry("selection.trust", "default", "B"),
        Entry("selection.materials", "default", "all"),
        Entry("selection.prefer", "default", "study"),
        Entry("selection.safety_factor", "4", "4"),
        Entry("selection.duty_class", "default", "none"),
        Entry("selection.objectives", "default", "[mass, drum_diameter, max_tension]"),
        Entry("selection.prices", "default", "none"),
        Entry("selection.termination_efficiency", "default", "1"),
        Entry("selection.sheave_diameter", "default", "none"),
        Entry("selection.groups", "default", "none"),
        Entry("selection.max_distinct_products", "default", "none"),
        *(
            Entry(f"selection.limits.{name}", "default", "none")
            for name in ("stiffness", "excitation", "drum_capacity", "platform_frequency")
        ),
        Entry("selection.rope_life", "default", "none"),
        Entry("load_cases", "default", "none"),
        Entry("catalogues", "default", "none"),
        Entry("measurements", "default", "none"),
        Entry("effects", "default", "none"),
        Entry("surroundings.temperature", "default", "20 degC"),
        *(
            Entry(f"document.{name}", "default", "none")
            for name in ("number", "revision", "author", "checker", "approver", "logo")
        ),
        Entry("uncertainty", "default", "none"),
        Entry("format", "default", "1"),
    )


def test_long_lists_take_one_entry(valid: str, study_of: StudyOf) -> None:
    points = ", ".join(f"[{x}, 1, 2]" for x in range(500))
    text = valid.replace("{prism: anchors, inset: 3 m, z: [1, 8]}", f"{{points: [{points}]}}")
    entries = {entry.field: entry for entry in study_of(text).source.entries}
    assert entries["workspace.region.points"] == Entry(
        "workspace.region.points", "500 rows", "[0, 1, 2] m … [499, 1, 2] m"
    )


def test_source_knows_the_file_and_its_digest(
    valid: str, study_of: StudyOf, tmp_path: Path
) -> None:
    source = study_of(valid).source
    assert source.path == tmp_path / "crane.yaml"
    assert source.sha256 == hashlib.sha256(valid.encode()).hexdigest()


def test_later_checks_can_point_at_a_line(valid: str, study_of: StudyOf) -> None:
    source = study_of(valid).source
    assert source.lines["robot.anchors[2]"] == 6
    fault = source.fault("selection.grades[1]", "there is no grade 'x'", "an id of the catalogue")
    assert str(fault) == (
        f"{source.path}:17: selection.grades[1]: there is no grade 'x' "
        "(expected an id of the catalogue)"
    )
    assert source.fault("robot.anchors[2][1]", "").line == 6
    assert source.fault("nowhere", "").line == 1


def test_the_fast_example_is_the_published_study() -> None:
    study = read_study(example_file("fast"))
    corners = [[0.0, 0.0, 0.0], [500.0, 0.0, 0.0], [250.0, 433.01, 0.0]]
    np.testing.assert_array_equal(study.robot.exit_points_m, corners)
    assert study.robot.platform.mass_kg == 4000.0
    assert study.material.density_kg_per_m3 == 7800.0
    assert study.material.youngs_modulus_Pa == 200e9
    assert study.material.allowable_stress_Pa == 180e6
    assert study.pose is not None
    np.testing.assert_array_equal(study.pose.position_m, [250, 200, -50])
    assert study.workspace is not None
    assert isinstance(study.workspace.region, Prism)
    assert study.workspace.region.z_m == (-200.0, -40.0)
    assert study.workspace.region.bounds_m[0, 1] == pytest.approx(10.35)
    assert study.workspace.samples == 20_000
    assert study.selection is not None
    assert study.selection.safety_factor == 2.0


def _with_options(text: str) -> str:
    """Return a commented example with its options switched on."""
    return re.sub(r"(?m)^( *)# (\w+:(?: .*)?)$", r"\1\2", text)


def test_the_options_in_the_starter_config_are_true(study_of: StudyOf) -> None:
    text = _with_options(example_file("fast").read_text(encoding="utf-8"))
    choices = re.compile(r"(?m)^ *(planar|poses|path|prices|rope_life|orientation\w*):.*\n")
    assert len(choices.findall(text)) == 11
    text = choices.sub("", text)
    with pytest.raises(InputError, match="uncertainty or groups, not both"):
        study_of(text)
    text = re.sub(r"(?m)^ *(groups|max_distinct_products):.*\n", "", text)
    spare = re.compile(r"(?m)^ *tension_min: 500 N.*\n")
    with pytest.raises(InputError, match="leave no tension to choose"):
        study_of(re.sub(r"(?m)^ *(attachments|centre_of_mass|hull|wrench|inertia):.*\n", "", text))
    text = spare.sub("", text)
    for_a_body = re.compile(r"(?m)^ *(attachments|centre_of_mass|hull|wrench|inertia):.*\n")
    assert len(for_a_body.findall(text)) == 5
    study = study_of(for_a_body.sub("", text))
    assert study.workspace is not None
    assert study.workspace.sampling == "grid"
    assert study.workspace.hangs_below == "exclude"
    assert study.workspace.clearance_m == pytest.approx(0.1)
    assert study.workspace.floor_m == -250.0
    assert study.workspace.proof_s == 20.0
    assert study.uncertainty is not None
    assert study.uncertainty.breaking_load == Uniform(0.0, 0.06)
    assert study.robot.is_upright
    assert study.measurements is not None
    assert study.measurements.axial_stiffness_N == pytest.approx(96.2e6)
    assert len(study.measurements.columns) == 4
    kinds = ["pulley_radius", *["anchor_offset"] * 2, "pose_shift"]
    assert [effect.id for effect in study.effects] == kinds
    with pytest.raises(InputError) as caught:
        study_of(text)
    (fault,) = caught.value.faults
    assert fault.problem == "6 attachments for 3 anchors"


def test_the_starter_config_shows_every_field() -> None:
    text = _with_options(example_file("fast").read_text(encoding="utf-8"))
    names = set(re.findall(r"\b(\w+):", text))
    sections = [
        value
        for value in vars(schema).values()
        if isinstance(value, type) and issubclass(value, Section)
    ]
    known = {name for section in sections for name in section.model_fields}
    assert known <= names


def test_the_yard_example_names_grades_that_are_shipped() -> None:
    study = read_study(example_file("yard"))
    assert study.robot.platform.mass_kg == 180.0
    assert study.selection is not None
    assert study.selection.grades
    for grade in study.selection.grades:
        assert (data_folder("catalog") / f"{grade}.yaml").is_file()


def test_values_made_in_python_have_the_defaults_of_a_config(study_of: StudyOf, valid: str) -> None:
    """But for the time of a proof, which nobody waits for who does not ask."""
    read = study_of(valid.replace("  samples: 500\n", "")).workspace
    assert read is not None
    made = Workspace(read.region)
    for field in fields(Workspace):
        if field.name not in {"region", "orientations", "proof_s"}:
            assert getattr(made, field.name) == getattr(read, field.name), field.name


@pytest.mark.parametrize(
    ("anchors", "prefer", "expected"),
    [
        ("[[0, 0, 12], [30 m, 0, 12], [15, 26, 12]]", "", "metric"),
        ("[[0 ft, 0 ft, 40 ft], [100 ft, 0 ft, 40 ft], [50 ft, 85 ft, 40 ft]]", "", "imperial"),
        ("[[0, 0, 12], [30 m, 0, 12], [15, 26, 12]]", "imperial", "imperial"),
    ],
)
def test_sizes_are_preferred_in_units_of_the_study(
    anchors: str, prefer: str, expected: str, study_of: StudyOf
) -> None:
    selection = f"selection: {{prefer: {prefer}}}" if prefer else "selection: {}"
    study = study_of(
        f"robot: {{anchors: {anchors}, platform: {{mass: 100}}}}\n"
        "cable: {density: 7800, youngs_modulus: 60 GPa, allowable_stress: 200 MPa}\n"
        f"workspace: {{region: {{points: [[12, 9, 2]]}}}}\n{selection}\n"
    )
    assert study.selection is not None
    assert study.selection.prefer == expected
