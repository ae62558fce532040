"""A small grade as a file and as a value."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path

from designer.grades.grade import Grade, Modulus, Reference, Size

GRADE_TEXT = """\
id: acme-7x19
manufacturer: Acme
product: Hoistline
construction: 7x19
core: WSC
finish: galvanised
trust: A
source:
  publisher: Acme Ropes
  document: Catalogue, page 3
modulus:
  value: 60 GPa
  reference_area: nominal
  basis: printed
  uncertainty: 0.05
  source: Catalogue, page 4
units: {diameter: mm, minimum_breaking_load: kN, linear_mass: kg/m}
sizes:
  - {id: 4 mm,  diameter:  4, minimum_breaking_load: 11.2, linear_mass: 0.061}
  - {id: 6 mm,  diameter:  6, minimum_breaking_load: 25.0, linear_mass: 0.137}
  - {id: 8 mm,  diameter:  8, minimum_breaking_load: 43.9, linear_mass: 0.244}
  - {id: 10 mm, diameter: 10, minimum_breaking_load: 68.6, linear_mass: 0.381}
"""


def write_grade(path: Path, text: str = GRADE_TEXT, *, grade_id: str = "acme-7x19") -> Path:
    """Write a grade file under another id, and return its path."""
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text.replace("id: acme-7x19", f"id: {grade_id}"), encoding="utf-8")
    return path


def family_grade(
    density_kg_per_m3: float = 5200.0,
    youngs_modulus_Pa: float = 62.7e9,
    breaking_stress_Pa: float = 1.0e9,
    diameters_mm: Sequence[float] = (4.0, 6.0, 8.0, 10.0, 12.0),
) -> Grade:
    """Return a grade whose sizes all follow one family exactly."""
    sizes = []
    for diameter_mm in diameters_mm:
        area_m2 = math.pi * (diameter_mm * 1e-3) ** 2 / 4.0
        sizes.append(
            Size(
                id=f"{diameter_mm:g} mm",
                diameter_m=diameter_mm * 1e-3,
                minimum_breaking_load_N=breaking_stress_Pa * area_m2,
                linear_density_kg_per_m=density_kg_per_m3 * area_m2,
            )
        )
    return Grade(
        id="exact",
        manufacturer="nobody",
        product="none",
        construction="7x19",
        core="WSC",
        finish="bright",
        modulus=Modulus(youngs_modulus_Pa, "nominal", "computed", "made up for a test", 0.0),
        sizes=tuple(sizes),
        source=Reference("nobody", "a test"),
        trust="B",
    )
