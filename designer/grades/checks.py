"""Checks of a grade: each field by itself, then its figures beside each other.

Breaking load over d² and mass over d² hardly change within a grade, and lie within known bounds
for every rope of a material. A figure in the wrong unit (lb/ft for kg/m, lbf for N), with two
digits swapped, or on the wrong reference area breaks one of these rules, which are looked at where
each figure makes sense by itself.

A rope is lighter and weaker than the same circle full of its fibre or wire. Its stiffness over
its strength is near that of the yarn, since laying and braiding lower both.
"""

from __future__ import annotations

import dataclasses
import math
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from statistics import median
from typing import get_args

from designer.documents.bounds import BOUNDS
from designer.documents.document import Flaw, Keys
from designer.grades.grade import Basis, ComputedColumn, Grade, ReferenceArea, RopeMaterial, Size
from designer.model.cable import Trust

_ID = re.compile(r"[a-z0-9][a-z0-9._-]{0,79}")
_LONGEST_TEXT = 1000
_EA_OVER_MBL = (0.5, 1000.0)

_FIGURES = {
    "diameter": ("diameter_m", BOUNDS["rope diameter"]),
    "minimum_breaking_load": ("minimum_breaking_load_N", BOUNDS["breaking load"]),
    "linear_mass": ("linear_density_kg_per_m", BOUNDS["mass per length"]),
    "metallic_area": ("metallic_area_m2", BOUNDS["metallic area"]),
    "price_per_m": ("price_per_m", BOUNDS["price"]),
}


def find_flaws(grade: Grade) -> list[Flaw]:
    """Return everything that is wrong with a grade, in the order of its fields."""
    checks = (_identity, _choices, _elasticity, _extras, _figures)
    flaws = [flaw for check in checks for flaw in check(grade)]
    return flaws or [*_areas(grade)] or [*proportion_flaws(grade)]


def _identity(grade: Grade) -> Iterator[Flaw]:
    for name in ("manufacturer", "product", "construction", "core", "finish"):
        if not isinstance(getattr(grade, name), str):
            yield Flaw((name,), f"is {type(getattr(grade, name)).__name__}", "a text")
    if not _ID.fullmatch(grade.id):
        expected = "lower-case letters, digits, '.', '_' or '-', at most 80"
        yield Flaw(("id",), f"{grade.id!r} is no grade id", expected)
    for keys, text in _texts(grade, ()):
        if not text.strip() or len(text) > _LONGEST_TEXT or not text.isprintable():
            expected = f"1 to {_LONGEST_TEXT} printable characters on one line"
            yield Flaw(keys, "is empty, too long, or not printable", expected)


def _texts(value: object, keys: Keys) -> Iterator[tuple[Keys, str]]:
    """Yield each text within a value, with its path; the registry's own marks left out."""
    if isinstance(value, str):
        yield keys, value
    elif isinstance(value, tuple):
        for index, item in enumerate(value):
            yield from _texts(item, (*keys, index))
    elif dataclasses.is_dataclass(value):
        for field in dataclasses.fields(value):
            if field.name not in ("origin", "file", "units"):
                yield from _texts(getattr(value, field.name), (*keys, field.name))


def _choices(grade: Grade) -> Iterator[Flaw]:
    choices: list[tuple[Keys, object, object]] = [(("trust",), grade.trust, Trust)]
    if grade.material is not None:
        choices.append((("material",), grade.material, RopeMaterial))
    if grade.modulus is not None:
        choices.append((("modulus", "reference_area"), grade.modulus.reference_area, ReferenceArea))
    for name in ("modulus", "stiffness", "area_factor", "thermal_expansion"):
        part = getattr(grade, name)
        if part is not None:
            choices.append(((name, "basis"), part.basis, Basis))
    choices += [(("computed",), column.figure, ComputedColumn) for column in grade.computed]
    for keys, value, choice in choices:
        if value not in get_args(choice):
            yield Flaw(keys, f"{value!r} is not known", "one of " + ", ".join(get_args(choice)))


