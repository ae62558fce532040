"""CASPR models: what a study takes from them, and what none can hold."""

from __future__ import annotations

import numpy as np
import pytest
from models import (
    EXITS,
    FREE,
    HELD,
    LIMITS,
    attachment,
    bodies,
    cable,
    cable_file,
    cables,
    link,
    write_caspr,
)
from scipy.spatial.transform import Rotation

from designer.errors import InputError
from designer.foreign.study import read_foreign


def test_either_file_leads_to_the_whole_robot(tmp_path) -> None:
    path = write_caspr(tmp_path, bodies(), cables())
    robot = read_foreign(path)
    assert np.array_equal(robot.exit_points_m, EXITS)
    assert np.allclose(robot.attachments_m, HELD)
    assert (robot.mass_kg, robot.centre_of_mass_m) == (20.0, (0.0, 0.0, 0.05))
    assert robot.position_m == (0.5, 0.0, 2.0)
    assert robot.tension_min_N == 5.0
    assert robot.limits_m is None
    other = read_foreign(tmp_path / "rig_cables.xml")
    assert other.exit_points_m == robot.exit_points_m
    (tmp_path / "apart").mkdir()
    apart = tmp_path / "apart" / "other.xml"
    path.rename(apart)
    assert read_foreign(apart, tmp_path / "rig_cables.xml").name == robot.name


def test_attachments_from_the_centre_of_mass_limits_and_an_old_file(tmp_path) -> None:
    rows = bodies(link(joint=f"{FREE} {LIMITS}"), root=False)
    robot = read_foreign(write_caspr(tmp_path, rows, cables(reference="com")))
    assert np.allclose(robot.attachments_m, np.add(HELD, [0.0, 0.0, 0.05]))
    assert robot.limits_m == ((-1.0, 1.0), (-1.0, 1.0), (1.0, 3.0))


def test_the_joint_stands_where_its_parent_has_it(tmp_path) -> None:
    moved = link().replace("<location>0 0 0<", "<location>1 2 3<")
    robot = read_foreign(write_caspr(tmp_path, bodies(moved), cables()))
    assert robot.position_m == (1.5, 2.0, 5.0)
    assert np.array_equal(robot.exit_points_m, EXITS)


def test_a_point(tmp_path) -> None:
    joint = 'type="T_XYZ" q_initial="0 0 2"'
    at_one = cables(EXITS[:4], [(0, 0, 0.5)] * 4)
    robot = read_foreign(write_caspr(tmp_path, bodies(link(joint=joint)), at_one))
    assert robot.attachments_m is None
    assert robot.position_m == (0.0, 0.0, 2.5)


@pytest.mark.parametrize(
    ("plane", "normal", "position_m", "limits_m"),
    [
        ("XY", (0.0, 0.0, 1.0), (1.0, 2.0, 0.0), ((-1.0, 1.0), (1.0, 3.0), (0.0, 0.0))),
        ("XZ", (0.0, 1.0, 0.0), (1.0, 0.0, 2.0), ((-1.0, 1.0), (0.0, 0.0), (1.0, 3.0))),
        ("YZ", (1.0, 0.0, 0.0), (0.0, 1.0, 2.0), ((0.0, 0.0), (-1.0, 1.0), (1.0, 3.0))),
    ],
)
def test_a_plane(tmp_path, plane: str, normal, position_m, limits_m) -> None:
    joint = f'type="PLANAR_{plane}" q_initial="1 2 0" q_min="-1 1 -3" q_max="1 3 3"'
    robot = read_foreign(write_caspr(tmp_path, bodies(link(joint=joint)), cables()))
    assert robot.plane_normal == normal
    assert robot.position_m == position_m
    assert robot.limits_m == limits_m


@pytest.mark.parametrize(("n_cables", "has_choice"), [(3, False), (4, True)])
def test_three_cables_hold_a_platform_in_a_plane(tmp_path, n_cables: int, has_choice: bool) -> None:
    """It moves in two ways and turns in one: only a fourth cable leaves a tension to choose."""
    joint = 'type="PLANAR_XZ" q_initial="1 2 0" q_min="-1 1 -3" q_max="1 3 3"'
    held = cables(EXITS[:n_cables], HELD[:n_cables])
    robot = read_foreign(write_caspr(tmp_path, bodies(link(joint=joint)), held))
    assert robot.has_choice is has_choice


def test_angles_are_taken_where_they_are_understood(tmp_path) -> None:
    turned = 'type="SPATIAL_EULER_XYZ" q_initial="0 0 2 0.1 0.2 0.3"'
    robot = read_foreign(write_caspr(tmp_path, bodies(link(joint=turned)), cables()))
    assert robot.euler_xyz_rad == (0.1, 0.2, 0.3)
    unknown = 'type="SPATIAL" q_initial="0 0 2 0.1 0.2 0.3"'
    robot = read_foreign(write_caspr(tmp_path, bodies(link(joint=unknown)), cables()))
    assert robot.euler_xyz_rad is None


