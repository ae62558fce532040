"""The config file as pydantic models: what each field is, may hold, and becomes in the study.

Geometry, which needs several fields at once, is checked in `designer.io.config.checks`, and what is
in ``effects`` in `designer.io.config.effects`.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from math import inf
from pathlib import Path
from typing import Annotated, Any, ClassVar, Literal

from pydantic import (
    AfterValidator,
    BeforeValidator,
    Field,
    StrictBool,
    Tag,
    model_validator,
)

from designer.arrays import FloatArray, frozen_array
from designer.documents import fields
from designer.documents.bounds import MAX_CABLES, MOST_SAMPLES
from designer.documents.columns import COVARIATE, IGNORE, column_hint, dimension_of
from designer.documents.fields import (
    Section,
    Text,
    WholeNumber,
    bounded,
    config_field,
    list_of,
    mapping,
    refusal,
)
from designer.documents.plain import CONFIG_FORMAT
from designer.io.config.machine import (
    EULER,
    QUATERNION,
    ROTATION_VECTOR,
    AnyRegion,
    ConfiguredCable,
    EulerSection,
    FollowingSection,
    LoadCaseSection,
    OrientationRangeSection,
    OrientationSection,
    Quaternion,
    RobotSection,
    only_one_of,
    rotation_vector_rad,
)
from designer.model.cable import MaterialName, Preference, PriceList, Trust
from designer.model.measurements import LogColumn, LogSession, Measurements, Reading
from designer.model.motion import Ends
from designer.model.region import Region, Sampling
from designer.model.robot import SAG_MAX, Poses
from designer.model.space import Orientations
from designer.model.uncertainty import INPUTS, Normal, Spread, Uncertainty, Uniform
from designer.model.winches import RUNNING_ROPE, DutyClass, RopeLife
from designer.model.workspace import HangsBelow, Workspace
from designer.study import CableGroup, DocumentControl, Entry, Objective, RopeLimits, Selection
from designer.units import (
    NUMBER,
    TEMPERATURE,
    Dimension,
    QuantityError,
    describe,
    read_quantity,
    unit_conversion,
)

_TARGET = f"a column of ours such as 'length_1_m', or '{IGNORE}', or '{COVARIATE}'"


def _target(value: object) -> str:
    if not isinstance(value, str):
        raise refusal(f"{describe(value)} is not a name", _TARGET)
    if value not in (IGNORE, COVARIATE) and dimension_of(value) is None:
        raise refusal(f"{describe(value)} is no column of ours", _TARGET + column_hint(value))
    return value


class ColumnSection(Section):
    """What one column of a log is to us, and in which unit.

    The value is the reading in its unit, or ``scale`` · reading, plus ``offset``.
    """

    to: Annotated[str, BeforeValidator(_target)] = config_field(expected=_TARGET)
    """Our name, such as length_1_m; ignore; or covariate."""
    unit: Text | None = None
    """Unit of the readings."""
    scale: Annotated[float, bounded("scale of a column")] | None = None
    """Factor from the readings to ours; instead of a unit."""
    offset: Any = None
    """What is added after that, as a quantity."""

    @model_validator(mode="before")
    @classmethod
    def _from_name(cls, value: object) -> object:
        if not isinstance(value, str | dict):
            expected = f"{_TARGET}, or {{to: …, unit: …}}"
            raise refusal(f"{describe(value)} is not a name", expected)
        return {"to": value} if isinstance(value, str) else value

    @model_validator(mode="after")
    def _check_conversion(self) -> ColumnSection:
        self.conversion()
        return self

    def conversion(self) -> tuple[float, float]:
        """Return scale and offset from the log's numbers to ours."""
        dimension = dimension_of(self.to)
        if dimension is None:
            fields_set = self.model_fields_set - {"to"}
            if fields_set:
                raise refusal(f"'{self.to}' takes no {sorted(fields_set)[0]}", f"'{self.to}' alone")
            return 1.0, 0.0
        scale, offset = self._scale(dimension)
        return scale, offset + self._offset(dimension)

    @property
    def meaning(self) -> str:
        """What becomes of a reading, for the table of inputs."""
        scale, offset = self.conversion()
        if (scale, offset) == (1.0, 0.0):
            return self.to
        shift = f" {'-' if offset < 0 else '+'} {abs(offset):.10g}" if offset else ""
        return f"{self.to} = {scale:.10g} · reading{shift}"

    def _scale(self, dimension: Dimension) -> tuple[float, float]:
        if self.scale is not None and self.unit is not None:
            raise refusal("both a unit and a scale are given", "one of the two")
        if self.scale == 0.0:
            raise refusal("the scale is zero", "a factor from the log's numbers to ours")
        if self.unit is None:
            return 1.0 if self.scale is None else self.scale, 0.0
        try:
            return unit_conversion(self.unit, dimension)
        except QuantityError as error:
            _, mark, hint = error.expected.partition("; did you mean")
            expected = f"a unit as in '{dimension.example}'" if dimension.unit else "none"
            problem = f"{describe(self.unit)} is no unit of {dimension.noun}"
            raise refusal(problem, f"{expected}{mark}{hint}") from None

    def _offset(self, dimension: Dimension) -> float:
        # '5 K' as a difference is not 5 K as a temperature
        kind = NUMBER if dimension == TEMPERATURE else dimension
        try:
            return 0.0 if self.offset is None else read_quantity(self.offset, kind)
        except QuantityError as error:
            raise refusal(f"the offset {error.problem}", error.expected) from None


