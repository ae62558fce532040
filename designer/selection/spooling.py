"""What the drums of the winches take up of given ropes, and how far aside the ropes run."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from designer.arrays import FloatArray
from designer.model.verdict import Requirement, State
from designer.model.winches import Drum


@dataclass(frozen=True, slots=True)
class Spooled:
    """The rope of one cable on its drum.

    Parameters
    ----------
    cable : int
        Its number, from 1.
    stroke_m, capacity_m : float
        Longest less shortest unstrained length, and what the drum takes up [m].
    turns, layers : float, int
        On the drum beside the dead turns, at the shortest length; NaN and 0 where it has no room.
    outer_diameter_m : float
        About the rope's centre in the outermost of them [m]; NaN where it has no room.
    fleet_angle_rad : float or None
        At a flange; None where the first sheave is not given [rad].
    """

    cable: int
    stroke_m: float
    capacity_m: float
    turns: float
    layers: int
    outer_diameter_m: float
    fleet_angle_rad: float | None


def spooled_on(
    drum: Drum, longest_m: FloatArray, shortest_m: FloatArray, ropes_m: Sequence[float]
) -> tuple[Spooled, ...]:
    """Return what becomes of each cable of these lengths and diameters (n_cables,) [m]."""
    each = []
    for k, (rope_m, stroke_m) in enumerate(
        zip(ropes_m, (longest_m - shortest_m).tolist(), strict=True), start=1
    ):
        turns, layers = drum.spooled(rope_m, stroke_m)
        outer_m = float(drum.diameters_m(rope_m)[layers - 1]) if layers else math.nan
        capacity_m = drum.capacity_m(rope_m)
        each.append(Spooled(k, stroke_m, capacity_m, turns, layers, outer_m, drum.fleet_angle_rad))
    return tuple(each)


def spooling_of(
    drum: Drum | None, longest_m: FloatArray, shortest_m: FloatArray, ropes_m: Sequence[float]
) -> Iterator[Requirement]:
    """Yield whether the drum takes up the stroke of each cable, and the fleet angle.

    Of the longest and the shortest unstrained length (n_cables,) in all load cases [m].
    """
    if drum is None:
        return
    each = [s for s in spooled_on(drum, longest_m, shortest_m, ropes_m) if s.stroke_m >= 0.0]
    if each:
        worst = max(each, key=_used)
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
            utilisation=_used(worst),
            cable=worst.cable,
            remark=_remark(drum, worst, ropes_m[worst.cable - 1]),
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


def _used(spooled: Spooled) -> float:
    return spooled.stroke_m / spooled.capacity_m if spooled.capacity_m > 0.0 else math.inf


def _remark(drum: Drum, spooled: Spooled, rope_m: float) -> str:
    if not drum.fits(rope_m):
        return f"a rope of {1e3 * rope_m:.4g} mm does not fit the pitch of the grooves"
    if not spooled.layers:
        return "no room on the drum"
    return f"{spooled.turns:.1f} turns in layer {spooled.layers} of {drum.layers_of(rope_m)}"
