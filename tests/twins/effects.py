"""Effects on a twin: changes of the machine, and changes of what its instruments read.

Ids and parameters are those of the measured-data contract, cables counted from 1. Below them come
effects that the contract does not know. Both dicts are applied in the order in which they stand.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from scipy.spatial.transform import Rotation

from twins.hanging import hang
from twins.physics import Equilibrium, Machine, least_tensions_N, solve
from twins.robots import TwinRobot

AIR_KG_PER_M3 = 1.25

Parameters = dict[str, float]
Effects = dict[str, Parameters]


@dataclass(frozen=True)
class Scene:
    """Where the platform is and what surrounds it, one value a row.

    Parameters
    ----------
    time_s, temperature_C : array (rows,)
    position_m, rotation_vector_rad, wind_m_per_s : array (rows, 3)
    motion : function or None
        Position and rotation vector at any times; None for settled poses.
    """

    time_s: np.ndarray
    position_m: np.ndarray
    rotation_vector_rad: np.ndarray
    temperature_C: np.ndarray
    wind_m_per_s: np.ndarray
    motion: Callable[[np.ndarray], tuple[np.ndarray, np.ndarray]] | None = None

    @property
    def progress(self) -> np.ndarray:
        """Time over the duration of the campaign (rows,)."""
        return self.time_s / self.time_s[-1]

    def earlier(self, offset_s: float) -> Scene:
        """Return the poses of ``offset_s`` ago, in the surroundings of now."""
        if self.motion is None:
            return self
        position, turn = self.motion(self.time_s - offset_s)
        return replace(self, position_m=position, rotation_vector_rad=turn)


def predict(robot: TwinRobot, effects: Effects, scene: Scene) -> tuple[np.ndarray, np.ndarray]:
    """Return noise-free length [m] and tension [N] readings (rows, cables)."""
    unknown = set(effects) - set(MACHINE) - set(READING) - set(POSE)
    if unknown:
        raise KeyError(f"no such effect: {sorted(unknown)}")
    now = _equilibrium(robot, effects, scene)
    lagged = now
    if "clock_offset" in effects:
        lagged = _equilibrium(robot, effects, scene.earlier(effects["clock_offset"]["offset_s"]))
    platform_N = np.linalg.norm(now.platform_pull_N, axis=-1)
    readings = Readings(lagged.length_m, now.exit_tension_N, now.length_m, platform_N, robot)
    if "encoder_on_rope" in effects:
        more_m = effects["encoder_on_rope"]["share"] * _stretch_run_past(robot, effects, scene)
        readings = replace(readings, length_m=readings.length_m + more_m)
    for name, change in READING.items():
        if name in effects:
            readings = change(readings, scene, effects[name])
    return readings.length_m, readings.tension_N


def _stretch_run_past(robot: TwinRobot, effects: Effects, scene: Scene) -> np.ndarray:
    """Stretch of what ran past the winches since homing (rows, cables) [m]: steps along the way."""
    steps = 8

    def on_the_way(values: np.ndarray, first: np.ndarray) -> np.ndarray:
        ends = np.concatenate([first[None], values])
        share = np.arange(steps)[:, None] / steps
        ways = (1 - share) * ends[:-1].reshape(len(values), 1, -1)
        ways = ways + share * ends[1:].reshape(len(values), 1, -1)
        flat = np.concatenate([ways.reshape(-1, ways.shape[-1]), ends[-1:].reshape(1, -1)])
        return flat.reshape(-1, *values.shape[1:])

    way = Scene(
        on_the_way(scene.time_s, scene.time_s[0]),
        on_the_way(scene.position_m, np.array(robot.pose_m)),
        on_the_way(scene.rotation_vector_rad, np.zeros(3)),
        on_the_way(scene.temperature_C, scene.temperature_C[0]),
        on_the_way(scene.wind_m_per_s, scene.wind_m_per_s[0]),
    )
    held = _equilibrium(robot, effects, way)
    strain = held.exit_tension_N / robot.stiffness_N
    pieces = 0.5 * (strain[1:] + strain[:-1]) * np.diff(held.length_m, axis=0)
    return np.cumsum(pieces, axis=0)[steps - 1 :: steps]


def swayed(robot: TwinRobot, effects: Effects, scene: Scene, *, chords: bool = False) -> Scene:
    """Return the scene with the platform turned as it hangs; given ``chords``, moved as well.

    With ``chords`` the winches have paid out the straight distances, so that all poses are such as
    taut cables hold.
    """
    turn = Rotation.from_rotvec(scene.rotation_vector_rad).as_matrix()
    free = tuple(range(6)) if chords else robot.free
    position, turn, _ = hang(_machine(robot, effects, scene), scene.position_m, turn, free)
    vector = Rotation.from_matrix(turn).as_rotvec()
    return replace(scene, position_m=position, rotation_vector_rad=vector)


def _equilibrium(robot: TwinRobot, effects: Effects, scene: Scene) -> Equilibrium:
    machine = _machine(robot, effects, scene)
    turn = Rotation.from_rotvec(scene.rotation_vector_rad).as_matrix()
    if robot.free:
        return hang(machine, scene.position_m, turn, robot.free)[2]
    if robot.set_cables:
        machine = replace(machine, set_N=_set_N(robot, scene, turn))
    return solve(machine, scene.position_m, turn)


def _machine(robot: TwinRobot, effects: Effects, scene: Scene) -> Machine:
    machine = robot.machine()
    for name, change in MACHINE.items():
        if name in effects:
            machine = change(machine, scene, effects[name])
    return machine


def _set_N(robot: TwinRobot, scene: Scene, turn: np.ndarray) -> np.ndarray:
    """Tensions of the winches under force control: a law that no model of the machine knows."""
    least = least_tensions_N(robot.machine(), scene.position_m, turn)
    swing = 1.1 + 0.15 * np.sin(2 * np.pi * scene.time_s / (7.3 * robot.period_s))
    return least[:, list(robot.set_cables)] * swing[:, None]


# --- the machine ---------------------------------------------------------------------------------


def _pulley_radius(machine: Machine, scene: Scene, p: Parameters) -> Machine:
    return replace(machine, pulley_radius_m=_each(machine, p["radius_m"]))


def _elastic_modulus(machine: Machine, scene: Scene, p: Parameters) -> Machine:
    return replace(machine, stiffness_N=machine.stiffness_N * p["scale"])


def _linear_mass(machine: Machine, scene: Scene, p: Parameters) -> Machine:
    return replace(machine, linear_mass=machine.linear_mass * p["scale"])


def _platform_mass(machine: Machine, scene: Scene, p: Parameters) -> Machine:
    return replace(machine, mass_kg=machine.mass_kg + p["offset_kg"])


def _centre_of_mass_offset(machine: Machine, scene: Scene, p: Parameters) -> Machine:
    return replace(machine, centre_m=machine.centre_m + _vector(p))


def _anchor_offset(machine: Machine, scene: Scene, p: Parameters) -> Machine:
    exit_m = machine.exit_m.copy()
    exit_m[:, int(p["cable"]) - 1] += _vector(p)
    return replace(machine, exit_m=exit_m)


def _attachment_offset(machine: Machine, scene: Scene, p: Parameters) -> Machine:
    attachment_m = machine.attachment_m.copy()
    attachment_m[int(p["cable"]) - 1] += _vector(p)
    return replace(machine, attachment_m=attachment_m)


def _of_cable(figures: np.ndarray, p: Parameters) -> np.ndarray:
    scaled = figures.copy()
    scaled[:, int(p["cable"]) - 1] *= p["scale"]
    return scaled


def _cable_modulus(machine: Machine, scene: Scene, p: Parameters) -> Machine:
    return replace(machine, stiffness_N=_of_cable(machine.stiffness_N, p))


def _cable_mass(machine: Machine, scene: Scene, p: Parameters) -> Machine:
    return replace(machine, linear_mass=_of_cable(machine.linear_mass, p))


def _cable_pulley_radius(machine: Machine, scene: Scene, p: Parameters) -> Machine:
    radius = _each(machine, 0.0)
    radius[:, int(p["cable"]) - 1] = p["radius_m"]
    return replace(machine, pulley_radius_m=radius)


def _wind_drag(machine: Machine, scene: Scene, p: Parameters) -> Machine:
    speed = np.linalg.norm(scene.wind_m_per_s, axis=1, keepdims=True)
    drag = 0.5 * AIR_KG_PER_M3 * speed * scene.wind_m_per_s * p["drag_area_m2"]
    return replace(machine, force_N=machine.force_N + drag)


def _base_tilt(machine: Machine, scene: Scene, p: Parameters) -> Machine:
    # A frame vector v is R v in the upright frame, so gravity in the frame is Rᵀ g.
    upright = Rotation.from_rotvec([p["rx_rad"], p["ry_rad"], 0.0])
    return replace(machine, gravity=upright.inv().apply(machine.gravity))


def _platform_force(machine: Machine, scene: Scene, p: Parameters) -> Machine:
    return replace(machine, force_N=machine.force_N + np.array([p[f"{a}_N"] for a in "xyz"]))


def _platform_moment(machine: Machine, scene: Scene, p: Parameters) -> Machine:
    return replace(machine, moment_Nm=machine.moment_Nm + [p[f"{a}_Nm"] for a in "xyz"])


def _bending_stiffness(machine: Machine, scene: Scene, p: Parameters) -> Machine:
    return replace(machine, bending_N_m2=_each(machine, p["flexural_rigidity_N_m2"]))


def _tower_settles(machine: Machine, scene: Scene, p: Parameters) -> Machine:
    """One exit point sinks: steadily, or with ``relaxation`` × duration as time constant."""
    share = scene.progress
    if p.get("relaxation"):
        share = 1 - np.exp(-share / p["relaxation"])
    exit_m = np.repeat(machine.exit_m[:1], len(share), axis=0)
    exit_m[:, int(p["cable"]) - 1, 2] -= p["depth_m"] * share
    return replace(machine, exit_m=exit_m)


def _mast_compliance(machine: Machine, scene: Scene, p: Parameters) -> Machine:
    return replace(machine, mast_m_per_N=_each(machine, p["compliance_m_per_N"]))


def _cable_mass_drift(machine: Machine, scene: Scene, p: Parameters) -> Machine:
    """Mass per length grows to 1 + gain times its value as cables soak; or swings with a period."""
    share = scene.progress
    if p.get("period_s"):
        share = np.sin(2 * np.pi * scene.time_s / p["period_s"])
    return replace(machine, linear_mass=machine.linear_mass * (1 + p["gain"] * share[:, None]))


def _pulley_inclination(machine: Machine, scene: Scene, p: Parameters) -> Machine:
    axis = np.tile([0.0, 0.0, 1.0], (machine.exit_m.shape[1], 1))
    turn = Rotation.from_rotvec([p["rx_rad"], p["ry_rad"], 0.0])
    axis[int(p["cable"]) - 1] = turn.apply([0.0, 0.0, 1.0])
    return replace(machine, pulley_axis=axis)


def _stiffening(machine: Machine, scene: Scene, p: Parameters) -> Machine:
    return replace(machine, toe_strain=p["toe_strain"], toe_tension_N=p["toe_tension_N"])


MACHINE: dict[str, Callable[[Machine, Scene, Parameters], Machine]] = {
    "pulley_radius": _pulley_radius,
    "elastic_modulus": _elastic_modulus,
    "linear_mass": _linear_mass,
    "platform_mass": _platform_mass,
    "centre_of_mass_offset": _centre_of_mass_offset,
    "anchor_offset": _anchor_offset,
    "attachment_offset": _attachment_offset,
    "cable_modulus": _cable_modulus,
    "cable_mass": _cable_mass,
    "cable_pulley_radius": _cable_pulley_radius,
    "wind_drag": _wind_drag,
    "base_tilt": _base_tilt,
    "platform_force": _platform_force,
    "platform_moment": _platform_moment,
    "bending_stiffness": _bending_stiffness,
    "tower_settles": _tower_settles,
    "mast_compliance": _mast_compliance,
    "cable_mass_drift": _cable_mass_drift,
    "stiffening": _stiffening,
    "pulley_inclination": _pulley_inclination,
}


# --- the instruments -----------------------------------------------------------------------------


@dataclass(frozen=True)
class Readings:
    """What the instruments read so far, beside the true lengths of now (rows, cables)."""

    length_m: np.ndarray
    tension_N: np.ndarray
    true_length_m: np.ndarray
    platform_N: np.ndarray
    robot: TwinRobot


def _thermal_expansion(readings: Readings, scene: Scene, p: Parameters) -> Readings:
    growth = 1 + p["coefficient_per_K"] * (scene.temperature_C - 20.0)
    return replace(readings, length_m=readings.length_m / growth[:, None])


def _creep(readings: Readings, scene: Scene, p: Parameters) -> Readings:
    growth = 1 + p["strain_per_decade"] * np.log10(1 + scene.time_s / p["onset_s"])
    return replace(readings, length_m=readings.length_m / growth[:, None])


def _cable_creep(readings: Readings, scene: Scene, p: Parameters) -> Readings:
    growth = 1 + p["strain_per_decade"] * np.log10(1 + scene.time_s / p["onset_s"])
    return _of_winch(readings, p, lambda length: length / growth)


def _winch_scale(readings: Readings, scene: Scene, p: Parameters) -> Readings:
    """One winch counts too much, from the homing pose on, where it is right."""
    homed = readings.robot.reference_length_m[int(p["cable"]) - 1]
    return _of_winch(readings, p, lambda length: homed + p["scale"] * (length - homed))


def _winch_zero(readings: Readings, scene: Scene, p: Parameters) -> Readings:
    return _of_winch(readings, p, lambda length: length + p["offset_m"])


def _of_winch(
    readings: Readings, p: Parameters, law: Callable[[np.ndarray], np.ndarray]
) -> Readings:
    length = readings.length_m.copy()
    column = int(p["cable"]) - 1
    length[:, column] = law(length[:, column])
    return replace(readings, length_m=length)


def _drum_layering(readings: Readings, scene: Scene, p: Parameters) -> Readings:
    """The winch counts turns: d(wound) = (1 + gain × wound) d(reading), from the homing pose."""
    gain = p["radius_gain_per_m"]
    wound = readings.robot.reference_length_m - readings.length_m
    counted = np.log1p(gain * wound) / gain if gain else wound
    return replace(readings, length_m=readings.robot.reference_length_m - counted)


def _drum_scale(readings: Readings, scene: Scene, p: Parameters) -> Readings:
    return replace(readings, length_m=readings.length_m * p["scale"])


def _winch_expansion(readings: Readings, scene: Scene, p: Parameters) -> Readings:
    """A drum of another size counts other turns: they are what is known of the rope."""
    radius = 0.25 / (1 + p["coefficient_per_K"] * (scene.temperature_C - 20.0))
    turns = readings.length_m / (2 * np.pi * radius[:, None])
    return replace(readings, length_m=turns * 2 * np.pi * 0.25)


def _tension_length(readings: Readings, scene: Scene, p: Parameters) -> Readings:
    change = p["compliance_m_per_N"] * readings.tension_N
    return replace(readings, length_m=readings.length_m + change)


def _length_offset(readings: Readings, scene: Scene, p: Parameters) -> Readings:
    return replace(readings, length_m=readings.length_m + _per_cable(p, "m"))


def _backlash(readings: Readings, scene: Scene, p: Parameters) -> Readings:
    """A driving side comes first by half the play; one that is dragged (play < 0) comes last."""
    reading = readings.length_m.copy()
    for column, length in enumerate(readings.length_m.T):
        play, side = p[f"play_{column + 1}_m"], 0.0
        lower, upper = length - abs(play) / 2, length + abs(play) / 2
        for row in range(1, len(length)):
            if play < 0:
                reading[row, column] = np.clip(reading[row - 1, column], lower[row], upper[row])
                continue
            if length[row] != length[row - 1]:
                side = 1.0 if length[row] > length[row - 1] else -1.0
            reading[row, column] += side * play / 2
    return replace(readings, length_m=reading)


def _drum_eccentricity(readings: Readings, scene: Scene, p: Parameters) -> Readings:
    """The drum's turns against what they pay out, from homing on, by a table of both."""
    homed = readings.robot.reference_length_m[int(p["cable"]) - 1]
    length = readings.length_m[:, int(p["cable"]) - 1]
    count = np.linspace(length.min() - 1.0, length.max() + 1.0, 400_001)

    def lifted(shown: np.ndarray | float) -> np.ndarray:
        return p["amplitude_m"] * np.sin(2 * np.pi * shown / p["circumference_m"] + p["phase_rad"])

    paid_out = count - lifted(count) + lifted(homed)
    return _of_winch(readings, p, lambda true: np.interp(true, paid_out, count))


