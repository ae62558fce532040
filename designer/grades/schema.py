"""A grade file as pydantic models: which fields there are and what each may hold.

What a figure may be beside the other figures is checked in `designer.grades.checks`.
"""

from __future__ import annotations

import math
from typing import Annotated, Any, Self

from pydantic import AfterValidator, BeforeValidator, Field, model_validator

from designer.documents.fields import (
    FormatOf,
    ListOf,
    Quantity,
    Temperature,
    Text,
    bounded,
    refusal,
)
from designer.documents.formats import GRADE_FORMAT
from designer.documents.section import Section
from designer.grades import grade as values
from designer.grades.stiffness import Basis
from designer.units import (
    AREA,
    FORCE,
    LENGTH,
    LINEAR_DENSITY,
    Dimension,
    QuantityError,
    describe,
    read_quantity,
)

MOST_SIZES = 500
DIMENSIONS = {
    "diameter": LENGTH,
    "minimum_breaking_load": FORCE,
    "linear_mass": LINEAR_DENSITY,
    "metallic_area": AREA,
}
"""The figures of a size, each with what it is."""


def _on_one_line(text: str) -> str:
    return " ".join(text.split())


def _unit_of(dimension: Dimension) -> BeforeValidator:
    def check(given: object) -> str:
        if not isinstance(given, str):
            raise refusal(f"{describe(given)} is not a unit", f"a unit of {dimension.noun}")
        try:
            read_quantity(f"1 {given}", dimension)
        except QuantityError:
            expected = f"a unit of {dimension.noun} such as '{dimension.unit}'"
            raise refusal(f"{describe(given)} does not fit", expected) from None
        return given

    return BeforeValidator(check)


Line = Annotated[Text, AfterValidator(_on_one_line)]
Lines = Annotated[tuple[Line, ...], BeforeValidator(ListOf(0, 100, "a list of texts"))]
Uncertainty = Annotated[float, bounded("uncertainty")]
Ratio = Annotated[float, bounded("sheave ratio")]
LoadFraction = Annotated[float, bounded("load fraction")]
OverBreakingLoad = Annotated[float, bounded("stiffness over breaking load")]
LoadPoint = Annotated[
    tuple[LoadFraction, OverBreakingLoad],
    BeforeValidator(ListOf(2, 2, "[load fraction, EA over breaking load]")),
]

TemperatureRange = Annotated[
    tuple[Temperature, Temperature], BeforeValidator(ListOf(2, 2, "[lowest, highest]"))
]


class SourceSection(Section):
    """Where the table was read."""

    publisher: Line = Field(description="who published the table")
    document: Line = Field(description="the name of the sheet, page or standard")
    url: Line | None = None
    date: Line | None = None


class ModulusSection(Section):
    """Effective modulus of elasticity."""

    value: Annotated[float, bounded("modulus")] = Field(description="a modulus such as '62.7 GPa'")
    reference_area: values.ReferenceArea = Field(description="'nominal' or 'metallic'")
    basis: Basis = Field(description="'printed', 'computed' or 'borrowed'")
    source: Line = Field(description="where the figure comes from")
    uncertainty: Uncertainty = Field(description="a fraction such as 0.15")


class StiffnessSection(Section):
    """Axial stiffness over breaking load."""

    ea_over_breaking_load: OverBreakingLoad | None = None
    at_load_fraction: LoadFraction | None = None
    by_load_fraction: (
        Annotated[
            tuple[LoadPoint, ...],
            BeforeValidator(ListOf(2, 20, "a list of [load fraction, EA over breaking load]")),
        ]
        | None
    ) = None
    basis: Basis = Field(description="'printed', 'computed' or 'borrowed'")
    source: Line = Field(description="where the figure comes from")
    uncertainty: Uncertainty = Field(description="a fraction such as 0.3")

    @model_validator(mode="after")
    def _is_one_figure_or_a_table(self) -> Self:
        if (self.ea_over_breaking_load is None) == (self.by_load_fraction is None):
            raise refusal(
                "needs one figure or a table", "ea_over_breaking_load or by_load_fraction"
            )
        if self.by_load_fraction is not None and self.at_load_fraction is not None:
            raise refusal("a table has its loads in it", "no at_load_fraction")
        return self


class ThermalExpansionSection(Section):
    """Axial thermal expansion."""

    value: Annotated[float, bounded("expansion")] = Field(
        description="a coefficient such as '12.5e-6 /K'"
    )
    basis: Basis = Field(description="'printed', 'computed' or 'borrowed'")
    source: Line = Field(description="where the figure comes from")


