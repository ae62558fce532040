"""Checks of a grade's figures that hold for every rope, so that slips of typing and unit show.

Breaking load over d² and mass over d² hardly change within a grade, and lie within known bounds
for every rope there is. A figure in the wrong unit (lb/ft for kg/m, lbf for N) breaks one of the
two rules.
"""

from __future__ import annotations

import dataclasses
import math
import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from statistics import median
from typing import get_args

from designer.catalogue.grade import Basis, Grade, ReferenceArea, Size, Trust

LARGEST_FACTOR_FROM_MEDIAN = 1.4
"""A size may be this much stronger or heavier for its d² than the median of its grade.

Real tables stay within 1.25; pound for kilogram per length is 1.49.
"""

_ID = re.compile(r"[a-z0-9][a-z0-9._-]{0,79}")
_LONGEST_TEXT = 1000
_DIAMETER_M = (1e-4, 0.5)
_MODULUS_PA = (1e8, 2.5e11)  # a wet nylon rope; a single steel wire has 2.1e11
_DENSITY_KG_PER_M3 = (200.0, 9000.0)  # a floating rope; solid steel with grease
_BREAKING_STRESS_PA = (2e7, 3e9)
_LARGEST_AREA_FACTOR = math.pi / 4.0
_TEXTS = ("manufacturer", "product", "construction", "core", "finish")
_FIGURES = {
    "diameter": "diameter_m",
    "minimum_breaking_load": "minimum_breaking_load_N",
    "linear_mass": "linear_density_kg_per_m",
    "metallic_area": "metallic_area_m2",
}


Keys = tuple[str | int, ...]
"""A path in a grade file, such as ``("sizes", 3, "linear_mass")``."""


@dataclass(frozen=True, slots=True)
class Flaw:
    """One thing that is wrong with a grade.

    Parameters
    ----------
    keys : tuple of str or int
        Path in a grade file.
    problem, expected : str
        What was found, and what was expected instead.
    """

    keys: Keys
    problem: str
    expected: str = ""


def find_flaws(grade: Grade) -> list[Flaw]:
    """Return everything that is wrong with a grade, in the order of its fields.

    Proportions are looked at only where each figure makes sense by itself.
    """
    flaws = [flaw for check in _CHECKS_OF_FIELDS for flaw in check(grade)]
    return flaws or [flaw for check in _CHECKS_OF_PROPORTION for flaw in check(grade)]


def _identity(grade: Grade) -> Iterator[Flaw]:
    for name in _TEXTS:
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
            if field.name not in ("origin", "file"):
                yield from _texts(getattr(value, field.name), (*keys, field.name))


def _choices(grade: Grade) -> Iterator[Flaw]:
    modulus = grade.modulus
    given: list[tuple[tuple[str, ...], str, object]] = [
        (("trust",), grade.trust, Trust),
        (("modulus", "reference_area"), modulus.reference_area, ReferenceArea),
        (("modulus", "basis"), modulus.basis, Basis),
    ]
    for keys, value, choice in given:
        if value not in get_args(choice):
            yield Flaw(keys, f"{value!r} is not known", "one of " + ", ".join(get_args(choice)))


def _modulus(grade: Grade) -> Iterator[Flaw]:
    value_GPa = grade.modulus.value_Pa / 1e9
    if not _within(grade.modulus.value_Pa, _MODULUS_PA):
        yield Flaw(("modulus", "value"), f"{value_GPa:.4g} GPa is no rope's", "0.1 to 250 GPa")
    if not 0.0 <= grade.modulus.uncertainty < 1.0:
        problem = f"is {grade.modulus.uncertainty:g}"
        yield Flaw(("modulus", "uncertainty"), problem, "a fraction from 0 to below 1")


