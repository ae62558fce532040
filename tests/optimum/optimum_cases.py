"""Optimisations of small studies: of one pose, solved in milliseconds, and of a whole yard."""

from __future__ import annotations

from pathlib import Path

from designer.optimum.optimise import Optimum, optimum_of
from designer.optimum.plan import OptimisationPlan, read_optimisation

STUDY = """# a small crane
robot:
  anchors: [[0, 0, 10], [20, 0, 10 m], [10, 17, 10]]  # mast tops
  platform: {mass: 100 kg}
cable: {density: 5290 kg/m^3, youngs_modulus: 60 GPa, allowable_stress: 200 MPa}
pose: [10, 6, 4]
"""
OF_POSE = """study: crane.yaml
objective: {minimise: pose.sagging.max_tension_N}
variables:
  shift: {fields: [robot.anchors.*.0], offset: [-4 m, 6 m]}
  robot.anchors[*][2]: [6 m, 12 m]
budget: {evaluations: 150}
"""
YARD = (
    STUDY
    + """workspace:
  region: {prism: anchors, inset: 2 m, z: [1, 7]}
  samples: 200
  proof: 0 s
selection: {grades: [unirope-7x19-galvanised]}
"""
)
OF_YARD = """study: crane.yaml
objective: rope_mass
variables:
  width: {fields: {robot.anchors.0.0: -1, robot.anchors.1.0: 1}, offset: [-1 m, 2 m]}
budget: {evaluations: 12}
starts: 1
samples: 100
"""


def written(folder: Path, plan: str = OF_POSE, study: str = STUDY) -> Path:
    """Write both files; returns the path of the optimisation."""
    (folder / "crane.yaml").write_text(study)
    path = folder / "masts.yaml"
    path.write_text(plan)
    return path


def plan_of(folder: Path, plan: str = OF_POSE, study: str = STUDY) -> OptimisationPlan:
    """Write both files, and read them."""
    return read_optimisation(written(folder, plan, study), with_plugins=False)


def optimum(folder: Path, plan: str = OF_POSE, study: str = STUDY) -> Optimum:
    """Write both files, and find the optimum."""
    return optimum_of(plan_of(folder, plan, study))