Columns = Annotated[dict[str, ColumnSection], BeforeValidator(mapping)]


_ENDS = "a half width or [lowest, highest]"


def _rising(ends: tuple[float, float]) -> tuple[float, float]:
    if ends[0] >= ends[1]:
        raise refusal(f"the lower end {ends[0]:g} is not below the upper {ends[1]:g}", _ENDS)
    return ends


RelativeEnds = Annotated[
    tuple[Annotated[float, bounded("deviation")], Annotated[float, bounded("deviation")]],
    list_of(2, 2, _ENDS),
    AfterValidator(_rising),
]
PointEnds = Annotated[
    tuple[Annotated[float, bounded("shift")], Annotated[float, bounded("shift")]],
    list_of(2, 2, _ENDS),
    AfterValidator(_rising),
]
Width = Annotated[
    Annotated[float, bounded("half width"), Tag("a half width")]
    | Annotated[RelativeEnds, Tag("ends")],
    fields.by_list("ends", "a half width"),
]
WidthOfPoint = Annotated[
    Annotated[float, bounded("scatter of points"), Tag("a half width")]
    | Annotated[PointEnds, Tag("ends")],
    fields.by_list("ends", "a half width"),
]


class SpreadSection(Section):
    """The distribution of a relative deviation."""

    example: ClassVar = "2 %"
    standard_deviation: Annotated[float, bounded("relative scatter")] | None = config_field(
        "Scatter of the {title}"
    )
    """Standard deviation, of a normal distribution, relative. {meaning}"""
    uniform: Width | None = config_field("Range of the {title}")
    """Half width of a uniform distribution, relative, or its two ends. {meaning}"""

    @model_validator(mode="before")
    @classmethod
    def _is_one_distribution(cls, raw: object) -> object:
        expected = f"{{standard_deviation: {cls.example}}} for a normal distribution, or "
        expected += f"{{uniform: {cls.example}}}"
        if not isinstance(raw, dict):
            raise refusal(f"{describe(raw)} is not a distribution", expected)
        unknown = [name for name in raw if name not in cls.model_fields]
        if unknown:
            raise refusal(f"the distribution {describe(unknown[0])} is not known", expected)
        count = sum(value is not None for value in raw.values())
        if count != 1:
            raise refusal(f"names {'two distributions' if count else 'no distribution'}", expected)
        return raw

    def value(self) -> Spread:
        """Return the distribution."""
        if self.standard_deviation is not None:
            return Normal(self.standard_deviation)
        assert self.uniform is not None  # see above
        if isinstance(self.uniform, tuple):
            return Uniform(*self.uniform)
        return Uniform(-self.uniform, self.uniform)


