"""What a rope of a material can be: bounds that tell a slip of unit or reference area.

A rope is lighter and weaker than the same circle full of its fibre or wire. Its stiffness over
its strength is near that of the yarn, since laying and braiding lower both.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, replace

from designer.grades.grade import Grade


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
BOUNDS = {
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
    bounds = BOUNDS.get(grade.material or "", wide)
    if bounds is _WIRE and _is_strand(grade):
        return _STRAND
    return bounds


def metallic_modulus_bounds_Pa(grade: Grade) -> tuple[float, float] | None:
    """Return the bounds of a wire rope's modulus on the metallic area; None for other ropes."""
    interval = _METALLIC_MODULUS_PA.get(grade.material or "")
    if interval is None:
        return None
    laid_twice, strand = interval
    return strand if _is_strand(grade) else laid_twice


def _is_strand(grade: Grade) -> bool:
    strand = r"\b1x\d|spiral|locked|\brod\b|\bsolid\b"
    return re.search(strand, grade.construction, re.IGNORECASE) is not None
