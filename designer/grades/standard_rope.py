"""Grades computed from the factors of EN 12385-4: what the standard asks of any rope of a kind.

For a construction, breaking force, metallic area and mass follow from the nominal diameter d and
the wires' tensile grade Rr alone:

    F = K d² Rr,    A = C d²,    m = W d²

K, C and W are those of table 1.9 of K. Feyrer, "Wire Ropes: Tension, Endurance, Reliability"; for
6x7, 6x19, 6x36 and 8x36, and K and C of the M ropes, Drahtseilerei Vornbäumen prints the same. No
factors were found for 35x7, which is stronger than 34x7, and for ropes of compacted strands.
Such a grade is nominal: a rope that follows the standard holds at least this, but it is nobody's
product. Its modulus is not in the standard and is borrowed.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from designer.grades.grade import (
    AreaFactor,
    ComputedFigure,
    Grade,
    Limits,
    Modulus,
    Reference,
    ReferenceArea,
    Remark,
    SheaveRatio,
    Size,
    ThermalExpansion,
)

WIRE_GRADES_MPA = (1570, 1770, 1960, 2160)
"""Tensile grades of the wires [MPa]."""

DIAMETERS_M = tuple(
    1e-3 * diameter_mm for diameter_mm in (*range(6, 21), *range(22, 35, 2), 35, *range(36, 61, 2))
)
"""Metric diameters: each of API Spec 9A (ISO 10425), table C.1, and of the makers' tables in the
catalogue, which have every millimetre to 20 mm and every second one from there [m]."""


@dataclass(frozen=True, slots=True)
class Factors:
    """Factors of EN 12385-4 for one construction, such as ``6x36 WS`` with the core ``IWRC``.

    K is breaking force over d² Rr, C metallic area over d², W mass over length and d² [kg per
    100 m and mm²].
    """

    construction: str
    core: str
    breaking_force: float  # K
    metallic_area: float  # C
    mass: float  # W

    def size(self, diameter_m: float, wire_grade_MPa: float) -> Size:
        """Return the size of this nominal diameter [m]."""
        return Size(
            id=f"{diameter_m * 1e3:g} mm",
            diameter_m=diameter_m,
            minimum_breaking_load_N=self.breaking_force * diameter_m**2 * wire_grade_MPa * 1e6,
            linear_density_kg_per_m=self.mass * diameter_m**2 * 1e4,
        )


FACTORS = (
    Factors("6x7", "FC", 0.332, 0.369, 0.345),
    Factors("6x7", "IWRC", 0.359, 0.432, 0.384),
    Factors("6x7", "WSC", 0.388, 0.432, 0.384),
    Factors("8x7", "FC", 0.291, 0.335, 0.327),
    Factors("8x7", "IWRC", 0.359, 0.439, 0.391),
    Factors("6x19", "FC", 0.330, 0.384, 0.359),
    Factors("6x19", "IWRC", 0.356, 0.449, 0.400),
    Factors("8x19", "FC", 0.293, 0.349, 0.340),
    Factors("8x19", "IWRC", 0.356, 0.457, 0.407),
    Factors("6x36 WS", "FC", 0.330, 0.393, 0.367),
    Factors("6x36 WS", "IWRC", 0.356, 0.460, 0.409),
    Factors("8x36 WS", "FC", 0.293, 0.357, 0.348),
    Factors("8x36 WS", "IWRC", 0.356, 0.468, 0.417),
    Factors("6x35N", "FC", 0.317, 0.377, 0.352),
    Factors("6x35N", "IWRC", 0.345, 0.441, 0.392),
    # W of these six as Drahtseilerei Vornbäumen prints it: the copy of Feyrer's table has less,
    # which the masses of 6x19M ropes that are sold do not bear out.
    Factors("6x19M", "FC", 0.307, 0.357, 0.346),
    Factors("6x19M", "IWRC", 0.332, 0.418, 0.381),
    Factors("6x19M", "WSC", 0.362, 0.418, 0.381),
    Factors("6x37M", "FC", 0.295, 0.357, 0.346),
    Factors("6x37M", "IWRC", 0.319, 0.418, 0.381),
    Factors("6x37M", "WSC", 0.346, 0.418, 0.381),
    Factors("18x7", "FC", 0.328, 0.408, 0.382),
    Factors("18x7", "WSC", 0.328, 0.433, 0.401),
    Factors("34x7", "FC", 0.318, 0.416, 0.390),
    Factors("34x7", "WSC", 0.318, 0.428, 0.401),
)
"""``6x19`` and ``8x19`` are the parallel-laid ropes: Seale, filler and Warrington."""

_SOURCE = Reference(
    publisher="EN 12385-4",
    document="factors K, C and W, as in K. Feyrer, Wire Ropes, table 1.9",
    url=(
        "http://what-when-how.com/Tutorial/topic-1297r4j9i2h/"
        "Wire-Ropes-Tension-Endurance-Reliability-51.html"
    ),
)
_STRETCH = "https://strandcore.com/resources/technical-resources/wire-rope-stretch/"


def _stretch_modulus(value_GPa: float, factor: str, lender: str, area: str = "") -> Modulus:
    """Modulus on the circle, or on the metal of an aircraft cable, which has more of it there."""
    over = f", over a metallic area of {area} d^2 (USITT, third hand)" if area else ""
    source = f"Strand Core, stretch factor G = {factor} of galvanised {lender}{over}; {_STRETCH}"
    kind: ReferenceArea = "metallic" if area else "nominal"
    return Modulus(value_GPa * 1e9, kind, "borrowed", source, 0.15)


_FIBRE_CORE = Modulus(
    46.7e9,
    "nominal",
    "borrowed",
    "ocean-engineering formula EA = 3.67e7 d^2 kN (d in m) for six-strand rope with fibre core, "
    "moorwire.py; https://github.com/ddjokic/Mooring-Line-Properties",
    0.15,
)
_ANY_ROPE = Modulus(
    103.4e9,
    "metallic",
    "borrowed",
    "theatre rigging rule of 15e6 psi for any wire rope, USITT TD&T, Understanding Shock Loads, "
    "third hand",
    0.2,
)
_MODULI = {
    ("6x7", "WSC"): _stretch_modulus(136.8, "1.07e-5", "7x7", "0.471"),
    ("6x19", "IWRC"): _stretch_modulus(64.5, "1.36e-5", "6x19 IWRC"),
    ("6x19M", "IWRC"): _stretch_modulus(64.5, "1.36e-5", "6x19 IWRC"),
    ("6x19M", "WSC"): _stretch_modulus(104.3, "1.40e-5", "7x19", "0.472"),
    ("6x36 WS", "IWRC"): _stretch_modulus(61.0, "1.44e-5", "6x37 IWRC"),
    ("6x35N", "IWRC"): _stretch_modulus(61.0, "1.44e-5", "6x37 IWRC"),
    ("6x37M", "IWRC"): _stretch_modulus(61.0, "1.44e-5", "6x37 IWRC"),
    ("6x37M", "WSC"): _stretch_modulus(61.0, "1.44e-5", "6x37 IWRC"),
    ("18x7", "WSC"): _stretch_modulus(49.3, "1.78e-5", "19x7"),
}
_RATIOS = (
    "Industrial Rope, sheave and drum ratios; "
    "https://industrialrope.com//catalog-wire-rope/sheave-and-drum-ratios/"
)
_SHEAVES = {
    "6x7": SheaveRatio(72, 42, f"for 6x7: {_RATIOS}"),
    "6x19": SheaveRatio(51, 34, f"for 6x19 Seale: {_RATIOS}"),
    "6x36 WS": SheaveRatio(35, 23, f"for 6x36 WS: {_RATIOS}"),
    "8x19": SheaveRatio(41, 27, f"for 8x19 Seale: {_RATIOS}"),
    "18x7": SheaveRatio(51, 34, f"for 19x7: {_RATIOS}"),
}


_WIRE_BREAKS = {
    "6x7": (2, 4),
    "8x7": (3, 6),
    "6x36 WS": (7, 14),
    "8x36 WS": (10, 21),
    "6x35N": (9, 18),
    "6x19M": (5, 10),
    "6x37M": (10, 19),
    "18x7": (2, 4),
    "34x7": (3, 5),
}
"""Visible broken wires to discard at, over 6 d and 30 d: by its construction where the table has it
as an example, else by the wires in the outer strands. ``6x19`` and ``8x19`` are several rows."""

_BREAKS_SOURCE = (
    "ISO 4309:2010 as printed in the inspection manual of Unirope, "
    "tables/wire-ropes/technical-info/inspmanual_14.php, commit 5ad968b9fb49; "
    "https://github.com/baudeveloper/unirope-beta"
)
_ROTATION_SOURCE = (
    "Unirope, rotation-resistant and non-rotating wire rope; "
    "http://unirope.com/ropes/rotation-resistant-non-rotating-wire-rope/"
)
_ROTATION = {
    "18x7": Remark("category II, rotation-resistant, by its two layers", _ROTATION_SOURCE),
    "34x7": Remark("category I, non-rotating, by its three layers", _ROTATION_SOURCE),
}
_STRETCH_SOURCE = (
    "Certex UK, properties of extension of steel wire ropes; "
    "https://www.certex.co.uk/Technical/Properties-of-Extension-of-Steel-Wire-Ropes"
)
_STRETCH_WITH_FIBRE = "0.25 % at a safety factor of 8, 0.5 % at 5, 0.75 % at 3"
_STRETCH_WITH_STEEL = "0.125 % at a safety factor of 8, 0.25 % at 5, 0.5 % at 3"
_LIMITS = Limits(
    temperature_C=(-40.0, 100.0),
    source="full load of wire rope slings: Certex, temperature and working load limit; "
    "https://www.certex.lv/en/technical-information/steel-wire-rope-slings/"
    "temperature-affect-on-working-load-limit-WLL",
)


def standard_rope(
    factors: Factors, wire_grade_MPa: int, diameters_m: Sequence[float] = DIAMETERS_M
) -> Grade:
    """Return the grade of a construction and wire grade, nominal and computed throughout.

    Parameters
    ----------
    factors : Factors
        One of `FACTORS`, or factors of your own.
    wire_grade_MPa : int
        One of `WIRE_GRADES_MPA`.
    diameters_m : sequence of float
        Ascending.

    Raises
    ------
    ValueError
        If the wire grade is none of the standard's, or if the diameters do not ascend from above
        zero.
    """
    if wire_grade_MPa not in WIRE_GRADES_MPA:
        raise ValueError(f"{wire_grade_MPa} MPa is none of the wire grades {WIRE_GRADES_MPA}")
    if not diameters_m or min(diameters_m) <= 0.0 or sorted(set(diameters_m)) != [*diameters_m]:
        raise ValueError("diameters have to ascend from above zero")
    construction, core = factors.construction, factors.core
    name = construction.replace(" ", "").lower()
    has_six_strands = construction.startswith("6x")
    usual_modulus = _FIBRE_CORE if core == "FC" and has_six_strands else _ANY_ROPE
    return Grade(
        id=f"en12385-{name}-{core.lower()}-{wire_grade_MPa}",
        manufacturer="none (EN 12385-4)",
        product=f"nominal {construction} {core}",
        construction=construction,
        core=core,
        finish="not stated",
        sizes=tuple(factors.size(diameter_m, wire_grade_MPa) for diameter_m in diameters_m),
        source=_SOURCE,
        trust="B",
        modulus=_MODULI.get((construction, core), usual_modulus),
        material="steel",
        standard="EN 12385-4",
        wire_grade=f"{wire_grade_MPa} N/mm2",
        area_factor=AreaFactor(factors.metallic_area, "printed", "factor C of EN 12385-4"),
        thermal_expansion=ThermalExpansion(
            12.5e-6, "borrowed", "Metalico, data sheet of galvanised messenger strand"
        ),
        sheave_ratio=_SHEAVES.get(construction),
        limits=_LIMITS,
        rotation=_ROTATION.get(construction),
        permanent_stretch=Remark(
            _STRETCH_WITH_FIBRE if core == "FC" else _STRETCH_WITH_STEEL, _STRETCH_SOURCE
        ),
        discard=_discard(construction),
        computed=(
            ComputedFigure("minimum_breaking_load", f"K d^2 Rr, K = {factors.breaking_force:.3f}"),
            ComputedFigure("linear_mass", f"W d^2, W = {factors.mass:.3f} kg/(100 m mm2)"),
            ComputedFigure("metallic_area", f"C d^2, C = {factors.metallic_area:.3f}"),
        ),
        notes=(
            "Nominal: computed by the standard's factors, not a product.",
            "Whether the standard lists this wire grade and these diameters for this construction "
            "was not looked up.",
        ),
        is_nominal=True,
    )


def standard_ropes() -> Iterator[Grade]:
    """Yield every construction in every wire grade."""
    for factors in FACTORS:
        for wire_grade_MPa in WIRE_GRADES_MPA:
            yield standard_rope(factors, wire_grade_MPa)


def _discard(construction: str) -> Remark | None:
    if construction not in _WIRE_BREAKS:
        return None
    short, long = _WIRE_BREAKS[construction]
    duty = "" if construction in _ROTATION else ", regular lay, M1 to M4 or class unknown"
    text = f"{short} visible broken wires over 6 d or {long} over 30 d, on steel sheaves and "
    return Remark(f"{text}single-layer drums{duty}", _BREAKS_SOURCE)