class PointSpreadSection(SpreadSection):
    """The distribution of each coordinate of each exit point."""

    example: ClassVar = "20 mm"
    standard_deviation: Annotated[float, bounded("scatter of points")] | None = config_field(
        "Scatter of the {title}"
    )
    """Standard deviation, of a normal distribution. {meaning}"""
    uniform: WidthOfPoint | None = config_field("Range of the {title}")
    """Half width of a uniform distribution, or its two ends. {meaning}"""


class UncertaintySection(Section):
    """How surely the inputs are known; what is left out is taken for certain.

    But a modulus that is left out is drawn from what the rope's grade states of it.
    """

    payload: SpreadSection | None = None
    """Of weight, inertia and constant loads of the platform."""
    modulus: SpreadSection | None = None
    """Of the rope's modulus; left out, what its grade states."""
    linear_mass: SpreadSection | None = config_field("Rope's mass")
    """Of the rope's mass per length, on all cables alike."""
    breaking_load: SpreadSection | None = None
    """Of the rope's breaking load, on all cables alike."""
    exit_points: PointSpreadSection | None = None
    """Of each coordinate of each exit point, for itself."""
    samples: Annotated[int, WholeNumber(100, 1_000_000)] = config_field("Draws", 4096)
    """How often the inputs are drawn."""
    seed: Annotated[int, WholeNumber(0, 2**32 - 1)] = config_field("Seed of the draws", 0)
    """Of the random numbers; other seeds, other draws."""

    def value(self) -> Uncertainty:
        """Return how surely the inputs are known."""
        payload, modulus, linear_mass, breaking_load, exit_points = (
            None if section is None else section.value()
            for section in (getattr(self, name) for name in INPUTS)
        )
        return Uncertainty(
            payload, modulus, linear_mass, breaking_load, exit_points, self.samples, self.seed
        )


_INCHES_OR_FEET = re.compile(r"\d\s*(in|inch|inches|ft|foot|feet)\b")
_GRADES = "'all' or a list of grade ids"
_MATERIALS = "'all' or a list of materials such as [steel, stainless]"
Objectives = Annotated[
    tuple[Objective, ...],
    fields.list_of(1, 5, "a list of objectives such as [mass, drum_diameter]"),
    AfterValidator(fields.different),
]
Readings = Annotated[
    tuple[Reading, ...],
    fields.list_of(0, 2, "a list of readings: length, tension or both"),
    AfterValidator(fields.different),
]
Names = Annotated[tuple[fields.Text, ...], fields.list_of(0, 1000, "a list")]
Files = Annotated[
    Annotated[fields.Text, Tag("a file")]
    | Annotated[
        Annotated[tuple[fields.Text, ...], fields.list_of(1, 100, "a list of files")], Tag("files")
    ],
    fields.by_list("files", "a file"),
]
CableNumbers = Annotated[
    tuple[Annotated[int, fields.WholeNumber(1, MAX_CABLES)], ...],
    fields.list_of(1, MAX_CABLES, "a list of one or more cable numbers, such as [1, 2]"),
]
Groups = Annotated[
    dict[fields.Text, CableNumbers],
    BeforeValidator(fields.mapping),
    AfterValidator(fields.not_empty),
]


ORIENTATION_KINDS = ("orientation", "orientations", "orientation_range", "orientation_free")
_PLACES = ("region", "poses", "path")
TurnList = Annotated[
    tuple[OrientationSection, ...],
    fields.list_of(1, 100, "1 to 100 orientations such as [0, 0, 10 deg]"),
]
GradeIds = Annotated[
    Annotated[Literal["all"], fields.only_word("all", _GRADES), Tag("a word")]
    | Annotated[tuple[fields.Text, ...], fields.list_of(1, 1000, _GRADES), Tag("a list")],
    fields.by_word("a list"),
]
_SomeMaterials = Annotated[
    tuple[MaterialName, ...],
    fields.list_of(1, 20, _MATERIALS),
    AfterValidator(fields.different),
]
Materials = Annotated[
    Annotated[Literal["all"], fields.only_word("all", _MATERIALS), Tag("a word")]
    | Annotated[_SomeMaterials, Tag("a list")],
    fields.by_word("a list"),
]


