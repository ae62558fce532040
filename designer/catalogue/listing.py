"""Plain data behind ``designer catalog list``, ``show`` and ``check``; the CLI prints it."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from designer.catalogue.files import nothing_found_fault, read_grades
from designer.catalogue.grade import (
    TRUST_MEANING,
    FamilyFit,
    Grade,
    Modulus,
    SheaveRatio,
    ThermalExpansion,
)
from designer.catalogue.registry import Catalogue
from designer.errors import Fault


@dataclass(frozen=True, slots=True)
class GradeRow:
    """One grade in the list; the ranges are smallest and largest over its sizes."""

    id: str
    manufacturer: str
    construction: str
    core: str
    finish: str
    wire_grade: str
    n_sizes: int
    n_doubtful: int
    diameter_m: tuple[float, float]
    minimum_breaking_load_N: tuple[float, float]
    youngs_modulus_Pa: float
    trust: str
    origin: str
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
    doubt: str


def list_rows(catalogue: Catalogue) -> list[GradeRow]:
    """Return one row for each grade; ``youngs_modulus_Pa`` is on the nominal circle [Pa]."""
    return [_grade_row(grade) for grade in catalogue.grades]


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
            doubt=size.doubt or "",
        )
        for size in grade.sizes
    ]


def facts(grade: Grade) -> list[tuple[str, str]]:
    """Return name and text of all that is known of a grade beside its sizes.

    What its source does not give says so, since a gap is a fact, too.
    """
    return [*_identity(grade), *_figures(grade), *(("note", note) for note in grade.notes)]


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
        wire_grade=grade.wire_grade or "",
        n_sizes=len(grade.sizes),
        n_doubtful=sum(size.doubt is not None for size in grade.sizes),
        diameter_m=(grade.sizes[0].diameter_m, grade.thickest.diameter_m),
        minimum_breaking_load_N=(min(loads_N), max(loads_N)),
        youngs_modulus_Pa=grade.fit().youngs_modulus_Pa,
        trust=grade.trust,
        origin=grade.origin,
        source=str(grade.source),
    )


def _identity(grade: Grade) -> Iterator[tuple[str, str]]:
    yield "manufacturer", grade.manufacturer
    yield "product", grade.product
    yield "construction", f"{grade.construction}, core {grade.core}"
    yield "finish", grade.finish
    yield "standard", grade.standard or "not given"
    yield "wire grade", grade.wire_grade or "not given"
    yield "source", str(grade.source)
    yield "trust", f"{grade.trust}: {TRUST_MEANING[grade.trust]}"
    yield "came in by", f"{grade.origin} ({grade.file})" if grade.file else grade.origin


def _figures(grade: Grade) -> Iterator[tuple[str, str]]:
    factor, expansion, ratio = grade.area_factor, grade.thermal_expansion, grade.sheave_ratio
    yield "modulus", _modulus_text(grade.modulus)
    yield "family on the nominal circle", _family_text(grade.fit())
    yield "sizes against the family", _spread_text(grade.fit(), len(grade.sizes))
    if factor is not None:
        yield "metallic area", f"{factor.value:g} d², {factor.basis}: {factor.source}"
    yield "thermal expansion", _expansion_text(expansion) if expansion else "not given"
    yield "sheave D/d", _ratio_text(ratio) if ratio else "not given"


def _modulus_text(modulus: Modulus) -> str:
    area = {"nominal": "nominal circle", "metallic": "metallic area"}[modulus.reference_area]
    value = f"{modulus.value_Pa / 1e9:.4g} GPa ± {modulus.uncertainty:.0%} on the {area}"
    return f"{value}, {modulus.basis}: {modulus.source}"


def _family_text(fit: FamilyFit) -> str:
    elastic = f"{fit.density_kg_per_m3:.0f} kg/m³, {fit.youngs_modulus_Pa / 1e9:.1f} GPa"
    return f"{elastic}, breaks at {fit.breaking_stress_Pa / 1e6:.0f} MPa"


def _spread_text(fit: FamilyFit, n_sizes: int) -> str:
    mass, load = _percent(fit.linear_density_spread), _percent(fit.breaking_load_spread)
    return f"mass {mass}, breaking load {load}, fitted to {fit.n_fitted} of {n_sizes}"


def _expansion_text(expansion: ThermalExpansion) -> str:
    return f"{expansion.coefficient_per_K:.3g} /K, {expansion.basis}: {expansion.source}"


def _ratio_text(ratio: SheaveRatio) -> str:
    return f"{ratio.suggested:g} suggested, {ratio.minimum:g} minimum, {ratio.source}"


def _percent(spread: tuple[float, float]) -> str:
    return f"{spread[0]:+.1%} to {spread[1]:+.1%}"
