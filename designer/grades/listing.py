"""Plain data behind ``designer catalog list``, ``show`` and ``check``; the CLI prints it."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from pathlib import Path

from designer.errors import Fault
from designer.grades.files import nothing_found_fault, read_grades
from designer.grades.grade import (
    TRUST_MEANING,
    FamilyFit,
    Grade,
    Limits,
    SheaveRatio,
    Size,
    ThermalExpansion,
)
from designer.grades.registry import Catalogue

SAME_DIAMETER = 0.02
"""Two nominal diameters within this part of each other count as one, such as 12.7 and 12.5 mm."""


@dataclass(frozen=True, slots=True)
class GradeRow:
    """One grade in the list; the ranges are smallest and largest over its sizes."""

    id: str
    manufacturer: str
    construction: str
    core: str
    finish: str
    material: str
    wire_grade: str
    n_sizes: int
    n_doubtful: int
    diameter_m: tuple[float, float]
    minimum_breaking_load_N: tuple[float, float]
    youngs_modulus_Pa: float
    trust: str
    is_nominal: bool
    origin: str
    publisher: str
    source: str


@dataclass(frozen=True, slots=True)
class SizeRow:
    """One size in the table of a grade; stiffness is EA."""

    id: str
    diameter_m: float
    minimum_breaking_load_N: float
    linear_density_kg_per_m: float
    metallic_area_m2: float | None
    axial_stiffness_N: float
    price_per_m: float | None
    doubt: str


@dataclass(frozen=True, slots=True)
class Wanted:
    """What grades to list; each None wants all.

    Parameters
    ----------
    construction : str or None
        Such as ``7x19`` or ``braid``; capitals and blanks do not matter.
    material : str or None
        The whole name of a material; capitals do not matter.
    maker : str or None
        Part of the manufacturer's or the publisher's name.
    diameter_m : float or None
        Nominal diameter; keeps the sizes that are within `SAME_DIAMETER` of it [m].
    """

    construction: str | None = None
    material: str | None = None
    maker: str | None = None
    diameter_m: float | None = None

    def among(self, grades: Iterable[Grade]) -> list[Grade]:
        """Return the grades that match, with the sizes that do."""
        matching = [replace(grade, sizes=self._sizes(grade)) for grade in grades if self._is(grade)]
        return [grade for grade in matching if grade.sizes]

    def _is(self, grade: Grade) -> bool:
        makers = f"{grade.manufacturer} {grade.source.publisher}".casefold()
        return (
            (self.construction is None or _names(grade.construction, self.construction))
            and (self.material is None or _same(self.material, grade.material or ""))
            and (self.maker is None or self.maker.casefold() in makers)
        )

    def _sizes(self, grade: Grade) -> tuple[Size, ...]:
        if self.diameter_m is None:
            return grade.sizes
        allowed_m = SAME_DIAMETER * self.diameter_m
        return tuple(s for s in grade.sizes if abs(s.diameter_m - self.diameter_m) <= allowed_m)


def _same(first: str, second: str) -> bool:
    return first.casefold() == second.casefold()


def _names(construction: str, wanted: str) -> bool:
    """Tell whether a construction has this in its name; ``9x7`` is not in ``19x7``."""
    text, part = ("".join(name.casefold().split()) for name in (construction, wanted))
    return re.search(rf"(?<!\d){re.escape(part)}", text) is not None


def list_rows(grades: Iterable[Grade]) -> list[GradeRow]:
    """Return one row for each grade; ``youngs_modulus_Pa`` is on the nominal circle [Pa]."""
    return [_grade_row(grade) for grade in grades]


def split_nominal(grades: Iterable[Grade]) -> tuple[list[Grade], list[Grade]]:
    """Return the products, and the grades that a standard's factors alone stand for."""
    both: tuple[list[Grade], list[Grade]] = ([], [])
    for grade in grades:
        both[grade.is_nominal].append(grade)
    return both


def materials(grades: Iterable[Grade]) -> list[str]:
    """Return the materials that there are, sorted."""
    return sorted({grade.material for grade in grades if grade.material})


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


