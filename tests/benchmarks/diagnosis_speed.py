"""The whole diagnosis against the same search with SciPy pose by pose, in the same run.

    python tests/benchmarks/diagnosis_speed.py [--rows 120]

The baseline solves each pose by `scipy.optimize.root` and lets `least_squares` take its own
finite-difference Jacobians. Where a trial has pulleys, tilt or wind, the baseline keeps our solver,
which flatters it.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
import time
from pathlib import Path
from unittest.mock import patch

import numpy as np
import scipy.optimize
from scipy.optimize import root

sys.path.insert(0, str(Path(__file__).parents[1]))

from twins.dataset import make, size_for
from twins.robots import YARD3

from designer.config import read_study
from designer.diagnosis import predict
from designer.diagnosis.case import case_of
from designer.diagnosis.diagnose import Case, diagnose
from designer.effects.effect import Readings
from designer.measured.read import read_measured
from designer.robot import Poses
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


def main() -> None:
    parser = argparse.ArgumentParser()
    parser.add_argument("--rows", type=int, default=120)
    problem = case(parser.parse_args().rows)
    diagnose(problem)  # compiled or loaded before the clock starts
    start = time.perf_counter()
    ours = diagnose(problem)
    middle = time.perf_counter()
    with (
        patch.object(predict, "readings_of", pose_by_pose),
        patch.object(scipy.optimize, "least_squares", own_differences),
    ):
        theirs = diagnose(problem)
    end = time.perf_counter()
    for name, found in (("ours", ours), ("pose by pose", theirs)):
        for finding in found.findings:
            values = {key: round(one.value, 5) for key, one in finding.parameters.items()}
            print(f"{name}: {finding.effect.key} {values}")
    fast, slow = middle - start, end - middle
    print(f"{fast:.2f} s against {slow:.1f} s: ratio {slow / fast:.0f}")


OURS = predict.readings_of
LEAST_SQUARES = scipy.optimize.least_squares

if __name__ == "__main__":
    main()
