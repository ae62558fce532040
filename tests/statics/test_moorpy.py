"""Cables and whole poses against MoorPy, an independent code for mooring lines.

MoorPy takes the length and the ends of a line and finds its end forces to a tolerance of its own.
Where the two codes differ, the catenary's own equations in 40 digits say which one is right.
"""

from __future__ import annotations

import warnings
from collections.abc import Callable
from decimal import Decimal, localcontext

import numpy as np
import pytest
from sample_robots import COGIRO, COGIRO_CABLE, ROPE, poses_under

from designer.model.cable import Cable
from designer.model.robot import Poses, Robot
from designer.physics import catenary
from designer.statics.forward import solve_forward
from designer.statics.geometry import load_wrench_N, structure_matrix
from designer.statics.inverse import Statics, solve_sagging

with warnings.catch_warnings():
    warnings.simplefilter("ignore")  # what another library warns of while it loads is not ours
    moorpy = pytest.importorskip("moorpy.Catenary", reason="the extra `test` brings MoorPy")

POSES = 100
"""Of each of three robots."""

Line = Callable[..., tuple[float, float]]


@pytest.fixture
def line(monkeypatch: pytest.MonkeyPatch) -> Line:
    """Return a function that has MoorPy solve a hanging line far above its sea bed."""
    monkeypatch.setenv("PYTHONBREAKPOINT", "0")  # MoorPy stops in the debugger when it fails

    def forces(
        X: float, drop: float, length: float, cable: Cable, tol: float
    ) -> tuple[float, float]:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            found = moorpy.catenary(
                X, drop, length, cable.axial_stiffness_N, cable.weight_N_per_m, CB=-1e5, Tol=tol
            )
        return float(found[0]), -float(found[1])

    return forces


def closure_m(
    length: float, force_x: float, force_z: float, X: float, drop: float, cable: Cable
) -> float:
    """By how much a line misses its end, Riehl et al., eqs. (7) and (8), in 40 digits [m]."""
    with localcontext() as context:
        context.prec = 40
        s, F, V, x, d, EA, w = (
            Decimal(float(value))
            for value in (
                length,
                force_x,
                force_z,
                X,
                drop,
                cable.axial_stiffness_N,
                cable.weight_N_per_m,
            )
        )
        top = V - w * s

        def asinh(v: Decimal) -> Decimal:
            return (v + (v * v + 1).sqrt()).ln()

        def size(a: Decimal, b: Decimal) -> Decimal:
            return (a * a + b * b).sqrt()

        miss_x = F * s / EA + F / w * (asinh(V / F) - asinh(top / F)) - x
        miss_z = V * s / EA - w * s * s / (2 * EA) + (size(F, V) - size(F, top)) / w + d
        return float(size(miss_x, miss_z))


def held(robot: Robot, cable: Cable) -> Statics:
    """As many balanced poses as are asked for."""
    poses = poses_under(robot, 2 * POSES, 7)
    if robot.is_square:
        lengths = None
        good = solve_sagging(robot, poses, cable).is_solved
    else:
        ends = poses.attachment_points_m(robot) - robot.exit_points_m
        lengths = 0.999 * np.linalg.norm(ends, axis=-1)
        good = solve_forward(robot, cable, lengths, poses).statics.is_solved
    chosen = np.flatnonzero(good)[:POSES]
    assert len(chosen) == POSES
    rotation = poses.rotation if robot.is_point_mass else poses.rotation[chosen]
    some = Poses(poses.position_m[chosen], rotation)
    if lengths is None:
        return solve_sagging(robot, some, cable)
    return solve_forward(robot, cable, lengths[chosen], some).statics


@pytest.mark.cases_by_default(1)
@pytest.mark.parametrize("name", ["three cables", "six cables", "eight cables"])
def test_poses_agree(fast_robot, six_cable_robot, line: Line, name: str) -> None:
    """End forces agree to 1e-6 of the tension, and MoorPy's forces hold the platform as well."""
    robot, cable = {
        "three cables": (fast_robot, ROPE),
        "six cables": (six_cable_robot, ROPE),
        "eight cables": (COGIRO, COGIRO_CABLE),
    }[name]
    statics = held(robot, cable)
    geometry = statics.geometry()
    X, drop = geometry.horizontal_distance_m, geometry.drop_m
    theirs = np.array(
        [line(X[at], drop[at], statics.length_m[at], cable, 1e-9) for at in np.ndindex(X.shape)]
    ).reshape(*X.shape, 2)
    ours = np.stack([statics.force_x_N, statics.force_z_N], axis=-1)
    tension = statics.exit_tension_N[..., None]
    assert np.abs((theirs - ours) / tension).max() < 1e-6
    wrench = np.einsum(
        "pij,pj->pi", structure_matrix(robot, geometry), theirs.reshape(POSES, -1)
    ) - load_wrench_N(robot, statics.poses)
    assert np.abs(wrench).max() < 1e-6 * statics.largest_tension_N.max()


def test_where_the_codes_differ_ours_closes_better(line: Line) -> None:
    """With MoorPy's usual tolerance of 1e-6 m the light cables of CoGiRo differ by up to 1e-4."""
    statics = held(COGIRO, COGIRO_CABLE)
    geometry = statics.geometry()
    differing = 0
    for at in np.ndindex(20, 8):
        where = (
            geometry.horizontal_distance_m[at],
            geometry.drop_m[at],
            COGIRO_CABLE,
        )
        length = statics.length_m[at]
        theirs = line(where[0], where[1], length, COGIRO_CABLE, 1e-6)
        ours = (statics.force_x_N[at], statics.force_z_N[at])
        if max(np.abs(np.subtract(theirs, ours))) > 1e-6 * statics.exit_tension_N[at]:
            differing += 1
            assert closure_m(length, *ours, *where) < 1e-12
            assert closure_m(length, *theirs, *where) > 1e-9
    assert differing > 0


def test_a_nearly_taut_line_that_the_peer_takes_for_a_spring(line: Line) -> None:
    """MoorPy 1.3 falls back on a straight line without weight here, and reports no error."""
    cable = Cable(0.02, 3.08735 / 9.81, 7e8, 1e6)
    X, drop, length = 246.22420940032947, 263.55766330843164, 360.63566262396927
    ours = catenary.forces_from_length(
        length, X, drop, cable.axial_stiffness_N, cable.weight_N_per_m
    )
    theirs = line(X, drop, length, cable, 1e-9)
    assert closure_m(length, float(ours[0]), float(ours[1]), X, drop, cable) < 1e-10
    upward = cable.weight_N_per_m * length - ours[1]
    assert ours[0] == pytest.approx(58377.2414227, rel=1e-9)
    assert upward == pytest.approx(63044.4129559, rel=1e-9)
    if abs(theirs[0] / float(ours[0]) - 1.0) > 1e-6:
        assert closure_m(length, *theirs, X, drop, cable) > 1e-5
