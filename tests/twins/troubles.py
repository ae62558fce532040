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

FREEDOM = 3
"""Degrees of freedom of Student's t."""

Shape = tuple[int, ...]
Draw = Callable[[np.random.Generator, Shape], np.ndarray]
"""Noise in units of the usual one, of a shape (rows, cables)."""
Trouble = Callable[[TwinRobot, float, int], DataSet]


def noisy(
    robot: TwinRobot, draw: Draw, seed: int, rows: int = 120, *, settled: bool = True
) -> DataSet:
    """Return a machine without effects, read with noise drawn in units of the usual one."""
    clean = make(robot, seed=seed, noise=0.0, rows=rows, settled=settled)
    rng, shape = np.random.default_rng([seed, 1]), clean.length_m.shape
    return _with(
        replace(clean, noise=1.0),
        clean.length_m + robot.noise_m * draw(rng, shape),
        clean.tension_N + robot.noise_N * draw(rng, shape),
    )


def _white(rng: np.random.Generator, shape: Shape) -> np.ndarray:
    return rng.normal(size=shape)


def _lasting(decay: float) -> Draw:
    """Noise of unit variance of which that share is left one row later, from the first row on."""

    def draw(rng: np.random.Generator, shape: Shape) -> np.ndarray:
        white = rng.normal(size=shape)
        white[1:] *= np.sqrt(1.0 - decay**2)
        return np.asarray(lfilter([1.0], [1.0, -decay], white, axis=0))

    return draw


def _student(rng: np.random.Generator, shape: Shape) -> np.ndarray:
    return rng.standard_t(FREEDOM, shape)


def _quantised(rng: np.random.Generator, shape: Shape) -> np.ndarray:
    """A display that shows every second multiple of the noise."""
    return np.round(rng.normal(size=shape) / 2.0) * 2.0


def _walk(rng: np.random.Generator, shape: Shape) -> np.ndarray:
    """White noise beside a random walk that goes as far as it within ten rows."""
    return rng.normal(size=shape) + np.cumsum(rng.normal(size=shape), axis=0) / np.sqrt(10.0)


NO_EFFECT: dict[str, Draw] = {
    "white": _white,
    "Student": _student,
    "AR0.5": _lasting(0.5),
    "AR0.9": _lasting(0.9),
    "AR0.97": _lasting(0.97),
    "quantised": _quantised,
    "walk": _walk,
}
"""Noise of unit size: nothing is wrong with the machine."""


def _with(dataset: DataSet, length_m: np.ndarray, tension_N: np.ndarray) -> DataSet:
    return replace(dataset, length_m=length_m, tension_N=tension_N)


def _serial(robot: TwinRobot, size: float, seed: int) -> DataSet:
    """Noise of the declared size that lasts over some ten rows."""
    return noisy(robot, _sized("AR0.9", size), seed)


def _heavy(robot: TwinRobot, size: float, seed: int) -> DataSet:
    return noisy(robot, _sized("Student", size), seed)


def _sized(kind: str, size: float) -> Draw:
    return lambda rng, shape: size * NO_EFFECT[kind](rng, shape)


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


def _off_centre(robot: TwinRobot, size: float, seed: int) -> DataSet:
    """A drum whose axis is not in its middle: a turn of it winds now more, now less."""
    rng = np.random.default_rng([seed, 10])
    dataset = make(robot, seed=seed)
    length = dataset.length_m.copy()
    cable = int(rng.integers(robot.cables))
    turn_m = rng.uniform(0.05, 0.15) * float(np.ptp(dataset.clean_length_m[:, cable]))
    phase = 2.0 * np.pi * (dataset.clean_length_m[:, cable] / turn_m + rng.uniform())
    length[:, cable] += size * robot.noise_m * np.sin(phase)
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
    "Student noise": (_heavy, 1.0),
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
    "off centre": (_off_centre, 3.5),
}
"""Something is wrong, and must not be taken for something else."""

TROUBLES = NOISES | FAILURES


def troubled(robot: TwinRobot, kind: str, seed: int) -> DataSet:
    """Return a data set with a trouble, of the size that is usual for it."""
    trouble, size = TROUBLES[kind]
    return trouble(robot, size, seed)
