"""Parts of a grade beside its sizes, and the kinds of values that its fields hold."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Annotated, Literal, Self, get_args

from pydantic import AfterValidator, BeforeValidator, Field, model_validator

from designer import units
from designer.documents.fields import QuantityField, Temperature, Text, bounded, list_of, refusal
from designer.documents.section import FileValue, Section
from designer.model.cable import Stiffening

DIMENSIONS = {
    "diameter": units.LENGTH,
    "minimum_breaking_load": units.FORCE,
    "linear_mass": units.LINEAR_DENSITY,
    "metallic_area": units.AREA,
}
"""The figures of a size, each with what it is."""


def unit_of(figure: str) -> BeforeValidator:
    """Return the check that a text is a unit of a size's figure."""
    dimension = DIMENSIONS[figure]

    def check(unit: object) -> str:
        if not isinstance(unit, str):
            raise refusal(f"{units.describe(unit)} is not a unit", f"a unit of {dimension.noun}")
        try:
            units.read_quantity(f"1 {unit}", dimension)
        except units.QuantityError:
            expected = dimension.expected_unit
            raise refusal(f"{units.describe(unit)} does not fit", expected) from None
        return unit

    return BeforeValidator(check)


def figure(name: str) -> QuantityField:
    """Return the annotation of a size's figure, which `designer.grades.checks` looks at."""
    return QuantityField(DIMENSIONS[name], above=0.0)


Line = Annotated[Text, AfterValidator(lambda text: " ".join(text.split()))]
Lines = Annotated[tuple[Line, ...], list_of(0, 100, "a list of texts")]
Origin = Annotated[Line, Field(description="where the figure comes from")]
Basis = Literal["printed", "computed", "borrowed"]
"""How a figure was got: printed for this grade, computed from others of it, or another rope's."""
StatedBasis = Annotated[Basis, Field(description="'printed', 'computed' or 'borrowed'")]
Uncertainty = Annotated[float, bounded("uncertainty")]
Ratio = Annotated[float, bounded("sheave ratio")]
LoadFraction = Annotated[float, bounded("load fraction")]
OverBreakingLoad = Annotated[float, bounded("stiffness over breaking load")]
TemperatureRange = Annotated[tuple[Temperature, Temperature], list_of(2, 2, "[lowest, highest]")]
ReferenceArea = Literal["nominal", "metallic"]
ComputedColumn = Literal["minimum_breaking_load", "linear_mass", "metallic_area"]


@dataclass(frozen=True, slots=True)
class Modulus(FileValue):
    """Effective modulus of elasticity of a rope: axial stiffness EA over the reference area."""

    value_Pa: Annotated[
        float, bounded("modulus"), Field(alias="value", description="a modulus such as '62.7 GPa'")
    ]
    #: The same before the rope has bedded in, where it is known. No effect on results.
    new_Pa: Annotated[Annotated[float, bounded("modulus")] | None, Field(alias="new")] = field(
        default=None, kw_only=True
    )
    #: ``nominal``, the circle of the nominal diameter, or ``metallic``
    reference_area: Annotated[ReferenceArea, Field(description="'nominal' or 'metallic'")]
    basis: StatedBasis
    source: Origin  #: of a borrowed one, the lender
    #: relative half-width of the range that the true value may lie in
    uncertainty: Annotated[Uncertainty, Field(description="a fraction such as 0.15")]

    @property
    def figure(self) -> str:
        """The modulus in words."""
        area = {"nominal": "nominal circle", "metallic": "metallic area"}[self.reference_area]
        new = f", {self.new_Pa / 1e9:.4g} GPa when new" if self.new_Pa is not None else ""
        return f"{self.value_Pa / 1e9:.4g} GPa on the {area}{new}"


@dataclass(frozen=True, slots=True)
class ThermalExpansion(FileValue):
    """Axial thermal expansion, how it was got, and its source."""

    coefficient_per_K: Annotated[
        float,
        bounded("expansion"),
        Field(alias="value", description="a coefficient such as '12.5e-6 /K'"),
    ]
    basis: StatedBasis
    source: Origin


@dataclass(frozen=True, slots=True)
class AreaFactor(FileValue):
    """Metallic area over d², for sizes whose metallic area is not given; basis and source."""

    value: Annotated[float, bounded("area factor"), Field(description="a number such as 0.449")]
    basis: StatedBasis
    source: Origin


@dataclass(frozen=True, slots=True)
class SheaveRatio(FileValue):
    """Sheave over rope diameter, D/d: what is suggested, the minimum, and their source."""

    suggested: Annotated[Ratio, Field(description="a number such as 35")]
    minimum: Annotated[Ratio, Field(description="a number such as 23")]
    source: Annotated[Line, Field(description="where the figures come from")]


@dataclass(frozen=True, slots=True)
class Limits(FileValue):
    """What a rope bears beside load: lowest and highest temperature of use [°C], and its creep."""

    temperature_C: TemperatureRange | None = field(default=None, kw_only=True)
    creep: Line | None = field(default=None, kw_only=True)
    source: Annotated[Line, Field(description="where the limits come from")]