class PoseSection(Section):
    """One pose of the platform."""

    position: fields.Point = config_field(expected="three lengths [x, y, z]")
    """Origin of the platform's frame in the world frame."""
    rotation_vector: fields.Rotation = ROTATION_VECTOR
    quaternion: Quaternion | None = QUATERNION
    euler: EulerSection | None = EULER

    @model_validator(mode="before")
    @classmethod
    def _from_list(cls, raw: object) -> object:
        if fields.in_brackets(raw):
            raise fields.refusal(
                f"{describe(raw)} is not a list", "[x, y, z]" + fields.in_brackets(raw)
            )
        return {"position": raw} if isinstance(raw, list) else only_one_of(raw)

    @property
    def turn_rad(self) -> FloatArray:
        """Rotation vector (3,) [rad]."""
        return rotation_vector_rad(self.rotation_vector, self.quaternion, self.euler)

    def poses(self) -> Poses:
        """Return it as poses, of which it is one."""
        return Poses.at(self.position, self.turn_rad)


class PathSection(Section):
    """A path of the platform, and how fast it is passed."""

    file: fields.Text = config_field("Path", expected="the name of a CSV file")
    """A table, relative to this file: x_m, y_m, z_m, for a platform that turns rx_rad, ry_rad,
    rz_rad, and time_s, or no times but the two limits below."""
    speed_max: fields.RopeSpeed | None = config_field("Speed along the path")
    """Of the platform's origin and of every attachment, where the file has no times."""
    acceleration_max: fields.PathAcceleration | None = config_field("Acceleration along the path")
    """The same of accelerations; half of it at least is left for starting and braking."""
    ends: Ends | None = config_field("Ends of the path")
    """Of a path with times: at_rest (unless given), the platform starts and stops in its first and
    last row; moving, where the path is cut out of a longer motion."""

    @model_validator(mode="before")
    @classmethod
    def _from_name(cls, raw: object) -> object:
        return {"file": raw} if isinstance(raw, str) else raw


class WorkspaceSection(Section):
    """Which poses the cable must serve."""

    region: AnyRegion | None = None
    """Where the platform works: one of prism, box, points and rectangle."""
    poses: fields.Text | None = config_field("Poses to serve")
    """Instead of a region a table of poses, relative to this file: x_m, y_m, z_m, for a platform
    that turns rx_rad, ry_rad, rz_rad, and load_case where a pose is for one of them."""
    path: PathSection | None = config_field("Path to follow")
    """Instead of a region a path that the platform follows, with its inertia: a table, or {file: …,
    speed_max: …, acceleration_max: …} where that has no times."""
    samples: Annotated[int, fields.WholeNumber(1, MOST_SAMPLES)] = 20_000
    """Number of positions of the region that are tried."""
    sampling: Sampling = config_field("Kind of samples", "low_discrepancy")
    """An even random spread (low_discrepancy), or a grid."""
    seed: Annotated[int, fields.WholeNumber(0, 2**32 - 1)] = 0
    """Of the random spread; another one tries other positions."""
    hangs_below: HangsBelow = config_field("Cables that hang below", "include")
    """Whether poses in which a cable hangs below the platform count."""
    clearance: fields.Clearance | None = None
    """Least distance that cables shall keep from each other and from the platform."""
    floor: fields.Length | None = None
    """Height that no cable may hang below."""
    sag: fields.Sag = config_field("Largest sag", SAG_MAX)
    """Largest distance of a cable from its chord, over the chord, at most 50 %. With cables to
    spare, a pose in which some cable would have to sag more is not held."""
    proof: fields.ProofTime | None = config_field("Longest time for the proof", None)
    """How long at most to try to prove that the chosen rope holds in all poses; 0 for not at all.
    Left out, a number of steps ends it, so that the answer is the same on every machine."""
    orientation: FollowingSection | None = None
    """How the platform is turned at every position: fixed, toward a point, or as a table has
    it."""
    orientations: TurnList | None = None
    """Several orientations, all of them asked for at every position."""
    orientation_range: OrientationRangeSection | None = None
    """All rotation vectors between two ends a component, zero where left out, asked for at
    every position."""
    orientation_free: OrientationRangeSection | None = None
    """As orientation_range, but the platform may choose: a position is served if some
    orientation serves. The one that needs the thinnest cable is taken."""

    @model_validator(mode="before")
    @classmethod
    def _is_of_one_kind(cls, value: object) -> object:
        if isinstance(value, dict) and not any(value.get(name) for name in _PLACES):
            raise fields.refusal("there is nothing to serve", "region, poses or path")
        value = only_one_of(value, _PLACES, "the workspace")
        return only_one_of(value, ORIENTATION_KINDS, "the workspace")

    def workspace(self, region: Region, orientations: Orientations) -> Workspace:
        """Return the workspace over a region, in these orientations."""
        return Workspace(
            region=region,
            samples=self.samples,
            sampling=self.sampling,
            seed=self.seed,
            hangs_below=self.hangs_below,
            clearance_m=self.clearance,
            floor_m=self.floor,
            sag_max=self.sag,
            proof_s=0.0 if self.path is not None else inf if self.proof is None else self.proof,
            orientations=orientations,
        )

    def fixed_orientations(self) -> Orientations:
        """Return the orientations, where no law has them."""
        if self.orientation_range is not None:
            return Orientations.within(*self.orientation_range.bounds_rad)
        sections = self.orientations or ((self.orientation,) if self.orientation else ())
        if not sections:
            return Orientations()
        return Orientations(frozen_array([orientation.turn_rad for orientation in sections]))


