"""Three machines to measure, and plausible sizes of each effect on them."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from twins.hanging import hang
from twins.physics import Machine, least_tensions_N, solve


@dataclass(frozen=True)
class TwinRobot:
    """A machine with its instruments.

    Parameters
    ----------
    exit_m : tuple of points
        Exit points [m].
    mass_kg, linear_mass, stiffness_N : float
        Platform mass [kg], cable mass per length [kg/m], EA [N].
    pose_m, box_m : tuple
        Middle pose, where the winches were homed, and box of the poses ((min, max), …) [m].
    attachment_m, centre_m : tuple of points, point
        Body frame [m]; empty for a point mass. Centre of mass.
    turn_rad : float
        Standard deviation of the rotation vector's components [rad].
    set_cables : tuple of int
        Cables, counted from 0, whose winches hold a tension; see `twins.physics.Machine`.
    noise_m, noise_N : float
        Standard deviation of a length and of a tension reading [m], [N].
    period_s : float
        How long a slow motion takes from one side of the box to the other and back [s].
    sizes : dict
        Effect id to its (small, large) plausible size; what a size is: see `draw`.
    """

    name: str
    exit_m: tuple[tuple[float, float, float], ...]
    mass_kg: float
    linear_mass: float
    stiffness_N: float
    pose_m: tuple[float, float, float]
    box_m: tuple[tuple[float, float], ...]
    noise_m: float
    noise_N: float
    period_s: float
    sizes: dict[str, tuple[float, float]]
    attachment_m: tuple[tuple[float, float, float], ...] = ()
    centre_m: tuple[float, float, float] = (0.0, 0.0, 0.0)
    turn_rad: float = 0.0
    set_cables: tuple[int, ...] = ()

    @property
    def cables(self) -> int:
        """Number of cables."""
        return len(self.exit_m)

    @property
    def free(self) -> tuple[int, ...]:
        """Directions in which the platform sways, of 0 … 5; none where cables hold them all."""
        return (3, 4, 5)[: max(6 - self.cables, 0)] if self.attachment_m else ()

    def machine(self) -> Machine:
        """Return the machine as the drawing has it."""
        attachment = self.attachment_m or np.zeros((self.cables, 3))
        return Machine(
            exit_m=np.array([self.exit_m], dtype=float),
            attachment_m=np.array(attachment, dtype=float),
            mass_kg=self.mass_kg,
            linear_mass=np.full((1, self.cables), self.linear_mass),
            stiffness_N=np.full((1, self.cables), self.stiffness_N),
            has_moments=bool(self.attachment_m),
            centre_m=np.array(self.centre_m),
            set_cables=self.set_cables,
        )

    @cached_property
    def reference_length_m(self) -> np.ndarray:
        """Lengths at the homing pose (cables,) [m]."""
        pose, turn = np.array([self.pose_m]), np.eye(3)[None]
        if self.free:
            return hang(self.machine(), pose, turn, tuple(range(6)))[2].length_m[0]
        set_N = least_tensions_N(self.machine(), pose, turn)[:, list(self.set_cables)]
        return solve(replace(self.machine(), set_N=set_N), pose, turn).length_m[0]

    def draw(self, effect: str, size: float, seed: int = 0) -> dict[str, float]:
        """Return parameters of an effect of this size; seed picks sign, cable and direction.

        The size of a scale or gain is |log(scale)|; of a vector its norm; of several offsets their
        rms; of a frame its shift, with a turn and a scale that move the exit points about as far;
        of a distortion its gain, the tracker being behind an exit point;
        of anything else its value. Modulus gets softer and mass per length heavier, as ropes
        do, and because the other way the effect is bounded.
        """
        rng = np.random.default_rng([seed, sum(map(ord, effect))])
        sign = rng.choice([-1.0, 1.0])
        cable = float(rng.integers(1, self.cables + 1))
        direction = _unit(rng.normal(size=3))
        spread = _unit(rng.normal(size=self.cables)) * np.sqrt(self.cables)
        tilt = _unit(rng.normal(size=2)) * size
        middle_N = self.mass_kg * 9.81 / self.cables
        vector = dict(zip(("x_m", "y_m", "z_m"), (size * direction).tolist(), strict=True))
        offsets = (size * spread).tolist()
        turn = size / np.ptp(self.exit_m, axis=0).max() * _unit(rng.normal(size=3))
        tracker = self.exit_m[int(cable) - 1]
        beside = {"x_m": 1.1 * tracker[0], "y_m": 1.1 * tracker[1], "z_m": 1.5}
        turns = dict(zip(("rx_rad", "ry_rad", "rz_rad"), turn.tolist(), strict=True))
        return {
            "pulley_radius": lambda: {"radius_m": size},
            "thermal_expansion": lambda: {"coefficient_per_K": size},
            "elastic_modulus": lambda: {"scale": float(np.exp(-size))},
            "linear_mass": lambda: {"scale": float(np.exp(size))},
            "platform_mass": lambda: {"offset_kg": float(sign * size)},
            "centre_of_mass_offset": lambda: vector,
            "anchor_offset": lambda: {"cable": cable, **vector},
            "attachment_offset": lambda: {"cable": cable, **vector},
            "cable_modulus": lambda: {"cable": cable, "scale": float(np.exp(-size))},
            "cable_mass": lambda: {"cable": cable, "scale": float(np.exp(size))},
            "cable_pulley_radius": lambda: {"cable": cable, "radius_m": size},
            "cable_creep": lambda: {"cable": cable, "strain_per_decade": size, "onset_s": 600.0},
            "winch_scale": lambda: {"cable": cable, "scale": float(np.exp(sign * size))},
            "winch_zero": lambda: {"cable": cable, "offset_m": float(sign * size)},
            "pose_shift": lambda: vector,
            "pose_scale": lambda: {"scale": float(np.exp(sign * size))},
            "pose_frame": lambda: {**vector, **turns, "scale": 1.0 + float(turn[0])},
            "tool_point": lambda: {**vector, **(turns if self.attachment_m else {})},
            "pose_distortion": lambda: {"gain_per_m": float(sign * size), **beside},
            "platform_force": lambda: {f"{a[0]}_N": v for a, v in vector.items()},
            "platform_moment": lambda: {f"{a[0]}_Nm": v for a, v in vector.items()},
            "winch_expansion": lambda: {"coefficient_per_K": float(sign * size)},
            "length_offset": lambda: {f"offset_{k}_m": v for k, v in enumerate(offsets, 1)},
            "drum_scale": lambda: {"scale": float(np.exp(sign * size))},
            "drum_layering": lambda: {"radius_gain_per_m": size},
            "creep": lambda: {"strain_per_decade": size, "onset_s": 600.0},
            "pulley_friction": lambda: {"coefficient": size},
            "tension_length": lambda: {"compliance_m_per_N": float(sign * size)},
            "tension_gain": lambda: {"cable": cable, "gain": float(np.exp(sign * size))},
            "tension_scale": lambda: {"gain": float(np.exp(sign * size))},
            "tension_bias": lambda: {f"offset_{k}_N": v for k, v in enumerate(offsets, 1)},
            "wind_drag": lambda: {"drag_area_m2": size},
            "base_tilt": lambda: {"rx_rad": float(tilt[0]), "ry_rad": float(tilt[1])},
            "clock_offset": lambda: {"offset_s": float(sign * size)},
            "bending_stiffness": lambda: {"flexural_rigidity_N_m2": size},
            "tower_settles": lambda: {
                "cable": cable, "depth_m": size, "relaxation": 0.2 if sign > 0 else 0.0,
            },
            "mast_compliance": lambda: {"compliance_m_per_N": size},
            "cable_mass_drift": lambda: {"gain": size},
            "stiffening": lambda: {"toe_strain": size, "toe_tension_N": middle_N},
            "backlash": lambda: {f"play_{k}_m": v for k, v in enumerate(offsets, 1)},
            "drum_eccentricity": lambda: {
                "cable": cable, "amplitude_m": size, "phase_rad": float(np.pi * direction[0]),
                "circumference_m": 0.1 * float(np.sqrt(np.ptp(self.exit_m, axis=0).max())),
            },
            "encoder_on_rope": lambda: {"share": size},
            "cell_at_platform": lambda: {"share": size},
            "tension_hysteresis": lambda: {f"width_{k}_N": v for k, v in enumerate(offsets, 1)},
        }[effect]()  # fmt: skip


def _unit(vector: np.ndarray) -> np.ndarray:
    return vector / np.linalg.norm(vector)


_COMMON = {
    "thermal_expansion": (2e-6, 2.5e-5),
    "winch_expansion": (2e-6, 2.5e-5),
    "elastic_modulus": (0.03, 0.6),
    "linear_mass": (0.1, 0.7),
    "drum_scale": (1e-4, 1e-2),
    "pulley_friction": (2e-3, 8e-2),
    "tension_gain": (2e-3, 0.2),
    "tension_scale": (2e-3, 0.2),
    "base_tilt": (5e-4, 2e-2),
    "clock_offset": (0.01, 0.5),
    "cable_modulus": (0.05, 0.6),
    "cable_mass": (0.2, 1.0),
    "winch_scale": (3e-4, 0.7),
    "pose_scale": (3e-4, 1e-2),
    "encoder_on_rope": (0.3, 2.0),
    "cell_at_platform": (0.3, 1.2),
}

YARD3 = TwinRobot(
    name="yard3",
    exit_m=((0, 0, 12), (30, 0, 12.5), (14, 26, 11.5)),
    mass_kg=180.0,
    linear_mass=0.142,
    stiffness_N=3.3e6,
    pose_m=(14.5, 10.0, 5.0),
    box_m=((9, 20), (5, 15), (2, 8)),
    noise_m=0.001,
    noise_N=4.0,
    period_s=60.0,
    sizes=_COMMON
    | {
        "pulley_radius": (0.005, 0.2),
        "platform_mass": (0.5, 30.0),
        "anchor_offset": (0.002, 0.2),
        "cable_pulley_radius": (0.005, 0.2),
        "cable_creep": (2e-5, 1e-3),
        "winch_zero": (0.002, 0.3),
        "pose_shift": (0.002, 0.3),
        "pose_frame": (0.002, 0.3),
        "tool_point": (0.002, 0.3),
        "pose_distortion": (2e-6, 1e-3),
        "platform_force": (0.5, 50.0),
        "length_offset": (0.001, 0.1),
        "drum_layering": (5e-5, 5e-3),
        "creep": (1e-5, 1e-3),
        "tension_bias": (3.0, 150.0),
        "wind_drag": (0.2, 4.0),
        "bending_stiffness": (1.0, 100.0),
        "tower_settles": (0.005, 0.2),
        "mast_compliance": (1e-6, 5e-5),
        "tension_length": (3e-7, 1e-5),
        "cable_mass_drift": (0.2, 1.5),
        "stiffening": (1e-4, 3e-3),
        "backlash": (0.004, 0.05),
        "drum_eccentricity": (0.004, 0.05),
        "tension_hysteresis": (1.0, 100.0),
    },
)

FAST3 = TwinRobot(
    name="fast3",
    exit_m=((0, 0, 0), (500, 0, 0), (250, 433.01, 0)),
    mass_kg=4000.0,
    linear_mass=3.75,
    stiffness_N=96.2e6,
    pose_m=(250.0, 170.0, -120.0),
    box_m=((165, 335), (80, 240), (-180, -60)),
    noise_m=0.005,
    noise_N=60.0,
    period_s=900.0,
    sizes=_COMMON
    | {
        "linear_mass": (0.001, 0.3),
        "pulley_radius": (0.02, 1.0),
        "platform_mass": (5.0, 300.0),
        "anchor_offset": (0.01, 1.0),
        "cable_mass": (0.002, 0.3),
        "cable_pulley_radius": (0.02, 1.0),
        "cable_creep": (5e-6, 1e-3),
        "winch_zero": (0.01, 1.0),
        "pose_shift": (0.01, 1.0),
        "pose_frame": (0.01, 1.0),
        "tool_point": (0.01, 1.0),
        "pose_distortion": (1e-7, 2e-5),
        "platform_force": (5.0, 500.0),
        "length_offset": (0.005, 0.5),
        "drum_layering": (1e-6, 3e-4),
        "creep": (5e-6, 1e-3),
        "tension_bias": (50.0, 3000.0),
        "wind_drag": (0.5, 30.0),
        "base_tilt": (1e-4, 1e-2),
        "bending_stiffness": (100.0, 30000.0),
        "tower_settles": (0.02, 1.0),
        "mast_compliance": (1e-7, 5e-6),
        "tension_length": (1e-7, 5e-6),
        "cable_mass_drift": (0.002, 0.3),
        "stiffening": (1e-5, 1e-3),
        "backlash": (0.02, 0.3),
        "drum_eccentricity": (0.02, 0.3),
        "tension_hysteresis": (20.0, 2000.0),
    },
)

HALL6 = TwinRobot(
    name="hall6",
    exit_m=(
        (0.15, 9.0, 8.0), (-7.944, -4.5, 8.05), (-7.644, -4.5, 8.05),
        (7.644, -4.5, 8.1), (7.944, -4.5, 8.1), (-0.15, 9.0, 8.0),
    ),
    attachment_m=(
        (-1.386, 0.8, 0.2), (-1.386, 0.8, 0.2), (0.0, -1.6, 0.2),
        (0.0, -1.6, 0.2), (1.386, 0.8, 0.2), (1.386, 0.8, 0.2),
    ),
    mass_kg=120.0,
    linear_mass=0.0616,
    stiffness_N=1.42e6,
    pose_m=(0.0, 0.0, 2.5),
    box_m=((-2, 2), (-2, 2), (1, 4)),
    turn_rad=0.03,
    noise_m=0.0005,
    noise_N=2.0,
    period_s=40.0,
    sizes=_COMMON
    | {
        "linear_mass": (0.2, 1.2),
        "pulley_radius": (0.003, 0.1),
        "platform_mass": (0.5, 20.0),
        "centre_of_mass_offset": (0.003, 0.15),
        "platform_moment": (0.2, 20.0),
        "anchor_offset": (0.002, 0.1),
        "attachment_offset": (0.002, 0.1),
        "cable_pulley_radius": (0.003, 0.1),
        "cable_creep": (2e-5, 1e-3),
        "winch_zero": (0.001, 0.1),
        "pose_shift": (0.001, 0.1),
        "pose_frame": (0.001, 0.1),
        "tool_point": (0.001, 0.1),
        "pose_distortion": (5e-6, 2e-3),
        "platform_force": (0.5, 50.0),
        "length_offset": (0.0005, 0.05),
        "drum_layering": (5e-5, 5e-3),
        "creep": (1e-5, 1e-3),
        "tension_bias": (2.0, 50.0),
        "wind_drag": (0.1, 2.0),
        "bending_stiffness": (0.3, 30.0),
        "tower_settles": (0.003, 0.1),
        "mast_compliance": (2e-6, 5e-5),
        "tension_length": (5e-7, 1e-5),
        "cable_mass_drift": (0.4, 2.0),
        "stiffening": (1e-4, 3e-3),
        "backlash": (0.002, 0.02),
        "drum_eccentricity": (0.002, 0.02),
        "tension_hysteresis": (1.0, 50.0),
    },
)  # fmt: skip

HALL8 = replace(
    HALL6,
    name="hall8",
    exit_m=(
        (-7.2, -5.2, 5.5), (-7.3, -5.1, 5.5), (-7.3, 5.2, 5.5), (-7.2, 5.4, 5.5),
        (7.2, 5.3, 5.5), (7.3, 5.2, 5.5), (7.3, -5.1, 5.5), (7.2, -5.3, 5.5),
    ),
    attachment_m=(
        (0.5, -0.5, 0.0), (-0.5, 0.35, 1.0), (-0.5, -0.27, 0.0), (0.5, 0.35, 1.0),
        (-0.5, 0.5, 0.0), (0.5, -0.34, 1.0), (0.5, 0.27, 0.0), (-0.5, -0.35, 1.0),
    ),
    pose_m=(0.0, 0.0, 1.2),
    box_m=((-2, 2), (-1.5, 1.5), (0.6, 1.8)),
    noise_N=4.0,
    set_cables=(1, 4),
)  # fmt: skip
"""Eight cables: six winches follow lengths, two a tension."""

FIELD4 = TwinRobot(
    name="field4",
    exit_m=((0, 0, 60), (250, 0, 62), (248, 200, 58), (2, 203, 61)),
    attachment_m=((-0.8, -0.6, 0.5), (0.8, -0.6, 0.5), (0.8, 0.6, 0.5), (-0.8, 0.6, 0.5)),
    centre_m=(0.05, -0.02, -0.3),
    mass_kg=34.0,
    linear_mass=0.041,
    stiffness_N=3e5,
    pose_m=(125.0, 100.0, 20.0),
    box_m=((80, 170), (65, 135), (5, 35)),
    noise_m=0.01,
    noise_N=2.0,
    period_s=600.0,
    sizes=_COMMON | {"platform_mass": (0.2, 10.0), "length_offset": (0.005, 0.5)},
)  # fmt: skip
"""Four long cables that weigh nearly as much as the platform, which may sway."""

FAST3_WIDE = replace(FAST3, box_m=((150, 350), (80, 260), (-180, -60)))
"""With poses at the very edge, where a cable hangs slack and a few rows carry any effect."""

ROBOTS = {robot.name: robot for robot in (YARD3, FAST3, HALL6)}
