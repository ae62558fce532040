"""Whole robots: the paper's, and one with eight cables."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import partial

from designer.arrays import frozen_array
from designer.model.cable import Material
from designer.model.robot import Platform, Poses, Robot
from designer.reference.case import Figure, ReferenceCase, as_printed

# Riehl et al., Table I
_PAPERS_ROBOT = Robot(
    frozen_array([[0.0, 0, 0], [500.0, 0, 0], [250.0, 433.01, 0]]), Platform(4000.0)
)
_PAPERS_STEEL = Material(7800.0, 200e9, 180e6)
_WORST = (243.0, 10.35, -40.0)
"""Of the plane z = −40 m in the triangle inset by 10.35 m, found by our search."""

# Of the pose (250, 200, −50): the first turns of the basic loop, which Figs. 6 and 7 draw.
_LOOP_kN = ("86.386", "123.082", "138.686", "145.323", "148.146", "149.347")
_LOOP_mm = ("24.719", "29.506", "31.321", "32.062", "32.372", "32.503")
# Along (250, y, −40): y [m], largest tension [kN], diameter [mm], tension without sag [kN].
_EDGE = (
    (40.0, "265.779", "43.359", "114.111"),
    (20.0, "306.447", "46.558", "118.818"),
    (10.0, "376.520", "51.608", "121.411"),
    (8.0, "438.994", "55.725", "121.951"),
    (6.0, "711.721", "70.953", "122.498"),
)

# Sample `cogiro` of github.com/cable-robots/cdpyr, each cable with the attachment that it holds
COGIRO = Robot(
    frozen_array(
        [
            [-7.11966, 5.47261, 5.41063],
            [7.50556, 5.07892, 5.41820],
            [7.14351, -5.54158, 5.39749],
            [-7.47855, -5.15440, 5.40093],
            [-7.40830, 5.19141, 5.39874],
            [7.22425, 5.36889, 5.40799],
            [7.42883, -5.26133, 5.38777],
            [-7.19673, -5.43978, 5.39277],
        ]
    ),
    Platform(
        91.058,
        frozen_array(
            [
                [0.49605, 0.35613, 0.99961],
                [0.49983, -0.34038, 0.99913],
                [-0.50453, -0.34632, 0.99765],
                [-0.50968, 0.35080, 0.99759],
                [-0.50316, -0.26997, 0.0],
                [-0.50316, 0.49282, 0.0],
                [0.50214, 0.27502, -0.00067],
                [0.50316, -0.49282, 0.0],
            ]
        ),
        frozen_array([-0.034, -0.013, 0.264]),
    ),
)
_COGIRO_LENGTHS_M = (9.69426, 9.3803, 9.73006, 9.40211, 9.71528, 10.00552, 9.74173, 10.01977)
_COGIRO_POSITION_M = (1.100564e-2, -1.002498e-2, 1.317075894)
_COGIRO_TURNS_RAD = (1.7486e-4, -2.0186e-4, -6.478e-5)
_COGIRO_TENSIONS_N = (311.711, 330.697, 327.472, 306.706, 325.902, 305.030, 306.584, 326.948)


def _paper() -> Sequence[Figure]:
    from designer.sizing.newton import size_poses

    poses = Poses.at([[250.0, 200.0, -50.0], _WORST])
    sizing = size_poses(_PAPERS_ROBOT, poses, _PAPERS_STEEL)
    diameter, tension = 1e3 * sizing.diameter_m, sizing.statics.largest_tension_N / 1e3
    straight = 1e3 * sizing.massless_diameter_m
    return (
        as_printed("one pose, diameter", "mm", "32.6", diameter[0]),
        as_printed("one pose, largest tension", "kN", "150.2", tension[0]),
        as_printed("plane, largest diameter", "mm", "51.2", diameter[1]),
        as_printed("plane, largest tension", "kN", "371", tension[1]),
        as_printed("plane, diameter without sag", "mm", "29.3", straight[1]),
        as_printed("plane, tension without sag", "kN", "121", sizing.massless_tension_N[1] / 1e3),
    )


def _same_pose() -> Sequence[Figure]:
    from designer.sizing.loop import size_by_loop
    from designer.sizing.newton import size_poses

    pose = Poses.at([250.0, 200.0, -50.0])
    statics = size_poses(_PAPERS_ROBOT, pose, _PAPERS_STEEL).statics
    lengths = zip((324.21623831, 238.20189774), statics.length_m[1:], strict=True)
    tensions = zip((119.627982, 150.236491), statics.exit_tension_N[1:] / 1e3, strict=True)
    turns = size_by_loop(_PAPERS_ROBOT, pose, _PAPERS_STEEL).iterates
    loop = tuple(enumerate(zip(_LOOP_kN, _LOOP_mm, turns, strict=False)))
    searched = partial(Figure, tolerance=1e-7)
    printed = partial(as_printed, units=1.0)
    return (
        *(searched(f"cable {i}, length", "m", *pair) for i, pair in enumerate(lengths, 2)),
        *(searched(f"cable {i}, tension", "kN", *pair) for i, pair in enumerate(tensions, 2)),
        *(
            printed(f"loop {i}, tension", "kN", kN, at.max_tension_N / 1e3)
            for i, (kN, _, at) in loop
        ),
        *(printed(f"loop {i}, diameter", "mm", mm, 1e3 * at.diameter_m) for i, (_, mm, at) in loop),
    )


def _edge() -> Iterator[Figure]:
    from designer.sizing.newton import size_poses

    poses = Poses.at([[250.0, y, -40.0] for y, *_ in _EDGE])
    sizing = size_poses(_PAPERS_ROBOT, poses, _PAPERS_STEEL)
    for k, (y, tension_kN, diameter_mm, straight_kN) in enumerate(_EDGE):
        largest_N, straight_N = sizing.statics.largest_tension_N[k], sizing.massless_tension_N[k]
        yield as_printed(f"y = {y:g} m, largest tension", "kN", tension_kN, largest_N / 1e3)
        yield as_printed(f"y = {y:g} m, diameter", "mm", diameter_mm, 1e3 * sizing.diameter_m[k])
        yield as_printed(f"y = {y:g} m, tension without sag", "kN", straight_kN, straight_N / 1e3)


def _cogiro() -> Sequence[Figure]:
    from scipy.spatial.transform import Rotation

    from designer.statics.forward import solve_forward

    cable = Material(7800.0, 100e9, 1e9).cable(0.004)
    start = Poses.at([0.0, 0.0, 1.0], [0.0, 0.0, 0.0])
    forward_statics = solve_forward(COGIRO, cable, frozen_array(_COGIRO_LENGTHS_M), start)
    tensions = zip(_COGIRO_TENSIONS_N, forward_statics.statics.exit_tension_N, strict=True)
    place = zip("xyz", _COGIRO_POSITION_M, forward_statics.poses.position_m, strict=True)
    about = Rotation.from_matrix(forward_statics.poses.rotation).as_euler("xyz")
    turns = zip("xyz", _COGIRO_TURNS_RAD, about, strict=True)
    return (
        *(Figure(f"platform, {axis}", "m", theirs, ours, 1e-5) for axis, theirs, ours in place),
        *(Figure(f"turn about {axis}", "rad", theirs, ours, 1e-4) for axis, theirs, ours in turns),
        *(
            Figure(f"cable {i}, tension", "N", theirs, ours, 1e-5)
            for i, (theirs, ours) in enumerate(tensions, 1)
        ),
    )


CASES = (
    ReferenceCase(
        "The paper's crane",
        "Riehl, Gouttefarde, Baradat and Pierrot, ICRA 2010: text and Figs. 6 to 9",
        "Three cables, 500 m apart. The paper's figures for the plane z = −40 m are those of the "
        "triangle inset by 10.35 m; nearer the edge the needed cable grows without bound.",
        _paper,
    ),
    ReferenceCase(
        "The pose of the paper's Figs. 6 and 7",
        "Two independent codes: the cable equation by quadrature in space, and in closed form",
        "Position (250, 200, −50) m. Cable 1 is the mirror image of cable 2; the loop starts with "
        "weightless cables. Where the needed section was searched for, 1e-7 is allowed, else one "
        "unit of the last digit.",
        _same_pose,
    ),
    ReferenceCase(
        "Toward the edge of the paper's crane",
        "The same independent codes",
        "Positions (250, y, −40) m. Below y = 4.8 m no finite cable holds the platform.",
        lambda: tuple(_edge()),
    ),
    ReferenceCase(
        "Eight cables of given length on six degrees of freedom",
        "Geometry of CoGiRo as in cdpyr; pose and tensions by two independent codes, finite "
        "elements and quadrature of the cable equation",
        "Steel-like cables of 4 mm; tensions at the exit points.",
        _cogiro,
    ),
)
