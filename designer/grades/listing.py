"""Plain data behind ``designer catalog list``, ``show`` and ``check``; the CLI prints it."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from statistics import median
from typing import Any

from designer.grades.grade import TRUST_MEANING, Grade, Size, Units
from designer.grades.registry import Catalogue, load_catalogue
from designer.units import FORCE, TONS, read_quantity

SAME_DIAMETER = 0.02
"""Two nominal diameters within this part of each other count as one, such as 12.7 and 12.5 mm."""
_BETWEEN = 0.03
"""So far off both, a breaking load lies between those of two wire grades, 10 to 13 % apart."""


@dataclass(frozen=True, slots=True)
class GradeFilter:
    """What grades to list; each None wants all. Capitals do not matter."""

    construction: str | None = None  #: such as ``7x19`` or ``braid``; blanks do not matter
    material: str | None = None  #: its whole name
    maker: str | None = None  #: part of the manufacturer's or the publisher's name
    diameter_m: float | None = None  #: keeps the sizes within `SAME_DIAMETER` of it [m]

    def among(self, grades: Iterable[Grade]) -> list[Grade]:
        """Return the grades that match, with the sizes that do."""
        matching = [
            replace(grade, sizes=self._sizes(grade)) for grade in grades if self._matches(grade)
        ]
        return [grade for grade in matching if grade.sizes]

    def _matches(self, grade: Grade) -> bool:
        makers = f"{grade.manufacturer} {grade.source.publisher}".casefold()
        material = (grade.material or "").casefold()
        return (
            (self.construction is None or _names(grade.construction, self.construction))
            and (self.material is None or self.material.casefold() == material)
            and (self.maker is None or self.maker.casefold() in makers)
        )

    def _sizes(self, grade: Grade) -> tuple[Size, ...]:
        if self.diameter_m is None:
            return grade.sizes
        allowed_m = SAME_DIAMETER * self.diameter_m
        return tuple(s for s in grade.sizes if abs(s.diameter_m - self.diameter_m) <= allowed_m)


def _names(construction: str, pattern: str) -> bool:
    """Tell whether a construction has this in its name; ``9x7`` is not in ``19x7``."""
    text, part = ("".join(name.casefold().split()) for name in (construction, pattern))
    return re.search(rf"(?<!\d){re.escape(part)}", text) is not None


def split_nominal(grades: Iterable[Grade]) -> tuple[list[Grade], list[Grade]]:
    """Return the products, and the grades that a standard's factors alone stand for."""
    halves: tuple[list[Grade], list[Grade]] = ([], [])
    for grade in grades:
        halves[grade.is_nominal].append(grade)
    return halves


def summary(catalogue: Catalogue) -> str:
    """Return how much there is in a catalogue, in one line."""
    grades = catalogue.grades
    nominal = sum(grade.is_nominal for grade in grades)
    sizes = [size for grade in grades for size in grade.sizes]
    doubtful = sum(size.doubt is not None for size in sizes)
    sources = len(catalogue.sources)
    return (
        f"{len(grades) - nominal} grades of products and {nominal} nominal ones from {sources} "
        f"source{'s' * (sources != 1)}, {len(sizes)} sizes, {doubtful} of them with a doubt"
    )


def facts(grade: Grade) -> list[tuple[str, str]]:
    """Return name and text of all that is known of a grade beside its sizes.

    What its source does not give says so, since a gap is a fact, too.
    """
    return [
        *_identity(grade),
        *_figures(grade),
        *_not_printed(grade),
        *(("note", note) for note in grade.notes),
    ]


def listed(grade: Grade) -> dict[str, Any]:
    """Return of a grade what a list shows of it, as plain values in SI."""
    names = ("id", "manufacturer", "product", "construction", "core", "finish", "material", "trust")
    loads_N = [size.minimum_breaking_load_N for size in grade.sizes]
    return {
        **{name: getattr(grade, name) for name in names},
        "source": str(grade.source),
        "origin": grade.origin,
        "sizes": [size.id for size in grade.sizes],
        "diameter_m": [grade.sizes[0].diameter_m, grade.thickest.diameter_m],
        "minimum_breaking_load_N": [min(loads_N), max(loads_N)],
    }


def ton_remarks(grade: Grade) -> list[str]:
    """Return why the tons of a grade's table may be others, of 2000 lb, 1000 kg or 2240 lb.

    Breaking load over d² changes by 10 or 12 % with the ton, about as much as from a wire grade to
    the next: with the wrong one it lies between two of them.
    """
    units = grade.units or Units()
    unit_N = read_quantity(f"1 {units.minimum_breaking_load or 'N'}", FORCE)
    stated = next((t for t in TONS if math.isclose(read_quantity(f"1 {t}", FORCE), unit_N)), None)
    if stated is None:
        return []
    remarks, beside = [], f"{units.diameter} and {units.linear_mass}"
    if stated == "tonf" and re.search(r"\bin|lb|pound|ft|foot", beside):
        remarks.append(
            f"tonf is 1000 kgf; beside {beside} most tons are of 2000 lb, short_ton_force, 9 % less"
        )
    kind = (grade.construction.partition(" ")[0], grade.core)
    ratios = [
        _strength_Pa(grade) / _strength_Pa(other)
        for other in load_catalogue(with_plugins=False).grades
        if (other.construction.partition(" ")[0], other.core) == kind
    ]
    off = min((abs(ratio - 1.0) for ratio in ratios), default=0.0)
    if off > _BETWEEN and min(ratios) < 1.0 < max(ratios):
        between = f"over d² the breaking load lies between those of known {' '.join(kind)} ropes"
        remarks.append(f"{between}, {off:.0%} from the nearest: check whether its ton is {stated}")
    return remarks


