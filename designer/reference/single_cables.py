"""Single cables: Irvine's closed form in 40 digits, MoorPy, and published ones."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial

import numpy as np

from designer.physics import catenary
from designer.reference.case import Figure, ReferenceCase, as_printed

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


CASES = (
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