class LimitsSection(Section):
    """What the chosen rope is checked against beyond its strength."""

    stiffness: fields.Stiffness | None = config_field("Least stiffness")
    """Force per displacement of the platform, in any direction, cables of fixed length."""
    excitation: fields.Band | None = None
    """Band in which no natural frequency of cables and platform may lie, overtones too."""
    drum_capacity: fields.DrumCapacity | None = None
    """Rope that a drum takes up, beside its dead turns."""
    platform_frequency: fields.BandOrLeast | None = config_field("Frequency of the platform")
    """Least natural frequency at which the platform takes part, or a band without one of these."""

    def limits(self) -> RopeLimits:
        """Return the limits."""
        least = self.platform_frequency
        return RopeLimits(
            self.stiffness,
            self.excitation,
            self.drum_capacity,
            (least,) if isinstance(least, float) else least,
        )


class RopeLifeSection(Section):
    """How many bends a wire rope bears, after Feyrer, and how many it shall."""

    b0: fields.LifeConstant = config_field("Constant b0", expected="a number, from its source")
    """Of Feyrer's equation for the number of bending cycles; S in N, d in mm."""
    b1: fields.LifeConstant = config_field("Constant b1", expected="a number, from its source")
    """Of the same equation."""
    b2: fields.LifeConstant = config_field("Constant b2", expected="a number, from its source")
    """Of the same equation."""
    b3: fields.LifeConstant = config_field("Constant b3", expected="a number, from its source")
    """Of the same equation."""
    wire_strength: fields.Stress = config_field(
        "Strength of the wires", expected="a stress such as '1960 MPa'"
    )
    """Nominal tensile strength of the wires."""
    source: fields.Text = config_field(
        "Source of the constants", expected="where the constants are from, in a few words"
    )
    """Where the constants are from: the report prints it."""
    core_factor: fields.LifeFactor = config_field("Factor of the core", 1.0)
    """Of core and number of strands, f_C."""
    runs_per_day: fields.RunsPerDay | None = config_field("Runs a day")
    """How often the machine runs along workspace.path."""
    days_min: fields.Days | None = config_field("Days that the rope shall last")
    """At so many runs a day."""

    def rope_life(self) -> RopeLife:
        """Return them."""
        return RopeLife(
            self.b0, self.b1, self.b2, self.b3, self.wire_strength, self.source,
            self.core_factor, self.runs_per_day, self.days_min,
        )  # fmt: skip