def _elasticity(grade: Grade) -> Iterator[Flaw]:
    if grade.modulus is None and grade.stiffness is None:
        yield Flaw(("modulus",), "is missing", "a modulus, or the stiffness of a fibre rope")
    elif grade.modulus is not None and grade.stiffness is not None:
        yield Flaw(("stiffness",), "is given beside a modulus", "one of the two")
    else:
        name = "modulus" if grade.modulus is not None else "stiffness"
        if not 0.0 <= grade.elasticity.uncertainty < 1.0:
            problem = f"is {grade.elasticity.uncertainty:g}"
            yield Flaw((name, "uncertainty"), problem, "a fraction from 0 to below 1")
    modulus = grade.modulus
    # From a wet nylon rope on; a single steel wire has 2.1e11.
    if modulus is not None and not within(modulus.value_Pa, (1e8, 2.5e11)):
        problem = f"{modulus.value_Pa / 1e9:.4g} GPa is no rope's"
        yield Flaw(("modulus", "value"), problem, "0.1 to 250 GPa")
    new_Pa = modulus.new_Pa if modulus else None
    if modulus is not None and new_Pa is not None and not 0.0 < new_Pa <= modulus.value_Pa:
        problem = f"is {new_Pa / 1e9:.4g} GPa, bedded in {modulus.value_Pa / 1e9:.4g}"
        yield Flaw(("modulus", "new"), problem, "above zero, at most the value")
    if grade.stiffness is None:
        return
    loads, ratios = grade.stiffness.load_fraction, grade.stiffness.ea_over_breaking_load
    given_loads, given_ratios = (
        ", ".join(f"{value:g}" for value in values) or "(none)" for values in (loads, ratios)
    )
    if len(ratios) != max(len(loads), 1) or not all(within(r, _EA_OVER_MBL) for r in ratios):
        lowest, highest = _EA_OVER_MBL
        expected = f"{lowest:g} to {highest:g}, for each load fraction"
        yield Flaw(("stiffness",), f"has the ratios {given_ratios}", expected)
    is_ascending = all(low < high for low, high in pairwise(loads))
    if not (is_ascending and all(0.0 < load <= 1.0 for load in loads)):
        problem = f"has the load fractions {given_loads}"
        yield Flaw(("stiffness",), problem, "ascending ones, above 0 and up to 1")


def _extras(grade: Grade) -> Iterator[Flaw]:
    ratio, expansion, factor = grade.sheave_ratio, grade.thermal_expansion, grade.area_factor
    if ratio is not None and not 0.0 < ratio.minimum <= ratio.suggested < 1000.0:
        problem = f"the minimum is {ratio.minimum:g}, suggested is {ratio.suggested:g}"
        yield Flaw(("sheave_ratio",), problem, "a positive minimum, at most the suggested")
    if expansion is not None and not abs(expansion.coefficient_per_K) < 1e-3:
        problem = f"{expansion.coefficient_per_K:g} /K is no rope's"
        yield Flaw(("thermal_expansion", "value"), problem, "less than 1e-3 /K")
    if factor is not None and not 0.0 < factor.value <= math.pi / 4.0:
        problem = f"{factor.value:g} is no share of d²"
        yield Flaw(("area_factor", "value"), problem, "more than 0, at most pi/4")
    limits = grade.limits
    if limits and limits.temperature_C is None and limits.creep is None:
        yield Flaw(("limits",), "sets no limit", "temperature_C or creep")
    if limits and limits.temperature_C is not None:
        lowest, highest = limits.temperature_C
        if not -273.15 <= lowest < highest <= 2000.0:
            problem = f"is {lowest:g} to {highest:g}"
            yield Flaw(("limits", "temperature_C"), problem, "[lowest, highest] in °C")
    if grade.currency is not None and not re.fullmatch("[A-Z]{3}", grade.currency):
        yield Flaw(("currency",), f"{grade.currency!r} is no currency", "such as 'EUR'")
    for index, size in enumerate(grade.sizes):
        if size.price_per_m is not None and grade.currency is None:
            problem = "there is no currency to it"
            yield Flaw(("sizes", index, "price_per_m"), problem, "the field 'currency'")


def _figures(grade: Grade) -> Iterator[Flaw]:
    if not grade.sizes:
        yield Flaw(("sizes",), "there is no size", "at least one")
    for index, size in enumerate(grade.sizes):
        for name, (attribute, bound) in _FIGURES.items():
            value = getattr(size, attribute)
            if value is None:
                continue
            if not (math.isfinite(value) and value > 0.0):
                yield Flaw(("sizes", index, name), f"is {value:g}", "a positive number")
            elif not within(value, (bound.least, bound.most)):
                unit = f" {bound.dimension.unit}".rstrip()
                ends = f"{bound.least:g} to {bound.most:g}{unit}"
                if name == "diameter":
                    ends = f"{1e3 * bound.least:g} mm to {1e3 * bound.most:g} mm"
                problem = f"{value:g}{unit} is no rope's"
                yield Flaw(("sizes", index, name), problem, f"{ends}; check the unit")
    seen: set[str] = set()
    for index, size in enumerate(grade.sizes):
        if size.id in seen:
            yield Flaw(("sizes", index, "id"), f"{size.id!r} is given twice", "once")
        seen.add(size.id)
        before = grade.sizes[index - 1] if index else None
        if before is not None and not size.diameter_m > before.diameter_m:
            problem = f"{size.diameter_m * 1e3:g} mm follows {before.diameter_m * 1e3:g} mm"
            yield Flaw(("sizes", index, "diameter"), problem, "ascending sizes")


