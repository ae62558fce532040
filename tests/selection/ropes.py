"""Grades made for the tests: after one law, so that what they should do is known."""

from __future__ import annotations

from designer.grades.grade import Grade, Modulus, Reference, RopeMaterial, SheaveRatio, Size

LOAD_PER_D2 = 780.0e6
"""Breaking load over diameter squared [N/m²], that of a 7x19 rope."""
MASS_PER_D2 = 4.15e3
"""Mass per length over diameter squared [kg/m³]."""


def rope(
    name: str,
    diameters_mm: list[float],
    *,
    weaker: dict[float, float] | None = None,
    strength: float = 1.0,
    weight: float = 1.0,
    stiffness: float = 1.0,
    sheave_ratio: float | None = None,
    price_per_kg: float | None = None,
    currency: str | None = None,
    material: RopeMaterial | None = None,
    is_nominal: bool = False,
) -> Grade:
    """Return a grade after the law, scaled; some sizes may be weaker by a factor."""
    sizes = tuple(
        Size(
            id=f"{d:g} mm",
            diameter_m=d / 1e3,
            minimum_breaking_load_N=strength * LOAD_PER_D2 * 1e-6 * d**2 * (weaker or {}).get(d, 1),
            linear_density_kg_per_m=weight * MASS_PER_D2 * 1e-6 * d**2,
            price_per_m=price_per_kg and price_per_kg * weight * MASS_PER_D2 * 1e-6 * d**2,
        )
        for d in diameters_mm
    )
    return Grade(
        id=name,
        manufacturer="maker",
        product="rope",
        construction="7x19",
        core="WSC",
        finish="galvanised",
        sizes=sizes,
        source=Reference("a", "b"),
        trust="B",
        modulus=Modulus(stiffness * 62.7e9, "nominal", "borrowed", "a like rope", 0.15),
        material=material,
        sheave_ratio=SheaveRatio(sheave_ratio, 0.6 * sheave_ratio, "maker")
        if sheave_ratio
        else None,
        currency=currency,
        is_nominal=is_nominal,
    )