def _extras(grade: Grade) -> Iterator[Flaw]:
    ratio, expansion, factor = grade.sheave_ratio, grade.thermal_expansion, grade.area_factor
    if ratio is not None and not 0.0 < ratio.minimum <= ratio.suggested < 1000.0:
        problem = f"the minimum is {ratio.minimum:g}, suggested is {ratio.suggested:g}"
        yield Flaw(("sheave_ratio",), problem, "a positive minimum, at most the suggested")
    if expansion is not None and not abs(expansion.coefficient_per_K) < 1e-3:
        problem = f"{expansion.coefficient_per_K:g} /K is no rope's"
        yield Flaw(("thermal_expansion", "value"), problem, "less than 1e-3 /K")
    if factor is not None and not 0.0 < factor.value <= _LARGEST_AREA_FACTOR:
        problem = f"{factor.value:g} is no share of d²"
        yield Flaw(("area_factor", "value"), problem, "more than 0, at most pi/4")


def _figures(grade: Grade) -> Iterator[Flaw]:
    if not grade.sizes:
        yield Flaw(("sizes",), "there is no size", "at least one")
    for index, size in enumerate(grade.sizes):
        for name, attribute in _FIGURES.items():
            value = getattr(size, attribute)
            if value is not None and not (math.isfinite(value) and value > 0.0):
                yield Flaw(("sizes", index, name), f"is {value:g}", "a positive number")
        if size.diameter_m > 0.0 and not _within(size.diameter_m, _DIAMETER_M):
            problem = f"{size.diameter_m:g} m is no rope's"
            yield Flaw(("sizes", index, "diameter"), problem, "0.1 mm to 500 mm; check the unit")


def _order(grade: Grade) -> Iterator[Flaw]:
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
    if missing and grade.modulus.reference_area == "metallic":
        problem = f"is metallic, but {len(missing)} of {len(grade.sizes)} sizes give no such area"
        expected = "metallic_area for each size, or an area_factor"
        yield Flaw(("modulus", "reference_area"), problem, expected)
    for index, size in enumerate(grade.sizes):
        share = (size.metallic_area_m2 or 0.5 * size.nominal_area_m2) / size.nominal_area_m2
        if not 0.2 <= share <= 1.0:
            problem = f"is {share:.3g} of the nominal circle"
            yield Flaw(("sizes", index, "metallic_area"), problem, "0.2 to 1 of it; check the unit")


def _densities(grade: Grade) -> Iterator[Flaw]:
    yield from _proportion(
        grade, "linear_mass", lambda size: size.density_kg_per_m3, _DENSITY_KG_PER_M3, "kg/m³"
    )


def _stresses(grade: Grade) -> Iterator[Flaw]:
    yield from _proportion(
        grade,
        "minimum_breaking_load",
        lambda size: size.breaking_stress_Pa,
        _BREAKING_STRESS_PA,
        "Pa",
    )


def _proportion(
    grade: Grade,
    name: str,
    measure: Callable[[Size], float],
    bounds: tuple[float, float],
    unit: str,
) -> Iterator[Flaw]:
    values = [measure(size) for size in grade.sizes]
    middle = median(values)
    if not _within(middle, bounds):
        problem = f"{name} over the nominal circle is {middle:.3g} {unit} in the median"
        expected = f"{bounds[0]:.3g} to {bounds[1]:.3g} {unit}; check the units"
        yield Flaw(("sizes",), problem, expected)
        return
    for index, value in enumerate(values):
        if not 1.0 / LARGEST_FACTOR_FROM_MEDIAN <= value / middle <= LARGEST_FACTOR_FROM_MEDIAN:
            problem = f"over d² it is {value / middle:.3g} times the median of the grade"
            yield Flaw(("sizes", index, name), problem, "about 1; check figure and unit")


def _within(value: float, bounds: tuple[float, float]) -> bool:
    return bounds[0] <= value <= bounds[1]


_CHECKS_OF_FIELDS = (_identity, _choices, _modulus, _extras, _figures, _order, _areas)
_CHECKS_OF_PROPORTION = (_densities, _stresses)