def _encoder_on_rope(readings: Readings, scene: Scene, p: Parameters) -> Readings:
    return readings  # already in: `predict` follows the rope from pose to pose


def _cell_at_platform(readings: Readings, scene: Scene, p: Parameters) -> Readings:
    change = p["share"] * (readings.platform_N - readings.tension_N)
    return replace(readings, tension_N=readings.tension_N + change)


def _tension_hysteresis(readings: Readings, scene: Scene, p: Parameters) -> Readings:
    tension = readings.tension_N.copy()
    for column, length in enumerate(readings.true_length_m.T):
        side = 0.0
        for row in range(1, len(length)):
            if length[row] != length[row - 1]:
                side = 1.0 if length[row] > length[row - 1] else -1.0
            tension[row, column] -= side * p[f"width_{column + 1}_N"] / 2
    return replace(readings, tension_N=tension)


def _pulley_friction(readings: Readings, scene: Scene, p: Parameters) -> Readings:
    length = readings.true_length_m
    direction = np.sign(np.diff(length, axis=0, prepend=length[:1]))
    factor = np.exp(-p["coefficient"] * direction)
    return replace(readings, tension_N=readings.tension_N * factor)


def _tension_gain(readings: Readings, scene: Scene, p: Parameters) -> Readings:
    tension = readings.tension_N.copy()
    tension[:, int(p["cable"]) - 1] *= p["gain"]
    return replace(readings, tension_N=tension)


