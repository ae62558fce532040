"""Whole robots: the paper's, and one with eight cables."""

from __future__ import annotations

from collections.abc import Sequence

from designer.arrays import frozen_array
from designer.model.cable import Material
from designer.model.robot import Platform, Poses, Robot
from designer.reference.case import Case, Figure, as_printed

# Riehl et al., Table I
_PAPERS_ROBOT = Robot(
    frozen_array([[0.0, 0, 0], [500.0, 0, 0], [250.0, 433.01, 0]]), Platform(4000.0)
)
_PAPERS_STEEL = Material(7800.0, 200e9, 180e6)
_WORST = (243.0, 10.35, -40.0)
"""Of the plane z = −40 m in the triangle inset by 10.35 m, found by our search."""

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


def _cogiro() -> Sequence[Figure]:
    from designer.statics.forward import solve_forward

    cable = Material(7800.0, 100e9, 1e9).cable(0.004)
    start = Poses.at([0.0, 0.0, 1.0], [0.0, 0.0, 0.0])
    found = solve_forward(COGIRO, cable, frozen_array(_COGIRO_LENGTHS_M), start)
    tensions = zip(_COGIRO_TENSIONS_N, found.statics.exit_tension_N, strict=True)
    place = zip(
        "xyz", (1.100564e-2, -1.002498e-2, 1.317075894), found.poses.position_m, strict=True
    )
    return (
        *(Figure(f"platform, {axis}", "m", theirs, ours, 1e-5) for axis, theirs, ours in place),
        *(
            Figure(f"cable {i}, tension", "N", theirs, ours, 1e-5)
            for i, (theirs, ours) in enumerate(tensions, 1)
        ),
    )


CASES = (
    Case(
        "The paper's crane",
        "Riehl, Gouttefarde, Baradat and Pierrot, ICRA 2010: text and Figs. 6 to 9",
        "Three cables, 500 m apart. The paper's figures for the plane z = −40 m are those of the "
        "triangle inset by 10.35 m; nearer the edge the needed cable grows without bound.",
        _paper,
    ),
    Case(
        "Eight cables of given length on six degrees of freedom",
        "Geometry of CoGiRo as in cdpyr; pose and tensions by two independent codes, finite "
        "elements and quadrature of the cable equation",
        "Steel-like cables of 4 mm; tensions at the exit points.",
        _cogiro,
    ),
)
