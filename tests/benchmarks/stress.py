"""Random cables and poses over ten decades: does anything called solved have a wrong number?

    python tests/benchmarks/stress.py [--cables 1000000] [--robots 400] [--exact 2000] [--seed 0]

Cables: stiffness and weight per length over ten decades each, the angle of sag and the slope over
ten decades, spans from a decimetre to ten kilometres; what would stretch to more than twice its
length is drawn again. Both solvers are tried on each: from the horizontal force to the length, and
back from the length to the forces. All are held to their residuals, a subset spread evenly over the
decades of the sag to a reference in 60 digits (`exact_catenary`).

Poses: random robots with three, six and eight cables, with rope from a millionth to a thousand
times the load, solved in batches; all are held to both residuals, and a few of each robot to the
reference where the cables are as many as the degrees of freedom. The thinnest cables of random
materials are held to the residuals and to the allowable stress, from both sides where they are
known to be the thinnest.

A number may be off by 1e-9 of the tension or length, or by a hundred times what one rounding of the
data moves it by, if that is more: a taut steel cable turns a length in double precision into a
tension with few digits, however it is solved. How many needed that is told. Anything beyond ends
the run with status 1. MoorPy solves the same subset beside it.
"""

from __future__ import annotations

import argparse
import contextlib
import io
import os
import sys
import time
import warnings
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1]))
import exact_catenary

from designer.arrays import frozen_array
from designer.model.cable import Cable, Material
from designer.model.robot import Platform, Poses, Robot
from designer.physics import catenary
from designer.sizing.newton import size_poses
from designer.statics.inverse import Statics, solve_sagging

RELATIVE = 1e-9
ROUNDINGS = 100.0
RESIDUAL = 1e-9
_CHUNK = 2**15
_STRAIN = 1.0
_MATERIALS = ((2.5, 4.3), (8.0, 11.5), (6.5, 9.5))
"""Decades of density, modulus and allowable stress."""
Lines = tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray, np.ndarray]


@dataclass
class Tally:
    """What was tried, what was not solved, and the worst of the rest."""

    name: str
    tried: int = 0
    unsolved: int = 0
    residual: float = 0.0
    compared: int = 0
    excused: int = 0
    error: float = 0.0
    roundings: float = 0.0
    faults: list[str] = field(default_factory=list)

    def hold_residual(self, residual: np.ndarray, solved: np.ndarray) -> None:
        self.tried += solved.size
        self.unsolved += int((~solved).sum())
        if solved.any():
            worst = float(residual[solved].max())
            self.residual = max(self.residual, worst)
            if not worst <= RESIDUAL:
                self.faults.append(f"{self.name}: residual {worst:.2g}")

    def hold_error(self, error: float, moves: float, what: object) -> None:
        """Take in a relative error, and how far one rounding moves the value, relative too."""
        allowed = max(RELATIVE, ROUNDINGS * exact_catenary.EPS * moves)
        self.compared += 1
        self.error = max(self.error, error if allowed == RELATIVE else 0.0)
        self.excused += error > RELATIVE
        self.roundings = max(self.roundings, error / (exact_catenary.EPS * max(moves, 1.0)))
        if not error <= allowed:
            self.faults.append(f"{self.name}: off by {error:.2g}, {allowed:.2g} allowed: {what}")

    def __str__(self) -> str:
        return (
            f"{self.name:34} {self.tried:9d} {self.unsolved:9d} {self.residual:9.1e} "
            f"{self.compared:9d} {self.error:9.1e} {self.excused:8d} {self.roundings:10.2g}"
        )


HEADING = (
    f"{'':34} {'tried':>9} {'unsolved':>9} {'residual':>9} {'exact':>9} {'error':>9} "
    f"{'excused':>8} {'roundings':>10}"
)


def decades(rng: np.random.Generator, low: float, high: float, count: int) -> np.ndarray:
    return 10.0 ** rng.uniform(low, high, count)