def _areas(grade: Grade) -> Iterator[Flaw]:
    missing = [size for size in grade.sizes if grade.metallic_area_m2(size) is None]
    if missing and grade.modulus and grade.modulus.reference_area == "metallic":
        problem = f"is metallic, but {len(missing)} of {len(grade.sizes)} sizes give no such area"
        expected = "metallic_area for each size, or an area_factor"
        yield Flaw(("modulus", "reference_area"), problem, expected)
    for index, size in enumerate(grade.sizes):
        share = (size.metallic_area_m2 or 0.5 * size.nominal_area_m2) / size.nominal_area_m2
        if not 0.2 <= share <= 1.0:
            problem = f"is {share:.3g} of the nominal circle"
            yield Flaw(("sizes", index, "metallic_area"), problem, "0.2 to 1 of it; check the unit")


def within(value: float, bounds: tuple[float, float]) -> bool:
    """Tell whether a value lies between two bounds, or on one of them."""
    return bounds[0] <= value <= bounds[1]


STEEL_DENSITY_KG_PER_M3 = 7850.0
MASS_OVER_METALLIC_AREA_KG_PER_M3 = 9170.0
"""Of a stranded rope: wires run at an angle, and core and grease weigh something.

9160 to 9200 in the GOST tables of six-strand rope with steel core.
"""

_METALLIC_MODULUS_PA = {
    # lowest and highest modulus on the metallic area: of rope laid twice, and of a single strand
    "steel": ((4.0e10, 1.45e11), (4.0e10, 2.1e11)),
    "stainless steel": ((3.5e10, 1.30e11), (3.5e10, 2.0e11)),
}


@dataclass(frozen=True, slots=True)
class Bounds:
    """Bounds of a rope's figures over the nominal circle, each lowest and highest.

    ``outlier`` is by which part a size may stand off its neighbours in mass or breaking load over
    d².
    """

    density_kg_per_m3: tuple[float, float]
    breaking_stress_Pa: tuple[float, float]
    ea_over_breaking_load: tuple[float, float]
    outlier: float


def _fibre(density_kg_per_m3: float, strength_Pa: float, modulus_over_strength: float) -> Bounds:
    return Bounds(
        density_kg_per_m3=(0.3 * density_kg_per_m3, 1.05 * density_kg_per_m3),
        # Of those in the catalogue 0.2 to 0.33; covers and hollows take some of the others. Kip for
        # kN, or the reverse, is a factor of 4.4.
        breaking_stress_Pa=(0.08 * strength_Pa, 0.8 * strength_Pa),
        ea_over_breaking_load=(modulus_over_strength / 6.0, 3.0 * modulus_over_strength),
        outlier=0.25,
    )


# Laid twice: 0.3 to 0.55 d² of wire of 1180 to 2160 N/mm² (EN 12385-4). Strands go from common
# guy wire (ASTM A475) to locked coil and rod.
_WIRE = Bounds((3800.0, 7000.0), (3.5e8, 1.6e9), (15.0, 400.0), outlier=0.1)
_STRAND = replace(_WIRE, density_kg_per_m3=(5000.0, 7800.0), breaking_stress_Pa=(2e8, 2.5e9))

# Density, strength and modulus over strength of yarn: Tension Technology International,
# "Synthetic fibre yarn properties", table 1; of two fibres with one name the stronger. The ratio
# of aramid is between Kevlar 29 (24) and Kevlar 49 (37). Polypropylene is not in that table: its
# density is 910, its ratio 10 by the formulas of moorwire.py (Mooring-Line-Properties).
MATERIAL_BOUNDS = {
    "steel": _WIRE,
    "stainless steel": _WIRE,
    "HMPE": _fibre(970.0, 3.0e9, 52.0),
    "Vectran": _fibre(1410.0, 2.8e9, 23.0),
    "PBO": _fibre(1560.0, 4.0e9, 70.0),
    "aramid": _fibre(1440.0, 3.0e9, 30.0),
    "polyester": _fibre(1380.0, 1.16e9, 12.0),
    "nylon": _fibre(1140.0, 0.96e9, 4.8),
    "polyester and nylon": _fibre(1380.0, 1.16e9, 8.0),
    "polypropylene": _fibre(910.0, 0.7e9, 10.0),
}


