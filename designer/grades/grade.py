"""Rope grades: one construction, one wire grade, the sizes it is sold in.

Each field is described once, here: what it is, how a file calls it and what it may hold there
(its annotation), and what it is when a file leaves it out. What figures may be beside each other
is checked in `designer.grades.checks`.

Two reference areas occur in rope data and must not be mixed: the circle of the nominal diameter,
π d²/4, and the metallic area, the sum of the wires' sections. `Modulus` says which one it refers
to; everything that leaves this module refers to the nominal circle, as
`designer.model.cable.Material` does.
"""

from __future__ import annotations

import math
import re
from dataclasses import dataclass, field
from statistics import median
from typing import TYPE_CHECKING, Annotated, Literal, Self, get_args

from pydantic import AfterValidator, BeforeValidator, Field, model_validator

from designer import units
from designer.documents.fields import (
    FileValue,
    FormatOf,
    QuantityField,
    ReadAs,
    Section,
    Temperature,
    Text,
    bounded,
    list_of,
    refusal,
)
from designer.documents.plain import GRADE_FORMAT
from designer.model.cable import STEEL_EXPANSION_PER_K, Cable, Material, Stiffening, Trust

if TYPE_CHECKING:
    from designer.study import Selection


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


RopeMaterial = Literal[
    "steel",
    "stainless steel",
    "HMPE",
    "Vectran",
    "PBO",
    "aramid",
    "polyester",
    "nylon",
    "polyester and nylon",
    "polypropylene",
    "other",
]

MAX_SIZES = 500
_STRAND = re.compile(r"\b1\s*[x×]\s*\d|spiral|locked|\brod\b|\bsolid\b", re.IGNORECASE)
_NO_MAKER = re.compile(r"(not|none|unknown|generic|various|standard \()\b", re.IGNORECASE)
NOT_NAMED = "not in selection.grades"
"""Why a study that names grades does not try another one."""
TYPICAL_LOAD_FRACTION = 0.2
"""Load over breaking load at a safety factor of 5; what stiffness is shown at without a study, and
what a search for the tension that a rope meets starts from."""


MaterialClass = Literal["steel", "stainless steel", "fibre", "not stated"]
MATERIAL_CLASSES: tuple[MaterialClass, ...] = get_args(MaterialClass)
"""In the order of a legend."""
TRUST_MEANING = {
    "A": "the maker's own or a standard's own table",
    "B": "a seller's transcript or a secondary table, consistent in itself",
    "C": "third hand or scattered text",
}


@dataclass(frozen=True, slots=True)
class Size(FileValue):
    """One size of a grade, by its nominal diameter; None where its source gives no figure."""

    id: Annotated[Line, Field(description="the size as its source names it, such as '6 mm'")]
    diameter_m: Annotated[
        float, figure("diameter"), Field(alias="diameter", description="a length such as '6 mm'")
    ]
    minimum_breaking_load_N: Annotated[
        float,
        figure("minimum_breaking_load"),
        Field(alias="minimum_breaking_load", description="a force such as '25 kN'"),
    ]
    linear_density_kg_per_m: Annotated[
        float,
        figure("linear_mass"),
        Field(alias="linear_mass", description="a mass per length such as '0.137 kg/m'"),
    ]
    #: Sum of the wires' sections.
    metallic_area_m2: Annotated[
        Annotated[float, figure("metallic_area")] | None, Field(alias="metallic_area")
    ] = None
    price_per_m: Annotated[float, bounded("price")] | None = None  #: in the grade's currency
    #: Why its figures may be wrong: such a size may be chosen, and its doubt is shown with it.
    doubt: Line | None = None

    @property
    def nominal_area_m2(self) -> float:
        """Area of the circle of the nominal diameter [m²]."""
        return math.pi * self.diameter_m**2 / 4.0

    @property
    def breaking_stress_Pa(self) -> float:
        """Minimum breaking load over the nominal circle [Pa]."""
        return self.minimum_breaking_load_N / self.nominal_area_m2

    @property
    def density_kg_per_m3(self) -> float:
        """Mass per length over the nominal circle [kg/m³]."""
        return self.linear_density_kg_per_m / self.nominal_area_m2


