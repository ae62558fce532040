"""The config file as pydantic models: which fields there are and what each may hold.

Geometry, which needs several fields at once, is checked in `designer.io.config.checks`, and what is
in ``effects`` in `designer.io.config.effects`.
"""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import (
    AfterValidator,
    BeforeValidator,
    Discriminator,
    Field,
    StrictBool,
    Tag,
    model_validator,
)

from designer.documents import fields
from designer.documents.bounds import MOST_SAMPLES
from designer.documents.fields import (
    FormatOf,
    Text,
    WholeNumber,
    different,
    in_brackets,
    list_of,
    mapping,
    not_empty,
    only_word,
    refusal,
)
from designer.documents.formats import CONFIG_FORMAT
from designer.documents.section import Section
from designer.io.config.columns import Columns
from designer.io.config.document_head import DocumentSection
from designer.io.config.loads import (
    MOST_CABLES,
    DragSection,
    IceSection,
    LostCable,
    WindSection,
)
from designer.io.config.orientation import (
    EulerSection,
    OrientationRangeSection,
    OrientationSection,
    Quaternion,
    only_one_of,
)
from designer.io.config.regions import AnyRegion, Box, word_or_list
from designer.io.config.uncertainty import UncertaintySection
from designer.model.measurements import Reading
from designer.model.region import Sampling
from designer.model.workspace import SAG_MAX, HangsBelow
from designer.study import Objective
from designer.units import describe

_GRADES = "'all' or a list of grade ids"
_points = list_of(2, MOST_CABLES, f"3 to {MOST_CABLES} points [x, y, z], 2 in a plane")

Anchors = Annotated[tuple[fields.Point, ...], _points]
Attachments = Annotated[tuple[fields.Point, ...], _points]
Objectives = Annotated[
    tuple[Objective, ...],
    list_of(1, 5, "a list of objectives such as [mass, drum_diameter]"),
    AfterValidator(different),
]
Readings = Annotated[
    tuple[Reading, ...],
    list_of(0, 2, "a list of readings: length, tension or both"),
    AfterValidator(different),
]
Names = Annotated[tuple[Text, ...], list_of(0, 1000, "a list")]
CableNumbers = Annotated[
    tuple[Annotated[int, WholeNumber(1, MOST_CABLES)], ...],
    list_of(1, MOST_CABLES, "a list of one or more cable numbers, such as [1, 2]"),
]
Groups = Annotated[dict[Text, CableNumbers], BeforeValidator(mapping), AfterValidator(not_empty)]


ORIENTATION_KINDS = ("orientation", "orientations", "orientation_range")
TurnList = Annotated[
    tuple[OrientationSection, ...],
    list_of(1, 100, "1 to 100 orientations such as [0, 0, 10 deg]"),
]
GradeIds = Annotated[
    Annotated[Literal["all"], only_word("all", _GRADES), Tag("a word")]
    | Annotated[tuple[Text, ...], list_of(1, 1000, _GRADES), Tag("a list")],
    Discriminator(word_or_list),
]


class WrenchSection(Section):
    """Constant load beside gravity, along the axes of the world frame."""

    force: fields.Forces = (0.0, 0.0, 0.0)
    moment: fields.Moments = (0.0, 0.0, 0.0)


class PlatformSection(Section):
    """What the cables carry."""

    mass: fields.Mass = Field(description="a mass such as '4000 kg'")
    attachments: Attachments | None = None
    centre_of_mass: fields.Point = (0.0, 0.0, 0.0)
    hull: Box | None = None
    wrench: WrenchSection = WrenchSection()
    drag: DragSection | None = None


class RobotSection(Section):
    """The machine."""

    anchors: Anchors = Field(description="at least 3 exit points [x, y, z]")
    platform: PlatformSection = Field(description="a mapping with the platform's mass")
    gravity: fields.Direction = (0.0, 0.0, -1.0)
    planar: StrictBool = False
    tension_min: fields.Tension = 0.0


class CableSection(Section):
    """The continuous family of cables in which the optimum is computed."""

    density: fields.Density = Field(description="a density such as '7800 kg/m^3'")
    youngs_modulus: fields.Modulus = Field(description="a modulus such as '200 GPa'")
    allowable_stress: fields.Stress = Field(description="a stress such as '180 MPa'")
    drag_coefficient: fields.DragCoefficient | None = None
    thermal_expansion: fields.Expansion | None = None


class GradeCableSection(Section):
    """The continuous family of a rope grade."""

    grade: Text = Field(description="a grade id from `designer catalog list`")
    safety_factor: fields.SafetyFactor | None = None
    drag_coefficient: fields.DragCoefficient | None = None
    thermal_expansion: fields.Expansion | None = None


def _cable_tag(value: object) -> str:
    names_grade = isinstance(value, dict | GradeCableSection) and "grade" in dict(value)
    return "grade of a cable" if names_grade else "figures of a cable"


ConfiguredCable = Annotated[
    Annotated[CableSection, Tag("figures of a cable")]
    | Annotated[GradeCableSection, Tag("grade of a cable")],
    Discriminator(_cable_tag),
]