def bounds_of(grade: Grade) -> Bounds:
    """Return the bounds of the grade's material; wide ones where it is not known."""
    wide = Bounds((200.0, 9000.0), (2e7, 3e9), (0.5, 1000.0), outlier=0.25)
    bounds = MATERIAL_BOUNDS.get(grade.material or "", wide)
    if bounds is _WIRE and grade.is_strand:
        return _STRAND
    return bounds


def metallic_modulus_bounds_Pa(grade: Grade) -> tuple[float, float] | None:
    """Return the bounds of a wire rope's modulus on the metallic area; None for other ropes."""
    interval = _METALLIC_MODULUS_PA.get(grade.material or "")
    if interval is None:
        return None
    laid_twice, strand = interval
    return strand if grade.is_strand else laid_twice


LARGEST_FACTOR_OF_DOUBT = 1.6
"""A doubtful size may be this much stronger or heavier for its d² than the grade's median."""

_NEIGHBOURS = 2
_LEAST_OF_SOLID = 0.5  # ropes of EN 12385-4 have 0.62 to 0.79
_MASS_OVER_AREA_KG_PER_M3 = (7500.0, 12000.0)  # of a strand about 8000, of a fibre core up to 9900


def proportion_flaws(grade: Grade) -> Iterator[Flaw]:
    """Yield what contradicts itself, or a rope of the grade's material."""
    columns = [*flaws_over_diameter(grade)]
    yield from columns or [*_strength(grade), *_metallic_areas(grade)] or _stiffness(grade)


def flaws_over_diameter(grade: Grade) -> Iterator[Flaw]:
    """Yield what is off the laws m = k d² and MBL = c d²: whole columns, else single figures."""
    bounds = bounds_of(grade)
    masses = ("linear_mass", [size.density_kg_per_m3 for size in grade.sizes])
    loads = ("minimum_breaking_load", [size.breaking_stress_Pa for size in grade.sizes])
    yield from _of_a_column(grade, *masses, bounds.density_kg_per_m3, "kg/m³")
    yield from _of_a_column(grade, *loads, bounds.breaking_stress_Pa, "Pa")


def _of_a_column(
    grade: Grade, name: str, values: Sequence[float], bounds: tuple[float, float], unit: str
) -> Iterator[Flaw]:
    middle = median(values)
    if not within(middle, bounds):
        problem = f"{name} over the nominal circle is {middle:.3g} {unit} in the median"
        whose = f" for {grade.material}" if grade.material else ""
        expected = f"{bounds[0]:.3g} to {bounds[1]:.3g} {unit}{whose}; check the units"
        yield Flaw(("sizes",), problem, expected)
        return
    allowed = bounds_of(grade).outlier
    for index, deviation in sorted(_outliers(grade.sizes, values, allowed).items()):
        side = "above" if deviation > 0.0 else "below"
        problem = f"over d² it is {abs(deviation):.0%} {side} the neighbouring sizes"
        expected = f"within {allowed:.0%}; check figure and unit, or say in 'doubt' why it is so"
        yield Flaw(("sizes", index, name), problem, expected)
    for index, size in enumerate(grade.sizes):
        factor = values[index] / middle
        if size.doubt and not 1.0 <= max(factor, 1.0 / factor) <= LARGEST_FACTOR_OF_DOUBT:
            problem = f"over d² it is {factor:.3g} times the median of the grade"
            yield Flaw(("sizes", index, name), problem, "about 1, even of a doubtful size")


def _outliers(sizes: Sequence[Size], values: Sequence[float], allowed: float) -> dict[int, float]:
    """Return the deviation of each size without doubt that stands off its neighbours.

    It has to stand off both the doubtful ones and those without doubt: where a table is uneven
    and says so, a size that lies between the two kinds is not to blame.
    """
    trusted = [index for index, size in enumerate(sizes) if size.doubt is None]
    among_trusted = _stand_off(values, trusted, allowed)
    among_all = _stand_off(values, range(len(sizes)), allowed)
    return {index: off for index, off in among_trusted.items() if index in among_all}


