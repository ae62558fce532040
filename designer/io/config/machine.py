"""The machine as a config has it: what the platform is, what holds it, and of what."""

from __future__ import annotations

from itertools import product
from typing import Annotated

from pydantic import Discriminator, Field, StrictBool, Tag

from designer.arrays import FloatArray, frozen_array
from designer.documents import fields
from designer.documents.bounds import MOST_CABLES
from designer.documents.fields import Text, list_of
from designer.documents.section import Section, config_field
from designer.io.config.regions import Box
from designer.model.robot import Platform, Robot

_points = list_of(2, MOST_CABLES, f"3 to {MOST_CABLES} points [x, y, z], 2 in a plane")

Anchors = Annotated[tuple[fields.Point, ...], _points]
Attachments = Annotated[tuple[fields.Point, ...], _points]


class WrenchSection(Section):
    """Constant load beside gravity, along the axes of the world frame."""

    force: fields.Forces = config_field("Force on the platform", (0.0, 0.0, 0.0))
    """Constant force beside the weight, along the axes of the world frame."""
    moment: fields.Moments = config_field("Moment on the platform", (0.0, 0.0, 0.0))
    """Constant moment about the origin of the platform's frame, along the axes of the world."""

    @property
    def wrench_N(self) -> FloatArray:
        """Force and moment (6,) [N, N·m]."""
        return frozen_array([*self.force, *self.moment])


class DragSection(Section):
    """What the wind finds of the platform."""

    area: fields.DragArea = config_field(
        "Area across the wind", expected="an area such as '1.2 m^2'"
    )
    """Of the platform, as the wind of a load case finds it."""
    coefficient: fields.DragCoefficient = config_field(
        "Drag of the platform", expected="a drag coefficient such as 1.1"
    )
    """Force of the wind over its pressure times the area."""


class PlatformSection(Section):
    """What the cables carry."""

    mass: fields.Mass = config_field("Platform with payload", expected="a mass such as '4000 kg'")
    """Mass that the cables carry: the platform with its payload."""
    attachments: Attachments | None = config_field("Attachment")
    """Where the cable holds the platform, in the platform's own frame."""
    centre_of_mass: fields.Point = (0.0, 0.0, 0.0)
    """Where the platform's weight acts, in its own frame."""
    hull: Box | None = config_field("Hull of the platform")
    """Box, in the platform's own frame, that cables shall keep clear of."""
    wrench: WrenchSection = WrenchSection()
    """Constant load beside the weight, at the origin of the platform's frame."""
    drag: DragSection | None = None
    """What the wind of a load case finds of the platform."""

    def platform(self) -> Platform:
        """Return the platform."""
        return Platform(
            self.mass,
            None if self.attachments is None else frozen_array(self.attachments),
            frozen_array(self.centre_of_mass),
            None if self.hull is None else frozen_array(list(product(*self.hull))),
            self.wrench.wrench_N,
            drag_area_m2=None if self.drag is None else self.drag.area * self.drag.coefficient,
        )


class RobotSection(Section):
    """The machine."""

    anchors: Anchors = config_field("Exit point", expected="at least 3 exit points [x, y, z]")
    """Where the cable leaves the base, in the world frame, z upward."""
    platform: PlatformSection = config_field(expected="a mapping with the platform's mass")
    """What the cables carry."""
    gravity: fields.Direction = (0.0, 0.0, -1.0)
    """Where things fall; only its direction counts."""
    planar: StrictBool = False
    """Whether the robot lies in one vertical plane."""
    tension_min: fields.Tension = config_field("Least tension", 0.0)
    """Least tension anywhere in any cable, where there are more cables than degrees of
    freedom."""

    def robot(self) -> Robot:
        """Return the robot."""
        return Robot(
            frozen_array(self.anchors),
            self.platform.platform(),
            tension_min_N=self.tension_min,
            gravity_direction=frozen_array(self.gravity),
            is_planar=self.planar,
        )


_DRAG = Field(
    None,
    title="Drag of the cables",
    description="Force of a load case's wind over its pressure times the cables' diameter and "
    "length.",
)
_EXPANSION = Field(
    None,
    title="Thermal expansion of the cables",
    description="Strain per change of temperature in load cases; left out, that of the rope's "
    "table, or that of steel, 12e-6 /K.",
)


class CableSection(Section):
    """The continuous family of cables in which the optimum is computed."""

    density: fields.Density = config_field(expected="a density such as '7800 kg/m^3'")
    """Mass per length over the area of the circle of the nominal diameter, of the family in
    which the optimum is computed."""
    youngs_modulus: fields.Modulus = config_field("Modulus", expected="a modulus such as '200 GPa'")
    """Force per strain over the area of the circle of the nominal diameter."""
    allowable_stress: fields.Stress = config_field(expected="a stress such as '180 MPa'")
    """Allowable tension over the area of the circle of the nominal diameter, safety factor
    included."""
    drag_coefficient: fields.DragCoefficient | None = _DRAG
    thermal_expansion: fields.Expansion | None = _EXPANSION


class GradeCableSection(Section):
    """The continuous family of a rope grade."""

    grade: Text = config_field(expected="a grade id from `designer catalog list`")
    """Id of a grade, from `designer catalog list`."""
    safety_factor: fields.SafetyFactor | None = config_field("Safety factor of the family")
    """Breaking load over allowable tension of the grade that the optimum is computed in."""
    drag_coefficient: fields.DragCoefficient | None = _DRAG
    thermal_expansion: fields.Expansion | None = _EXPANSION


def _cable_tag(value: object) -> str:
    names_grade = isinstance(value, dict | GradeCableSection) and "grade" in dict(value)
    return "grade of a cable" if names_grade else "figures of a cable"


ConfiguredCable = Annotated[
    Annotated[CableSection, Tag("figures of a cable")]
    | Annotated[GradeCableSection, Tag("grade of a cable")],
    Discriminator(_cable_tag),
]
