"""Machines as they were built: what their makers chose, and what this package would have said."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from designer.arrays import FloatArray, frozen_array
from designer.model.cable import STANDARD_GRAVITY_M_PER_S2 as GRAVITY
from designer.model.cable import Material
from designer.model.prism import Prism
from designer.model.robot import Platform, Poses, Robot
from designer.model.workspace import Workspace
from designer.reference.case import Figure, ReferenceCase
from designer.reference.robots import COGIRO

# FAST's feed cabin: CASPR, models/SCDM/spatial_manipulators/FAST; Adv. Mech. Eng. 2014/716097
_AZIMUTHS_RAD = np.radians(30.0 + 60.0 * np.arange(6))
_PAIRS_M = [[3.25, 5.6292, 0.0], [-6.5, 0.0, 0.0], [3.25, -5.6292, 0.0]]
_DISC_kg_m2 = 30e3 * 6.5**2 * np.diag([0.25, 0.25, 0.5])
FAST_CABIN = Robot(
    frozen_array(
        np.column_stack(
            [300.0 * np.cos(_AZIMUTHS_RAD), 300.0 * np.sin(_AZIMUTHS_RAD), np.full(6, 270.0)]
        )
    ),
    Platform(30e3, frozen_array(np.repeat(_PAIRS_M, 2, axis=0)), inertia_kg_m2=_DISC_kg_m2),
)
_WIRE_ROPE = Material(5208.0, 61e9, 177.7e6)
"""6x36 WS-IWRC 1960 by EN 12385-4 over its nominal circle, with a safety factor of 5; modulus of
6x37 IWRC by Strand Core."""
_SMALL_ROPE = Material(5290.0, 62.7e9, 330e6)
"""Galvanised 7x19 over its nominal circle, with a safety factor of 3."""
# The CableRobot Simulator of the Max Planck Institute for Biological Cybernetics, and CAROCA:
# CASPR, models/SCDM/spatial_manipulators, the latter with its set of cables gazebo_sim.
SIMULATOR = Robot(
    frozen_array(
        [
            [0.8, 14.9, 7.9], [0.8, 14.9, 0.6], [11.3, 14.6, 7.9], [11.3, 14.6, 1.2],
            [11.2, 0.6, 7.9], [11.2, 0.5, 1.2], [0.42, 0.5, 8.0], [0.42, 0.5, 0.7],
        ]
    ),
    Platform(
        100.0,
        frozen_array(
            [
                [-1.4, 0.5, -0.7], [-0.8, 1.2, 0.7], [1.5, 0.4, -0.7], [1.0, 1.1, 0.7],
                [0.8, -1.3, -0.7], [1.4, -0.6, 0.7], [-0.9, -1.2, -0.7], [-1.4, -0.4, 0.7],
            ]
        ),
    ),
    tension_min_N=1000.0,
)  # fmt: skip
_CORNERS_M = [[-3.5, -2.0, 3.5], [3.5, -2.0, 3.5], [-3.5, 2.0, 3.5], [3.5, 2.0, 3.5]]
CAROCA = Robot(
    frozen_array(np.repeat(_CORNERS_M, 2, axis=0)),
    Platform(
        150.0,
        frozen_array(
            [
                [0.6, -0.3, -0.2], [-0.6, 0.3, 0.2], [-0.6, -0.3, 0.2], [0.6, 0.3, -0.2],
                [-0.6, -0.3, -0.2], [0.6, 0.3, 0.2], [0.6, -0.3, 0.2], [-0.6, 0.3, -0.2],
            ]
        ),
    ),
)  # fmt: skip
STADIUM_CAMERA = Robot(
    frozen_array(
        [[-85.0, -60.0, 40.0], [85.0, -60.0, 40.0], [85.0, 60.0, 40.0], [-85.0, 60.0, 40.0]]
    ),
    Platform(30.0),
)
_LADEN = 1.3
"""Mass of a rope with what hangs on it, over its own."""
_RIM_M = 103.0
_RING_RAD = np.radians(15.0 * np.arange(24))


def _ring(radius_m: float, tilt_rad: float) -> Poses:
    """Return poses all around the focal surface, tilted toward its middle."""
    x, y = np.cos(_RING_RAD), np.sin(_RING_RAD)
    height = np.full(24, 300.0 - np.sqrt(160.0**2 - radius_m**2))
    turn = tilt_rad * np.column_stack([y, -x, 0.0 * x])
    return Poses.at(np.column_stack([radius_m * x, radius_m * y, height]), turn)


def _needed_m(tilt_rad: float) -> FloatArray:
    from designer.sizing.newton import size_poses

    sizing = size_poses(FAST_CABIN, _ring(_RIM_M, tilt_rad), _WIRE_ROPE)
    return np.where(sizing.statics.is_solved, sizing.diameter_m, np.inf)


def _fast_cabin() -> Sequence[Figure]:
    from scipy.optimize import minimize_scalar

    from designer.statics.inverse import solve_sagging
    from designer.statics.modes import frequencies_Hz

    tilts_rad = np.radians([12.0, 16.0])
    best = minimize_scalar(
        lambda tilt: float(_needed_m(tilt).max()), bounds=tilts_rad, method="bounded"
    )
    rope = _WIRE_ROPE.cable(0.046)
    laden = replace(rope, linear_density_kg_per_m=_LADEN * rope.linear_density_kg_per_m)
    radii_m = (0.0, 55.0, _RIM_M)
    lowest_Hz = np.concatenate(
        [
            frequencies_Hz(
                solve_sagging(FAST_CABIN, _ring(r, np.radians(14.0) * r / _RIM_M), laden),
                FAST_CABIN.platform,
                laden.linear_density_kg_per_m,
            )
            for r in radii_m
        ]
    )
    middle_Hz = 0.5 * float(lowest_Hz.min() + lowest_Hz.max())
    return (
        Figure("rope, thinnest for a factor of 5", "mm", 46.0, 1e3 * best.fun, 0.05),
        Figure("tilt at the rim that needs it", "°", 14.0, float(np.degrees(best.x)), 0.1),
        Figure("lowest frequency, middle of its range", "Hz", 0.16, middle_Hz, 0.25),
    )


def _cogiro() -> Sequence[Figure]:
    from designer.workspace.sweep import map_workspace

    laden = replace(COGIRO.platform, wrench_N=frozen_array([0, 0, -500 * GRAVITY, 0, 0, 0]))
    workspace = Workspace(Prism.box((-4, 4), (-3, 3), (0.5, 2.5)), samples=2000)
    robot = replace(COGIRO, platform=laden)
    worst = map_workspace(robot, workspace, _SMALL_ROPE, with_massless=False).sagging
    assert worst is not None
    return (Figure("rope for a factor of 3", "mm", 4.0, 1e3 * worst.diameter_m, 0.1),)


def _simulator() -> Sequence[Figure]:
    return (_winch_force(SIMULATOR, Prism.box((3.9, 7.9), (5.0, 10.0), (3.0, 5.5)), 14.0),)


def _caroca() -> Sequence[Figure]:
    return (_winch_force(CAROCA, Prism.box((-1.5, 1.5), (-0.75, 0.75), (0.5, 2.0)), 1.0),)


def _winch_force(robot: Robot, region: Prism, largest_kN: float) -> Figure:
    ours = 1e-3 * _largest_tension_N(robot, region)
    return Figure("largest force that a winch needs", "kN", largest_kN, ours, 0.0, is_limit=True)


def _camera() -> Sequence[Figure]:
    field = Prism.box((-52.5, 52.5), (-34.0, 34.0), (3.0, 20.0))
    ours = _largest_tension_N(STADIUM_CAMERA, field) / GRAVITY
    return (Figure("largest force of a rope", "kgf", 65.0, ours, 0.15),)


def _largest_tension_N(robot: Robot, region: Prism) -> float:
    """Return the tension where a rope is used most; infinite where a pose is not held."""
    from designer.workspace.sweep import map_workspace

    workspace = Workspace(region, samples=500)
    worst = map_workspace(robot, workspace, _SMALL_ROPE, with_massless=False).sagging
    return np.inf if worst is None else worst.max_tension_N


CASES = (
    ReferenceCase(
        "The feed cabin of FAST, found blind",
        "Exit points and attachments: CASPR; mass and focal surface: Adv. Mech. Eng. 2014/716097; "
        "tilt: 2014/209167; rope: hgnnw.com, 2016-07-05; frequencies measured: Universe 2024, 10, "
        "450",
        "Nothing but geometry, mass and a 6x36 rope of grade 1960 goes in. Ours are the one tilt "
        "toward the middle, at 24 places around the rim, that needs the thinnest rope, and that "
        "rope; its makers took the next size. Frequencies, measured as 0.12 to 0.2 Hz, are of "
        "the rope that was bought with cables below it, 30 % of its mass, and a cabin that is a "
        "disc. They are quasi-static, and so from above: the ropes' own, from 0.12 Hz, couple with "
        "the cabin and bring its lowest down.",
        _fast_cabin,
    ),
    ReferenceCase(
        "CoGiRo with its load",
        "Geometry: sample cogiro of github.com/cable-robots/cdpyr; a load of 500 kg on "
        "steel ropes of 4 mm, as descriptions of the machine have it",
        "The load hangs at the platform's frame and goes where the example goes, 8 x 6 x 2 m; that "
        "and the safety factor of 3 are ours. The rope is galvanised 7x19 over its nominal circle.",
        _cogiro,
    ),
    ReferenceCase(
        "The CableRobot Simulator at rest",
        "Geometry, 100 kg, and forces of 1 to 14 kN a cable: CASPR, model "
        "The_Cable_Robot_Simulator, of Miermeister et al., IROS 2016, pp. 3024-3029",
        "Held level over 4 x 5 x 2.5 m about the pose that the model begins in, with the least "
        "force of 1 kN in each cable; the region, the wire rope and that it is at rest are ours. "
        "What its winches have beyond that is for what its passenger feels, and is not compared.",
        _simulator,
    ),
    ReferenceCase(
        "CAROCA at rest",
        "Geometry, 150 kg, and a largest force of 1 kN a cable: CASPR, model CAROCA, cables "
        "gazebo_sim",
        "Held level over 3 x 1.5 x 1.5 m about the pose that the model begins in; the region, the "
        "wire rope and that it is at rest are ours. No more is told than that the winches do.",
        _caroca,
    ),
    ReferenceCase(
        "A stadium camera",
        "A load of 30 kg: Spidercam, 2018; ropes run up to 65 kgf: JoyMechanix, frequently asked "
        "questions",
        "Two makers, no drawing: where the sheaves hang, 170 x 120 m apart and 40 m up, over a "
        "field of 105 x 68 m that is flown at 3 to 20 m, is our assumption, as in the example "
        "'stadium', and with it how near the two figures are.",
        _camera,
    ),
)
