"""Data sets as they come from machines with troubles: noise of other kinds, and failing sensors.

Each trouble takes a robot, a size in units of the usual noise, and a seed; poses are settled.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from scipy.signal import lfilter

from twins.dataset import DataSet, make, size_for
from twins.effects import predict
from twins.robots import TwinRobot

LASTS = 0.9
"""Correlation of serially correlated noise from row to row."""
FREEDOM = 3
"""Degrees of freedom of Student's t."""

Trouble = Callable[[TwinRobot, float, int], DataSet]


def _noisy(robot: TwinRobot, seed: int, draw: Callable[..., np.ndarray]) -> DataSet:
    clean = make(robot, seed=seed, noise=0.0)
    shape = clean.length_m.shape
    return _with(
        replace(clean, noise=1.0),
        clean.length_m + robot.noise_m * draw(shape),
        clean.tension_N + robot.noise_N * draw(shape),
    )


def _with(dataset: DataSet, length_m: np.ndarray, tension_N: np.ndarray) -> DataSet:
    return replace(dataset, length_m=length_m, tension_N=tension_N)


def _serial(robot: TwinRobot, size: float, seed: int) -> DataSet:
    """Noise of the declared size that lasts over some ten rows."""
    rng = np.random.default_rng([seed, 1])

    def draw(shape: tuple[int, ...]) -> np.ndarray:
        white = rng.normal(size=shape) * np.sqrt(1 - LASTS**2)
        return size * np.asarray(lfilter([1.0], [1.0, -LASTS], white, axis=0))

    return _noisy(robot, seed, draw)


def _student(robot: TwinRobot, size: float, seed: int) -> DataSet:
    rng = np.random.default_rng([seed, 2])
    return _noisy(robot, seed, lambda shape: size * rng.standard_t(FREEDOM, shape))


def _pose(robot: TwinRobot, size: float, seed: int) -> DataSet:
    """Poses that are measured no better than this, as if lengths were."""
    rng = np.random.default_rng([seed, 3])
    dataset = make(robot, seed=seed)
    off = size * robot.noise_m
    scene = dataset.scene
    place = scene.position_m + off * rng.normal(size=scene.position_m.shape)
    turn = scene.rotation_vector_rad
    if robot.attachment_m:
        reach = float(np.linalg.norm(robot.attachment_m, axis=1).max())
        turn = turn + off / reach * rng.normal(size=turn.shape)
    return replace(dataset, scene=replace(scene, position_m=place, rotation_vector_rad=turn))


def _gusts(robot: TwinRobot, size: float, seed: int) -> DataSet:
    """Wind on the platform that changes from row to row, and that nobody recorded."""
    rng = np.random.default_rng([seed, 4])
    dataset = make(robot, seed=seed)
    wind = np.zeros((len(dataset.scene.time_s), 3))
    wind[:, :2] = 5.0 * rng.normal(size=(len(wind), 2))
    scene = replace(dataset.scene, wind_m_per_s=wind)

    def pushed(area_m2: float) -> tuple[np.ndarray, np.ndarray]:
        length, tension = predict(robot, {"wind_drag": {"drag_area_m2": area_m2}}, scene)
        return length - dataset.clean_length_m, tension - dataset.clean_tension_N

    per_area = pushed(0.1)
    over_noise = _size(robot, *per_area) / 0.1
    return _with(
        dataset, *(a + b for a, b in zip(
            (dataset.length_m, dataset.tension_N), pushed(size / over_noise), strict=True))
    )  # fmt: skip


def _saturation(robot: TwinRobot, size: float, seed: int) -> DataSet:
    """A load cell that reads no more than its range, in the upper sixth of its readings."""
    rng = np.random.default_rng([seed, 5])
    dataset = make(robot, seed=seed)
    cable = int(rng.integers(robot.cables))
    tension = dataset.tension_N.copy()
    tension[:, cable] = np.minimum(tension[:, cable], np.quantile(tension[:, cable], 0.85))
    return _with(dataset, dataset.length_m, tension)


