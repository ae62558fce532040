"""The parts of a diagnosis, each against a baseline in the same run.

    python tests/benchmarks/diagnosis_speed.py [--rows 120] [--log STUDY]

The search against the same with SciPy pose by pose: each pose by `scipy.optimize.root`, and slopes
by `least_squares` itself. Where a trial has pulleys, tilt or wind, the baseline keeps our solver,
which flatters it. Then poses of a platform on four heavy cables against SciPy pose by pose; the
design before and after against one that proves every product; and a search with linear algebra on
one thread against one with as many as it likes, for a study of one's own where ``--log`` names it.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
import time
from contextlib import nullcontext
from pathlib import Path
from unittest.mock import patch

import numpy as np
import scipy.optimize
import threadpoolctl
from scipy.optimize import root

sys.path.insert(0, str(Path(__file__).parents[1]))

from twins.dataset import make, size_for
from twins.robots import FIELD4, YARD3

from designer.diagnosis import design as diagnosis_design
from designer.diagnosis import problem as prediction
from designer.diagnosis.case import Case, case_of
from designer.diagnosis.design import with_design
from designer.diagnosis.diagnose import diagnose
from designer.effects.effect import Readings
from designer.grades.registry import load_catalogue
from designer.io.config import read_study
from designer.measured.read import read_measured
from designer.model.robot import Poses
from designer.physics import catenary
from designer.selection.select import select
from designer.statics.geometry import cable_geometry, load_wrench_N, structure_matrix
from designer.statics.inverse import solve_massless


def case(rows: int) -> Case:
    effect = {
        "elastic_modulus": YARD3.draw("elastic_modulus", size_for(YARD3, "elastic_modulus", 10.0))
    }
    with tempfile.TemporaryDirectory() as folder:
        make(YARD3, effect, rows=rows).write(Path(folder))
        study = read_study(Path(folder) / "config.yaml")
        assert study.measurements is not None
        return case_of(study, study.measurements, read_measured(study))


def pose_by_pose(machine, poses, measured=None):
    """What a user would write: the paper's equations, one root solve a pose."""
    robot = machine.robot
    if robot.pulley_radius_m or robot.tilt_rad.any() or machine.drag_area_m2:
        return OURS(machine, poses, measured)
    w, EA = machine.cable.weight_N_per_m, machine.cable.axial_stiffness_N
    lengths, tensions = [], []
    for position in poses.position_m:
        pose = Poses.at(position)
        geometry = cable_geometry(robot, pose)
        X, Z, chord = geometry.horizontal_distance_m, -geometry.drop_m, geometry.chord_m
        W, e = structure_matrix(robot, geometry), load_wrench_N(robot, pose)
        start = solve_massless(robot, pose).tension_N
        force = start.max()

        def equations(u, X=X, Z=Z, chord=chord, W=W, e=e, force=force):
            Fx, Fz, length = u.reshape(-1, 3).T
            Fx, Fz, length = Fx * force, Fz * force, length * chord
            top = Fz - w * length
            x = Fx * length / EA + Fx / w * (np.arcsinh(Fz / Fx) - np.arcsinh(top / Fx))
            z = Fz * length / EA - length**2 * w / (2 * EA)
            z = z + (np.hypot(Fx, Fz) - np.hypot(Fx, top)) / w
            balance = (W @ np.stack([Fx, Fz], axis=1).ravel() - e) / force
            return np.concatenate([(x - X) / chord, (z - Z) / chord, balance])

        share = start / force / chord
        guess = np.stack([share * X, share * Z, np.ones_like(share)], axis=1).ravel()
        Fx, Fz, length = root(equations, guess, tol=1e-12).x.reshape(-1, 3).T
        lengths.append(length * chord)
        tensions.append(np.hypot(Fx * force, Fz * force - w * length * chord))
    return Readings(np.array(lengths), np.array(tensions))


def own_differences(*arguments, **options):
    """`least_squares` without our slopes."""
    return LEAST_SQUARES(*arguments, **{**options, "jac": "2-point"})