@pytest.mark.parametrize("quaternion", ["1 0 0 0", "0.8 0 0.6 0", "2 1 0 -1", "0.5 0.5 0.5 -0.5"])
def test_quaternion_is_a_pose(tmp_path, quaternion: str) -> None:
    joint = f'type="SPATIAL_QUATERNION" q_initial="0.5 0 2 {quaternion}"'
    robot = read_foreign(write_caspr(tmp_path, bodies(link(joint=joint)), cables()))
    assert robot.position_m == (0.5, 0.0, 2.0)
    turn = Rotation.from_euler("XYZ", robot.euler_xyz_rad)
    w, x, y, z = map(float, quaternion.split())
    norm = w * w + x * x + y * y + z * z
    column = [w * w + x * x - y * y - z * z, 2 * (x * y + w * z), 2 * (x * z - w * y)]
    assert np.allclose(turn.apply([1.0, 0.0, 0.0]), np.divide(column, norm))
    assert any(robot.euler_xyz_rad) == (quaternion != "1 0 0 0")


def test_quaternion_of_zeros_is_no_pose(tmp_path) -> None:
    joint = 'type="SPATIAL_QUATERNION" q_initial="0 0 2 0 0 0 0"'
    robot = read_foreign(write_caspr(tmp_path, bodies(link(joint=joint)), cables()))
    assert robot.euler_xyz_rad is None


def test_cables_that_meet_make_a_point_mass(tmp_path) -> None:
    joint = 'type="SPATIAL_EULER_XYZ" q_initial="1 0 2 0 0 1.5707963267948966" '
    at_one = cables(EXITS, [(0.1, 0, 0.5)] * 8)
    rows = bodies(link(joint=joint + LIMITS))
    robot = read_foreign(write_caspr(tmp_path, rows, at_one))
    assert robot.attachments_m is None
    assert robot.position_m == pytest.approx((1.0, 0.1, 2.5))  # the point turns with the platform
    assert robot.euler_xyz_rad == (0.0, 0.0, 0.0)
    assert np.allclose(robot.limits_m, [(-0.9, 1.1), (-1.0, 1.0), (1.5, 3.5)])
    assert "point mass" in robot.remarks["robot"][0]


def with_largest(*texts: str) -> str:
    whole = cables()
    for text in texts:
        whole = whole.replace("<force_max>900<", f"<force_max>{text}<", 1)
    return whole


@pytest.mark.parametrize(
    "text", ["9999999999", "1e10", "inf", "Inf", " +INF ", "1e400", "-1", "0", "0.1"]
)
def test_a_number_that_is_no_winchs_is_no_limit(tmp_path, text: str) -> None:
    robot = read_foreign(write_caspr(tmp_path, bodies(), with_largest(*[text] * 8)))
    assert robot.tension_max_N is None
    assert "no winch's: taken as no limit" in robot.remarks["robot.winches"][0]
    robot = read_foreign(write_caspr(tmp_path, bodies(), with_largest(text)))
    assert robot.tension_max_N == (None, *[900.0] * 7)


def test_a_limit_of_a_winch_has_no_remark(tmp_path) -> None:
    robot = read_foreign(write_caspr(tmp_path, bodies(), with_largest("2e6")))
    assert robot.tension_max_N == (2e6, *[900.0] * 7)
    assert not robot.remarks


@pytest.mark.parametrize(
    "kind",
    [
        *("cable_ideal", "cable_linear_spring", "cable_vsd_torsion_spring"),
        *("cable_vsd_flexure_linear", "cable_vsd_polynomial"),
    ],
)
def test_cables_with_winches_are_ropes(tmp_path, kind: str) -> None:
    text = cables().replace("cable_ideal", kind).replace("<properties>", "<properties><K>100</K>")
    robot = read_foreign(write_caspr(tmp_path, bodies(), text))
    assert len(robot.exit_points_m) == 8
    assert robot.remarks["cable"][0].startswith("Of its cables the file has K;")


def test_pulleys_that_a_study_can_have(tmp_path) -> None:
    def ends(a, b, radius) -> str:
        place = " ".join(map(str, a))
        return (
            f"<base_rotating_pulley><fixed_location>{place}</fixed_location>"
            f"<pulley_radius>{radius}</pulley_radius><cable_entry_vector>0 0 1"
            f"</cable_entry_vector></base_rotating_pulley>{attachment(1, b)}"
        )

    def model(radii) -> str:
        rows = zip(EXITS, HELD, radii, strict=True)
        return cable_file(
            f'<cable_set id="first">{"".join(cable(ends(*row)) for row in rows)}</cable_set>'
        )

    alike = read_foreign(write_caspr(tmp_path, bodies(), model([0.045] * 8)))
    assert alike.pulley_radius_m == 0.045
    assert np.array_equal(alike.exit_points_m, EXITS)
    differ = read_foreign(write_caspr(tmp_path, bodies(), model([0.045] * 7 + [0.05])))
    assert differ.pulley_radius_m is None
    assert "pulleys" in differ.remarks["effects"][0]