def draw(count: int, rng: np.random.Generator) -> tuple[Lines, np.ndarray]:
    """Return X, D, EA, w and the force density of random cables, and their angle of sag."""
    found: list[np.ndarray] = []
    left = count
    while left > 0:
        n = 2 * left + 100
        chord = decades(rng, -1, 4, n)
        angle = np.arctan(decades(rng, -5, 5, n)) * rng.choice([-1.0, 1.0], n)
        X, D = chord * np.cos(angle), chord * np.sin(angle)
        EA, w, sag = decades(rng, 3, 13, n), decades(rng, -5, 5, n), decades(rng, -8, 2, n)
        density = w / (2.0 * sag)
        with np.errstate(over="ignore"):
            arc = np.hypot(D, X * np.sinh(sag) / sag)
        kept = (density * chord <= _STRAIN * EA) & (w * arc <= _STRAIN * EA)
        found.append(np.stack([X, D, EA, w, density, sag])[:, kept][:, :left])
        left -= found[-1].shape[1]
    X, D, EA, w, density, sag = np.concatenate(found, axis=1)
    return (X, D, EA, w, density), sag


def spread(sag: np.ndarray, count: int, rng: np.random.Generator) -> np.ndarray:
    """Return places of about ``count`` cables, as many of each decade of the sag."""
    decade = np.floor(np.log10(sag)).astype(int)
    each = max(1, count // len(np.unique(decade)))
    picked = [rng.permutation(np.flatnonzero(decade == one))[:each] for one in np.unique(decade)]
    return np.concatenate(picked)


def closure(length, force_x, force_z, lines: Lines) -> np.ndarray:
    """By how much the cables miss their ends, over the larger of length and chord."""
    X, D, EA, w, _ = lines
    x, z = catenary.end_position_m(length, force_x, force_z, EA, w)
    return np.hypot(x - X, z + D) / np.maximum(length, np.hypot(X, D))


def try_cables(count: int, exact: int, rng: np.random.Generator) -> Iterator[Tally]:
    to_length, to_forces = Tally("cables, force to length"), Tally("cables, length to forces")
    for at in range(0, count, _CHUNK):
        size = min(_CHUNK, count - at)
        lines, sag = draw(size, rng)
        X, D, EA, w, density = lines
        length, force_z = catenary.length_and_force_z(density, X, D, EA, w)
        solved = np.isfinite(length) & np.isfinite(force_z)
        to_length.hold_residual(closure(length, density * X, force_z, lines), solved)
        forces = catenary.forces_from_length(length, X, D, EA, w)
        back = np.isfinite(forces[0]) & np.isfinite(forces[1])
        to_forces.hold_residual(closure(length, *forces, lines), back)
        wanted = max(1, exact * size // count)
        for i in spread(sag, wanted, rng):
            given = X[i], D[i], EA[i], w[i]
            if solved[i]:
                true = exact_catenary.length_and_force(
                    (length[i], force_z[i]), (density[i], X[i]), *given
                )
                top = tension(density[i] * X[i], true.values[1], w[i] * true.values[0])
                scale = np.array([true.values[0], top])
                off = np.abs([length[i], force_z[i]] - true.values) / scale
                for error, moves in zip(off, true.moves / scale, strict=True):
                    to_length.hold_error(error, moves, (*given, density[i]))
            if back[i]:
                ours = np.array([forces[0][i], forces[1][i]])
                true = exact_catenary.forces(ours, length[i], *given)
                top = tension(*true.values, w[i] * length[i])
                off = np.abs(ours - true.values) / top
                for error, moves in zip(off, true.moves / top, strict=True):
                    to_forces.hold_error(error, moves, (*given, length[i]))
    yield to_length
    yield to_forces


def tension(force_x: float, force_z: float, weight: float) -> float:
    """Return the larger of the tensions at the ends."""
    return max(np.hypot(force_x, force_z), np.hypot(force_x, force_z - weight))


def random_robot(n: int, rng: np.random.Generator) -> tuple[Robot, Cable]:
    """Return a robot of three cables, or of two at each corner of a platform, and its rope."""
    size, mass = decades(rng, -1, 3.5, 1)[0], decades(rng, -2, 5, 1)[0]
    corners = 3 if n == 3 else n // 2
    angle = 2 * np.pi * (np.arange(corners) / corners + rng.uniform(-0.1, 0.1, corners))
    height = rng.uniform(-0.05, 0.05, corners)
    exits = size * np.column_stack([np.cos(angle), np.sin(angle), height])
    rope = mass / size * decades(rng, -6, 3, 1)[0]
    stiffness = 9.81 * max(mass * decades(rng, 0.5, 9, 1)[0], 10.0 * rope * size)
    cable = Cable(0.01, rope, stiffness, 1e9)
    if n == 3:
        return Robot(frozen_array(exits), Platform(mass)), cable
    pairs = exits.repeat(2, axis=0) + 0.02 * size * rng.uniform(-1, 1, (n, 3))
    turned = angle + np.pi / corners
    held = 0.1 * size * np.column_stack([np.cos(turned), np.sin(turned), np.zeros(corners)])
    # Each corner of the frame holds the two corners of the platform that are nearest.
    places = np.stack([np.roll(held, 1, axis=0), held], axis=1).reshape(n, 3)
    places = places + 0.005 * size * rng.uniform(-1, 1, (n, 3))
    return Robot(frozen_array(pairs), Platform(mass, frozen_array(places))), cable


def random_poses(robot: Robot, count: int, rng: np.random.Generator) -> Poses:
    exits = robot.exit_points_m
    size = np.ptp(exits[:, 0])
    position = rng.dirichlet(np.ones(len(exits)), count) @ exits
    position[:, 2] = exits[:, 2].min() - size * decades(rng, -2, 1, count)
    if robot.is_point_mass:
        return Poses.at(position)
    return Poses.at(position, rng.normal(0.0, 0.03, (count, 3)))


def try_poses(n: int, robots: int, each: int, exact: int, rng: np.random.Generator) -> Tally:
    tally = Tally(f"poses, {n} cables")
    for _ in range(robots):
        robot, cable = random_robot(n, rng)
        statics = solve_sagging(robot, random_poses(robot, each, rng), cable)
        solved = statics.is_solved
        tally.hold_residual(_residual(statics), solved)
        for i in rng.permutation(np.flatnonzero(solved))[:exact]:
            _hold_pose(tally, statics, i)
    return tally


def try_sizes(n: int, robots: int, each: int, rng: np.random.Generator) -> Tally:
    """Hold thinnest cables of random materials to both residuals and to the allowable stress."""
    tally = Tally(f"thinnest cables, {n}")
    for _ in range(robots):
        robot, _ = random_robot(n, rng)
        density, modulus, stress = (decades(rng, *ends, 1)[0] for ends in _MATERIALS)
        material = Material(density, modulus, min(stress, 0.3 * modulus))
        sizing = size_poses(robot, random_poses(robot, each, rng), material)
        with np.errstate(invalid="ignore"):
            area = np.pi / 4 * sizing.diameter_m**2
            used = sizing.statics.largest_tension_N / (area * material.allowable_stress_Pa)
        # What is not known to be the thinnest may be left below its limit, never above.
        beyond = np.where(sizing.is_thinnest, np.abs(used - 1.0), np.maximum(used - 1.0, 0.0))
        residual = np.fmax(_residual(sizing.statics), beyond)
        tally.hold_residual(residual, sizing.statics.is_solved)
    return tally


def _residual(statics: Statics) -> np.ndarray:
    """Return the larger of closure over length and of unbalanced force over the tension."""
    with np.errstate(invalid="ignore"):
        unbalanced = np.abs(statics.equilibrium_residual_N()[..., :3]).max(axis=-1)
        closed = (statics.closure_residual_m() / statics.length_m).max(axis=-1)
        return np.fmax(unbalanced / statics.largest_tension_N, closed)


def _hold_pose(tally: Tally, statics: Statics, i: int) -> None:
    robot, pose = statics.robot, statics.poses
    ends = pose.attachment_points_m(robot)[i]
    arms = None if robot.is_point_mass else ends - pose.position_m[i]
    ours = np.stack([statics.length_m[i], statics.force_x_N[i], statics.force_z_N[i]], axis=-1)
    EA, w = float(statics.axial_stiffness_N[i, 0]), float(statics.weight_N_per_m[i, 0])
    load = 9.81 * robot.platform.mass_kg
    where = robot.exit_points_m.tolist(), pose.position_m[i].tolist()
    try:
        true = exact_catenary.pose(ours.ravel(), robot.exit_points_m, ends, arms, load, EA, w)
    except ArithmeticError as error:  # nothing near by balances
        tally.faults.append(f"{tally.name}: {error}: {where}")
        return
    exact = true.values.reshape(ours.shape)
    top = np.array([tension(F, V, w * s) for s, F, V in exact])
    scale = np.column_stack([exact[:, 0], top, top])
    off, moves = np.abs(ours - exact) / scale, true.moves.reshape(ours.shape) / scale
    for error, moved in zip(off.ravel(), moves.ravel(), strict=True):
        tally.hold_error(error, moved, where)


def try_moorpy(count: int, rng: np.random.Generator) -> str:
    """Return how MoorPy does on such cables, at a tolerance of 1e-9 of the length.

    It may be off by 1e-6 of the tension, or by ten times what that tolerance moves the forces by.
    """
    os.environ["PYTHONBREAKPOINT"] = "0"  # MoorPy stops in the debugger when it fails
    with warnings.catch_warnings(), contextlib.redirect_stdout(io.StringIO()):
        warnings.simplefilter("ignore")
        from moorpy import Catenary

        (X, D, EA, w, density), sag = draw(50 * count, rng)
        length, _ = catenary.length_and_force_z(density, X, D, EA, w)
        failed = wrong = 0
        chosen = spread(sag, count, rng)
        for i in chosen:
            given = X[i], D[i], EA[i], w[i]
            ours = catenary.forces_from_length(length[i], *given)
            true = exact_catenary.forces(np.array(ours), length[i], *given)
            try:
                found = Catenary.catenary(
                    X[i], D[i], length[i], EA[i], w[i], CB=-1e9, Tol=1e-9 * length[i]
                )
            except Exception:  # whatever it raises is no answer
                failed += 1
                continue
            top = tension(*true.values, w[i] * length[i])
            error = np.abs(np.array([found[0], -found[1]]) - true.values).max() / top
            wrong += not error <= max(1e-6, 1e-8 * true.moves.max() / top)
    return (
        f"MoorPy on {len(chosen)} such cables: no answer to {failed}, off by more than its "
        f"tolerance allows in {wrong}"
    )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--cables", type=int, default=1_000_000)
    parser.add_argument("--robots", type=int, default=400)
    parser.add_argument("--exact", type=int, default=2000)
    parser.add_argument("--moorpy", type=int, default=200)
    parser.add_argument("--seed", type=int, default=0)
    given = parser.parse_args()
    rng = np.random.default_rng(given.seed)
    start = time.perf_counter()
    print(HEADING)
    faults: list[str] = []
    for tally in try_cables(given.cables, given.exact, rng):
        print(tally)
        faults += tally.faults
    for n, robots, exact in ((3, given.robots, 2), (6, given.robots, 1), (8, given.robots // 4, 0)):
        tally = try_poses(n, robots, 500, exact, rng)
        print(tally, flush=True)
        faults += tally.faults
        tally = try_sizes(n, robots // 2, 500, rng)
        print(tally, flush=True)
        faults += tally.faults
    if given.moorpy:
        print(try_moorpy(given.moorpy, rng))
    print(f"{time.perf_counter() - start:.0f} s, {len(faults)} faults")
    print("\n".join(faults[:20]))
    sys.exit(bool(faults))


if __name__ == "__main__":
    main()
