"""Data sets as a measuring campaign on a twin would bring them home, and their files."""

from __future__ import annotations

import json
from collections.abc import Iterable
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import yaml

from twins.effects import Effects, Parameters, Scene, as_seen, predict, swayed
from twins.robots import TwinRobot

ROWS_PER_PASS = 30
SECONDS_PER_POSE = 320.0
DAY_S = 86400.0
MOST_PER_K = 5e-5
"""No rope and no drum of a twin, all of metal, expands by more."""


@dataclass(frozen=True)
class DataSet:
    """One campaign; readings (rows, cables), NaN where missing.

    Parameters
    ----------
    effects : dict
        What is in the machine: effect id to parameters.
    scene : Scene
        Times, poses, surroundings.
    clean_length_m, clean_tension_N, length_m, tension_N : array
        Readings without and with noise, outliers and gaps.
    outlier_length, outlier_tension : bool array
        Readings that are outliers.
    noise : float
        Actual noise over the robot's usual noise.
    """

    robot: TwinRobot
    effects: Effects
    scene: Scene
    clean_length_m: np.ndarray
    clean_tension_N: np.ndarray
    length_m: np.ndarray
    tension_N: np.ndarray
    outlier_length: np.ndarray
    outlier_tension: np.ndarray
    noise: float = 1.0

    @property
    def settled(self) -> bool:
        """Whether the platform stood still for each row."""
        return self.scene.motion is None

    def columns(self, quantities: Iterable[str] = ("length", "tension")) -> dict[str, list[str]]:
        """Return the columns of ``measured.csv`` as text; '' where missing."""
        scene, axes = as_seen(self.scene, self.effects), "xyz"
        table = {"time_s": _text(scene.time_s, ".4f")}
        table |= {f"{a}_m": _text(scene.position_m[:, k], ".6f") for k, a in enumerate(axes)}
        if self.robot.attachment_m:
            turn = scene.rotation_vector_rad
            table |= {f"r{a}_rad": _text(turn[:, k], ".9f") for k, a in enumerate(axes)}
        readings = {"length": ("m", self.length_m, ".6f"), "tension": ("N", self.tension_N, ".3f")}
        for quantity in quantities:
            unit, values, form = readings[quantity]
            for k in range(self.robot.cables):
                table[f"{quantity}_{k + 1}_{unit}"] = _text(values[:, k], form)
        table["temperature_C"] = _text(scene.temperature_C, ".3f")
        for k, a in enumerate(axes):
            table[f"wind_{a}_m_per_s"] = _text(scene.wind_m_per_s[:, k], ".4f")
        return table

    def config(self) -> dict:
        """Return the config that knows nothing of the effects."""
        robot = self.robot
        platform: dict = {"mass": f"{robot.mass_kg} kg"}
        if robot.attachment_m:
            platform["attachments"] = [list(point) for point in robot.attachment_m]
            platform["centre_of_mass"] = list(robot.centre_m)
        scale = self.noise or 1.0
        return {
            "name": robot.name,
            "robot": {"anchors": [list(point) for point in robot.exit_m], "platform": platform},
            "cable": {
                "density": "7800 kg/m^3",
                "youngs_modulus": "200 GPa",
                "allowable_stress": "180 MPa",
            },
            "pose": list(robot.pose_m),
            "workspace": {
                "region": {"box": [list(side) for side in robot.box_m]},
                "samples": 400,
            },
            "selection": {"grades": "all", "safety_factor": 5},
            "measurements": {
                "file": "measured.csv",
                "settled": self.settled,
                "cable": {
                    "linear_mass": f"{robot.linear_mass} kg/m",
                    "axial_stiffness": f"{robot.stiffness_N:.0f} N",
                },
                "noise": {
                    "length": f"{scale * robot.noise_m:g} m",
                    "tension": f"{scale * robot.noise_N:g} N",
                },
            },
        }

    def write(self, folder: Path, quantities: Iterable[str] = ("length", "tension")) -> Path:
        """Write ``measured.csv``, ``config.yaml`` and ``truth.json``; return the config's path."""
        folder.mkdir(parents=True, exist_ok=True)
        table = self.columns(quantities)
        rows = [",".join(table), *map(",".join, zip(*table.values(), strict=True))]
        (folder / "measured.csv").write_text("\n".join(rows) + "\n", encoding="utf-8")
        truth = {"robot": self.robot.name, "effects": self.effects, "noise": self.noise}
        (folder / "truth.json").write_text(json.dumps(truth, indent=1), encoding="utf-8")
        path = folder / "config.yaml"
        text = yaml.safe_dump(self.config(), sort_keys=False, default_flow_style=None)
        path.write_text(text, encoding="utf-8")
        return path


