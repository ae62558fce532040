"""Rows at the edge of what the cables hold do not settle a fit by poses known to a hair."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from twins.dataset import make
from twins.robots import YARD3

from designer.diagnosis.calibration import calibration_of
from designer.diagnosis.case import case_of
from designer.diagnosis.fit import fit
from designer.diagnosis.problem import Problem, readings_of
from designer.io.config import read_study
from designer.measured.read import read_measured
from designer.model.measured_data import Noise
from designer.model.robot import Poses

EDGE = 7
"""Place of the row next to the line between two exit points, where the third cable hangs slack."""


def calibrated(folder, *, y_m):
    """Return the calibration of the scale of poses, by exact poses and lengths to 1 mm."""
    make(YARD3, {}, rows=32, seed=5).write(folder)
    study = read_study(folder / "config.yaml")
    case = case_of(study, study.measurements, read_measured(study))
    position = case.measured.poses.position_m.copy()
    position[EDGE] = [15.0, y_m, 5.0]
    true = readings_of(case.machine, Poses.at(position))
    length = true.length_m + 0.001 * np.random.default_rng(4).normal(size=position.shape)
    unread = np.full_like(length, np.nan)
    measured = replace(
        case.measured, poses=Poses.at(position), length_m=length, tension_N=unread, settled=True
    )
    case = replace(case, measured=measured)
    problem = Problem(measured, case.predictor(), Noise(0.001, 4.0, "declared"))
    (scale,) = (e for e in case.candidates if e.id == "pose_scale")
    fitted = fit(problem, [scale], np.ones(32, dtype=np.bool_), thorough=True)
    return calibration_of(problem, fitted)


def test_a_slack_cable_does_not_make_the_scale_more_certain_than_poses_are(tmp_path):
    at_the_edge, within = (calibrated(tmp_path, y_m=y_m) for y_m in (0.03, 6.0))
    assert at_the_edge.edge_rows == (EDGE + 1,)
    assert within.edge_rows == ()
    (scale_there,), (scale_within,) = at_the_edge.parameters, within.parameters
    assert abs(scale_within.value - 1.0) < 3.0 * scale_within.std
    assert scale_there.std == pytest.approx(scale_within.std, rel=0.3)