class SelectionSection(Section):
    """How a product is chosen."""

    grades: GradeIds = "all"
    """Grades to choose among: all, or a list of ids from `designer catalog list`."""
    trust: Trust = config_field("Least trust", "B")
    """Lowest trust of a grade that is tried unless `grades` or `prices` name it: A, a maker's or
    standard's own table, B, a seller's transcript, C, third hand; a doubted size counts as C."""
    materials: Materials = "all"
    """Materials to choose among: all, or a list."""
    prefer: Preference | Literal["study"] = config_field("Preferred sizes", "study")
    """Sizes that are chosen before others as good, at most 2 % worse in each objective: metric,
    imperial, none, or study: imperial where most lengths of the study are in inches or feet."""
    safety_factor: fields.SafetyFactor = 5.0
    """What is left of the minimum breaking load, over the allowable tension."""
    duty_class: DutyClass = config_field("Duty class", "none")
    """Group of the mechanism, M1 to M8: gives the safety factor of running ropes (ISO 4308-1) and,
    with a sheave, a least sheave over rope diameter by the class of the rope."""
    objectives: Objectives = ("mass", "drum_diameter", "max_tension")
    """What ropes are compared by; the first decides."""
    prices: fields.Text | None = config_field("Price list")
    """Prices of your own, a CSV file relative to this file with the columns grade, size (or
    diameter_mm), price_per_m, currency and date; they come before all others."""
    termination_efficiency: fields.Efficiency = config_field("End fittings keep", 1.0)
    """Share of the breaking load that the end fittings keep: poured socket about 1, swaged
    0.95, steel ferrule 0.89, clips 0.8, wedge socket 0.75."""
    sheave_diameter: fields.SheaveDiameter | None = None
    """Diameter that the rope is bent over; a wire rope keeps 1 - 0.5/sqrt(D/d) of its breaking
    load. Bending is left out where it is not given."""
    groups: Groups | None = None
    """Cables that may get a rope of their own: names, each with its cable numbers, counted from
    1 in the order of the anchors."""
    max_distinct_products: Annotated[int, fields.WholeNumber(1, MAX_CABLES)] | None = config_field(
        "Different ropes"
    )
    """How many different ropes the groups of cables may have between them."""
    limits: LimitsSection = LimitsSection()
    """What else the chosen rope is checked against."""
    rope_life: RopeLifeSection | None = None
    """Constants that tell how many bends a rope bears along workspace.path."""

    @model_validator(mode="before")
    @classmethod
    def _factor_of_duty_class(cls, raw: object) -> object:
        factor = RUNNING_ROPE.get(str(raw.get("duty_class"))) if isinstance(raw, dict) else None
        if factor is None or not isinstance(raw, dict):
            return raw
        only_one_of(raw, ("safety_factor", "duty_class"), "the selection")
        return {**raw, "safety_factor": factor}

    def selection(self, price_list: PriceList | None, entries: Sequence[Entry]) -> Selection:
        """Return how a product is chosen, with the prices of its list, in a study as given."""
        given = (entry for entry in entries if entry.given != "default")
        lengths = [entry.given for entry in given if entry.value_SI.endswith(" m")]
        in_feet = [given for given in lengths if _INCHES_OR_FEET.search(given)]
        of_study: Preference = "imperial" if 2 * len(in_feet) > len(lengths) else "metric"
        groups = self.groups or {}
        return Selection(
            grades=None if self.grades == "all" else self.grades,
            safety_factor=self.safety_factor,
            duty_class=self.duty_class,
            objectives=self.objectives,
            termination_efficiency=self.termination_efficiency,
            sheave_diameter_m=self.sheave_diameter,
            groups=tuple(CableGroup(name, cables) for name, cables in groups.items()),
            max_distinct_products=self.max_distinct_products,
            limits=self.limits.limits(),
            rope_life=None if self.rope_life is None else self.rope_life.rope_life(),
            price_list=price_list,
            trust=self.trust,
            materials=() if self.materials == "all" else self.materials,
            prefer=of_study if self.prefer == "study" else self.prefer,
        )


