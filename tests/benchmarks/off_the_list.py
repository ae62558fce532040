"""What a diagnosis says of machines with an effect that is in no list, on simulated twins.

    python tests/benchmarks/off_the_list.py [--sets 60] [--first 0] [--kinds spring,hose,…]
                                            [--robots yard3,plaza4,hall6] [--verbose]

The twins come from physics that shares nothing with the product (`tests/twins`); the effect of each
set is of a kind below, 5 to 30 times the noise. A set is *bad* where the answer is "found" and a
physical effect of it has no rival, unless it is the one named in `NEAR`; *in part* where the answer
is not positive but names such an effect.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1]))

from twins import robots
from twins.dataset import DataSet, make
from twins.effects import MACHINE, Scene, predict
from twins.physics import Machine
from twins.robots import TwinRobot

PLAZA4 = replace(
    robots.YARD3,
    name="plaza4",
    exit_m=((-22.4, -21.9, 15.4), (23.2, -22.7, 15.1), (22.2, 23.4, 14.7), (-23.9, 22.5, 14.7)),
    mass_kg=620.0,
    linear_mass=0.55,
    stiffness_N=5.5e6,
    pose_m=(0.0, 0.0, 4.0),
    box_m=((-11, 11), (-11, 11), (1, 7)),
    noise_m=0.002,
    noise_N=15.0,
    set_cables=(3,),
)
ROBOTS = {"yard3": robots.YARD3, "plaza4": PLAZA4, "hall6": robots.HALL6}
ROWS = 72

Draw = np.random.Generator
OnMachine = Callable[[Machine, Scene, float, dict], Machine]
"""From a machine, the scene, a size and what was drawn (see `_drawn`) to the changed machine."""
OnReadings = Callable[[np.ndarray, np.ndarray, Scene, float, dict], tuple[np.ndarray, np.ndarray]]
"""From lengths and tensions to those that are read."""
OnPoses = Callable[[np.ndarray, Scene, float, dict], np.ndarray]
"""From positions to those that are measured."""


def _drawn(robot: TwinRobot, rng: Draw) -> dict:
    """What a kind may need of chance: a direction, two cables, a place beside the machine."""
    exits = np.array(robot.exit_m, dtype=float)
    one, other = rng.choice(robot.cables, 2, replace=False)
    level = rng.normal(size=2)
    angle = rng.uniform(0.0, 2.0 * np.pi)
    reach = 0.6 * np.ptp(exits, axis=0).max()
    return {
        "rng": rng,
        "cable": int(one),
        "other": int(other),
        "level": np.array([*level / np.linalg.norm(level), 0.0]),
        "beside": exits.mean(axis=0) + reach * np.array([np.cos(angle), np.sin(angle), 0.0]),
        "exits": exits,
        "middle": np.array(robot.pose_m, dtype=float),
    }


# --- the machine ---------------------------------------------------------------------------------


def _force(machine: Machine, force_N: np.ndarray) -> Machine:
    return replace(machine, force_N=machine.force_N + force_N)


def _hose(machine: Machine, scene: Scene, size: float, drawn: dict) -> Machine:
    """A hose pulls to one side."""
    return _force(machine, size * (drawn["level"] + [0.0, 0.0, -0.3])[None])


def _hose_at_the_rim(machine: Machine, scene: Scene, size: float, drawn: dict) -> Machine:
    """A hose that is held beside the platform's origin: it turns the platform as well."""
    pulled = _hose(machine, scene, size, drawn)
    arm_m = np.ptp(machine.attachment_m, axis=0).max() * (drawn["level"][[1, 0, 2]] + [0, 0, 0.3])
    return replace(pulled, moment_Nm=np.cross(arm_m, pulled.force_N))


def _hanging_hose(machine: Machine, scene: Scene, size: float, drawn: dict) -> Machine:
    """A hose from the floor: the higher the platform, the more of it hangs there."""
    height = scene.position_m[:, 2] - scene.position_m[:, 2].min()
    return _force(machine, -size * height[:, None] * [0.0, 0.0, 1.0])


def _spring(machine: Machine, scene: Scene, size: float, drawn: dict) -> Machine:
    """A gravity compensator: a spring to a point high above."""
    away = drawn["middle"] + [0.0, 0.0, 40.0] - scene.position_m
    length = np.linalg.norm(away, axis=1, keepdims=True)
    return _force(machine, size * (length - 30.0) * away / length)


def _tether(machine: Machine, scene: Scene, size: float, drawn: dict) -> Machine:
    """A cable chain beside the machine that pulls the more, the farther away."""
    away = drawn["beside"] - scene.position_m
    return _force(machine, size * away)