def _strength_Pa(grade: Grade) -> float:
    return median(size.breaking_stress_Pa for size in grade.sizes)


def _identity(grade: Grade) -> Iterator[tuple[str, str]]:
    if why := grade.why_only_by_name():
        yield "by name only", why
    yield "manufacturer", grade.manufacturer
    yield "product", grade.product
    part = "core" if grade.material in (None, "steel", "stainless steel") else "fibre"
    yield "construction", f"{grade.construction}, {part} {grade.core}"
    yield "material", grade.material or "not given"
    yield "finish", grade.finish
    yield "standard", grade.standard or "not given"
    yield "wire grade", grade.wire_grade or "not given"
    yield "source", str(grade.source)
    yield "trust", f"{grade.trust}: {TRUST_MEANING[grade.trust]}"
    yield "came in by", f"{grade.origin} ({grade.file})" if grade.file else grade.origin


def _figures(grade: Grade) -> Iterator[tuple[str, str]]:
    elasticity, expansion, ratio = grade.elasticity, grade.thermal_expansion, grade.sheave_ratio
    fit, factor = grade.fit(), grade.area_factor
    stiff = f"{elasticity.figure}, ±{elasticity.uncertainty:.0%}"
    yield (
        "modulus" if grade.modulus else "stiffness",
        f"{stiff}, {elasticity.basis}: {elasticity.source}",
    )
    elastic = f"{fit.density_kg_per_m3:.0f} kg/m³, {fit.youngs_modulus_Pa / 1e9:.3g} GPa"
    breaks = f"breaks at {fit.breaking_stress_Pa / 1e6:.0f} MPa"
    yield "family on the nominal circle", f"{elastic}, {breaks}"
    spreads = (fit.linear_density_spread, fit.breaking_load_spread)
    mass, load = ("{:+.1%} to {:+.1%}".format(*spread) for spread in spreads)
    fitted = f"fitted to {fit.n_fitted} of {len(grade.sizes)}"
    yield "sizes against the family", f"mass {mass}, breaking load {load}, {fitted}"
    if factor:
        yield "metallic area", f"{factor.value:g} d², {factor.basis}: {factor.source}"
    if expansion:
        value = f"{expansion.coefficient_per_K:.3g} /K"
        yield "thermal expansion", f"{value}, {expansion.basis}: {expansion.source}"
    else:
        yield "thermal expansion", "not given"
    ratios = f"{ratio.suggested:g} suggested, {ratio.minimum:g} minimum, " if ratio else ""
    yield "sheave D/d", f"{ratios}{ratio.source}" if ratio else "not given"
    if grade.fill_factor is not None:
        yield "fill factor", f"{grade.fill_factor:.3g} of the nominal circle is metal"
    yield from _in_service(grade)


def _in_service(grade: Grade) -> Iterator[tuple[str, str]]:
    """What is known of the rope at work, and one row that names what is not."""
    limits, range_C = grade.limits, grade.limits and grade.limits.temperature_C
    texts = {
        "rotation": grade.rotation and str(grade.rotation),
        "permanent stretch": grade.permanent_stretch and str(grade.permanent_stretch),
        "discard": grade.discard and str(grade.discard),
        "temperature": limits
        and range_C
        and f"{range_C[0]:g} to {range_C[1]:g} °C, {limits.source}",
        "creep": limits and limits.creep and f"{limits.creep}, {limits.source}",
    }
    yield from ((name, text) for name, text in texts.items() if text)
    can_creep = grade.material_class == "fibre"
    missing = [name for name, text in texts.items() if not text and (can_creep or name != "creep")]
    if missing:
        yield "not given", ", ".join(missing)


def _not_printed(grade: Grade) -> Iterator[tuple[str, str]]:
    """What a reader should not take for the source's own figures."""
    for column in grade.computed:
        yield f"computed {column.figure.replace('_', ' ')}", column.how
    names = ("modulus", "stiffness", "area_factor", "thermal_expansion")
    parts = [(name.replace("_", " "), getattr(grade, name)) for name in names]
    for basis in ("borrowed", "computed"):
        ours = [name for name, part in parts if part is not None and part.basis == basis]
        if ours:
            yield basis, ", ".join(ours)
    doubtful = [size.id for size in grade.sizes if size.doubt]
    if doubtful:
        yield "doubtful sizes", ", ".join(doubtful)
