"""Logs as machines of others write them: their own columns, units and zero points.

Two machines: a platform that hangs on four cables and sways, and a printer's head on four lines,
one of them to spare.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
from scipy.optimize import root
from scipy.spatial.transform import Rotation

HANGING_EXIT_M = np.array([[-2.0, -6.0, 8.4], [2.0, -6.0, 8.5], [2.2, 5.0, 8.3], [-1.9, 5.0, 8.4]])
HANGING_ARM_M = np.array([[-0.3, -0.2, 0.0], [0.3, -0.2, 0.0], [0.3, 0.2, 0.0], [-0.3, 0.2, 0.0]])
HANGING_CENTRE_M = np.array([0.0, 0.0, -0.15])
HANGING_MASS_KG = 5.0
CLOCK_OFFSET_S = 0.06
HOMING_M = np.array([0.021, -0.034, 0.012, 0.017])
"""Constant that each winch adds, unknown to the study."""

HANGING_STUDY = f"""\
name: hanging platform
robot:
  anchors: {HANGING_EXIT_M.tolist()}
  platform:
    mass: {HANGING_MASS_KG} kg
    attachments: {HANGING_ARM_M.tolist()}
    centre_of_mass: {HANGING_CENTRE_M.tolist()}
cable: {{density: 7800 kg/m^3, youngs_modulus: 200 GPa, allowable_stress: 180 MPa}}
measurements:
  file: log.csv
  settled: false
  unknown: [length_offset]
  columns:
    stamp_ms: {{to: time_s, unit: ms}}
    qw: quaternion_w
    qx: quaternion_x
    qy: quaternion_y
    qz: quaternion_z
    L1_m: length_1_m
    L2_m: length_2_m
    L3_m: length_3_m
    L4_m: length_4_m
    marker_m: ignore
  cable: {{linear_mass: 1e-6 kg/m, axial_stiffness: 1e5 N}}
"""


def hanging(position_m: np.ndarray, yaw_rad: np.ndarray) -> tuple[Rotation, np.ndarray]:
    """Return how a platform on four straight cables tilts, and the unstrained lengths (rows, 4).

    Position and heading are driven; two angles of tilt and four tensions follow from balance.
    """
    vectors, lengths = [], []
    weight_N = np.array([0.0, 0.0, -9.81 * HANGING_MASS_KG])
    guess = np.array([0.0, 0.0, *np.full(4, 13.0)])
    for position, yaw in zip(position_m, yaw_rad, strict=True):

        def pulls(unknown: np.ndarray, position=position, yaw=yaw):
            turn = Rotation.from_rotvec([unknown[0], unknown[1], yaw])
            arm = turn.apply(HANGING_ARM_M)
            chord = HANGING_EXIT_M - position - arm
            return turn, arm, chord, np.linalg.norm(chord, axis=1)

        def unbalance(unknown: np.ndarray, pulls=pulls) -> np.ndarray:
            turn, arm, chord, span = pulls(unknown)
            force = unknown[2:, None] * chord / span[:, None]
            moment = np.cross(arm, force).sum(axis=0)
            moment += np.cross(turn.apply(HANGING_CENTRE_M), weight_N)
            return np.concatenate([force.sum(axis=0) + weight_N, moment])

        answer = root(unbalance, guess, tol=1e-12)
        assert answer.success
        guess = answer.x
        turn, _, _, span = pulls(guess)
        vectors.append(turn.as_rotvec())
        lengths.append(span / (1.0 + guess[2:] / 1e5))
    return Rotation.from_rotvec(vectors), np.array(lengths)


def write_hanging(folder: Path, rows: int = 80, seed: int = 0) -> Path:
    """Write the log of the swaying platform and its study; return the study's path.

    The winches' clock lags that of the cameras, and each winch was homed at an unknown length.
    """
    rng = np.random.default_rng(seed)
    rate, phase = rng.uniform(0.15, 0.5, (3, 4)), rng.uniform(0.0, 2.0 * np.pi, (3, 4))

    def path(time: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        wave = np.sin(rate * time[:, None, None] + phase).sum(axis=1) / 3.0
        wave *= 1.0 - np.exp(-((np.maximum(time, 0.0)[:, None] / 3.0) ** 3))  # from rest
        return np.array([0.1, -0.5, 3.0]) + wave[:, :3] * [0.9, 2.5, 1.0], 0.2 * wave[:, 3]

    time = 0.25 * np.arange(rows)
    position = path(time)[0]
    turn, _ = hanging(*path(time))
    _, length = hanging(*path(time - CLOCK_OFFSET_S))
    length += HOMING_M + rng.normal(0.0, 1e-3, length.shape)
    quaternion = turn.as_quat(scalar_first=True)
    names = "stamp_ms,x_m,y_m,z_m,qw,qx,qy,qz,L1_m,L2_m,L3_m,L4_m,marker_m"
    table = np.column_stack([1e3 * time, position, quaternion, length, length[:, 0]])
    return _written(folder, names, [[f"{x:.7f}" for x in row] for row in table], HANGING_STUDY)


PRINTER_EXIT_M = np.array(
    [[0.0, -1.6, -0.1], [1.3, 1.2, -0.15], [-1.4, 0.75, -0.15], [0.0, 0.0, 2.3]]
)
ORIGIN_M = np.linalg.norm(PRINTER_EXIT_M, axis=1)
"""Length of each line where the head is at the origin and the motors stand at zero."""
DEGREES_PER_M = 20_000.0

PRINTER_STUDY = f"""\
name: line printer
robot:
  anchors: {PRINTER_EXIT_M.tolist()}
  platform: {{mass: 2 kg}}