class AreaFactorSection(Section):
    """Metallic area over d²."""

    value: Annotated[float, bounded("area factor")] = Field(description="a number such as 0.449")
    basis: Basis = Field(description="'printed', 'computed' or 'borrowed'")
    source: Line = Field(description="where the figure comes from")


class SheaveRatioSection(Section):
    """Sheave over rope diameter, D/d."""

    suggested: Ratio = Field(description="a number such as 35")
    minimum: Ratio = Field(description="a number such as 23")
    source: Line = Field(description="where the figures come from")


class LimitsSection(Section):
    """What the rope bears beside load."""

    temperature_C: (
        Annotated[
            tuple[Temperature, Temperature], BeforeValidator(ListOf(2, 2, "[lowest, highest]"))
        ]
        | None
    ) = None
    creep: Line | None = None
    source: Line = Field(description="where the limits come from")


class ComputedSection(Section):
    """Columns of the table that the source does not print: how each was computed."""

    minimum_breaking_load: Line | None = None
    linear_mass: Line | None = None
    metallic_area: Line | None = None


class UnitsSection(Section):
    """Units of the bare numbers in the table of sizes."""

    diameter: Annotated[str | None, _unit_of(LENGTH)] = None
    minimum_breaking_load: Annotated[str | None, _unit_of(FORCE)] = None
    linear_mass: Annotated[str | None, _unit_of(LINEAR_DENSITY)] = None
    metallic_area: Annotated[str | None, _unit_of(AREA)] = None


class SizeSection(Section):
    """One row of the table of sizes; `designer.grades.checks` looks at what a rope can be."""

    id: Line = Field(description="the size as its source names it, such as '6 mm'")
    diameter: Annotated[float, Quantity(LENGTH, above=0.0)] = Field(
        description="a length such as '6 mm'"
    )
    minimum_breaking_load: Annotated[float, Quantity(FORCE, above=0.0)] = Field(
        description="a force such as '25 kN'"
    )
    linear_mass: Annotated[float, Quantity(LINEAR_DENSITY, above=0.0)] = Field(
        description="a mass per length such as '0.137 kg/m'"
    )
    metallic_area: Annotated[float, Quantity(AREA, above=0.0)] | None = None
    price_per_m: Annotated[float, bounded("price")] | None = None
    doubt: Line | None = None


class GradeSection(Section):
    """The whole file."""

    id: Line = Field(description="a unique name such as 'maker-7x19-galvanised'")
    manufacturer: Line = Field(description="who makes the rope")
    product: Line = Field(description="the name it is sold under")
    construction: Line = Field(description="such as '7x19'")
    core: Line = Field(description="such as 'WSC', 'IWRC' or 'FC'")
    finish: Line = Field(description="such as 'galvanised'")
    standard: Line | None = None
    wire_grade: Line | None = None
    trust: values.Trust = Field(description="'A', 'B' or 'C'")
    source: SourceSection = Field(description="a mapping with publisher and document")
    material: values.RopeMaterial | None = None
    modulus: ModulusSection | None = None
    stiffness: StiffnessSection | None = None
    area_factor: AreaFactorSection | None = None
    thermal_expansion: ThermalExpansionSection | None = None
    sheave_ratio: SheaveRatioSection | None = None
    limits: LimitsSection | None = None
    currency: Line | None = None
    computed: ComputedSection = ComputedSection()
    notes: Lines = ()
    units: UnitsSection = UnitsSection()
    sizes: Annotated[
        tuple[SizeSection, ...], BeforeValidator(ListOf(1, MOST_SIZES, f"1 to {MOST_SIZES} sizes"))
    ] = Field(description="a list of sizes")
    format: Annotated[int, FormatOf(GRADE_FORMAT)] = 1

    @model_validator(mode="before")
    @classmethod
    def _apply_units(cls, given: object) -> object:
        """Give each bare number of the table the unit that ``units`` declares for it."""
        if not isinstance(given, dict) or not isinstance(given.get("sizes"), list):
            return given
        units = _valid_units(given.get("units"))
        return {**given, "sizes": [_with_units(row, units) for row in given["sizes"]]}


def _valid_units(given: object) -> dict[str, str]:
    """Return the units that fit; the others are reported once, not in every row."""
    try:
        return UnitsSection.model_validate(given).model_dump(exclude_none=True)
    except ValueError:  # pydantic's ValidationError is one
        return {}


def _with_units(row: Any, units: dict[str, str]) -> Any:
    if not isinstance(row, dict):
        return row
    return {key: _with_unit(value, units.get(key)) for key, value in row.items()}


def _with_unit(value: object, unit: str | None) -> object:
    if not unit or isinstance(value, bool) or not isinstance(value, int | float):
        return value
    return f"{value!r} {unit}" if math.isfinite(value) else value