class MeasuredCableSection(Section):
    """The cable that is on the machine."""

    linear_mass: fields.LinearDensity = config_field(
        "Mass of the cable on the machine", expected="a mass per length such as '0.142 kg/m'"
    )
    """Mass per length of the cable that was on the machine when it was measured."""
    axial_stiffness: fields.AxialStiffness = config_field(
        "Stiffness of the cable on the machine", expected="a force such as '3.3 MN'"
    )
    """Force per strain of the cable that was on the machine when it was measured."""
    diameter: fields.RopeDiameter | None = config_field("Diameter of the cable on the machine")
    """Nominal diameter of the cable that was on the machine, for laws that ask for it."""
    minimum_breaking_load: fields.BreakingLoad | None = config_field(
        "Breaking load of the cable on the machine"
    )
    """With it the cable is checked as a product would be."""


class NoiseSection(Section):
    """Standard deviations of the measured values."""

    length: fields.LengthNoise | None = config_field("Noise of lengths")
    """Standard deviation of a measured length."""
    tension: fields.TensionNoise | None = config_field("Noise of tensions")
    """Standard deviation of a measured tension."""
    position: fields.LengthNoise | None = config_field("Noise of positions")
    """Standard deviation of a measured coordinate; with `unknown: [poses]`, such as the log has
    are data beside lengths and tensions."""
    rotation: fields.AngleNoise | None = config_field("Noise of angles")
    """The same of a measured angle."""
    estimated: Readings = ()
    """Which of them a diagnosis has estimated; it writes this."""


class PlausibleSection(Section):
    """How far what is unknown may be from the drawing."""

    anchors: fields.Clearance | None = config_field("Exit points")
    """Of each exit point, along each axis; where left out, a tenth of the frame and 0.1 m,
    at most 3 m."""
    attachments: fields.Clearance | None = config_field("Attachment points")
    """Of each attachment point, along each axis; a fifth of the platform where left out."""
    length_offset: fields.Clearance | None = config_field("Homing of the winches")
    """Of each winch; where left out, a tenth of the frame and 0.1 m,
    at most 3 m."""


class SessionSection(Section):
    """One of several times at which the machine was measured."""

    file: Files = config_field(expected="the name of a CSV file, or a list of files")
    """The table of this session, as `measurements.file`."""
    unknown: Names = ()
    """Effects that are fitted for this session alone, as in `measurements.unknown`."""
    effects: fields.FreeMapping = Field(default_factory=dict)
    """What is known of this session alone, as `effects` of the machine; `designer diagnose` writes
    here what it finds."""

    def session(self, folder: Path) -> LogSession:
        """Return its files, from this folder, and what is unknown of it."""
        files = (self.file,) if isinstance(self.file, str) else self.file
        paths = [folder / name for name in files]
        return LogSession(paths[0], tuple(paths[1:]), self.unknown)


Sessions = Annotated[
    tuple[SessionSection, ...],
    fields.list_of(2, 50, "a list of 2 to 50 sessions such as [{file: monday.csv}, …]"),
]


class MeasurementsSection(Section):
    """Data measured on the built machine."""

    file: Files | None = config_field("File")
    """The table, relative to this file: CSV, Excel, Parquet or a bag of ROS; several are joined by
    their times."""
    sessions: Sessions | None = config_field("Sessions")
    """In place of `file`, for a machine that was measured several times: each has a file, and
    may have unknowns and effects of its own; all else here is of all of them."""
    columns: Columns = Field(default_factory=dict)
    """What the file's columns are, where their names are not ours."""
    settled: StrictBool = True
    """Whether each row of the data is a pose at rest; else a sample of a slow motion."""
    unknown: Names = ()
    """Effects that are fitted from the start and not counted as a finding; `anchors` for all
    exit points, `attachments` for all of those; `poses` where the readings have to tell
    them; `ID of cable K` for an effect of one cable."""
    plausible: PlausibleSection = PlausibleSection()
    """How far what is unknown may be from the drawing, before the diagnosis doubts it."""
    cable: MeasuredCableSection = config_field(expected="{linear_mass: …, axial_stiffness: …}")
    """The cable that was on the machine."""
    noise: NoiseSection = NoiseSection()
    """Standard deviations of one reading; estimated from the data where left out."""
    search_time: fields.SearchTime = config_field("Time for the search", 600.0)
    """How long the diagnosis may search for effects."""

    def measurements(self, folder: Path) -> Measurements:
        """Return what was measured, with its files from this folder."""
        sessions = tuple(session.session(folder) for session in self.sessions or ())
        raw = (self.file,) if isinstance(self.file, str) else self.file
        files = [folder / name for name in raw or ()]
        if sessions:
            files = [sessions[0].file, *sessions[0].more_files]
        return Measurements(
            file=files[0],
            more_files=tuple(files[1:]),
            sessions=sessions,
            linear_density_kg_per_m=self.cable.linear_mass,
            axial_stiffness_N=self.cable.axial_stiffness,
            diameter_m=self.cable.diameter,
            minimum_breaking_load_N=self.cable.minimum_breaking_load,
            columns=tuple(
                LogColumn(
                    name,
                    column.to,
                    *column.conversion(),
                    has_unit=column.unit is not None or column.scale is not None,
                )
                for name, column in self.columns.items()
            ),
            settled=self.settled,
            unknown=self.unknown,
            plausible_m=tuple((name, limit) for name, limit in self.plausible if limit is not None),
            length_noise_m=self.noise.length,
            tension_noise_N=self.noise.tension,
            position_noise_m=self.noise.position,
            rotation_noise_rad=self.noise.rotation,
            estimated_noise=self.noise.estimated,
            search_time_s=self.search_time,
        )