@dataclass(frozen=True, slots=True)
class FamilyFit:
    """The continuous family of a grade, on the nominal circle, and how well its sizes follow it.

    The stress is the breaking one, without a safety factor. The spreads are the lowest and the
    highest deviation of any size from the family, relative to the family.
    """

    density_kg_per_m3: float
    youngs_modulus_Pa: float
    breaking_stress_Pa: float
    n_fitted: int
    linear_density_spread: tuple[float, float]
    breaking_load_spread: tuple[float, float]


@dataclass(frozen=True, slots=True, kw_only=True)
class GradeSheet(FileValue):
    """A grade as its file has it.

    Parameters
    ----------
    id : str
        Unique in a catalogue: lower-case letters, digits, ``.``, ``_`` and ``-``.
    manufacturer, product : str
        Who makes it, and under which name it is sold.
    construction, core, finish : str
        Such as ``6x36 WS``, ``IWRC``, ``galvanised``.
    standard, wire_grade : str or None
        Standard, and tensile grade of the wires, where stated.
    trust : str
        How far to trust it: a key of `TRUST_MEANING`.
    source : Reference
        Where the table was read.
    material : str or None
        What bears the load; None where it is not known.
    modulus : Modulus or None
        Effective modulus of elasticity.
    stiffness : RelativeStiffness or None
        Stiffness over breaking load, for a rope that is described so. A grade has either this or
        a modulus.
    area_factor, thermal_expansion, sheave_ratio, limits
        None where they are not known.
    rotation, permanent_stretch, discard : Remark or None
        How far the rope turns under load, by its class; how much it stays longer once loaded; what
        it is to be discarded at. For a reader: nothing is computed from them.
    currency : str or None
        Of the prices of the sizes, such as ``EUR``.
    computed : tuple of ComputedFigure
        Columns of the table that the source does not print.
    notes : tuple of str
        What a user of the figures should know.
    units : Units or None
        For the reading of the file alone; the sizes are in SI.
    sizes : tuple of Size
        Ascending in diameter.
    format : int
        Of the file.
    """

    id: Annotated[Line, Field(description="a unique name such as 'maker-7x19-galvanised'")]
    manufacturer: Annotated[Line, Field(description="who makes the rope")]
    product: Annotated[Line, Field(description="the name it is sold under")]
    construction: Annotated[Line, Field(description="such as '7x19'")]
    core: Annotated[Line, Field(description="such as 'WSC', 'IWRC' or 'FC'")]
    finish: Annotated[Line, Field(description="such as 'galvanised'")]
    standard: Line | None = None
    wire_grade: Line | None = None
    trust: Annotated[Trust, Field(description="'A', 'B' or 'C'")]
    source: Annotated[Reference, Field(description="a mapping with publisher and document")]
    material: RopeMaterial | None = None
    modulus: Modulus | None = None
    stiffness: Annotated[RelativeStiffness, ReadAs(StiffnessSection)] | None = None
    area_factor: AreaFactor | None = None
    thermal_expansion: ThermalExpansion | None = None
    sheave_ratio: SheaveRatio | None = None
    limits: Limits | None = None
    rotation: Remark | None = None
    permanent_stretch: Remark | None = None
    discard: Remark | None = None
    currency: Line | None = None
    computed: Annotated[tuple[ComputedFigure, ...], ReadAs(ComputedSection)] = ()
    notes: Lines = ()
    units: Units | None = None
    sizes: Annotated[
        tuple[Size, ...],
        list_of(1, MAX_SIZES, f"1 to {MAX_SIZES} sizes"),
        Field(description="a list of sizes"),
    ]
    format: Annotated[int, FormatOf(GRADE_FORMAT)] = 1