cable: {{density: 1000 kg/m^3, youngs_modulus: 50 GPa, allowable_stress: 500 MPa}}
measurements:
  file: log.csv
  unknown: [length_offset]
  columns:
    x_mm: {{to: x_m, unit: mm}}
    y_mm: {{to: y_m, unit: mm}}
    z_mm: {{to: z_m, unit: mm}}
    motorA_deg: {{to: length_1_m, scale: {1 / DEGREES_PER_M}, offset: {ORIGIN_M[0]}}}
    motorB_deg: {{to: length_2_m, scale: {1 / DEGREES_PER_M}, offset: {ORIGIN_M[1]}}}
    motorC_deg: {{to: length_3_m, scale: {1 / DEGREES_PER_M}, offset: {ORIGIN_M[2]}}}
    motorD_deg: {{to: length_4_m, scale: {1 / DEGREES_PER_M}, offset: {ORIGIN_M[3]}}}
    current: ignore
    row: ignore
  cable: {{linear_mass: 1 g/m, axial_stiffness: 20 kN}}
"""


def write_printer(folder: Path, *, drum_scale: float, rows: int = 26, seed: int = 0) -> Path:
    """Write the log of the printer and its study; return the study's path.

    Motor angles instead of lengths, a column of text, and two rows without a pose. The winches
    count ``drum_scale`` times the true length. How tight the lines are is up to the motors.
    """
    rng = np.random.default_rng(seed)
    position = rng.uniform([-0.3, -0.3, 0.05], [0.3, 0.3, 0.8], (rows, 3))
    chord = PRINTER_EXIT_M - position[:, None]
    span = np.linalg.norm(chord, axis=2)
    pull = (chord / span[..., None]).transpose(0, 2, 1)
    least_N = np.linalg.pinv(pull) @ [0.0, 0.0, 2.0 * 9.81]
    inner = np.linalg.svd(pull)[2][:, -1]
    inner /= inner[:, 3:]  # the line to the ceiling pulls up, the others then down
    assert inner.min() > 0.0
    wanted_N = rng.uniform(10.0, 15.0, (rows, 1))
    tension_N = least_N + inner * ((wanted_N - least_N) / inner).max(axis=1, keepdims=True)
    counted_m = drum_scale * span / (1.0 + tension_N / 20e3)
    angle = DEGREES_PER_M * (counted_m + rng.normal(0.0, 1e-3, span.shape) - ORIGIN_M)
    cells = [
        [str(k), *(f"{1e3 * x:.4f}" for x in pose), "camera", *(f"{a:.3f}" for a in motor), "0.7"]
        for k, (pose, motor) in enumerate(zip(position, angle, strict=True))
    ]
    for row in cells[-2:]:
        row[1:5] = ["", "", "", "none"]
    names = "row,x_mm,y_mm,z_mm,source,motorA_deg,motorB_deg,motorC_deg,motorD_deg,current"
    return _written(folder, names, cells, PRINTER_STUDY)


def _written(folder: Path, names: str, rows: list[list[str]], study: str) -> Path:
    table = "\n".join([names, *map(",".join, rows)]) + "\n"
    (folder / "log.csv").write_text(table, encoding="utf-8")
    path = folder / "study.yaml"
    path.write_text(study, encoding="utf-8")
    return path