def _tension_scale(readings: Readings, scene: Scene, p: Parameters) -> Readings:
    return replace(readings, tension_N=readings.tension_N * p["gain"])


def _tension_bias(readings: Readings, scene: Scene, p: Parameters) -> Readings:
    return replace(readings, tension_N=readings.tension_N + _per_cable(p, "N"))


def _clock_offset(readings: Readings, scene: Scene, p: Parameters) -> Readings:
    return readings  # already in: `predict` takes the lengths from the earlier scene


READING: dict[str, Callable[[Readings, Scene, Parameters], Readings]] = {
    "clock_offset": _clock_offset,
    "thermal_expansion": _thermal_expansion,
    "creep": _creep,
    "cable_creep": _cable_creep,
    "encoder_on_rope": _encoder_on_rope,
    "drum_layering": _drum_layering,
    "drum_scale": _drum_scale,
    "winch_expansion": _winch_expansion,
    "tension_length": _tension_length,
    "winch_scale": _winch_scale,
    "length_offset": _length_offset,
    "winch_zero": _winch_zero,
    "drum_eccentricity": _drum_eccentricity,
    "backlash": _backlash,
    "cell_at_platform": _cell_at_platform,
    "pulley_friction": _pulley_friction,
    "tension_hysteresis": _tension_hysteresis,
    "tension_gain": _tension_gain,
    "tension_scale": _tension_scale,
    "tension_bias": _tension_bias,
}

