"""Load cases of a config, each of which builds itself, and what they are made of."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Discriminator, Tag, model_validator

from designer.arrays import frozen_array
from designer.documents import fields
from designer.documents.bounds import MOST_CABLES
from designer.documents.fields import Text, WholeNumber, only_word
from designer.documents.section import Section, config_field
from designer.io.config.machine import CableSection, GradeCableSection, WrenchSection
from designer.io.config.orientation import only_one_of
from designer.io.config.regions import AnyRegion
from designer.model.load_case import Ice, LoadCase, Wind
from designer.model.region import Region

LostCable = Annotated[
    Annotated[Literal["each"], only_word("each", "'each' or the number of a cable"), Tag("a word")]
    | Annotated[int, WholeNumber(1, MOST_CABLES), Tag("a number")],
    Discriminator(lambda given: "a word" if isinstance(given, str) else "a number"),
]

Directions = Annotated[
    Annotated[Literal["all"], only_word("all", "'all' or a number of directions"), Tag("a word")]
    | Annotated[int, WholeNumber(1, 72), Tag("a number")],
    Discriminator(lambda given: "a word" if isinstance(given, str) else "a number"),
]


class WindSection(Section):
    """Wind of one speed, from the worst horizontal direction, from so many or along one."""

    speed: fields.Speed = config_field("Wind in load case", expected="a speed such as '20 m/s'")
    """Speed of the wind, horizontal; it acts on the platform and on the cables."""
    directions: Directions | None = config_field("Winds in load case")
    """From how many directions, evenly spread, the wind may come; all searches for the
    worst."""
    direction: fields.Direction | None = None
    """Where the wind blows to; instead of `directions`."""

    @model_validator(mode="before")
    @classmethod
    def _one_kind_of_direction(cls, value: object) -> object:
        return only_one_of(value, ("directions", "direction"), "the wind")

    def wind(self, drag_coefficient: float) -> Wind:
        """Return the wind on cables of this drag."""
        count = None if isinstance(self.directions, str) else self.directions
        along = None if self.direction is None else frozen_array(self.direction)
        return Wind(self.speed, drag_coefficient, count, along)


class IceSection(Section):
    """Ice around the cables."""

    thickness: fields.IceThickness = config_field(
        "Ice in load case", expected="a length such as '10 mm'"
    )
    """Thickness of the ice around the cables."""
    density: fields.Density = config_field("Density of ice in load case", 900.0)
    """Of the ice around the cables."""


class CaseWrenchSection(WrenchSection):
    """Constant load beside gravity, along the axes of the world frame."""

    force: fields.Forces = config_field("Force in load case", (0.0, 0.0, 0.0))
    """Constant force on the platform in this case, along the axes of the world frame."""
    moment: fields.Moments = config_field("Moment in load case", (0.0, 0.0, 0.0))
    """Constant moment on the platform in this case, along the axes of the world frame."""


class LoadCaseSection(Section):
    """One load case; what it leaves out is as in the rest of the study."""

    name: Text = config_field(expected="a name such as 'hoisting'")
    """What the report calls the case."""
    mass: fields.Mass | None = config_field("Mass in load case")
    """Mass of the platform with its payload in this case, instead of the study's."""
    wrench: CaseWrenchSection | None = None
    """Constant load on the platform in this case, instead of the robot's."""
    dynamic_factor: fields.DynamicFactor = config_field("Dynamic factor in load case", 1.0)
    """On the weight and the wrench of the platform, not on the cables' own weight."""
    acceleration: fields.Acceleration = config_field("Acceleration in load case", 0.0)
    """Of the platform, in the direction in which its inertia force is worst."""
    wind: WindSection | None = None
    """Wind on the platform and on the cables."""
    ice: IceSection | None = None
    """Ice around the cables."""
    cable_lost: LostCable | None = config_field("Cable lost in load case")
    """Number of the cable that breaks."""
    temperature_change: fields.TemperatureChange | None = config_field(
        "Change of temperature in load case"
    )
    """Of the cables since the pose was reached; the winches are braked and the lengths kept, so
    that the platform comes to rest elsewhere."""
    safety_factor: fields.SafetyFactor | None = config_field("Safety factor in load case")
    """Instead of that of the selection."""
    termination_efficiency: fields.Efficiency | None = config_field(
        "End fittings keep in load case"
    )
    """Share of the breaking load, instead of that of the selection."""
    region: AnyRegion | None = None
    """Where the platform is in this case, instead of the workspace's region."""

    def load_case(self, cable: CableSection | GradeCableSection, region: Region | None) -> LoadCase:
        """Return the load case, on cables of a family, over its region."""
        return LoadCase(
            name=self.name,
            mass_kg=self.mass,
            wrench_N=None if self.wrench is None else self.wrench.wrench_N,
            dynamic_factor=self.dynamic_factor,
            acceleration_m_per_s2=self.acceleration,
            wind=None if self.wind is None else self.wind.wind(cable.drag_coefficient or 0.0),
            ice=None if self.ice is None else Ice(self.ice.thickness, self.ice.density),
            cable_lost=self.cable_lost,
            temperature_change_K=self.temperature_change,
            expansion_per_K=cable.thermal_expansion,
            safety_factor=self.safety_factor,
            termination_efficiency=self.termination_efficiency,
            region=region,
        )
