"""Orientation of a pose in the config: rotation vector, unit quaternion, or Euler angles."""

from __future__ import annotations

import math
import re
from typing import Annotated

import numpy as np
from pydantic import AfterValidator, BeforeValidator, Field, model_validator
from scipy.spatial.transform import Rotation as SpatialRotation

from designer.arrays import FloatArray
from designer.documents.fields import Rotation, Turn, bounded, list_of, refusal
from designer.documents.section import Section, config_field
from designer.units import describe

FORMS = ("rotation_vector", "quaternion", "euler")
_LARGEST_NORM_ERROR = 1e-3

_AXES = "three axes such as XYZ, which turn with the body, or xyz, which do not"


def _of_unit_length(parts: tuple[float, float, float, float]) -> tuple[float, ...]:
    length = math.hypot(*parts)
    if abs(length - 1.0) > _LARGEST_NORM_ERROR:
        raise refusal(f"the quaternion has length {length:.6g}", "length 1, as [w, x, y, z]")
    return parts


def _convention(value: object) -> str:
    axes = r"(?!.*(.)\1)(?:[XYZ]{3}|[xyz]{3})"
    if not isinstance(value, str) or not re.fullmatch(axes, value):
        raise refusal(f"{describe(value)} is no order of axes", _AXES)
    return value


def only_one_of(value: object, names: tuple[str, ...] = FORMS, owner: str = "the pose") -> object:
    """Return a mapping unchanged, or refuse it if it has several of these fields."""
    if isinstance(value, dict):
        given_kinds = [name for name in names if value.get(name) is not None]
        if len(given_kinds) > 1:
            raise refusal(f"{owner} has {' and '.join(given_kinds)}", f"one of {', '.join(names)}")
    return value


_Number = Annotated[float, bounded("part of a quaternion")]
Quaternion = Annotated[
    tuple[_Number, _Number, _Number, _Number],
    list_of(4, 4, "four numbers [w, x, y, z]"),
    AfterValidator(_of_unit_length),
]
Convention = Annotated[str, BeforeValidator(_convention)]


class EulerSection(Section):
    """Three turns, one after the other.

    Capital letters name axes that turn with the body (intrinsic), small ones axes that stay
    (extrinsic); the turns are made in the order of the letters.
    """

    convention: Convention = config_field(expected=_AXES)
    """Order of the axes: XYZ turn with the platform, xyz stay."""
    angles: Rotation = config_field(
        "Euler angle", expected="three angles, in the order of the axes"
    )
    """Turned about in the order of the convention."""


_TURN = "Component of the rotation vector: axis times angle, from the platform's frame to the world"
_BETWEEN = f"{_TURN}: from where to where."
ROTATION_VECTOR = Field((0.0, 0.0, 0.0), title="Turn", description=f"{_TURN}.")
QUATERNION = Field(
    None,
    description="Orientation as a unit quaternion [w, x, y, z] from the platform's frame to the "
    "world.",
)
EULER = Field(None, description="Orientation as three turns, one after the other.")


class OrientationSection(Section):
    """How the platform is turned, in one of three forms."""

    rotation_vector: Rotation = ROTATION_VECTOR
    quaternion: Quaternion | None = QUATERNION
    euler: EulerSection | None = EULER

    @model_validator(mode="before")
    @classmethod
    def _from_list(cls, given: object) -> object:
        return {"rotation_vector": given} if isinstance(given, list) else only_one_of(given)

    def __str__(self) -> str:
        """Return the rotation vector with its unit, for the table of inputs."""
        return f"[{', '.join(f'{angle:.6g}' for angle in self.turn_rad)}] rad"

    @property
    def turn_rad(self) -> FloatArray:
        """Rotation vector (3,) [rad]."""
        return rotation_vector_rad(self.rotation_vector, self.quaternion, self.euler)


class OrientationRangeSection(Section):
    """Components of the rotation vector between two ends each; zero where left out."""

    rx: Turn | None = Field(None, title="Turn about x", description=_BETWEEN)
    ry: Turn | None = Field(None, title="Turn about y", description=_BETWEEN)
    rz: Turn | None = Field(None, title="Turn about z", description=_BETWEEN)

    @model_validator(mode="after")
    def _has_a_component(self) -> OrientationRangeSection:
        if self.rx is None and self.ry is None and self.rz is None:
            raise refusal("the range is empty", "one or more of rx, ry and rz, as [lower, upper]")
        return self

    @property
    def bounds_rad(self) -> FloatArray:
        """Lowest and highest rotation vector (2, 3) [rad]."""
        return np.array([component or (0.0, 0.0) for component in (self.rx, self.ry, self.rz)]).T


def rotation_vector_rad(
    vector: tuple[float, float, float],
    quaternion: tuple[float, ...] | None,
    euler: EulerSection | None,
) -> FloatArray:
    """Return the orientation as a rotation vector (3,) [rad], from the one form that is given.

    The quaternion is from body to world, scalar first; it is scaled to unit length.
    """
    if quaternion is not None:
        scalar_last = np.roll(quaternion, -1)
        return np.asarray(SpatialRotation.from_quat(scalar_last).as_rotvec())
    if euler is not None:
        return np.asarray(SpatialRotation.from_euler(euler.convention, euler.angles).as_rotvec())
    return np.array(vector)