class PoseSection(Section):
    """One pose of the platform."""

    position: fields.Point = Field(description="three lengths [x, y, z]")
    rotation_vector: fields.Rotation = (0.0, 0.0, 0.0)
    quaternion: Quaternion | None = None
    euler: EulerSection | None = None

    @model_validator(mode="before")
    @classmethod
    def _from_list(cls, given: object) -> object:
        if in_brackets(given):
            raise refusal(f"{describe(given)} is not a list", "[x, y, z]" + in_brackets(given))
        return {"position": given} if isinstance(given, list) else only_one_of(given)


class WorkspaceSection(Section):
    """Which poses the cable must serve."""

    region: AnyRegion = Field(description="one of {prism, z}, {box}, {points} and {rectangle, z}")
    samples: Annotated[int, WholeNumber(1, MOST_SAMPLES)] = 20_000
    sampling: Sampling = "low_discrepancy"
    seed: Annotated[int, WholeNumber(0, 2**32 - 1)] = 0
    hangs_below: HangsBelow = "include"
    clearance: fields.Clearance | None = None
    floor: fields.Length | None = None
    sag: fields.Sag = SAG_MAX
    proof: fields.ProofTime = 20.0
    orientation: OrientationSection | None = None
    orientations: TurnList | None = None
    orientation_range: OrientationRangeSection | None = None

    @model_validator(mode="before")
    @classmethod
    def _one_kind_of_orientation(cls, value: object) -> object:
        return only_one_of(value, ORIENTATION_KINDS, "the workspace")


class LimitsSection(Section):
    """What the chosen rope is checked against beyond its strength."""

    stiffness: fields.Stiffness | None = None
    excitation: fields.Band | None = None
    drum_capacity: fields.DrumCapacity | None = None


class SelectionSection(Section):
    """How a product is chosen."""

    grades: GradeIds = "all"
    safety_factor: fields.SafetyFactor = 5.0
    objectives: Objectives = ("mass", "drum_diameter", "max_tension")
    termination_efficiency: fields.Efficiency = 1.0
    sheave_diameter: fields.SheaveDiameter | None = None
    groups: Groups | None = None
    max_distinct_products: Annotated[int, WholeNumber(1, MOST_CABLES)] | None = None
    limits: LimitsSection = LimitsSection()


class LoadCaseSection(Section):
    """One load case; what it leaves out is as in the rest of the study."""

    name: Text = Field(description="a name such as 'hoisting'")
    mass: fields.Mass | None = None
    wrench: WrenchSection | None = None
    dynamic_factor: fields.DynamicFactor = 1.0
    acceleration: fields.Acceleration = 0.0
    wind: WindSection | None = None
    ice: IceSection | None = None
    cable_lost: LostCable | None = None
    temperature_change: fields.TemperatureChange | None = None
    safety_factor: fields.SafetyFactor | None = None
    termination_efficiency: fields.Efficiency | None = None
    region: AnyRegion | None = None


class MeasuredCableSection(Section):
    """The cable that is on the machine."""

    linear_mass: fields.LinearDensity = Field(description="a mass per length such as '0.142 kg/m'")
    axial_stiffness: fields.AxialStiffness = Field(description="a force such as '3.3 MN'")
    diameter: fields.RopeDiameter | None = None
    minimum_breaking_load: fields.BreakingLoad | None = None


class NoiseSection(Section):
    """Standard deviations of the measured values."""

    length: fields.LengthNoise | None = None
    tension: fields.TensionNoise | None = None
    estimated: Readings = ()


class MeasurementsSection(Section):
    """Data measured on the built machine."""

    file: Text = Field(description="the name of a CSV file")
    columns: Columns = Field(default_factory=dict)
    settled: StrictBool = True
    unknown: Names = ()  # checked by designer.io.config.checks
    cable: MeasuredCableSection = Field(description="{linear_mass: …, axial_stiffness: …}")
    noise: NoiseSection = NoiseSection()
    search_time: fields.SearchTime = 600.0


class SurroundingsSection(Section):
    """What the laws of effects are given in a design."""

    temperature: fields.Temperature = 20.0


LoadCases = Annotated[
    tuple[LoadCaseSection, ...],
    list_of(0, 50, "a list of at most 50 load cases such as [{name: hoisting, …}]"),
]


class StudySection(Section):
    """The whole file."""

    name: Text | None = None
    robot: RobotSection = Field(description="a mapping with anchors and platform")
    cable: ConfiguredCable = Field(
        description="{density: …, youngs_modulus: …, allowable_stress: …} or {grade: ID}"
    )
    pose: PoseSection | None = None
    workspace: WorkspaceSection | None = None
    selection: SelectionSection | None = None
    load_cases: LoadCases = ()
    catalogues: Names = ()
    measurements: MeasurementsSection | None = None
    # designer.io.config.effects checks what is in it
    effects: fields.FreeMapping = Field(default_factory=dict)
    surroundings: SurroundingsSection = SurroundingsSection()
    document: DocumentSection = DocumentSection()
    uncertainty: UncertaintySection | None = None
    format: Annotated[int, FormatOf(CONFIG_FORMAT)] = 1