def size_rows(grade: Grade) -> list[SizeRow]:
    """Return one row for each size."""
    return [
        SizeRow(
            id=size.id,
            diameter_m=size.diameter_m,
            minimum_breaking_load_N=size.minimum_breaking_load_N,
            linear_density_kg_per_m=size.linear_density_kg_per_m,
            metallic_area_m2=grade.metallic_area_m2(size),
            axial_stiffness_N=grade.axial_stiffness_N(size),
            price_per_m=size.price_per_m,
            doubt=size.doubt or "",
        )
        for size in grade.sizes
    ]


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


def check_path(path: Path) -> list[Fault]:
    """Return every fault of a grade file, or of all the grade files in a folder.

    A folder without a grade file is a fault as well: nothing has been checked.
    """
    found, faults = read_grades(path)
    if not found and not faults:
        return [nothing_found_fault(path)]
    return faults


def _grade_row(grade: Grade) -> GradeRow:
    loads_N = [size.minimum_breaking_load_N for size in grade.sizes]
    return GradeRow(
        id=grade.id,
        manufacturer=grade.manufacturer,
        construction=grade.construction,
        core=grade.core,
        finish=grade.finish,
        material=grade.material or "",
        wire_grade=grade.wire_grade or "",
        n_sizes=len(grade.sizes),
        n_doubtful=sum(size.doubt is not None for size in grade.sizes),
        diameter_m=(grade.sizes[0].diameter_m, grade.thickest.diameter_m),
        minimum_breaking_load_N=(min(loads_N), max(loads_N)),
        youngs_modulus_Pa=grade.fit().youngs_modulus_Pa,
        trust=grade.trust,
        is_nominal=grade.is_nominal,
        origin=grade.origin,
        publisher=grade.source.publisher,
        source=str(grade.source),
    )


def _identity(grade: Grade) -> Iterator[tuple[str, str]]:
    if grade.why_only_by_name:
        yield "by name only", grade.why_only_by_name
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
    factor, expansion, ratio = grade.area_factor, grade.thermal_expansion, grade.sheave_ratio
    yield "modulus" if grade.modulus else "stiffness", _elasticity_text(grade)
    yield "family on the nominal circle", _family_text(grade.fit())
    yield "sizes against the family", _spread_text(grade.fit(), len(grade.sizes))
    if factor is not None:
        yield "metallic area", f"{factor.value:g} d², {factor.basis}: {factor.source}"
    yield "thermal expansion", _expansion_text(expansion) if expansion else "not given"
    yield "sheave D/d", _ratio_text(ratio) if ratio else "not given"
    if grade.limits is not None:
        yield from _limit_texts(grade.limits)


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


def _elasticity_text(grade: Grade) -> str:
    elasticity = grade.elasticity
    return (
        f"{elasticity.figure}, ±{elasticity.uncertainty:.0%}, "
        f"{elasticity.basis}: {elasticity.source}"
    )


def _family_text(fit: FamilyFit) -> str:
    elastic = f"{fit.density_kg_per_m3:.0f} kg/m³, {fit.youngs_modulus_Pa / 1e9:.3g} GPa"
    return f"{elastic}, breaks at {fit.breaking_stress_Pa / 1e6:.0f} MPa"


def _spread_text(fit: FamilyFit, n_sizes: int) -> str:
    mass, load = _percent(fit.linear_density_spread), _percent(fit.breaking_load_spread)
    return f"mass {mass}, breaking load {load}, fitted to {fit.n_fitted} of {n_sizes}"


def _expansion_text(expansion: ThermalExpansion) -> str:
    return f"{expansion.coefficient_per_K:.3g} /K, {expansion.basis}: {expansion.source}"


def _ratio_text(ratio: SheaveRatio) -> str:
    return f"{ratio.suggested:g} suggested, {ratio.minimum:g} minimum, {ratio.source}"


def _limit_texts(limits: Limits) -> Iterator[tuple[str, str]]:
    if limits.temperature_C is not None:
        lowest, highest = limits.temperature_C
        yield "temperature", f"{lowest:g} to {highest:g} °C, {limits.source}"
    if limits.creep is not None:
        yield "creep", f"{limits.creep}, {limits.source}"


def _percent(spread: tuple[float, float]) -> str:
    return f"{spread[0]:+.1%} to {spread[1]:+.1%}"
