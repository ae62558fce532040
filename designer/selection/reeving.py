r"""What fittings, sheaves and drums leave of a rope, and what they ask of it.

**Strength.** Noble Denton, 0027/ND "Guidelines for Marine Lifting & Lowering Operations", rev. 11
(2016), 7.6 to 7.8, which takes the bending of wire rope from IMCA M 179: over a body of diameter D,
a wire rope of diameter d breaks at

.. math::

    E_B = 1 - \frac{1}{2 \sqrt{D/d}}, \qquad D \ge d

times its breaking load. Bending and the end fitting weaken different places, so the smaller of
the two efficiencies counts and not their product. A fibre rope loses nothing by bending as long
as D is not below what its maker asks for; below that, nothing is known. One whose maker gives no
least diameter is taken for a wire rope here, which is on the safe side.

Typical efficiencies of end fittings: poured socket 1.0, steel ferrule 0.89, hand splice 0.8
(0027/ND, 7.7.1, as factors 1.00, 1.12 and 1.25); swaged socket 0.95, clips 0.8, wedge socket 0.75
to 0.95 (US Army TM 5-3810-305-10, table 4).

Between exit point and drum a rope that is hauled in bears the tension at the exit point over the
efficiency of the sheaves, where it is bent and has no fitting: there :math:`E_B` counts times that
efficiency. Of a cable that rises from its exit point the tension at the platform is larger than at
the exit point, and this on the safe side.

The allowable tension is the minimum breaking load times that efficiency over the safety factor.
The rule is for a rope at rest; fatigue of a rope that runs over sheaves is another matter.

**Bending.** With a duty class the least sheave over rope diameter follows from the class of the
rope. The table is of the lowest class of crane; that of higher ones was not available. A rope whose
table does not tell how its strands are laid is taken for one of the rest, on the safe side.

**Drums** take up the stroke of each cable; how far aside the ropes run is their fleet angle.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from designer.arrays import FloatArray
from designer.grades.grade import Grade, Size
from designer.model.cable import Cable, Material
from designer.model.verdict import Requirement, State
from designer.model.winches import Drum, Winches
from designer.study import Selection

_RATIO_SOURCE = "Japanese crane ordinance, table hor1-10-6-2-2, sheaves, lowest class"
_STRANDS = re.compile(r"(\d+)\s*[x×]\s*(\d+)(M?)", re.IGNORECASE)
_PARALLEL = re.compile(r"\b(seale|warrington|filler|ws)\b", re.IGNORECASE)
_PARALLEL_WIRES = (25, 26, 29, 31, 36, 41)
_MOST_IN_A_LAYER = 9


@dataclass(frozen=True, slots=True)
class Allowance:
    """How much of a breaking load may be used."""

    safety_factor: float  #: on what is left of the breaking load
    termination_efficiency: float = 1.0  #: share of the breaking load that the end fitting keeps
    sheave_diameter_m: float | None = None  #: the rope is bent over it [m]; None: not bent
    reeving_efficiency: float = 1.0  #: tension at exit point over drum, of a rope hauled in

    @classmethod
    def of(cls, selection: Selection, winches: Winches) -> Allowance:
        """Return what a study asks for."""
        fitting, sheave_m = selection.termination_efficiency, selection.sheave_diameter_m
        return cls(selection.safety_factor, fitting, sheave_m, winches.reeving_efficiency)

    def bending_efficiency(self, grade: Grade, diameter_m: float) -> float:
        """Return the share of the breaking load that bending leaves; NaN outside the rule."""
        if self.sheave_diameter_m is None:
            return 1.0
        ratio = self.sheave_diameter_m / diameter_m
        least = _least_of_fibre(grade)
        if least is not None:
            return 1.0 if ratio >= least else math.nan
        return bending_efficiency(ratio)

    def efficiency(self, grade: Grade, diameter_m: float) -> float:
        """Return the share of the breaking load that counts; NaN outside the rule."""
        bending = self.bending_efficiency(grade, diameter_m) * self.reeving_efficiency
        return math.nan if math.isnan(bending) else min(bending, self.termination_efficiency)

    def cable(self, grade: Grade, size: Size) -> Cable:
        """Return a size with its allowable tension [N]."""
        return grade.cable(size, self._factor(grade, size.diameter_m))

    def family(self, grade: Grade, diameter_m: float) -> Material:
        """Return the continuous family of a grade, as strong as its member of this diameter."""
        return grade.family(self._factor(grade, diameter_m))

    def _factor(self, grade: Grade, diameter_m: float) -> float:
        """Return minimum breaking load over allowable tension."""
        return self.safety_factor / self.efficiency(grade, diameter_m)


def _least_of_fibre(grade: Grade) -> float | None:
    """Return the least D/d of a fibre rope by its maker; None for wire, or where none is given."""
    is_fibre = grade.material not in ("steel", "stainless steel", None)
    return grade.sheave_ratio.minimum if grade.sheave_ratio and is_fibre else None


def why_not_bent(grade: Grade) -> str:
    """Return why the rule has no efficiency for a size of a grade."""
    least = _least_of_fibre(grade)
    if least is None:
        return "the sheave is thinner than the rope"
    return f"the sheave is thinner than {least:g} times the rope, the least of its grade"


def bending_efficiency(sheave_ratio: float) -> float:
    """Return E_B of a wire rope over a body D/d times as thick; NaN below 1."""
    return 1.0 - 0.5 / math.sqrt(sheave_ratio) if sheave_ratio >= 1.0 else math.nan


def least_sheave_ratio(grade: Grade) -> tuple[float, str] | None:
    """Return D/d and the class of a rope by that table; None for one that is not of steel."""
    if grade.material_class not in ("steel", "stainless steel"):
        return None
    match = _STRANDS.match(grade.construction)
    if match is None:
        return 25.0, "lay not stated"
    strands, wires = int(match[1]), int(match[2])
    is_parallel = bool(_PARALLEL.search(grade.construction)) or wires in _PARALLEL_WIRES
    is_stainless = grade.material_class == "stainless steel"
    in_parallel = strands in (6, 8) and is_parallel
    # The first that applies.
    classes = (
        (in_parallel and not is_stainless, 16.0, "6 or 8 strands in parallel lay"),
        (in_parallel, 20.0, "stainless, parallel lay"),
        (strands in (3, 4), 20.0, "three or four strands"),
        (strands > _MOST_IN_A_LAYER, 20.0, "multi-strand"),
        (bool(match[3]) or (strands, wires) == (7, 19), 20.0, "cross lay"),
        (True, 25.0, "neither parallel nor cross lay by its table"),
    )
    return next((ratio, name) for applies, ratio, name in classes if applies)


def sheave_ratio_of(grade: Grade, size: Size, selection: Selection) -> Iterator[Requirement]:
    """Yield the bending ratio, where the study has a sheave and a least ratio is known.

    That is the maker's or, with a duty class, that of the rope's class where it is larger.
    """
    ratio = grade.sheave_ratio
    least, source = (0.0, "") if ratio is None else (ratio.minimum, f"table of {grade.id}")
    by_class = None if selection.duty_class == "none" else least_sheave_ratio(grade)
    if by_class is not None and by_class[0] > least:
        least, source = by_class[0], f"{_RATIO_SOURCE}: {by_class[1]}"
    if selection.sheave_diameter_m is None or least == 0.0:
        return
    bending_ratio = selection.sheave_diameter_m / size.diameter_m
    yield Requirement(
        id="sheave_ratio",
        title="Sheave",
        formula="D / d ≥ the least ratio of the construction",
        source=source,
        state=State.HOLDS if bending_ratio >= least else State.FAILS,
        load_case="all",
        demand=least,
        capacity=bending_ratio,
        utilisation=least / bending_ratio,
        remark="" if ratio is not None and least == ratio.minimum else source,
    )


def drum_of(
    longest_m: FloatArray, shortest_m: FloatArray, selection: Selection | None
) -> Iterator[Requirement]:
    """Yield the largest stroke of a cable, where the study says what a drum takes up.

    Of the longest and the shortest unstrained length (n_cables,) in all load cases [m].
    """
    capacity_m = None if selection is None else selection.limits.drum_capacity_m
    stroke_m = longest_m - shortest_m
    if capacity_m is None or not np.isfinite(stroke_m).any():
        return
    cable = int(np.nan_to_num(stroke_m, nan=-1.0).argmax())
    yield Requirement(
        id="drum_capacity",
        title="Drum",
        formula="stroke: largest − smallest unstrained length ≤ what the drum takes up",
        source="selection.limits.drum_capacity, beside its dead turns",
        state=State.HOLDS if stroke_m[cable] <= capacity_m else State.FAILS,
        load_case="all",
        demand=float(stroke_m[cable]),
        capacity=capacity_m,
        unit="m",
        utilisation=float(stroke_m[cable]) / capacity_m,
        cable=cable + 1,
    )


@dataclass(frozen=True, slots=True)
class Spooled:
    """The rope of one cable on its drum."""

    cable: int  #: its number, from 1
    stroke_m: float  #: longest less shortest unstrained length [m]
    capacity_m: float  #: what the drum takes up [m]
    turns: float  #: on the drum beside the dead turns, at the shortest length; NaN without room
    layers: int  #: of them; 0 where it has no room
    outer_diameter_m: float  #: about the rope's centre in the outermost layer [m]; NaN without room
    fleet_angle_rad: float | None  #: at a flange [rad]; None where the first sheave is not given


def spooled_on(
    drum: Drum, longest_m: FloatArray, shortest_m: FloatArray, ropes_m: Sequence[float]
) -> tuple[Spooled, ...]:
    """Return what becomes of each cable of these lengths and diameters (n_cables,) [m]."""
    spooled, strokes_m = [], (longest_m - shortest_m).tolist()
    for cable, (rope_m, stroke_m) in enumerate(zip(ropes_m, strokes_m, strict=True), start=1):
        turns, layers = drum.spooled(rope_m, stroke_m)
        outer_m = float(drum.diameters_m(rope_m)[layers - 1]) if layers else math.nan
        capacity_m, angle_rad = drum.capacity_m(rope_m), drum.fleet_angle_rad
        spooled.append(Spooled(cable, stroke_m, capacity_m, turns, layers, outer_m, angle_rad))
    return tuple(spooled)


def spooling_of(
    drum: Drum | None, longest_m: FloatArray, shortest_m: FloatArray, ropes_m: Sequence[float]
) -> Iterator[Requirement]:
    """Yield whether the drum takes up the stroke of each cable, and the fleet angle.

    Of the longest and the shortest unstrained length (n_cables,) in all load cases [m].
    """
    if drum is None:
        return
    spooled = [s for s in spooled_on(drum, longest_m, shortest_m, ropes_m) if s.stroke_m >= 0.0]

    def utilisation(rope: Spooled) -> float:
        return rope.stroke_m / rope.capacity_m if rope.capacity_m > 0.0 else math.inf

    if spooled:
        worst = max(spooled, key=utilisation)
        rope_m, remark = ropes_m[worst.cable - 1], "no room on the drum"
        if not drum.fits(rope_m):
            remark = f"a rope of {1e3 * rope_m:.4g} mm does not fit the pitch of the grooves"
        elif worst.layers:
            remark = f"{worst.turns:.1f} turns in layer {worst.layers} of {drum.layers_of(rope_m)}"
        yield Requirement(
            id="spooling",
            title="Spooling",
            formula="stroke ≤ rope in the layers of the drum beside its dead turns; D_k = D + d + "
            "2 (k − 1) √(d² − p²/4), "
            + ("d nominal" if drum.groove_pitch_m else f"p = d, {drum.rope_oversize:.1%} oversize"),
            source="robot.winches.drum; helices about the rope's centre, each layer in the "
            "valleys of the one below",
            state=State.HOLDS if worst.stroke_m <= worst.capacity_m else State.FAILS,
            load_case="all",
            demand=worst.stroke_m,
            capacity=worst.capacity_m,
            unit="m",
            utilisation=utilisation(worst),
            cable=worst.cable,
            remark=remark,
        )
    angle_rad, most_rad = drum.fleet_angle_rad, drum.fleet_angle_max_rad
    if angle_rad is not None and most_rad is not None:
        yield Requirement(
            id="fleet_angle",
            title="Fleet angle",
            formula="angle of the rope at a flange, atan(L / 2a) ≤ the largest that is allowed; L "
            "between the flanges, a to the first sheave",
            source="robot.winches.drum.fleet_angle_max; sheave opposite the middle of the drum",
            state=State.HOLDS if angle_rad <= most_rad else State.FAILS,
            load_case="all",
            demand=math.degrees(angle_rad),
            capacity=math.degrees(most_rad),
            unit="deg",
            utilisation=angle_rad / most_rad,
        )
