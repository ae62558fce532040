"""WireX files: what a study takes from them, and what nobody entered."""

from __future__ import annotations

import numpy as np
import pytest
from models import ENTERED, EXITS, HELD, NOBODY, NOBODYS_ROPE, ROPE, wirex

from designer.errors import InputError
from designer.foreign.study import read_foreign


def read(folder, text):
    path = folder / "rig.wcrfx"
    path.write_text(text, encoding="utf-8")
    return read_foreign(path)


def test_a_robot_with_all_that_a_study_takes(tmp_path) -> None:
    robot = read(tmp_path, wirex())
    assert np.array_equal(robot.exit_points_m, EXITS)
    assert np.array_equal(robot.attachments_m, HELD)
    assert (robot.mass_kg, robot.centre_of_mass_m) == (40.0, (0.0, 0.0, 0.1))
    assert robot.pulley_radius_m == 0.03
    assert robot.position_m is None
    area = np.pi * 0.002**2
    assert robot.rope.density_kg_per_m3 == pytest.approx(0.06 / area)
    assert robot.rope.breaking_stress_Pa == pytest.approx(9000 / area)
    assert robot.rope.youngs_modulus_Pa == 6e10


def test_what_wirex_writes_where_nobody_entered_anything_is_asked_for(tmp_path) -> None:
    robot = read(tmp_path, wirex(NOBODY, NOBODYS_ROPE, 'a33="1" radius="0.1"'))
    assert robot.mass_kg is robot.centre_of_mass_m is robot.rope is robot.pulley_radius_m is None
    for field in ("robot.platform.mass", "robot.platform.centre_of_mass", "cable", "effects"):
        assert "nobody entered" in robot.remarks[field][0]


def test_a_file_that_leaves_out_what_it_may(tmp_path) -> None:
    robot = read(tmp_path, wirex("", "", ""))
    assert robot.mass_kg is robot.centre_of_mass_m is robot.rope is robot.pulley_radius_m is None
    assert not robot.remarks


@pytest.mark.parametrize("more", ['a33="-1" radius="0.03"', 'a33="0.7" radius="0.03"'])
def test_pulleys_that_no_study_has_are_told(tmp_path, more: str) -> None:
    robot = read(tmp_path, wirex(more=more))
    assert robot.pulley_radius_m is None
    assert "0.03 m" in robot.remarks["effects"][0]


@pytest.mark.parametrize("a33", ["-1", "0.7"])
def test_one_pulley_that_hangs_otherwise_is_enough_to_be_told(tmp_path, a33: str) -> None:
    upright = 'a33="1" radius="0.03"'
    robot = read(tmp_path, wirex(more=upright).replace('a33="1"', f'a33="{a33}"', 1))
    assert robot.pulley_radius_m is None
    assert "0.03 m" in robot.remarks["effects"][0]


def test_winch_data_are_told(tmp_path) -> None:
    winch = '<winch><cable f_max="900"/><drum r_drum="0.25"/></winch></models>'
    robot = read(tmp_path, wirex().replace("</models>", winch))
    assert robot.tension_max_N == 900.0
    assert "drum radius 0.25 m" in robot.remarks["robot"][0]


@pytest.mark.parametrize("pattern", ["3T", "3R3T"])
def test_a_point_mass(tmp_path, pattern: str) -> None:
    assert read(tmp_path, wirex(pattern=pattern, held=[(0, 0, 0)] * 8)).attachments_m is None


def test_a_number_that_is_no_winchs_is_no_limit(tmp_path) -> None:
    winch = '<winch><cable f_max="1e10"/></winch></models>'
    robot = read(tmp_path, wirex().replace("</models>", winch))
    assert robot.tension_max_N is None
    assert "1e+10 N, which is no winch's" in robot.remarks["robot.winches"][0]


@pytest.mark.parametrize(
    ("old", "new", "figure"),
    [
        ("6e10", "1.77e9", "E 1.77 GPa"),  # a grade of wire, typed as a modulus
        ("0.002", "0.004", "1194 kg/m³"),  # the diameter, typed as a radius
        ('elasticity="6e10" radius="0.002"', 'radius="0.003"', "318 MPa: check"),
        ("9000", "900", "72 MPa"),
    ],
)
def test_a_rope_unlike_all_known(tmp_path, old: str, new: str, figure: str) -> None:
    robot = read(tmp_path, wirex(rope=ROPE.replace(old, new)))
    _, remark = robot.remarks["cable"]
    assert remark.startswith("No rope of the catalogue is near")
    assert figure in remark


def test_a_thick_rope_with_a_wire_grade_as_modulus(tmp_path) -> None:
    """Each figure alone is some rope's: no polyester is so dense, no steel so soft."""
    rope = '<cable elasticity="1.77e9" radius="0.007" breaking_load="21900" weight="0.198"/>'
    _, remark = read(tmp_path, wirex(rope=rope)).remarks["cable"]
    assert "its 1286 kg/m³, breaking at 142 MPa, E 1.77 GPa: check" in remark


@pytest.mark.parametrize("elasticity", ["6e10", "8e10"])
def test_a_rope_like_known_ones_has_no_such_remark(tmp_path, elasticity: str) -> None:
    robot = read(tmp_path, wirex(rope=ROPE.replace("6e10", elasticity)))
    assert len(robot.remarks["cable"]) == 1


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (wirex(pattern="2R3T"), "no study has a platform of the motion pattern '2R3T'"),
        (wirex(pattern="3T"), "the platform does not turn though"),
        (wirex().replace('y="-2.0"', "", 1), "<base> has no attribute 'y'"),
        (wirex().replace('y="-2.0"', 'y="east"', 1), "<base> has y='east'"),
        (wirex().replace("<robot", "<robots").replace("</robot", "</robots"), "no robots"),
        (wirex(rope=NOBODYS_ROPE.replace("40000", "0")), "zero or less"),
        (wirex(rope=ROPE.replace("0.002", "1e-170")), "the rope has a radius of 1e-170 m"),
        (wirex(rope=ROPE.replace("0.002", "1e200")), "the rope has a radius of 1e+200 m"),
        ("<models><robot><geometry/></robot></models>", "the robot has no cables"),
        ("<models><robot/></models>", "<robot> has no <geometry>"),
        ("<html/>", "the file holds <html>"),
        (ENTERED, "the file holds <platform>"),
    ],
)
def test_what_is_refused(tmp_path, text: str, said: str) -> None:
    with pytest.raises(InputError) as refused:
        read(tmp_path, text)
    (fault,) = refused.value.faults
    assert said in str(fault)
    assert fault.line is not None
