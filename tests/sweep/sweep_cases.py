"""A sweep over a study of one pose, which is solved in milliseconds."""

from __future__ import annotations

from pathlib import Path

STUDY = """robot:
  anchors: [[0, 0, 10], [20, 0, 10], [10, 17, 10]]
  platform: {mass: 100 kg}
cable: {density: 5290 kg/m^3, youngs_modulus: 60 GPa, allowable_stress: 200 MPa}
pose: [10, 6, 4]
"""
SWEEP = """study: crane.yaml
vary:
  robot.platform.mass: {from: 100 kg, to: 200 kg, count: 3}
  pose[2]: [4, 12, 5]
keep: [pose.optimum.diameter_m, pose.sagging.status]
"""


def written(folder: Path, sweep: str = SWEEP, study: str = STUDY) -> Path:
    """Write both files; returns the path of the sweep."""
    (folder / "crane.yaml").write_text(study)
    path = folder / "masses.yaml"
    path.write_text(sweep)
    return path