# --- the camera ----------------------------------------------------------------------------------


def _pose_shift(position: np.ndarray, turn: np.ndarray, p: Parameters) -> Pose:
    return position + _vector(p), turn


def _pose_scale(position: np.ndarray, turn: np.ndarray, p: Parameters) -> Pose:
    return position * p["scale"], turn


def _pose_frame(position: np.ndarray, turn: np.ndarray, p: Parameters) -> Pose:
    """Its own axes, zero and unit: x' = scale · R x + shift, about the frame's zero."""
    rotation = Rotation.from_rotvec([p["rx_rad"], p["ry_rad"], p["rz_rad"]])
    turned = (rotation * Rotation.from_rotvec(turn)).as_rotvec()
    return p["scale"] * rotation.apply(position) + _vector(p), turned


def _tool_point(position: np.ndarray, turn: np.ndarray, p: Parameters) -> Pose:
    """A marker beside the body's origin, its axes askew: where it is, and how it is turned."""
    body = Rotation.from_rotvec(turn)
    askew = Rotation.from_rotvec([p.get(f"r{axis}_rad", 0.0) for axis in "xyz"])
    return position + body.apply(_vector(p)), (body * askew).as_rotvec()


def _pose_distortion(position: np.ndarray, turn: np.ndarray, p: Parameters) -> Pose:
    """A line of sight that is an arc: the target seems lifted by what the arc falls below it."""
    away = np.linalg.norm(position - _vector(p), axis=1)
    radius = 0.5 / p["gain_per_m"]
    lift = radius - np.sign(radius) * np.sqrt(radius**2 - away**2)
    return position + lift[:, None] * [0.0, 0.0, 1.0], turn