class SurroundingsSection(Section):
    """What the laws of effects are given in a design."""

    temperature: fields.Temperature = 20.0
    """What the laws of effects are given in a design; lengths are counted at 20 °C."""


class DocumentSection(Section):
    """What a drawing office writes on the report."""

    number: fields.Text | None = None
    """Number of the document."""
    revision: fields.Text | None = None
    """Its revision."""
    author: fields.Text | None = None
    """Who made it."""
    checker: fields.Text | None = None
    """Who checked it."""
    approver: fields.Text | None = None
    """Who approved it."""
    logo: fields.Text | None = None
    """A picture for the head, PNG, JPEG or SVG, relative to this file."""

    def control(self, folder: Path) -> DocumentControl:
        """Return the head of the report, with its logo from this folder."""
        texts = {name: text or "" for name, text in self if name != "logo"}
        return DocumentControl(**texts, logo=None if self.logo is None else folder / self.logo)


LoadCases = Annotated[
    tuple[LoadCaseSection, ...],
    fields.list_of(0, 50, "a list of at most 50 load cases such as [{name: hoisting, …}]"),
]


class StudySection(Section):
    """The whole file."""

    name: fields.Text | None = None
    """Title of the report."""
    robot: RobotSection = config_field(
        "Robot and load", expected="a mapping with anchors and platform"
    )
    """The machine."""
    cable: ConfiguredCable = config_field(
        "Cable family",
        expected="{density: …, youngs_modulus: …, allowable_stress: …} or {grade: ID}",
    )
    """The family of cables in which the optimum is computed: by its figures, or a grade as if
    it were sold in every diameter."""
    pose: PoseSection | None = None
    """One pose that the report shows in detail."""
    workspace: WorkspaceSection | None = None
    """All poses that the cable has to serve."""
    selection: SelectionSection | None = config_field("Choice of the rope")
    """Which rope to buy."""
    load_cases: LoadCases = ()
    """Load cases, at most 50, in each of which the rope has to hold everywhere; left out, there
    is one case without wind, ice, motion or loss of a cable."""
    catalogues: Names = ()
    """Rope tables of your own: files or folders, relative to this file."""
    measurements: MeasurementsSection | None = config_field("Measured data")
    """What was measured on the built machine, for `designer diagnose`."""
    effects: fields.FreeMapping = Field(default_factory=dict)
    """What the machine is known to do beside the rest, by the ids of effects; `designer
    diagnose` writes here what it finds."""
    surroundings: SurroundingsSection = SurroundingsSection()
    """What the laws of effects are given in a design."""
    document: DocumentSection = DocumentSection()
    """What a drawing office writes at the head of the report."""
    uncertainty: UncertaintySection | None = None
    """How surely inputs are known: how likely the chosen rope is enough. What is left out is
    certain."""
    format: Annotated[int, fields.FormatOf(CONFIG_FORMAT)] = 1
    """Format of this file, for later versions of the program."""
