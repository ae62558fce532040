"""How far readings are trusted, where internal forces are taken from them."""

from __future__ import annotations

import numpy as np
import pytest

from designer.diagnosis.case import case_of
from designer.diagnosis.fit import fit
from designer.diagnosis.problem import Problem
from designer.io.config import read_study
from designer.measured.read import read_measured
from designer.model.measurements import Noise

STUDY = """
name: tripod with a line from above
robot:
  anchors: [[0, -1.8, -0.1], [1.6, 1.0, -0.1], [-1.6, 1.0, -0.1], [0, 0, 2.6]]
  platform: {mass: 3 kg}
cable: {density: 1000 kg/m^3, youngs_modulus: 50 GPa, allowable_stress: 500 MPa}
workspace: {region: {box: [[-0.4, 0.4], [-0.4, 0.4], [0, 1]]}, samples: 100}
measurements:
  file: measured.csv
  unknown: [anchors, length_offset]
  cable: {linear_mass: 1 g/m, axial_stiffness: 30 kN}
  noise: {length: 0.5 mm}
"""


def write_lengths(folder) -> None:
    """Lengths of taut cables that are read with an error no effect has, from anchors elsewhere."""
    rng = np.random.default_rng(10)
    exits_m = np.array([[0, -1.8, -0.1], [1.6, 1.0, -0.1], [-1.6, 1.0, -0.1], [0, 0, 2.6]])
    exits_m += rng.normal(scale=0.03, size=exits_m.shape)
    positions_m = rng.uniform([-0.4, -0.4, 0.0], [0.4, 0.4, 1.0], (40, 3))
    true_m = np.linalg.norm(exits_m - positions_m[:, None], axis=-1)
    read_m = true_m - 0.006 * (true_m - np.linalg.norm(exits_m, axis=1)) ** 2
    read_m += rng.normal(scale=0.0005, size=true_m.shape)
    head = ",".join(["x_m", "y_m", "z_m", *(f"length_{k}_m" for k in range(1, 5))])
    table = np.hstack([positions_m, read_m])
    np.savetxt(folder / "measured.csv", table, delimiter=",", header=head, comments="")


@pytest.mark.slow
@pytest.mark.parametrize("key", ["drum_scale", "tension_length"])
def test_one_more_effect_leaves_no_more_than_the_model_without_it(key, tmp_path) -> None:
    write_lengths(tmp_path)
    (tmp_path / "study.yaml").write_text(STUDY, encoding="utf-8")
    study = read_study(tmp_path / "study.yaml")
    case = case_of(study, study.measurements, read_measured(study))
    problem = Problem(case.measured, case.predictor(), Noise(0.0005, 1.0, "declared"))
    rows = np.ones(case.measured.n_rows, dtype=np.bool_)
    present = fit(problem, case.given, rows, thorough=True)
    (effect,) = (e for e in case.candidates if e.key == key)
    more = fit(problem, [*case.given, effect], rows, present.settings, anew=True)
    assert more.loss < 1.001 * present.loss