@dataclass(frozen=True, slots=True)
class Remark(FileValue):
    """What is known of a rope in words, and its source."""

    text: Annotated[Line, Field(description="what is known, in words")]
    source: Origin

    def __str__(self) -> str:
        return f"{self.text}, {self.source}"


@dataclass(frozen=True, slots=True)
class ComputedFigure:
    """A column of the table of sizes that the source does not print, and how it was computed."""

    figure: ComputedColumn
    how: str


class ComputedSection(Section):
    """Columns of the table that the source does not print, as a file has them."""

    minimum_breaking_load: Line | None = None
    linear_mass: Line | None = None
    metallic_area: Line | None = None

    def value(self) -> tuple[ComputedFigure, ...]:
        """Return those that are given."""
        columns = ((column, getattr(self, column)) for column in get_args(ComputedColumn))
        return tuple(ComputedFigure(column, how) for column, how in columns if how is not None)


@dataclass(frozen=True, slots=True)
class Reference(FileValue):
    """Where a grade's table was read: who published what, its address, its date or edition."""

    publisher: Annotated[Line, Field(description="who published the table")]
    document: Annotated[Line, Field(description="the name of the sheet, page or standard")]
    url: Line | None = None
    date: Line | None = None

    def __str__(self) -> str:
        parts = (self.publisher, self.document, self.date, self.url)
        return ", ".join(part for part in parts if part)


@dataclass(frozen=True, slots=True)
class Units(FileValue):
    """Units of the bare numbers in a file's table of sizes."""

    diameter: Annotated[str | None, unit_of("diameter")] = None
    minimum_breaking_load: Annotated[str | None, unit_of("minimum_breaking_load")] = None
    linear_mass: Annotated[str | None, unit_of("linear_mass")] = None
    metallic_area: Annotated[str | None, unit_of("metallic_area")] = None


@dataclass(frozen=True, slots=True)
class RelativeStiffness:
    """Axial stiffness EA of a worked-in rope over its minimum breaking load.

    A sagging cable is computed with one EA. It is the one at the largest tension that the rope
    meets in a load case, see `designer.selection.cases`; of a continuous family the one at
    its allowable tension, which its thinnest member meets. Strain at low load, and stretch that
    does not come back, are not in it.
    """

    #: EA / MBL, slope of load fraction over strain; one figure, or one for each load.
    ea_over_breaking_load: tuple[float, ...]
    load_fraction: tuple[float, ...]  #: loads over MBL, ascending; empty for one figure for all
    basis: Basis
    source: str
    uncertainty: float

    @property
    def figure(self) -> str:
        """The stiffness in words."""
        ratios = ", ".join(f"{ratio:.4g}" for ratio in self.ea_over_breaking_load)
        loads = ", ".join(f"{load:.4g}" for load in self.load_fraction)
        at_loads = f" at {loads} of it" if loads else ""
        return f"EA is {ratios} times the breaking load{at_loads}"

    @property
    def stiffening(self) -> Stiffening | None:
        """EA over the load, both over the breaking load; None where one figure is for all loads."""
        if len(self.load_fraction) < 2:
            return None
        return Stiffening(self.load_fraction, self.ea_over_breaking_load)

    def at(self, load_fraction: float) -> float:
        """Return EA / MBL at a load over MBL: linear between the loads, constant beyond."""
        law = self.stiffening
        return self.ea_over_breaking_load[0] if law is None else law.at(load_fraction)


class StiffnessSection(Section):
    """A relative stiffness as a file has it: one figure, or a table by load fraction."""

    ea_over_breaking_load: OverBreakingLoad | None = None
    at_load_fraction: LoadFraction | None = None
    by_load_fraction: (
        Annotated[
            tuple[
                Annotated[
                    tuple[LoadFraction, OverBreakingLoad],
                    list_of(2, 2, "[load fraction, EA over breaking load]"),
                ],
                ...,
            ],
            list_of(2, 20, "a list of [load fraction, EA over breaking load]"),
        ]
        | None
    ) = None
    basis: StatedBasis
    source: Origin
    uncertainty: Uncertainty = Field(description="a fraction such as 0.3")

    @model_validator(mode="after")
    def _is_one_figure_or_a_table(self) -> Self:
        if (self.ea_over_breaking_load is None) == (self.by_load_fraction is None):
            expected = "ea_over_breaking_load or by_load_fraction"
            raise refusal("needs one figure or a table", expected)
        if self.by_load_fraction is not None and self.at_load_fraction is not None:
            raise refusal("a table has its loads in it", "no at_load_fraction")
        return self

    def value(self) -> RelativeStiffness:
        """Return the stiffness."""
        if self.by_load_fraction is not None:
            loads, ratios = zip(*self.by_load_fraction, strict=True)
        else:
            assert self.ea_over_breaking_load is not None  # see above
            ratios = (self.ea_over_breaking_load,)
            loads = () if self.at_load_fraction is None else (self.at_load_fraction,)
        return RelativeStiffness(ratios, loads, self.basis, self.source, self.uncertainty)
