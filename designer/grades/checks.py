"""Checks of a grade's fields: texts, choices, signs, order.

What is known of every rope of a material is checked in `designer.grades.proportions`, and only
where each figure makes sense by itself.
"""

from __future__ import annotations

import dataclasses
import math
import re
from collections.abc import Iterator
from itertools import pairwise
from typing import get_args

from designer.documents.bounds import BOUNDS
from designer.documents.document import Flaw, Keys
from designer.grades.grade import Grade, RopeMaterial
from designer.grades.parts import Basis, ComputedColumn, ReferenceArea
from designer.grades.proportions import proportion_flaws, within
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