def make(
    robot: TwinRobot,
    effects: Effects | Iterable[str] = (),
    parameters: dict[str, Parameters] | Parameters | None = None,
    rows: int = 120,
    seed: int = 0,
    settled: bool = True,
    noise: float = 1.0,
    missing: float = 0.0,
    outliers: float = 0.0,
    repeats: int = 0,
    order: str = "passes",
) -> DataSet:
    """Return a campaign on a machine with these effects.

    Parameters
    ----------
    effects, parameters
        Effect ids, and their parameters by id; for one effect its parameters alone will do, and
        a dict of ids and parameters needs no second argument.
    noise : float
        Noise over the robot's usual noise.
    missing, outliers : float
        Fraction of the readings that are lost, or off by 8 to 60 times the noise.
    repeats : int
        How many of the rows return to a pose seen before (settled only).
    order : {"passes", "random"}
        Settled poses are visited in tours over the whole box, or in no order.
    """
    names = [effects] if isinstance(effects, str) else list(effects)
    given = effects if isinstance(effects, dict) else parameters or {}
    if len(names) == 1 and names[0] not in given:
        given = {names[0]: given}
    present = {name: dict(given[name]) for name in names}
    rng = np.random.default_rng(seed)
    scene = _settled(robot, rows, rng, repeats, order) if settled else _moving(robot, rows, rng)
    if robot.free:
        scene = swayed(robot, present, swayed(robot, {}, scene, chords=True))
    length, tension = predict(robot, present, scene)
    read_m, wild_m = _spoil(length, noise * robot.noise_m, missing, outliers, rng)
    read_N, wild_N = _spoil(tension, noise * robot.noise_N, missing, outliers, rng)
    return DataSet(
        robot, present, scene, length, tension, read_m, read_N, wild_m, wild_N, noise
    )  # fmt: skip


def effect_size(dataset: DataSet, effect: str | None = None) -> float:
    """Return the rms of what an effect (or all of them) changes in the readings, over the noise.

    Of an effect on the poses: the change from the readings in the poses that are seen.
    """
    kept = {k: v for k, v in dataset.effects.items() if effect is not None and k != effect}
    seen = as_seen(dataset.scene, {k: v for k, v in dataset.effects.items() if k not in kept})
    length, tension = predict(dataset.robot, kept, seen)
    scale = dataset.noise or 1.0
    change_m = (dataset.clean_length_m - length) / (scale * dataset.robot.noise_m)
    change_N = (dataset.clean_tension_N - tension) / (scale * dataset.robot.noise_N)
    return float(np.sqrt(np.mean(np.concatenate([change_m, change_N]) ** 2)))


def size_for(
    robot: TwinRobot, effect: str, over_noise: float, seed: int = 0, **how: object
) -> float:
    """Return the size, for `TwinRobot.draw`, of an effect that is this many times the noise.

    ``how`` goes to `make`. Compare with ``robot.sizes`` to see whether that size is plausible.
    Raises ValueError where nothing up to ten times the largest plausible size does it.
    """
    blank = make(robot, seed=seed, **how)
    size = float(np.sqrt(np.prod(robot.sizes[effect])))
    for _ in range(12):
        trial = {effect: robot.draw(effect, size, seed)}
        try:
            length, tension = predict(robot, trial, blank.scene)
        except RuntimeError:  # so large that some pose has no equilibrium
            size *= 0.3
            continue
        found = effect_size(
            replace(blank, effects=trial, clean_length_m=length, clean_tension_N=tension)
        )
        if "_expansion" in effect and size > MOST_PER_K:
            break
        if abs(found / over_noise - 1) < 0.01:
            return size
        if found == 0 or size > 10 * robot.sizes[effect][1]:
            break
        size *= min(max(over_noise / found, 0.1), 10.0)
    raise ValueError(f"{effect} on {robot.name} cannot be {over_noise} times the noise")