@dataclass(frozen=True, slots=True, kw_only=True)
class Grade(GradeSheet):
    """A rope of one construction and one wire grade or fibre, in the sizes it is sold in.

    Parameters
    ----------
    is_nominal : bool
        True for a grade computed from the factors of a standard. It is no product: a selection
        among all grades leaves it out, and takes it where a study names it.
    origin : str
        Name of the plugin or folder the grade came in by; set by the registry.
    file : str
        File it was read from; empty for a grade made in Python.
    **fields
        What a file says: see `GradeSheet`.
    """

    is_nominal: bool = False
    origin: str = ""
    file: str = ""

    def drum_turn_m(self, size: Size) -> float:
        """Return the rope on one turn of the drum that the table suggests [m].

        In one layer, about the rope's centre; NaN where no drum is suggested.
        """
        ratio = self.sheave_ratio
        return math.pi * (ratio.suggested + 1.0) * size.diameter_m if ratio else math.nan

    @property
    def material_class(self) -> MaterialClass:
        """What it bears its load with, in the classes that a reviewer tells apart."""
        if self.material in ("steel", "stainless steel"):
            return self.material
        return "not stated" if self.material in (None, "other") else "fibre"

    @property
    def is_strand(self) -> bool:
        """Whether it is one strand by its construction: of wires, locked coil, or a rod."""
        return _STRAND.search(self.construction) is not None

    @property
    def maker(self) -> str | None:
        """Who makes it; None where its source names nobody."""
        return None if _NO_MAKER.match(self.manufacturer) else self.manufacturer.split(" (")[0]

    @property
    def material_name(self) -> str:
        """Its material as a study names it: `designer.model.cable.MaterialName`."""
        return (self.material or "other").casefold().removesuffix(" steel")

    def why_only_by_name(self, trust: Trust = "B", size: Size | None = None) -> str | None:
        """Why a selection takes this grade, or a size of it, only where the study names it.

        None for others: those whose figures have this trust at least.
        """
        if self.is_nominal:
            return (
                "computed from the factors of a standard, no product; taken where a study names it"
            )
        if self.is_strand:
            return "a single strand, made for stays and not for drums; taken where a study names it"
        if self.trust > trust:
            why = f"its figures are of trust {self.trust}, {TRUST_MEANING[self.trust]}"
            return f"{why}; taken where a study names it or says trust: {self.trust}"
        if size is not None and size.doubt and trust != "C":
            why = "the catalogue doubts the figures of this size, which counts as trust C"
            return f"{why}; taken where a study names the grade or says trust: C"
        return None

    def why_excluded(self, selection: Selection, size: Size | None = None) -> str | None:
        """Why a selection does not try this grade, or this size of it; None where it does.

        A price list names what it offers, but sells no strand for a rope that runs over drums.
        """
        if selection.materials and self.material_name not in selection.materials:
            return "of another material than selection.materials"
        if selection.grades is not None:
            return None if self.id in selection.grades else NOT_NAMED
        if selection.price_list is not None and not self.is_strand:
            for offer in selection.price_list.offers_of(self.id):
                if size is None or offer.is_for(size.id, size.diameter_m):
                    return None
        return self.why_only_by_name(selection.trust, size)

    @property
    def thickest(self) -> Size:
        """The largest size."""
        return self.sizes[-1]

    def metallic_area_m2(self, size: Size) -> float | None:
        """Return the metallic area of a size, as given or by the area factor [m²]."""
        if size.metallic_area_m2 is not None or self.area_factor is None:
            return size.metallic_area_m2
        return self.area_factor.value * size.diameter_m**2

    @property
    def fill_factor(self) -> float | None:
        """Metallic area over the nominal circle, of the thickest; None where it is not known."""
        area_m2 = self.metallic_area_m2(self.thickest)
        return None if area_m2 is None else area_m2 / self.thickest.nominal_area_m2

    @property
    def elasticity(self) -> Modulus | RelativeStiffness:
        """The modulus or the relative stiffness, whichever the grade has.

        Raises
        ------
        ValueError
            If it has neither.
        """
        stiffness = self.modulus or self.stiffness
        if stiffness is None:
            raise ValueError(f"{self.id}: neither modulus nor stiffness is known")
        return stiffness

    def axial_stiffness_N(self, size: Size, load_fraction: float = TYPICAL_LOAD_FRACTION) -> float:
        """Return EA of a size [N]; of a fibre rope, EA at this load over breaking load.

        Raises
        ------
        ValueError
            If the grade has neither modulus nor stiffness, or if the modulus refers to a metallic
            area that is not known.
        """
        elasticity = self.elasticity
        if isinstance(elasticity, RelativeStiffness):
            return elasticity.at(load_fraction) * size.minimum_breaking_load_N
        if elasticity.reference_area == "nominal":
            return elasticity.value_Pa * size.nominal_area_m2
        area_m2 = self.metallic_area_m2(size)
        if area_m2 is None:
            raise ValueError(f"{self.id}, {size.id}: the metallic area is not known")
        return elasticity.value_Pa * area_m2

    def cable(self, size: Size, safety_factor: float) -> Cable:
        """Return one size as a cable, its breaking load divided by ``safety_factor``.

        Where EA depends on the tension it is that at `TYPICAL_LOAD_FRACTION`, until the tension
        that the cable meets is known; the safety factor is not in it.
        """
        expansion, breaking_N = self.thermal_expansion, size.minimum_breaking_load_N
        law = self.stiffness.stiffening if self.stiffness and not self.modulus else None
        return Cable(
            diameter_m=size.diameter_m,
            linear_density_kg_per_m=size.linear_density_kg_per_m,
            axial_stiffness_N=self.axial_stiffness_N(size),
            allowable_tension_N=breaking_N / safety_factor,
            expansion_per_K=expansion.coefficient_per_K if expansion else STEEL_EXPANSION_PER_K,
            stiffening=law and law.scaled(breaking_N, breaking_N),
        )

    def family(self, safety_factor: float) -> Material:
        """Return the continuous family of this grade, see `fit`.

        As stiff as at its allowable tension, which the thinnest member that serves meets.
        """
        fit = self.fit(1.0 / safety_factor)
        return Material(
            density_kg_per_m3=fit.density_kg_per_m3,
            youngs_modulus_Pa=fit.youngs_modulus_Pa,
            allowable_stress_Pa=fit.breaking_stress_Pa / safety_factor,
        )

    def fit(self, load_fraction: float = TYPICAL_LOAD_FRACTION) -> FamilyFit:
        """Return the continuous family fitted to the sizes, stiff as it is at this load.

        Mass, stiffness and breaking load over the nominal circle would be the same for every
        size of an ideal grade. Tables deviate: masses of thin sizes are rounded coarsely, single
        figures are misprinted, some sizes are another rope. The median over the sizes is not
        moved by any of these, and is exact for a grade that follows the law. A least-squares fit
        of the loads themselves would follow the two or three thickest sizes alone, a fit of the
        ratios the worst misprint.
        """
        # A doubt that most of a table shares is about the table, and the few sizes that are left
        # would be its exceptions rather than its rule.
        certain = tuple(size for size in self.sizes if size.doubt is None)
        trusted = certain if 2 * len(certain) >= len(self.sizes) else self.sizes
        density = median(size.density_kg_per_m3 for size in trusted)
        stress = median(size.breaking_stress_Pa for size in trusted)
        return FamilyFit(
            density_kg_per_m3=density,
            youngs_modulus_Pa=median(
                self.axial_stiffness_N(size, load_fraction) / size.nominal_area_m2
                for size in trusted
            ),
            breaking_stress_Pa=stress,
            n_fitted=len(trusted),
            linear_density_spread=_spread([s.density_kg_per_m3 / density for s in self.sizes]),
            breaking_load_spread=_spread([s.breaking_stress_Pa / stress for s in self.sizes]),
        )


def _spread(ratios: list[float]) -> tuple[float, float]:
    return min(ratios) - 1.0, max(ratios) - 1.0