def _wind_of_the_day(machine: Machine, scene: Scene, size: float, drawn: dict) -> Machine:
    """Wind that nobody read, stronger as the day goes on."""
    gust = drawn["rng"].normal(0.0, 0.5, (len(scene.time_s), 1)) + 1.0
    return _force(machine, size * scene.progress[:, None] * gust * drawn["level"])


def _gusty(machine: Machine, scene: Scene, size: float, drawn: dict) -> Machine:
    """A steady wind that nobody read, whose gusts grow as the day goes on."""
    gusts = 0.7 * scene.progress[:, None] * drawn["rng"].normal(size=(len(scene.time_s), 2))
    return _force(machine, size * (drawn["level"] + np.pad(gusts, ((0, 0), (0, 1)))))


def _fuel(machine: Machine, scene: Scene, size: float, drawn: dict) -> Machine:
    """The platform becomes lighter as it works."""
    return replace(machine, mass_kg=machine.mass_kg - size * scene.progress)


def _leaning(machine: Machine, scene: Scene, size: float, drawn: dict) -> Machine:
    """A foundation that sinks on one side: gravity turns with time."""
    exits = np.repeat(machine.exit_m[:1], len(scene.time_s), axis=0)
    along = exits[0] @ drawn["level"]
    exits[..., 2] -= size * scene.progress[:, None] * (along - along.min())
    return replace(machine, exit_m=exits)


def _warm_masts(machine: Machine, scene: Scene, size: float, drawn: dict) -> Machine:
    """Masts that grow with temperature."""
    exits = np.repeat(machine.exit_m[:1], len(scene.time_s), axis=0)
    exits[..., 2] += size * (scene.temperature_C - 20.0)[:, None]
    return replace(machine, exit_m=exits)


def _swaying_mast(machine: Machine, scene: Scene, size: float, drawn: dict) -> Machine:
    """One mast that bends in the wind."""
    exits = np.repeat(machine.exit_m[:1], len(scene.time_s), axis=0)
    exits[:, drawn["cable"]] += size * scene.wind_m_per_s
    return replace(machine, exit_m=exits)


def _drying(machine: Machine, scene: Scene, size: float, drawn: dict) -> Machine:
    """Ropes that dry."""
    wet = 1.0 + size * np.exp(-3.0 * scene.progress)
    return replace(machine, linear_mass=machine.linear_mass * wet[:, None])


def _soft_when_warm(machine: Machine, scene: Scene, size: float, drawn: dict) -> Machine:
    """A modulus that falls with temperature."""
    soft = np.exp(-size * (scene.temperature_C - 20.0))
    return replace(machine, stiffness_N=machine.stiffness_N * soft[:, None])


# --- the sensors ---------------------------------------------------------------------------------


def _of(readings: np.ndarray, cable: int, change: np.ndarray) -> np.ndarray:
    changed = readings.copy()
    changed[:, cable] += change
    return changed


def _hot_drum(length, tension, scene, size, drawn):
    """Readings of the winches that grow with heat."""
    return length * (1.0 + size * (scene.temperature_C - 20.0)[:, None]), tension


def _curved_cell(length, tension, scene, size, drawn):
    """A load cell whose reading bends with the load."""
    own = tension[:, drawn["cable"]]
    return length, _of(tension, drawn["cable"], size * (own / own.mean()) ** 2)


def _warm_cell(length, tension, scene, size, drawn):
    """A load cell whose zero goes with temperature."""
    return length, _of(tension, drawn["cable"], size * (scene.temperature_C - 22.0))


def _crosstalk(length, tension, scene, size, drawn):
    """A load cell that feels its neighbour."""
    return length, _of(tension, drawn["cable"], size * tension[:, drawn["other"]])


def _slipping(length, tension, scene, size, drawn):
    """A winch that slips a little in every row."""
    return _of(length, drawn["cable"], size * scene.progress), tension


def _coarse(length, tension, scene, size, drawn):
    """Lengths that are shown in coarse steps."""
    return np.round(length / (size + 1e-12)) * (size + 1e-12), tension


def _edge(length, tension, scene, size, drawn):
    """A cable that rubs over an edge where the platform is far to one side."""
    side = (scene.position_m - drawn["middle"]) @ drawn["level"]
    return _of(length, drawn["cable"], size * np.maximum(side, 0.0) ** 2), tension


def _two_harmonics(length, tension, scene, size, drawn):
    """A gear whose error has two waves."""
    own = length[:, drawn["cable"]]
    wave = np.sin(2.1 * own) + 0.7 * np.sin(5.3 * own + 1.0)
    return _of(length, drawn["cable"], size * wave), tension


