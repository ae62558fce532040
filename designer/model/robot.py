"""Frozen values of a robot, its platform, its poses, and the machine as it is built."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from functools import lru_cache
from typing import Annotated

import numpy as np
from numpy.typing import ArrayLike
from scipy.spatial.transform import Rotation

from designer import checked
from designer.arrays import BoolArray, FloatArray, IntArray, frozen_array
from designer.model.cable import STANDARD_GRAVITY_M_PER_S2, AttachedEach, Cable, Cables
from designer.model.motion import Motion
from designer.model.winches import Winches

SAG_MAX, SAG_AT_MOST = 0.2, 0.5
"""Largest sag over chord of a cable that counts as taut: unless given, and at most."""
_AS_BUILT = frozen_array(np.eye(3))


@checked.reports_field
@dataclass(frozen=True, slots=True, eq=False)
class Platform(checked.Value):
    """What the cables carry.

    Parameters
    ----------
    mass_kg : float
        Mass [kg].
    attachments_m : array (n_cables, 3) or None
        Attachment points in the body frame [m]; None for a point mass with 3 degrees of freedom.
    centre_of_mass_m : array (3,)
        Centre of mass in the body frame [m].
    hull_m : array (n_corners, 3) or None
        Corners of the body's convex hull in the body frame [m]; None for that of the attachments.
    wrench_N : array (6,)
        Constant force on the body at the origin of its frame and moment about it, beside gravity,
        along the axes of the world frame [N, N·m].
    centre_force_N : array (3,)
        Constant force at the centre of mass, beside gravity, along those axes [N].
    drag_area_m2 : float or None
        Drag coefficient times area in the wind [m²]; None where it is not known.
    drag_centre_m : array (3,) or None
        Where the wind acts, in the body frame [m]; None for the centre of mass.
    drag_force_N : array (3,)
        Force of the wind there, along the axes of the world frame [N].
    mass_offset_kg : float
        Share of the mass that a load case does not replace: what the platform weighs beyond its
        drawing [kg].
    wrench_offset_N : array (6,)
        Share of the wrench that a load case does not replace, likewise [N, N·m].
    inertia_kg_m2 : array (3, 3) or None
        Moments of inertia about the centre of mass, along the axes of the body frame; None where
        they are not known. Products are minus the integrals of x y and so on [kg·m²].
    motion : Motion or None
        How it moves where it takes its poses in motion; None at rest.
    moving_mass_kg : float or None
        What is accelerated where that is not the mass, as under a dynamic factor [kg].
    """

    mass_kg: checked.NotNegative
    attachments_m: checked.Points | None = None
    centre_of_mass_m: checked.Vector = field(default_factory=lambda: frozen_array(np.zeros(3)))
    hull_m: checked.Points | None = None
    wrench_N: checked.Wrench = field(default_factory=lambda: frozen_array(np.zeros(6)))
    centre_force_N: checked.Vector = field(default_factory=lambda: frozen_array(np.zeros(3)))
    drag_area_m2: checked.NotNegative | None = None
    drag_centre_m: checked.Vector | None = None
    drag_force_N: checked.Vector = field(default_factory=lambda: frozen_array(np.zeros(3)))
    mass_offset_kg: float = 0.0
    wrench_offset_N: checked.Wrench = field(default_factory=lambda: frozen_array(np.zeros(6)))
    inertia_kg_m2: Annotated[FloatArray, checked.Shape((3, 3))] | None = None
    motion: Motion | None = None
    moving_mass_kg: checked.NotNegative | None = None


@checked.reports_field
@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Robot(checked.Shown):
    """A cable-driven parallel robot.

    Parameters
    ----------
    exit_points_m : array (n_cables, 3)
        Points where the cables leave the base, world frame [m].
    platform : Platform
        The load.
    pulley_radius_m : float
        Radius of the swivelling pulleys at the exit points [m]; see `designer.physics.pulley`.
        A fit takes its slope at zero from both sides, so it may be negative.
    tilt_rad : array (2,)
        The base is turned by the rotation vector (rx, ry, 0) against the vertical, x and y of the
        upright frame [rad].
    tension_min_N : float
        Least tension anywhere in any cable, where there are more cables than degrees of freedom:
        at its lower end, or at its lowest point where that hangs below both ends [N].
    sag_max : float
        Largest sag over chord of any cable, see `designer.statics.inverse.sag_m`: where there are
        more cables than degrees of freedom, a pose that cannot keep it is not held.
    gravity_direction : array (3,)
        Where things fall, world frame; its length does not count.
    is_planar : bool
        Whether everything lies in one vertical plane, in which the platform moves and turns.
    cable_load_direction : array (3,) or None
        Where the load on the cables points, world frame, such as that of weight and wind; its
        length does not count. None for gravity alone. The upright frame is then built from it.
    winches : Winches
        What pulls the cables.
    attached : tuple of Attached
        What is clipped along each of the cables; see `Cable.with_attached`.
    """

    exit_points_m: checked.Points
    platform: Platform
    pulley_radius_m: checked.Finite = 0.0
    tilt_rad: Annotated[FloatArray, checked.Shape((2,))] = field(
        default_factory=lambda: frozen_array(np.zeros(2))
    )
    tension_min_N: checked.NotNegative = 0.0
    sag_max: Annotated[float, checked.Number(above=0.0, most=SAG_AT_MOST)] = SAG_MAX
    gravity_direction: checked.Vector = field(
        default_factory=lambda: frozen_array([0.0, 0.0, -1.0])
    )
    is_planar: bool = False
    cable_load_direction: checked.Vector | None = None
    winches: Winches = field(default_factory=Winches)
    attached: AttachedEach = ()

    def __post_init__(self) -> None:
        checked.check_fields(self)
        if not self.gravity_direction.any():
            raise ValueError("gravity_direction must not be zero")
        if self.attachments_m.shape[0] != self.n_cables:
            raise ValueError(
                f"every cable needs an exit point and an attachment: there are {self.n_cables} "
                f"exit points and {self.attachments_m.shape[0]} attachments"
            )

        positions_m = self.winches.positions_m
        if positions_m is not None and len(positions_m) != self.n_cables:
            raise ValueError(f"{len(positions_m)} winches for {self.n_cables} exit points")
        largest_N = self.winches.tension_max_N
        if isinstance(largest_N, np.ndarray) and len(largest_N) != self.n_cables:
            raise ValueError(f"{len(largest_N)} largest tensions of {self.n_cables} winches")
        if len(self.attached) not in (0, 1, self.n_cables):
            raise ValueError(f"{len(self.attached)} lines along {self.n_cables} cables")

    @property
    def n_cables(self) -> int:
        """Number of cables."""
        return len(self.exit_points_m)

    @property
    def is_point_mass(self) -> bool:
        """Whether all cables meet in one point and the platform cannot turn."""
        return self.platform.attachments_m is None

    @property
    def degrees_of_freedom(self) -> int:
        """3 for a point mass, 6 otherwise; in a plane 2 and 3."""
        return len(self.balance_rows)

    @property
    def balance_rows(self) -> IntArray:
        """Which of force x, y, z and moment x, y, z the cables balance, in the upright frame."""
        if self.is_planar:
            return np.array([0, 2] if self.is_point_mass else [0, 2, 4])
        return np.arange(3 if self.is_point_mass else 6)

    @property
    def is_square(self) -> bool:
        """Whether there are as many cables as degrees of freedom."""
        return self.n_cables == self.degrees_of_freedom

    @property
    def has_equal_cables(self) -> bool:
        """Whether the same is attached to all cables."""
        return len(self.attached) < 2

    @property
    def has_enough_cables(self) -> bool:
        """Whether there are at least as many cables as degrees of freedom."""
        return self.n_cables >= self.degrees_of_freedom

    @property
    def is_redundant(self) -> bool:
        """Whether there are more cables than degrees of freedom, so that tensions can be chosen."""
        return self.n_cables > self.degrees_of_freedom

    @property
    def has_one_branch(self) -> bool:
        """Whether a pose has one equilibrium only: a point mass on as few cables as hold it.

        All pulls are then one number times the barycentric weights of the position, and the lift
        grows with that number.
        """
        return self.is_point_mass and self.is_square and self.pulley_radius_m == 0.0

    @property
    def is_upright(self) -> bool:
        """Whether the base frame surely is the upright frame, so that nothing has to be turned."""
        x, y, z = self.gravity_direction.tolist()  # asked often: of arrays it takes long
        is_as_built = not any(self.tilt_rad.tolist()) and self.cable_load_direction is None
        return x == y == 0.0 > z and not self.is_planar and is_as_built

    @property
    def upright(self) -> FloatArray:
        """Rotation (3, 3) from the base frame to the upright frame.

        Its z axis is the true vertical, or against the load on the cables where that points
        elsewhere: in this frame each cable hangs in the plane of z and its chord. A planar robot
        lies in its x-z plane.
        """
        if self.cable_load_direction is not None:
            return self._headed(vertical_frame(self.cable_load_direction))
        return self.level

    @property
    def level(self) -> FloatArray:
        """Rotation (3, 3) from the base frame to one whose z axis is the true vertical."""
        if self.is_upright:
            return _AS_BUILT
        line = self.exit_points_m.tobytes() if self.is_planar else b""
        return _level(line, *self.tilt_rad.tolist(), *self.gravity_direction.tolist())

    @property
    def leaning(self) -> FloatArray:
        """Rotation (3, 3) from the frame of `level` to that of `upright`."""
        return np.asarray(self.upright @ self.level.T)

    def _headed(self, vertical: FloatArray) -> FloatArray:
        return _headed(vertical, self.exit_points_m) if self.is_planar else vertical

    @property
    def attachments_m(self) -> FloatArray:
        """Attachment points in the body frame, zeros for a point mass (n_cables, 3) [m]."""
        if self.platform.attachments_m is None:
            return frozen_array(np.zeros((self.n_cables, 3)))
        return self.platform.attachments_m

    @property
    def weight_N(self) -> float:
        """Weight of the platform [N]."""
        return self.platform.mass_kg * STANDARD_GRAVITY_M_PER_S2

    @property
    def pull_N(self) -> FloatArray:
        """What the cables have to pull with, force and moment (6,), upright frame [N, N·m].

        Against weight, wind and wrench, about the origin of the body frame; without the moments of
        what acts at points of the body, which turn with it.
        """
        applied = self.platform.wrench_N.reshape(2, 3) @ self.upright.T
        pull = -applied.ravel()
        pull[:3] += sum(force for _, force in self.turning_pulls_N)
        return np.asarray(pull)

    @property
    def centre_pull_N(self) -> FloatArray:
        """The part of that force that acts at the centre of mass (3,), upright frame [N]."""
        return self.turning_pulls_N[0][1]

    @property
    def turning_pulls_N(self) -> list[tuple[FloatArray, FloatArray]]:
        """Points of the body (3,), its centre of mass first, and the parts of it there (3,)."""
        body, wind = self.platform, self.upright @ self.platform.drag_force_N
        pull = np.array([0.0, 0.0, self.weight_N])
        if self.cable_load_direction is not None:
            pull = self.leaning @ pull
        pull = pull - self.upright @ body.centre_force_N
        if body.drag_centre_m is None:
            return [(body.centre_of_mass_m, pull - wind)]
        return [(body.centre_of_mass_m, pull), (body.drag_centre_m, -wind)]

    @property
    def at_rest(self) -> Robot:
        """The robot whose platform takes its poses at rest."""
        if self.platform.motion is None:
            return self
        return replace(self, platform=replace(self.platform, motion=None))

    def inertia_wrench_N(self, poses: Poses) -> FloatArray | None:
        """Return force and moment of inertia in motion, about the origin of the body frame.

        Along the axes of the base frame (..., 6); None where all poses are taken at rest [N, N·m].
        """
        body = self.platform
        if body.motion is None:
            return None
        mass_kg = body.mass_kg if body.moving_mass_kg is None else body.moving_mass_kg
        centre, inertia = body.centre_of_mass_m, body.inertia_kg_m2
        at = poses.position_m, poses.rotations
        return body.motion.inertia_wrench_N(*at, mass_kg, centre, inertia)

    def without_cable(self, cable: int) -> Robot:
        """Return the robot without one of its cables, counted from 1."""
        remaining = np.delete(np.arange(self.n_cables), cable - 1)
        body = self.platform
        if body.attachments_m is not None:
            body = replace(body, attachments_m=body.attachments_m[remaining])
        exit_points_m, winches = self.exit_points_m[remaining], self.winches.without(cable)
        attached = self.attached
        if not self.has_equal_cables:
            attached = attached[: cable - 1] + attached[cable:]
        return replace(
            self, exit_points_m=exit_points_m, platform=body, winches=winches, attached=attached
        )

    def loads_N(self, wrench_N: FloatArray | None = None) -> FloatArray:
        """Return `pull_N` less a force (n_poses, 3), or force and moment (n_poses, 6).

        Upright frame, (1 or n_poses, 6) [N, N·m].
        """
        pull = self.pull_N[None]
        if wrench_N is None:
            return pull
        return pull - np.pad(wrench_N, ((0, 0), (0, 6 - wrench_N.shape[1])))


def vertical_frame(gravity_direction: FloatArray) -> FloatArray:
    """Return the rotation (3, 3) to a frame whose z axis is the vertical, by the shortest way."""
    x, y, z = gravity_direction
    return _vertical_frame(float(x), float(y), float(z))


@lru_cache(maxsize=256)
def _level(exit_points: bytes, rx: float, ry: float, *down: float) -> FloatArray:
    """Return the frame of `Robot.level`; remembered, as every solve asks for it several times.

    ``exit_points`` has the bytes of those of a planar robot.
    """
    frame = vertical_frame(np.array(down))
    if exit_points:
        frame = _headed(frame, np.frombuffer(exit_points).reshape(-1, 3))
    return frozen_array(Rotation.from_rotvec([rx, ry, 0.0]).as_matrix() @ frame)


def _headed(vertical: FloatArray, exit_points_m: FloatArray) -> FloatArray:
    """Return a frame with the line of the exit points, seen from above, turned into x."""
    plan = (exit_points_m @ vertical.T)[:, :2]
    x, y = np.linalg.svd(plan - plan.mean(axis=0))[2][0]
    if (x, y) < (0.0, 0.0):
        x, y = -x, -y
    return np.array([[x, y, 0.0], [-y, x, 0.0], [0.0, 0.0, 1.0]]) @ vertical


@lru_cache(maxsize=256)
def _vertical_frame(x: float, y: float, z: float) -> FloatArray:
    up = -np.array([x, y, z]) / np.linalg.norm([x, y, z])
    axis = np.cross(up, [0.0, 0.0, 1.0])
    sine, cosine = float(np.linalg.norm(axis)), float(up[2])
    if sine == 0.0:
        return frozen_array(np.eye(3) if cosine > 0.0 else np.diag([1.0, -1.0, -1.0]))
    turn = Rotation.from_rotvec(axis / sine * np.arctan2(sine, cosine))
    return frozen_array(turn.as_matrix())


@checked.reports_field
@dataclass(frozen=True, slots=True, eq=False)
class Poses:
    """A batch of platform poses, over any leading axes.

    Parameters
    ----------
    position_m : array (..., 3)
        Origin of the body frame in the world frame [m].
    rotation : array (..., 3, 3)
        Rotation from the body frame to the world frame; may be one matrix (3, 3) for all. NaN,
        as in positions, where a pose was not found.
    """

    position_m: FloatArray
    rotation: FloatArray

    def __post_init__(self) -> None:
        for name in ("position_m", "rotation"):
            value = getattr(self, name)
            is_array = isinstance(value, np.ndarray) and value.dtype == np.float64
            object.__setattr__(self, name, value if is_array else frozen_array(value, name))
        position, rotation = self.position_m, self.rotation
        if position.ndim < 1 or position.shape[-1] != 3:
            raise ValueError(f"position_m must have the shape (…, 3), not {position.shape}")
        if rotation.shape[-2:] != (3, 3):
            raise ValueError(f"rotation must have the shape (…, 3, 3), not {rotation.shape}")
        have, want = rotation.shape[:-2], position.shape[:-1]
        pairs = zip(reversed(have), reversed(want), strict=False)
        if len(have) > len(want) or not all(h in (1, w) for h, w in pairs):
            raise ValueError(f"rotations for {have} poses do not fit positions for {want}")
        # The squares of its entries add up to three; cheap enough for every batch.
        size = np.einsum("...ij,...ij->...", rotation, rotation)
        if np.any(np.abs(size - 3.0) > 1e-6):
            raise ValueError("rotation must consist of rotation matrices")

    @classmethod
    def at(cls, position_m: ArrayLike, rotation_vector_rad: ArrayLike | None = None) -> Poses:
        """Return poses from positions (..., 3) [m] and rotation vectors (..., 3) [rad].

        Both may stand in one array (..., 6).
        """
        position = frozen_array(position_m, "position_m")
        if position.shape[-1] == 6:
            return cls.at(position[..., :3], position[..., 3:])
        if rotation_vector_rad is None:
            return cls(position, frozen_array(np.eye(3)))
        vectors = np.array(rotation_vector_rad, dtype=np.float64)  # SciPy refuses read-only ones
        matrices = Rotation.from_rotvec(vectors.reshape(-1, 3)).as_matrix()
        return cls(position, frozen_array(matrices.reshape(*vectors.shape[:-1], 3, 3)))

    @property
    def place(self) -> FloatArray:
        """Position and rotation vector in one array (..., 6) [m, rad]; see `at`."""
        turn = Rotation.from_matrix(self.rotation.reshape(-1, 3, 3)).as_rotvec()
        turn = np.broadcast_to(turn.reshape(*self.rotation.shape[:-2], 3), self.position_m.shape)
        return np.concatenate([self.position_m, turn], axis=-1)

    @property
    def shape(self) -> tuple[int, ...]:
        """Leading axes of the batch."""
        return self.position_m.shape[:-1]

    @property
    def rotations(self) -> FloatArray:
        """The rotation of each pose (..., 3, 3), also where all have one."""
        return np.broadcast_to(self.rotation, (*self.shape, 3, 3))

    @property
    def flat(self) -> Poses:
        """The poses with one leading axis."""
        count = int(np.prod(self.shape, dtype=np.int64))
        rotation = self.rotation
        if self.shape == (count,) and rotation.shape[:-2] in ((), (count,)):
            return self
        if rotation.ndim > 2:
            rotation = self.rotations.reshape(-1, 3, 3)
        return Poses(self.position_m.reshape(count, 3), rotation)

    def part(self, chosen: int | slice | IntArray | BoolArray) -> Poses:
        """Return some of poses (n_poses,)."""
        rotation = self.rotation if self.rotation.ndim == 2 else self.rotation[chosen]
        return Poses(self.position_m[chosen], rotation)

    def attachment_points_m(self, robot: Robot) -> FloatArray:
        """Return the attachment points in the world frame (..., n_cables, 3) [m]."""
        levers = np.einsum("...ij,nj->...ni", self.rotation, robot.attachments_m)
        return np.asarray(self.position_m[..., None, :] + levers, dtype=np.float64)


@dataclass(frozen=True, slots=True)
class Surroundings:
    """What is around the machine, for effects whose law asks for it.

    A design takes those that the study declares. Where data are compared with the machine, each
    row has its own, which effects on readings are given.
    """

    temperature_C: float = 20.0  #: Temperature of the cables [°C]


TEMPERATE = Surroundings()
"""20 °C, at which lengths are counted."""


@dataclass(frozen=True, slots=True, eq=False)
class Machine:
    """A robot with its cables, and what acts on it beside gravity."""

    robot: Robot  #: Exit points, pulleys, platform, tilt
    cable: Cable  #: The cable that is on the machine, the same on every winch
    drag_area_m2: float = 0.0  #: Drag coefficient times area of the platform, C_d A [m²]
    #: EI of the cable, clamped at both ends along its chord [N·m²]
    flexural_rigidity_N_m2: float = 0.0
    surroundings: Surroundings = TEMPERATE  #: As the study declares them
    #: Mass that is on the platform from a time on [kg], [s]; no design has it
    late_load_kg: float = 0.0
    late_load_from_s: float = 0.0
    #: (n_cables,): Mass per length and EA of each cable over those of ``cable``; None where all are
    #: alike. No design has them.
    relative_mass: FloatArray | None = None
    relative_stiffness: FloatArray | None = None
    #: Mass of the rope on the machine over the circle of its diameter, which tells its material;
    #: NaN where nothing tells it [kg/m³]
    rope_density_kg_per_m3: float = math.nan

    @property
    def cables(self) -> Cable | Cables:
        """The cable that is on all winches, or what is on each where they differ.

        With what is attached along it, of which the effects know nothing.
        """
        attached = self.robot.attached
        if self.relative_mass is None and self.relative_stiffness is None:
            return self.cable.with_attached(attached)
        mass, stiffness = (
            np.ones(self.robot.n_cables) if share is None else share
            for share in (self.relative_mass, self.relative_stiffness)
        )
        return Cables(
            [
                replace(
                    self.cable.with_attached(attached).with_rope_scaled(m),
                    axial_stiffness_N=self.cable.axial_stiffness_N * s,
                )
                for m, s in zip(mass.tolist(), stiffness.tolist(), strict=True)
            ]
        )