def _settled(
    robot: TwinRobot, rows: int, rng: np.random.Generator, repeats: int, order: str
) -> Scene:
    low, high = np.array(robot.box_m).T
    position = rng.uniform(low, high, (rows, 3))
    turn = robot.turn_rad * rng.normal(size=(rows, 3))
    if order == "passes":
        tours = [
            start + _tour((position[start : start + ROWS_PER_PASS] - low) / (high - low))
            for start in range(0, rows, ROWS_PER_PASS)
        ]
        position, turn = position[np.concatenate(tours)], turn[np.concatenate(tours)]
    if repeats:
        again = np.sort(rng.choice(np.arange(1, rows), repeats, replace=False))
        for row, before in zip(again, rng.integers(0, again), strict=True):
            position[row], turn[row] = position[before], turn[before]
    gaps = SECONDS_PER_POSE * rng.uniform(0.4, 1.6, rows)
    time = np.cumsum(gaps)
    return Scene(time, position, turn, *_weather(time, rng))


def _tour(points: np.ndarray) -> np.ndarray:
    """Order in which a greedy traveller visits points (n, 3), from the first."""
    order, left = [0], list(range(1, len(points)))
    while left:
        distance = np.linalg.norm(points[left] - points[order[-1]], axis=1)
        order.append(left.pop(int(np.argmin(distance))))
    return np.array(order)


def _moving(robot: TwinRobot, rows: int, rng: np.random.Generator) -> Scene:
    """Three slow oscillations an axis, about two periods in 120 rows."""
    low, high = np.array(robot.box_m).T
    rate = 2 * np.pi / robot.period_s * rng.uniform(0.5, 1.5, (6, 3))
    phase = rng.uniform(0, 2 * np.pi, (6, 3))
    share = rng.dirichlet(np.ones(3), 6)
    reach = np.concatenate([(high - low) / 2, np.full(3, 2 * robot.turn_rad)])

    def motion(time_s: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        wave = (share * np.sin(rate * time_s[:, None, None] + phase)).sum(-1) * reach
        return (low + high) / 2 + wave[:, :3], wave[:, 3:]

    time = robot.period_s / 60 * np.arange(1, rows + 1)
    return Scene(time, *motion(time), *_weather(time, rng), motion=motion)


def _weather(time_s: np.ndarray, rng: np.random.Generator) -> tuple[np.ndarray, np.ndarray]:
    """Temperature from a morning on, 15 to 30 °C, and level wind with gusts of about a minute."""
    day = time_s / DAY_S + rng.uniform(0.0, 0.1)
    drift = 22.0 - 6.5 * np.cos(2 * np.pi * day)
    temperature = np.clip(drift + rng.normal(0, 0.4, len(time_s)), 15.0, 30.0)
    wind = np.zeros((len(time_s), 3))
    wind[:, :2] = _gusts(time_s, rng) + np.array([4.0, 0.0])
    return temperature, wind


def _gusts(time_s: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    gust = 3.0 * rng.normal(size=(len(time_s), 2))
    kept = np.exp(-np.diff(time_s) / 60.0)
    for row, share in enumerate(kept, 1):
        gust[row] = share * gust[row - 1] + np.sqrt(1 - share**2) * gust[row]
    return gust


def _spoil(
    clean: np.ndarray, noise: float, missing: float, outliers: float, rng: np.random.Generator
) -> tuple[np.ndarray, np.ndarray]:
    """Add noise, outliers and gaps; also tell which readings are outliers."""
    reading = clean + noise * rng.normal(size=clean.shape)
    wild = rng.random(clean.shape) < outliers
    leap = rng.choice([-1, 1], clean.shape) * rng.uniform(8, 60, clean.shape)
    reading = reading + np.where(wild, noise * leap, 0.0)
    lost = rng.random(clean.shape) < missing
    return np.where(lost, np.nan, reading), wild & ~lost


def _text(values: np.ndarray, form: str) -> list[str]:
    return ["" if np.isnan(value) else format(value, form) for value in values.tolist()]