def _exchanged(length, tension, scene, size, drawn):
    """Two winches and their cells on each other's plugs from the middle on."""
    order = np.arange(length.shape[1])
    order[[drawn["cable"], drawn["other"]]] = drawn["other"], drawn["cable"]
    late = (np.arange(len(length)) >= len(length) // 2)[:, None]
    return np.where(late, length[:, order], length), np.where(late, tension[:, order], tension)


# --- the camera ----------------------------------------------------------------------------------


def _refraction(position, scene, size, drawn):
    """Heights off by the square of the distance."""
    distance = np.linalg.norm(position - drawn["beside"], axis=1, keepdims=True)
    return position + size * distance**2 * [0.0, 0.0, 1.0]


def _range_error(position, scene, size, drawn):
    """Ranges of the tracker off by the square of the distance."""
    away = position - drawn["beside"]
    return position + size * np.linalg.norm(away, axis=1, keepdims=True) * away


def _barrel(position, scene, size, drawn):
    """A camera above whose lens bends what is far from its axis."""
    off = (position - drawn["middle"]) * [1.0, 1.0, 0.0]
    return position + size * np.sum(off**2, axis=1, keepdims=True) * off


def _stale(position, scene, size, drawn):
    """A tracker that shows the pose before in some rows."""
    rows = drawn["rng"].choice(np.arange(1, len(position)), len(position) // 9, replace=False)
    seen = position.copy()
    seen[rows] = position[rows - 1]
    return seen


def _wrong_poses(position, scene, size, drawn):
    """Poses that are off by metres in some rows."""
    rows = drawn["rng"].choice(len(position), len(position) // 10, replace=False)
    seen = position.copy()
    far_m = 0.05 * np.ptp(drawn["exits"], axis=0).max()
    seen[rows] += far_m * drawn["rng"].normal(size=(len(rows), 3))
    return seen


def _blurred(position, scene, size, drawn):
    """Poses that are measured the worse, the farther from the tracker."""
    distance = np.linalg.norm(position - drawn["beside"], axis=1, keepdims=True)
    return position + size * distance * drawn["rng"].normal(size=position.shape)


def _beside_the_point(position, scene, size, drawn):
    """A marker beside the platform's origin, turned with the platform."""
    from scipy.spatial.transform import Rotation

    body = Rotation.from_rotvec(scene.rotation_vector_rad)
    return position + size * body.apply(drawn["level"] + [0.0, 0.0, 0.5])


MACHINES: dict[str, OnMachine] = {
    "hose": _hose, "hose at the rim": _hose_at_the_rim, "hanging hose": _hanging_hose,
    "spring": _spring, "tether": _tether,
    "wind of the day": _wind_of_the_day, "gusty": _gusty, "fuel": _fuel,
    "leaning": _leaning,
    "warm masts": _warm_masts, "swaying mast": _swaying_mast, "drying": _drying,
    "soft when warm": _soft_when_warm,
}  # fmt: skip
READINGS: dict[str, OnReadings] = {
    "hot drum": _hot_drum, "curved cell": _curved_cell, "warm cell": _warm_cell,
    "crosstalk": _crosstalk, "slipping": _slipping, "coarse": _coarse, "edge": _edge,
    "two harmonics": _two_harmonics, "exchanged": _exchanged,
}  # fmt: skip
POSES: dict[str, OnPoses] = {
    "refraction": _refraction, "range error": _range_error, "barrel": _barrel, "stale": _stale,
    "wrong poses": _wrong_poses, "blurred": _blurred, "beside the point": _beside_the_point,
}  # fmt: skip
KINDS = (*MACHINES, *READINGS, *POSES)
UNSIZED = ("exchanged", "stale", "wrong poses")
NEAR = {
    "hose": {"platform_force"}, "hose at the rim": {"platform_force", "platform_moment"},
    "gusty": {"platform_force"}, "hot drum": {"winch_expansion"},
    "refraction": {"pose_distortion"}, "beside the point": {"tool_point"},
}  # fmt: skip
"""What is in the list of effects by now."""


def _spoiled(blank: DataSet, kind: str, size: float, seed: int) -> DataSet:
    """Return a campaign of that size of effect, noise drawn as in the blank one."""
    robot, scene = blank.robot, blank.scene
    drawn = _drawn(robot, np.random.default_rng([seed, 17]))
    length, tension, seen = blank.clean_length_m, blank.clean_tension_N, scene
    if kind in MACHINES:
        MACHINE["off_the_list"] = lambda m, s, p: MACHINES[kind](m, s, p["size"], drawn)
        length, tension = predict(robot, {"off_the_list": {"size": size}}, scene)
    elif kind in READINGS:
        length, tension = READINGS[kind](length, tension, scene, size, drawn)
    else:
        seen = replace(scene, position_m=POSES[kind](scene.position_m, scene, size, drawn))
    return replace(
        blank, scene=seen,
        length_m=blank.length_m + length - blank.clean_length_m,
        tension_N=blank.tension_N + tension - blank.clean_tension_N,
    )  # fmt: skip


def _over_noise(blank: DataSet, spoiled: DataSet) -> float:
    """Root mean square of what the effect changes in the readings, over their noise."""
    robot = blank.robot
    length, tension = spoiled.length_m - blank.length_m, spoiled.tension_N - blank.tension_N
    if spoiled.scene is not blank.scene:
        there = predict(robot, {}, spoiled.scene)
        length, tension = blank.clean_length_m - there[0], blank.clean_tension_N - there[1]
    both = np.concatenate([length / robot.noise_m, tension / robot.noise_N])
    return float(np.sqrt(np.mean(both**2)))


def data_set(robot: TwinRobot, kind: str, seed: int) -> DataSet:
    """Return a campaign with an effect of a kind, 5 to 30 times the noise."""
    blank = make(robot, seed=seed, rows=ROWS)
    wanted = float(np.exp(np.random.default_rng([seed, 18]).uniform(np.log(5.0), np.log(30.0))))
    size = 1e-4
    if kind not in UNSIZED:
        for _ in range(12):
            there = _over_noise(blank, _spoiled(blank, kind, size, seed))
            size *= min(max(wanted / max(there, 1e-9), 0.02), 50.0)
    return _spoiled(blank, kind, size, seed)


@dataclass(frozen=True)
class Answer:
    """What a diagnosis said of a set, and how good that is: bad, in part, or right."""

    kind: str
    robot: str
    seed: int
    score: str
    verdict: str
    findings: tuple[tuple[str, tuple[str, ...]], ...]
    left: str
    seconds: float

    def __str__(self) -> str:
        found = "; ".join(f"{key} (or {', '.join(r) or '-'})" for key, r in self.findings)
        return (
            f"  {self.score:8} {self.kind:17} {self.robot:7} {self.seed:3d} {self.verdict:15} "
            f"{found or 'none'} | {self.left}"
        )


def diagnosed(dataset: DataSet):
    """Return the diagnosis of a set, as the command makes it."""
    from designer.diagnosis.case import case_of
    from designer.diagnosis.diagnose import diagnose
    from designer.io.config import read_study
    from designer.measured.read import read_measured

    with tempfile.TemporaryDirectory() as folder:
        dataset.write(Path(folder))
        study = read_study(Path(folder) / "config.yaml")
        assert study.measurements is not None
        measured = read_measured(study)
    return diagnose(case_of(study, study.measurements, measured))


def answer(robot: str, kind: str, seed: int) -> Answer:
    """Diagnose a set, and say how good that is."""
    dataset = data_set(ROBOTS[robot], kind, seed)
    start = time.perf_counter()
    result = diagnosed(dataset)
    alone = [
        f for f in result.findings
        if f.effect.cause == "physics" and not f.rivals and f.effect.id not in NEAR.get(kind, ())
    ]  # fmt: skip
    score = "right" if not alone else "bad" if result.is_positive else "in part"
    structure = result.structure_after
    left = [e.text for e in structure.events] + [c.name for c in structure.present][:2]
    findings = tuple((f.effect.key, f.rivals) for f in result.findings)
    seconds = time.perf_counter() - start
    return Answer(
        kind, robot, seed, score, result.verdict.value, findings, ", ".join(left), seconds
    )


def main() -> None:
    parser = argparse.ArgumentParser()
    parser.add_argument("--sets", type=int, default=60)
    parser.add_argument("--first", type=int, default=0, help="first seed")
    parser.add_argument("--kinds", default=",".join(KINDS))
    parser.add_argument("--robots", default=",".join(ROBOTS))
    parser.add_argument("--verbose", action="store_true", help="every set")
    arguments = parser.parse_args()
    kinds, names = arguments.kinds.split(","), arguments.robots.split(",")
    answers = []
    for k in range(arguments.sets):
        turn = k // len(kinds)
        robot = names[(k + turn) % len(names)]
        answers.append(answer(robot, kinds[k % len(kinds)], arguments.first + k))
        if arguments.verbose or answers[-1].score != "right":
            print(answers[-1], flush=True)
    counts = {s: sum(a.score == s for a in answers) for s in ("bad", "in part", "right")}
    positive = sum(a.verdict in ("found", "nothing_to_find") for a in answers)
    mean = sum(a.seconds for a in answers) / len(answers)
    print(f"{counts}; {positive} of {len(answers)} positive; {mean:.1f} s on average")


if __name__ == "__main__":
    main()