def _swapped(robot: TwinRobot, size: float, seed: int) -> DataSet:
    """Two load cells on each other's plugs."""
    rng = np.random.default_rng([seed, 6])
    dataset = make(robot, seed=seed)
    order = np.arange(robot.cables)
    one, other = rng.choice(robot.cables, 2, replace=False)
    order[[one, other]] = other, one
    return _with(dataset, dataset.length_m, dataset.tension_N[:, order])


def _step(robot: TwinRobot, size: float, seed: int) -> DataSet:
    """A load that is put on the platform in the middle of the campaign."""
    rng = np.random.default_rng([seed, 7])
    dataset = make(robot, seed=seed)
    mass_kg = size_for(robot, "platform_mass", size, seed)
    length, tension = predict(robot, {"platform_mass": {"offset_kg": mass_kg}}, dataset.scene)
    late = np.arange(len(length)) >= rng.integers(len(length) // 4, 3 * len(length) // 4)
    return _with(
        dataset,
        dataset.length_m + np.where(late[:, None], length - dataset.clean_length_m, 0.0),
        dataset.tension_N + np.where(late[:, None], tension - dataset.clean_tension_N, 0.0),
    )


def _slip(robot: TwinRobot, size: float, seed: int) -> DataSet:
    """A winch that slips once."""
    rng = np.random.default_rng([seed, 8])
    dataset = make(robot, seed=seed)
    length = dataset.length_m.copy()
    row = int(rng.integers(len(length) // 4, 3 * len(length) // 4))
    length[row:, int(rng.integers(robot.cables))] += size * robot.noise_m
    return _with(dataset, length, dataset.tension_N)


def _settlement(robot: TwinRobot, size: float, seed: int) -> DataSet:
    """A tower that sinks from the middle of the campaign on."""
    rng = np.random.default_rng([seed, 9])
    dataset = make(robot, seed=seed)
    cable = float(rng.integers(1, robot.cables + 1))
    share = np.clip((dataset.scene.progress - 0.65) / 0.1, 0.0, 1.0)[:, None]
    moved = {"anchor_offset": {"cable": cable, "x_m": 0.0, "y_m": 0.0, "z_m": -1e-3}}
    length, tension = predict(robot, moved, dataset.scene)
    change = length - dataset.clean_length_m, tension - dataset.clean_tension_N
    times = size / _size(robot, *change)
    return _with(
        dataset, dataset.length_m + times * share * change[0],
        dataset.tension_N + times * share * change[1],
    )  # fmt: skip


def _stiffening(robot: TwinRobot, size: float, seed: int) -> DataSet:
    toe = robot.draw("stiffening", size_for(robot, "stiffening", size, seed), seed)
    return make(robot, {"stiffening": toe}, seed=seed)


def _in_proportion(robot: TwinRobot, size: float, seed: int) -> DataSet:
    """Lengths that read wrong in proportion to tension."""
    per_N = robot.draw("tension_length", size_for(robot, "tension_length", size, seed), seed)
    return make(robot, {"tension_length": per_N}, seed=seed)


def _size(robot: TwinRobot, length_m: np.ndarray, tension_N: np.ndarray) -> float:
    """Root mean square in units of noise."""
    both = np.concatenate([length_m / robot.noise_m, tension_N / robot.noise_N])
    return float(np.sqrt(np.mean(both**2)))


NOISES: dict[str, tuple[Trouble, float]] = {
    "serial noise": (_serial, 1.0),
    "pose noise": (_pose, 3.0),
    "gusts": (_gusts, 3.0),
    "Student noise": (_student, 1.0),
}
"""Nothing is wrong with the machine: whatever is named is a false finding."""

FAILURES: dict[str, tuple[Trouble, float]] = {
    "saturation": (_saturation, 1.0),
    "stiffening": (_stiffening, 5.0),
    "tension error": (_in_proportion, 5.0),
    "step": (_step, 5.0),
    "slip": (_slip, 25.0),
    "settlement": (_settlement, 8.0),
    "swapped": (_swapped, 1.0),
}
"""Something is wrong, and must not be taken for something else."""

TROUBLES = NOISES | FAILURES


def troubled(robot: TwinRobot, kind: str, seed: int) -> DataSet:
    """Return a data set with a trouble, of the size that is usual for it."""
    trouble, size = TROUBLES[kind]
    return trouble(robot, size, seed)