TWO_LINKS = bodies(link() + link(2))
ON_LINK_2 = cable(attachment(0, EXITS[0]) + attachment(2, HELD[0]))
SPRING = "cable_passive_linear_spring"
SCREW = "screw_base_rotating_pulley"
BETWEEN = cable(attachment(1, HELD[0]) + attachment(1, HELD[1]))
LONG = cable(attachment(0, EXITS[0]) + attachment(1, HELD[0]) + attachment(1, HELD[1]))


def one_other(tag: str, instead_of: str = "cable_ideal") -> str:
    """Return cables the last of which, or whose last attachment, is of another kind."""
    before, _, after = cables().rpartition(f"<{instead_of}")
    return f"{before}<{tag}{after.replace(f'</{instead_of}>', f'</{tag}>', 1)}"


def in_a_set(inner: str) -> str:
    return cable_file(f'<cable_set id="first">\n{inner}</cable_set>\n')


@pytest.mark.parametrize(
    ("bodies_text", "cables_text", "said"),
    [
        (TWO_LINKS, cables(), "2 links that move against each other"),
        (bodies(), in_a_set(ON_LINK_2), "held by link 2"),
        (bodies(), in_a_set(BETWEEN), "0 points of the base and 2 of the platform"),
        (bodies(), in_a_set(LONG), "1 points of the base and 2 of the platform"),
        (bodies(), one_other(SPRING), f"<{SPRING}> is not supported: no study has a spring"),
        (bodies(), one_other("muscle_hill_type"), "<muscle_hill_type> is not supported"),
        (bodies(), one_other("pneumatic_artificial_muscle"), "no study has a muscle (expected"),
        (bodies(), one_other("cable_new"), "<cable_new> is not supported: CASPR has no such kind"),
        (bodies(), one_other(SCREW, "attachment"), "no study has an exit point that a screw moves"),
        (bodies(), one_other("hook", "attachment"), "<hook> is not supported: CASPR has no such"),
        (bodies(), cables(reference="base"), "attachments counted from 'base' (expected joint or"),
        (bodies(), with_largest("nan"), "<force_max> has 'nan' (expected a finite number)"),
        (bodies(), cables(default="second"), "no cable set 'second' (expected one of: first)"),
        (bodies(), in_a_set(""), "the cable set has no cables"),
        (bodies(), "<cables/>", "the file has no cable set (expected <cable_set>"),
        (bodies(), bodies(), "the file holds <bodies_system> (expected CASPR's cables"),
        (bodies(link(mass="heavy")), cables(), "<mass> has 'heavy' (expected a finite number)"),
        (bodies(link(mass="nan")), cables(), "<mass> has 'nan'"),
        (bodies(link(centre="0 0")), cables(), "<com_location> has '0 0' (expected 3 finite"),
        (bodies(link(joint='type="R_X" q_initial="0"')), cables(), "a joint of type R_X"),
        (bodies(link(joint='type="T_XYZ"')), cables(), "does not turn though"),
        (bodies("<other/>"), cables(), "the robot has no link"),
    ],
)
def test_what_is_refused(tmp_path, bodies_text: str, cables_text: str, said: str) -> None:
    path = write_caspr(tmp_path, bodies_text, cables_text)
    with pytest.raises(InputError) as refused:
        read_foreign(path)
    (fault,) = refused.value.faults
    assert said in str(fault)
    assert fault.line is not None


def test_another_set_by_its_name(tmp_path) -> None:
    text = cables().replace("</cables>", f'<cable_set id="few">{ON_LINK_2}</cable_set></cables>')
    path = write_caspr(tmp_path, bodies(), text)
    assert len(read_foreign(path).exit_points_m) == 8
    with pytest.raises(InputError, match="held by link 2"):
        read_foreign(path, cable_set="few")


def test_the_other_file_is_missing(tmp_path) -> None:
    path = write_caspr(tmp_path, bodies(), cables())
    (tmp_path / "rig_cables.xml").unlink()
    with pytest.raises(InputError, match=r"no rig_cables\.xml beside it \(expected --cables FILE"):
        read_foreign(path)
    path = path.rename(tmp_path / "alone.xml")
    with pytest.raises(InputError, match=r"holds the bodies alone \(expected --cables FILE"):
        read_foreign(path)
