"""Figures of others beside ours, with what they may differ by and why.

Single cables: Irvine's closed form in 40 digits, MoorPy, and published ones. Whole robots: the
paper's, and one with eight cables. Machines as they were built: what their makers chose, and what
this package would have said.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from designer.arrays import FloatArray, frozen_array
from designer.model.cable import STANDARD_GRAVITY_M_PER_S2 as GRAVITY
from designer.model.cable import Material
from designer.model.region import Prism
from designer.model.robot import Platform, Poses, Robot
from designer.model.workspace import Workspace
from designer.physics import catenary


@dataclass(frozen=True, slots=True)
class Figure:
    """One figure of a case."""

    name: str
    unit: str
    theirs: float  #: as published, or as another code has it
    ours: float  #: as this package computes it
    #: largest relative difference that holds; None where theirs is wrong, and is only shown
    tolerance: float | None
    #: whether theirs is what ours may not exceed, such as the largest force of a winch
    is_limit: bool = False

    @property
    def difference(self) -> float:
        """Relative difference of ours from theirs."""
        return (self.ours - self.theirs) / abs(self.theirs)

    @property
    def holds(self) -> bool:
        """Whether the difference is within the tolerance, if there is one."""
        difference = self.difference if self.is_limit else abs(self.difference)
        return self.tolerance is None or difference <= self.tolerance


@dataclass(frozen=True, slots=True)
class ReferenceCase:
    """Figures of one source; ``figures`` computes ours when called."""

    title: str
    source: str
    note: str
    figures: Callable[[], Sequence[Figure]]


def as_printed(name: str, unit: str, theirs: str, ours: float, units: float = 0.5) -> Figure:
    """Return a figure that holds to half of the last digit of ``theirs``, or so many ``units``."""
    decimals = len(theirs.partition(".")[2])
    value = float(theirs)
    return Figure(name, unit, value, ours, units * 10.0**-decimals / abs(value))


Line = tuple[float, float, float, float, float]

# Span, rise, unstrained length [m], axial stiffness [N], weight [N/m]. For each: horizontal force
# and vertical force at the upper end [N], from the closed form in 40 digits, and the same from
# MoorPy 1.3.0 with a tolerance of 1e-9 m.
LINES: tuple[tuple[str, Line, tuple[float, float], tuple[float, float]], ...] = (
    (
        "slack, stiff",
        (400.0, 200.0, 500.0, 7.51e12, 200.0),
        (43694.6046221, 77634.4105458),
        (43694.60462206872, 77634.41054580802),
    ),
    (
        "slack, heavy",
        (89.9, 59.2, 130.0, 7.51e8, 881.05),
        (31373.2348763, 87886.1613),
        (31373.23487630567, 87886.1612999649),
    ),
    (
        "nearly taut 1",
        (246.22420940032947, 263.55766330843164, 360.62566262396927, 7e8, 3.08735),
        (71116.8171986, 76680.6434641),
        (71116.81718661802, 76680.64345124319),
    ),
    (
        "nearly taut 2",
        (246.22420940032947, 263.55766330843164, 360.63566262396927, 7e8, 3.08735),
        (58377.2414227, 63044.4129559),
        (56804.57394468487, 60803.44743741568),
    ),
    (
        "nearly taut 3",
        (246.22420940032947, 263.55766330843164, 360.64566262396927, 7e8, 3.08735),
        (46077.2711724, 49878.8124286),
        (46077.27117186565, 49878.812427945246),
    ),
    (
        "taut, heavy",
        (119.3237383002058, 52.49668849178113, 130.36140355177318, 7e8, 34.91060469991227),
        (72694.6498942, 34266.3849557),
        (72694.64989081594, 34266.38495420268),
    ),
    (
        "long, heavy",
        (800.0, 100.0, 1000.0, 64e9, 1962.0),
        (671447.442408, 1100067.36332),
        (671447.4424083185, 1100067.3633213397),
    ),
)
WRONG_IN_MOORPY = "nearly taut 2"


def _upper_end_N(line: Line) -> tuple[float, float]:
    """Return the horizontal and the vertical force at the upper end [N]."""
    span, rise, length, stiffness, weight = line
    force_x, force_z = catenary.forces_from_length(length, span, rise, stiffness, weight)
    return float(force_x), float(weight * length - force_z)


def _lines(source: int, wrong: str = "") -> Sequence[Figure]:
    return [
        Figure(f"{name}, {end}", "N", their, ours, None if name == wrong else 1e-9)
        for name, line, *theirs in LINES
        for end, their, ours in zip("HV", theirs[source], _upper_end_N(line), strict=True)
    ]


def _lowe_and_langley() -> Sequence[Figure]:
    span, rise, length, stiffness, weight = 100.0, 50.0, 170.0, 500e6, 410.3
    horizontal, upper = _upper_end_N((span, rise, length, stiffness, weight))
    lower = weight * length - upper
    return (
        Figure("horizontal force", "kN", 11.40, horizontal / 1e3, 1e-2),
        Figure("vertical force, upper end", "kN", 45.71, upper / 1e3, 1e-3),
        Figure("vertical force, lower end", "kN", 24.04, lower / 1e3, 1e-3),
    )


def _point_load() -> Sequence[Figure]:
    from scipy.optimize import root

    span, weight, stiffness, load = 304.8, 46.12, 131e9 * 5.484e-4, 35586.0
    lengths = np.array([125.84695, 186.85526])

    def pulls(node: Sequence[float]) -> tuple[np.ndarray, np.ndarray]:
        x, z = node
        return catenary.forces_from_length(lengths, [x, span - x], [-z, -z], stiffness, weight)

    def unbalanced(node: Sequence[float], down: float) -> list[float]:
        force_x, force_z = pulls(node)
        return [force_x[1] - force_x[0], -force_z.sum() - down]

    hanging = root(unbalanced, [120.0, -30.0], args=(0.0,), tol=1e-13).x
    loaded = root(unbalanced, hanging, args=(load,), tol=1e-13).x
    along, down = loaded - hanging
    printed = partial(as_printed, units=1.0)
    return (
        printed("node, horizontal place", "m", "121.91997", float(hanging[0])),
        printed("node, height", "m", "-29.27588", float(hanging[1])),
        printed("horizontal force, own weight", "N", "17796.7", float(pulls(hanging)[0][0])),
        printed("node moves along", "m", "-0.85936", float(along)),
        printed("node moves up", "m", "-5.62559", float(down)),
    )


SINGLE_CABLES = (
    ReferenceCase(
        "The elastic catenary, in closed form",
        "H. M. Irvine, Cable Structures, MIT Press, 1981; evaluated in 40 digits",
        "Seven suspended cables, from slack to nearly taut. H: horizontal force; V: vertical force "
        "at the upper end, with the whole weight of the cable.",
        partial(_lines, 0),
    ),
    ReferenceCase(
        "The same cables in MoorPy",
        "MoorPy 1.3.0, function catenary, tolerance 1e-9 m, far above the sea bed",
        f"At '{WRONG_IN_MOORPY}' MoorPy falls back on a straight line without weight and reports "
        "no error; the closed form above tells which is right.",
        partial(_lines, 1, WRONG_IN_MOORPY),
    ),
    ReferenceCase(
        "A heavy cable between fixed ends",
        "Lowe and Langley, 2006: span 100 m, rise 50 m, length 170 m, 500 MN, 410.3 N/m",
        "Their cable resists bending, ours does not: 1 % of the horizontal force is allowed.",
        _lowe_and_langley,
    ),
    ReferenceCase(
        "A cable with a point load",
        "Michalos and Birnstiel; figures of Jayaraman and Knudson, 1981",
        "Span 304.8 m; two segments meet at a node that is loaded with 35.586 kN. What is given is "
        "rounded as well: one unit of the last digit is allowed.",
        _point_load,
    ),
)


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
    iterates = size_by_loop(_PAPERS_ROBOT, pose, _PAPERS_STEEL).iterates
    loop = tuple(enumerate(zip(_LOOP_kN, _LOOP_mm, iterates, strict=False)))
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


ROBOT_CASES = (
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
    rotation_rad = tilt_rad * np.column_stack([y, -x, 0.0 * x])
    return Poses.at(np.column_stack([radius_m * x, radius_m * y, height]), rotation_rad)


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


def _laden_cogiro() -> Sequence[Figure]:
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


MACHINES = (
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
        _laden_cogiro,
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

CASES: tuple[ReferenceCase, ...] = (*ROBOT_CASES, *SINGLE_CABLES, *MACHINES)
