"""What a foreign file says of a robot, in SI units; None where it says nothing."""

from __future__ import annotations

from dataclasses import dataclass, field

from designer.documents.xml import Element

Point = tuple[float, float, float]
Remarks = dict[str, tuple[str, ...]]
"""What to know of a field, by its path in a study; of the whole file under ""."""
ORIGIN: Point = (0.0, 0.0, 0.0)


@dataclass(frozen=True, slots=True)
class ForeignRope:
    """A rope over the circle of its nominal diameter; ``breaking_stress_Pa`` without safety."""

    density_kg_per_m3: float
    breaking_stress_Pa: float
    youngs_modulus_Pa: float | None = None


@dataclass(frozen=True, slots=True)
class ForeignRobot:
    """A robot with one platform, as another program's file has it.

    Parameters
    ----------
    file, name : str
        Where it is from, as the user named it, and its name there.
    source : str
        Which program's files it is from.
    exit_points_m, attachments_m : tuple of points
        One each a cable, world and body frame [m]; attachments are None for a point mass.
    mass_kg, centre_of_mass_m : float, point or None
        Of the platform [kg], body frame [m].
    plane_normal : point or None
        Normal of the plane in which the platform moves; None if it moves in space.
    position_m : point or None
        Where the file has the platform at first [m].
    euler_xyz_rad : point or None
        Angles about its own x, y and z, in this order [rad]; None where the file has others.
    limits_m : tuple of intervals or None
        From where to where it may move, along x, y and z [m].
    tension_min_N : float
        Least tension of a cable [N].
    tension_max_N : float, tuple of float or None, or None
        Largest tension of all cables or, where they differ, of each; None for no limit [N].
    pulley_radius_m : float or None
        Of pulleys that a study can have at the exit points [m].
    rope : ForeignRope or None
        What the cables are.
    remarks : Remarks
        What to know of its fields.
    """

    file: str
    name: str
    source: str
    exit_points_m: tuple[Point, ...]
    attachments_m: tuple[Point, ...] | None
    mass_kg: float | None = None
    centre_of_mass_m: Point | None = None
    plane_normal: Point | None = None
    position_m: Point | None = None
    euler_xyz_rad: Point | None = ORIGIN
    limits_m: tuple[tuple[float, float], ...] | None = None
    tension_min_N: float = 0.0
    tension_max_N: float | tuple[float | None, ...] | None = None
    pulley_radius_m: float | None = None
    rope: ForeignRope | None = None
    remarks: Remarks = field(default_factory=dict)

    @property
    def has_choice(self) -> bool:
        """Whether it has more cables than degrees of freedom."""
        turning = 0 if self.attachments_m is None else 1 if self.plane_normal else 3
        moving = 2 if self.plane_normal else 3
        return len(self.exit_points_m) > moving + turning


def held_at_one_point(element: Element, attachments_m: tuple[Point, ...]) -> Point:
    """Return where all cables hold a platform that does not turn; `InputError` if at several."""
    if len(set(attachments_m)) > 1:
        element.refuse(
            "the platform does not turn though its cables hold it at several points",
            "a free platform, or all cables at one point",
        )
    return attachments_m[0]


def moved(point: Point, by: Point) -> Point:
    """Return the sum of two vectors."""
    x, y, z = (component + shift for component, shift in zip(point, by, strict=True))
    return x, y, z