def four_cables(rows: int) -> None:
    """Compare readings of a swaying platform with SciPy's least squares pose by pose."""
    with tempfile.TemporaryDirectory() as folder:
        make(FIELD4, {}, rows=rows, noise=0.0).write(Path(folder))
        study = read_study(Path(folder) / "config.yaml")
        measured = read_measured(study)
    machine = case_of(study, study.measurements, measured).machine
    OURS(machine, measured.poses)
    start = time.perf_counter()
    ours = OURS(machine, measured.poses)
    middle = time.perf_counter()
    theirs = np.array([least_left(machine, measured.poses, k) for k in range(rows)])
    end = time.perf_counter()
    print(f"four cables: lengths differ by {np.abs(ours.length_m - theirs).max():.1e} m")
    tell("four cables", middle - start, end - middle)


def least_left(machine, poses, k: int):
    """Return the lengths of one pose, by the pulls that leave the least out of balance."""
    robot, w, EA = machine.robot, machine.cable.weight_N_per_m, machine.cable.axial_stiffness_N
    pose = Poses(poses.position_m[k], poses.rotation[k])
    geometry, load = cable_geometry(robot, pose), load_wrench_N(robot, pose)
    W, X, D = structure_matrix(robot, geometry), geometry.horizontal_distance_m, geometry.drop_m

    def cables(logarithm):
        density = np.exp(logarithm)
        return density, *catenary.length_and_force_z(density, X, D, EA, w)

    def left(logarithm):
        density, _, force_z = cables(logarithm)
        return W @ np.stack([density * X, force_z], axis=-1).ravel() - load

    start = np.log(np.full(robot.n_cables, robot.weight_N / robot.n_cables) / geometry.chord_m)
    return cables(LEAST_SQUARES(left, start, xtol=1e-12, ftol=1e-12, gtol=1e-12).x)[1]


def design(found, grades) -> None:
    """Compare the design before and after with one that proves every product."""

    def every(*arguments, **named):
        return select(*arguments, **named).chosen

    with_design(found, grades)
    start = time.perf_counter()
    ours = with_design(found, grades)
    middle = time.perf_counter()
    with patch.object(diagnosis_design, "best_product", every):
        theirs = with_design(found, grades)
    end = time.perf_counter()
    assert (ours.design_before, ours.design_after) == (theirs.design_before, theirs.design_after)
    tell("design", middle - start, end - middle)


def threads(problem: Case) -> None:
    """Compare linear algebra on one thread with as many as it likes."""
    start = time.perf_counter()
    diagnose(problem)
    middle = time.perf_counter()
    with patch.object(threadpoolctl, "threadpool_limits", lambda *_, **__: nullcontext()):
        diagnose(problem)
    end = time.perf_counter()
    tell("threads", middle - start, end - middle)


def tell(what: str, fast: float, slow: float) -> None:
    print(f"{what}: {fast:.3g} s against {slow:.3g} s: ratio {slow / fast:.3g}", flush=True)


def main() -> None:
    parser = argparse.ArgumentParser()
    parser.add_argument("--rows", type=int, default=120)
    parser.add_argument("--log", type=Path)
    given = parser.parse_args()
    problem = case(given.rows)
    diagnose(problem)  # compiled or loaded before the clock starts
    start = time.perf_counter()
    ours = diagnose(problem)
    middle = time.perf_counter()
    with (
        patch.object(prediction, "readings_of", pose_by_pose),
        patch.object(scipy.optimize, "least_squares", own_differences),
    ):
        theirs = diagnose(problem)
    end = time.perf_counter()
    for name, found in (("ours", ours), ("pose by pose", theirs)):
        for finding in found.findings:
            values = {key: round(one.value, 5) for key, one in finding.parameters.items()}
            print(f"{name}: {finding.effect.key} {values}")
    tell("search", middle - start, end - middle)
    four_cables(given.rows)
    design(ours, load_catalogue(with_plugins=False).grades)
    if given.log:
        study = read_study(given.log)
        assert study.measurements is not None
        problem = case_of(study, study.measurements, read_measured(study))
    threads(problem)


OURS = prediction.readings_of
LEAST_SQUARES = scipy.optimize.least_squares

if __name__ == "__main__":
    main()