def _stand_off(values: Sequence[float], indices: Sequence[int], allowed: float) -> dict[int, float]:
    """Return the deviation of each value that stands off its neighbours.

    The worst goes first and is no neighbour any more, so that it does not blame the others. Of
    fewer than three nobody can say which one is wrong.
    """
    remaining = list(indices)
    outliers: dict[int, float] = {}
    while len(remaining) >= 3:
        deviations = {
            index: values[index] / _around(values, remaining, place) - 1.0
            for place, index in enumerate(remaining)
        }
        worst = max(deviations, key=lambda index: abs(deviations[index]))
        if abs(deviations[worst]) <= allowed:
            break
        outliers[worst] = deviations[worst]
        remaining.remove(worst)
    return outliers


def _around(values: Sequence[float], remaining: Sequence[int], place: int) -> float:
    """Return the median of the nearest values on either side."""
    before = remaining[max(place - _NEIGHBOURS, 0) : place]
    after = remaining[place + 1 : place + 1 + _NEIGHBOURS]
    return median(values[index] for index in (*before, *after))


def _strength(grade: Grade) -> Iterator[Flaw]:
    """A rope is weaker than all of its wires pulled straight, R·A, but not by half."""
    wire_grade = re.match(r"(\d{3,4})\s*(?:N/mm|MPa)", grade.wire_grade or "")
    if wire_grade is None:
        return
    strength_Pa = 1e6 * float(wire_grade[1])
    for index, size in enumerate(grade.sizes):
        aggregate_N = strength_Pa * _metal_m2(grade, size, STEEL_DENSITY_KG_PER_M3)
        # An area or a factor of a table is rounded.
        if size.minimum_breaking_load_N > 1.05 * aggregate_N:
            problem = f"is {size.minimum_breaking_load_N / 1e3:.4g} kN"
            expected = (
                f"less than metallic area times wire grade, {aggregate_N / 1e3:.4g} kN; check "
                "breaking load, wire_grade and mass"
            )
            yield Flaw(("sizes", index, "minimum_breaking_load"), problem, expected)
        solid_N = strength_Pa * size.linear_density_kg_per_m / STEEL_DENSITY_KG_PER_M3
        if size.minimum_breaking_load_N < _LEAST_OF_SOLID * solid_N:
            share = size.minimum_breaking_load_N / solid_N
            problem = f"is {share:.0%} of what the same mass of such wire would hold"
            expected = f"at least {_LEAST_OF_SOLID:.0%}; check breaking load, wire_grade and mass"
            yield Flaw(("sizes", index, "minimum_breaking_load"), problem, expected)


def _metal_m2(grade: Grade, size: Size, density_kg_per_m3: float) -> float:
    """Return the metallic area; where it is not known, that of the mass at this density [m²]."""
    return grade.metallic_area_m2(size) or size.linear_density_kg_per_m / density_kg_per_m3


def _metallic_areas(grade: Grade) -> Iterator[Flaw]:
    for index, size in enumerate(grade.sizes):
        if size.metallic_area_m2 is None or metallic_modulus_bounds_Pa(grade) is None:
            continue
        density = size.linear_density_kg_per_m / size.metallic_area_m2
        if not within(density, _MASS_OVER_AREA_KG_PER_M3):
            lowest, highest = _MASS_OVER_AREA_KG_PER_M3
            problem = f"mass over metallic area is {density:.0f} kg/m³"
            expected = f"{lowest:.0f} to {highest:.0f} kg/m³; check both figures"
            yield Flaw(("sizes", index, "metallic_area"), problem, expected)


def _stiffness(grade: Grade) -> Iterator[Flaw]:
    metallic = metallic_modulus_bounds_Pa(grade)
    if metallic is not None:
        # What a modulus on the nominal circle is on the metal, and whether metal can be that.
        value_Pa = median(
            grade.axial_stiffness_N(size)
            / _metal_m2(grade, size, MASS_OVER_METALLIC_AREA_KG_PER_M3)
            for size in grade.sizes
        )
        if not within(value_Pa, metallic):
            problem = f"is {value_Pa / 1e9:.0f} GPa on the metallic area"
            expected = (
                f"{metallic[0] / 1e9:.0f} to {metallic[1] / 1e9:.0f} GPa for {grade.material}, "
                f"{grade.construction}; check value and reference_area"
            )
            yield Flaw(("modulus", "value") if grade.modulus else ("stiffness",), problem, expected)
    fit, bounds = grade.fit(), bounds_of(grade).ea_over_breaking_load
    ratio = fit.youngs_modulus_Pa / fit.breaking_stress_Pa
    if not within(ratio, bounds):
        problem = f"EA is {ratio:.3g} times the breaking load"
        whose = grade.material or "a rope"
        field = "modulus" if grade.modulus else "stiffness"
        yield Flaw((field,), problem, f"{bounds[0]:.3g} to {bounds[1]:.3g} for {whose}")
