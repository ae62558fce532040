"""What a foreign file says of a robot, in SI units; None where it says nothing."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace

from designer.documents.xml import Element

Point = tuple[float, float, float]
Remarks = dict[str, tuple[str, ...]]
"""What to know of a field, by its path in a study; of the whole file under ""."""
ORIGIN: Point = (0.0, 0.0, 0.0)
WINCHES_N = (1.0, 1e8)
"""From a thread to ten times what strand jacks pull, the strongest [N]."""


@dataclass(frozen=True, slots=True)
class ForeignRope:
    """A rope over the circle of its nominal diameter; ``breaking_stress_Pa`` without safety."""

    density_kg_per_m3: float
    breaking_stress_Pa: float
    youngs_modulus_Pa: float | None = None


@dataclass(frozen=True, slots=True)
class ForeignRobot:
    """A robot with one platform, as another program's file has it."""

    file: str  #: as the user named it
    name: str  #: of the robot, in the file
    source: str  #: which program's files it is from
    exit_points_m: tuple[Point, ...]  #: one of each cable, world frame [m]
    attachments_m: tuple[Point, ...] | None  #: the same, body frame [m]; None for a point mass
    mass_kg: float | None = None  #: of the platform [kg]
    centre_of_mass_m: Point | None = None  #: of the platform, body frame [m]
    plane_normal: Point | None = None  #: of the plane that it moves in; None if it moves in space
    turns: bool = True  #: whether its joint lets the platform turn
    position_m: Point | None = None  #: where the file has it at first [m]
    #: Angles about its own x, y and z, in this order [rad]; None where the file has others.
    euler_xyz_rad: Point | None = ORIGIN
    limits_m: tuple[tuple[float, float], ...] | None = None  #: of its moves along x, y and z [m]
    tension_min_N: float = 0.0  #: of any cable [N]
    #: Of all cables or, where they differ, of each; None for no limit [N].
    tension_max_N: float | tuple[float | None, ...] | None = None
    pulley_radius_m: float | None = None  #: of pulleys that a study can have at the exit points [m]
    rope: ForeignRope | None = None
    remarks: Remarks = field(default_factory=dict)

    @property
    def has_choice(self) -> bool:
        """Whether it has more cables than degrees of freedom."""
        turning = 0 if self.attachments_m is None else 1 if self.plane_normal else 3
        moving = 2 if self.plane_normal else 3
        return len(self.exit_points_m) > moving + turning

    def as_point_mass(self) -> ForeignRobot:
        """Return it as a point mass where all cables meet; unchanged where they do not."""
        from scipy.spatial.transform import Rotation

        if self.attachments_m is None or len(set(self.attachments_m)) > 1:
            return self
        point, position_m = self.attachments_m[0], None
        if self.position_m is not None and (self.euler_xyz_rad or not any(point)):
            rotation = Rotation.from_euler("XYZ", self.euler_xyz_rad or ORIGIN)
            position_m = moved(self.position_m, rotation.apply(point).tolist())
        limits_m = self.limits_m and tuple(
            (low + d, high + d) for (low, high), d in zip(self.limits_m, point, strict=True)
        )
        remarks = dict(self.remarks)
        if self.turns:
            remark = "All cables hold the platform at one point: it is a point mass there."
            remarks["robot"] = (*remarks.get("robot", ()), remark)
        return replace(
            self,
            attachments_m=None,
            position_m=position_m,
            euler_xyz_rad=ORIGIN,
            limits_m=limits_m,
            remarks=remarks,
        )


def largest_tension_N(force_N: float | None, remarks: Remarks) -> float | None:
    """Return the limit of a winch [N]; None, with a remark, for a number that is none."""
    if force_N is None or WINCHES_N[0] <= force_N < WINCHES_N[1]:
        return force_N
    remarks["robot.winches"] = (
        f"The file has a largest tension of {force_N:g} N, which is no winch's: taken as no limit.",
    )
    return None


def held_at_one_point(element: Element, attachments_m: tuple[Point, ...]) -> None:
    """Require that all cables hold a platform that does not turn at one point."""
    if len(set(attachments_m)) > 1:
        element.refuse(
            "the platform does not turn though its cables hold it at several points",
            "a free platform, or all cables at one point",
        )


def moved(point: Point, by: Point) -> Point:
    """Return the sum of two vectors."""
    x, y, z = (component + shift for component, shift in zip(point, by, strict=True))
    return x, y, z


@dataclass(frozen=True, slots=True)
class Importer:
    """What reads a kind of file; `designer.errors.InputError` from it is shown as it stands."""

    ending: str  #: of the files' names, such as ``.points``
    read: Callable[..., ForeignRobot]  #: from the path; and, of a model in parts, from two more
    #: Whether it also takes the path of the other file, and which set of cables; None for usual.
    has_parts: bool = False