Pose = tuple[np.ndarray, np.ndarray]
POSE: dict[str, Callable[[np.ndarray, np.ndarray, Parameters], Pose]] = {
    "pose_shift": _pose_shift,
    "pose_scale": _pose_scale,
    "pose_frame": _pose_frame,
    "tool_point": _tool_point,
    "pose_distortion": _pose_distortion,
}


def as_seen(scene: Scene, effects: Effects) -> Scene:
    """Return the scene with the poses as the camera measures them."""
    position, turn = scene.position_m, scene.rotation_vector_rad
    for name, change in POSE.items():
        if name in effects:
            position, turn = change(position, turn, effects[name])
    return replace(scene, position_m=position, rotation_vector_rad=turn)


UNLISTED = (
    "tower_settles",
    "cable_mass_drift",
)
"""Effects that the contract does not know."""

LISTED = tuple(name for name in [*MACHINE, *READING, *POSE] if name not in UNLISTED)
"""Effects of the contract."""


def _vector(p: Parameters) -> np.ndarray:
    return np.array([p["x_m"], p["y_m"], p["z_m"]])


def _per_cable(p: Parameters, unit: str) -> np.ndarray:
    """``offset_1_unit``, ``offset_2_unit`` … in order."""
    return np.array([p[f"offset_{k}_{unit}"] for k in range(1, len(p) + 1)])


def _each(machine: Machine, value: float) -> np.ndarray:
    return np.full((1, machine.exit_m.shape[1]), value)
