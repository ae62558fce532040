"""Bending cycles of each rope along the path, place by place, and how many runs it bears.

A rope runs from the platform over the sheave at its exit point to its winch. Each time an end of a
bent piece passes a place of the rope it is bent or straightened: half a cycle. Places are counted
by unstrained length from the platform's end. In which sense sheave and drum bend a rope the study
does not say, so that reverse bends, which wear it more, are not counted apart; nor are sheaves
between exit point and winch.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from designer.analysis.path_case import PathCase
from designer.arrays import BoolArray, FloatArray
from designer.documents.plain import Json
from designer.model.verdict import Requirement, State
from designer.model.winches import RopeLife
from designer.physics.bending import borne_cycles, crossings
from designer.selection.criteria import rope_diameter_m

_PLACES = 1000


@dataclass(frozen=True, eq=False)
class CableBending:
    """What one cable bends in a run along the path.

    Parameters
    ----------
    places_m : array (n_places,)
        From the platform's end [m].
    on_sheave : array (n_places,)
        Bending cycles at the exit point.
    on_drum : array (n_places,) or None
        Bending cycles on the drum; None where the study does not say where it is.
    damage : array (n_places,) or None
        Share of the life that one run takes, after Palmgren and Miner; None where it is not known.
    """

    places_m: FloatArray
    on_sheave: FloatArray
    on_drum: FloatArray | None
    damage: FloatArray | None = None

    @property
    def cycles(self) -> FloatArray:
        """All of them (n_places,)."""
        return self.on_sheave if self.on_drum is None else self.on_sheave + self.on_drum

    @cached_property
    def worst(self) -> int:
        """The place that wears most, or bends most often."""
        return int((self.cycles if self.damage is None else self.damage).argmax())

    @property
    def runs(self) -> float | None:
        """How many runs it bears until it breaks, in the mean; None where it is not known."""
        if self.damage is None:
            return None
        largest = self.damage[self.worst]
        return float(1.0 / largest) if largest > 0.0 else np.inf

    def to_dict(self) -> Json:
        """Return what result files hold."""
        return {
            "most_bent_m": self.places_m[self.worst],
            "cycles_on_sheave": self.on_sheave[self.worst],
            "cycles_on_drum": None if self.on_drum is None else self.on_drum[self.worst],
            "bent_length_m": self.bent_m,
            "runs_to_break": self.runs,
        }

    @property
    def bent_m(self) -> float:
        """How much of the rope bends at all [m]."""
        step_m = self.places_m[1] - self.places_m[0]
        return float(step_m * np.count_nonzero(self.cycles))


def bending_of(
    case: PathCase, life: RopeLife | None, sheave_diameter_m: float | None
) -> tuple[CableBending, ...]:
    """Return what each cable bends in a run; nothing where an instant is not held.

    ``life`` is None where it gives no constants for these ropes.
    """
    if not case.is_held:
        return ()
    statics, winches = case.statics, case.winches
    is_hauled = np.diff(statics.length_m, axis=0) < 0.0
    step_N = 0.5 * (case.tension_N[1:] + case.tension_N[:-1])
    # The larger of the tensions on both sides of the sheave at the exit point.
    sheave_N = step_N / np.where(is_hauled, winches.sheave_efficiency, 1.0)
    rope_m = float(np.max(rope_diameter_m(case.loaded.cable)))
    ends_m = statics.free_length_m, statics.length_m
    bent = [(end_m, sheave_diameter_m, sheave_N) for end_m in ends_m]
    if winches.positions_m is not None and winches.drum_diameter_m is not None:
        distance_m = np.linalg.norm(winches.positions_m - statics.robot.exit_points_m, axis=1)
        unstrained_m = distance_m / (1.0 + case.tension_N / statics.axial_stiffness_N)
        drum_m = winches.drum_diameter_m + rope_m
        bent.append(
            (statics.length_m + unstrained_m, drum_m, winches.drum_tension_N(step_N, ~is_hauled))
        )
    cables = []
    for k in range(statics.robot.n_cables):
        cable, passes = _bending([end_m[:, k] for end_m, *_ in bent])
        if life is not None:
            over = [(over_m, each_N[:, k]) for _, over_m, each_N in bent if over_m is not None]
            damage = _damage(passes, over, rope_m, cable.bent_m, life)
            cable = replace(cable, damage=damage)
        cables.append(cable)
    return tuple(cables)


def _bending(ends_m: Sequence[FloatArray]) -> tuple[CableBending, list[BoolArray]]:
    """Return it of the ends (n_instants,) of a cable's bent pieces, and what passes them."""
    low, high = ends_m[0].min(), ends_m[-1].max()
    places_m = low + (high - low) * (np.arange(_PLACES) + 0.5) / _PLACES
    passes = [crossings(end_m, places_m) for end_m in ends_m]
    come, leave, *wound = (0.5 * each.sum(axis=0) for each in passes)
    return CableBending(places_m, come + leave, wound[0] if wound else None), passes


def _damage(
    passes: Sequence[BoolArray],
    over: Sequence[tuple[float, FloatArray]],
    rope_m: float,
    bent_m: float,
    life: RopeLife,
) -> FloatArray:
    """Return the share of its life (n_places,) that a run takes, half a cycle a passage.

    Of each end ``over`` has the diameter that it bends over, and the tension there in each step.
    """
    b, damage = (life.b0, life.b1, life.b2, life.b3), np.zeros(_PLACES)
    for of_end, (diameter_m, step_N) in zip(passes, over, strict=True):
        borne = borne_cycles(
            step_N, rope_m, diameter_m, bent_m, b, life.wire_strength_Pa, life.core_factor
        )
        damage += 0.5 * (of_end / borne[:, None]).sum(axis=0)
    return damage


def life_requirements(
    directions: Sequence[Sequence[tuple[PathCase, Sequence[CableBending]]]],
    life: RopeLife | None,
) -> Iterator[Requirement]:
    """Yield whether the ropes last as long as they shall, in each load case by itself.

    Of each direction of its loads what each cable bends.
    """
    if life is None or life.days_min is None or life.runs_per_day is None:
        return
    wanted = life.days_min * life.runs_per_day
    for each in directions:
        ends = [
            (bending.runs, number, case)
            for case, cables in each
            for number, bending in enumerate(cables, start=1)
            if bending.runs is not None
        ]
        runs, cable, worst = min(ends, key=lambda end: end[0], default=(math.nan, None, each[0][0]))
        is_held = all(case.is_held for case, _ in each)
        state = State.HOLDS if is_held and runs >= wanted else State.OPEN
        yield Requirement(
            id="rope_life",
            title="Life of the rope",
            formula="runs along the path in the days asked for ≤ 1 / Σ (n / N), half a cycle for "
            "each time that the rope is bent or straightened",
            source=f"selection.rope_life; Palmgren and Miner, N after Feyrer: {life.source}",
            state=State.FAILS if runs < wanted else state,
            load_case=worst.name,
            demand=wanted,
            capacity=runs,
            utilisation=wanted / runs if runs > 0.0 else math.inf if runs == 0.0 else math.nan,
            cable=cable,
            loaded=worst.loaded,
            remark="" if ends or not is_held else "the constants are of steel wire ropes",
        )
