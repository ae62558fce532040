"""Bending cycles of each rope along the path, place by place, and how many runs it bears.

A rope runs from the platform over the sheave at its exit point to its winch. Each time an end of a
bent piece passes a place of the rope it is bent or straightened: half a cycle. Places are counted
by unstrained length from the platform's end. In which sense sheave and drum bend a rope the study
does not say, so that reverse bends, which wear it more, are not counted apart; nor are sheaves
between exit point and winch.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from designer.analysis.path_case import PathCase
from designer.arrays import BoolArray, FloatArray
from designer.documents.plain import Json
from designer.model.requirement import Requirement, State
from designer.model.rope_life import RopeLife
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
    passes : tuple of array (n_steps, n_places)
        In which step which place comes to the sheave or leaves it, by its platform's end and by
        the other, and comes to the drum or leaves it, where the study says where it is.
    damage : array (n_places,) or None
        Share of the life that one run takes, after Palmgren and Miner; None without constants.
    """

    places_m: FloatArray
    passes: tuple[BoolArray, ...]
    damage: FloatArray | None = None

    @cached_property
    def on_sheave(self) -> FloatArray:
        """Bending cycles at the exit point (n_places,)."""
        return _cycles(self.passes[:2])

    @cached_property
    def on_drum(self) -> FloatArray | None:
        """Bending cycles on the drum (n_places,); None where it is not known."""
        return _cycles(self.passes[2:]) if len(self.passes) > 2 else None

    @property
    def cycles(self) -> FloatArray:
        """All of them (n_places,)."""
        return _cycles(self.passes)

    @cached_property
    def worst(self) -> int:
        """The place that wears most, or bends most often."""
        return int((self.cycles if self.damage is None else self.damage).argmax())

    @property
    def runs(self) -> float | None:
        """How many runs it bears until it breaks, in the mean; None without constants."""
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


def _cycles(passes: Sequence[BoolArray]) -> FloatArray:
    return np.asarray(0.5 * np.sum(passes, axis=(0, 1)))


def bending_of(
    case: PathCase, life: RopeLife | None, sheave_diameter_m: float | None
) -> tuple[CableBending, ...]:
    """Return what each cable bends in a run, of a case that is held at every instant."""
    statics, winches = case.statics, case.winches
    ends_m = [statics.free_length_m, statics.length_m]
    if winches.positions_m is not None and winches.drum_diameter_m is not None:
        distance_m = np.linalg.norm(winches.positions_m - statics.robot.exit_points_m, axis=1)
        ends_m.append(ends_m[1] + distance_m / (1.0 + case.tension_N / statics.axial_stiffness_N))
    every = range(statics.robot.n_cables)
    cables = [_bending([end_m[:, k] for end_m in ends_m]) for k in every]
    if life is None or sheave_diameter_m is None:
        return tuple(cables)
    rope_m = float(np.max(rope_diameter_m(case.loaded.cable)))
    drum_m = (winches.drum_diameter_m or 0.0) + rope_m
    over_m = [sheave_diameter_m, sheave_diameter_m, drum_m][: len(ends_m)]
    return tuple(
        replace(cables[k], damage=_damage(cables[k], case.tension_N[:, k], rope_m, over_m, life))
        for k in every
    )


def _bending(ends_m: Sequence[FloatArray]) -> CableBending:
    """Return it of one cable, of the ends (n_instants,) of its bent pieces."""
    low, high = ends_m[0].min(), ends_m[-1].max()
    places_m = low + (high - low) * (np.arange(_PLACES) + 0.5) / _PLACES
    return CableBending(places_m, tuple(crossings(end_m, places_m) for end_m in ends_m))


def _damage(
    cable: CableBending,
    tension_N: FloatArray,
    rope_m: float,
    over_m: Sequence[float],
    life: RopeLife,
) -> FloatArray:
    """Return the share of its life (n_places,) that a run takes, half a cycle a passage."""
    b, step_N = (life.b0, life.b1, life.b2, life.b3), 0.5 * (tension_N[1:] + tension_N[:-1])
    damage = np.zeros(_PLACES)
    for passes, diameter_m in zip(cable.passes, over_m, strict=True):
        borne = borne_cycles(
            step_N, rope_m, diameter_m, cable.bent_m, b, life.wire_strength_Pa, life.core_factor
        )
        damage += 0.5 * (passes / borne[:, None]).sum(axis=0)
    return damage


def life_requirements(
    directions: Sequence[Sequence[PathCase]],
    life: RopeLife | None,
    sheave_diameter_m: float | None,
    is_steel: bool,
) -> Iterator[Requirement]:
    """Yield whether the ropes last as long as they shall, in each load case by itself."""
    if life is None or life.days_min is None or life.runs_per_day is None:
        return
    wanted = life.days_min * life.runs_per_day
    for cases in directions:
        ends = [
            (bending.runs or 0.0, cable, case)
            for case in cases
            if case.is_held
            for cable, bending in enumerate(bending_of(case, life, sheave_diameter_m), start=1)
        ]
        runs, cable, worst = min(ends, key=lambda end: end[0], default=(np.nan, None, cases[0]))
        remark, state = "", State.HOLDS if runs >= wanted else State.FAILS
        if not is_steel or np.isnan(runs):
            remark = "constants are those of steel wire ropes" if not is_steel else ""
            state = State.OPEN
        yield Requirement(
            id="rope_life",
            title="Life of the rope",
            formula="runs along the path in the days asked for ≤ 1 / Σ (n / N), half a cycle for "
            "each time that the rope is bent or straightened",
            source=f"selection.rope_life; Palmgren and Miner, N after Feyrer: {life.source}",
            state=state,
            load_case=worst.name,
            demand=wanted,
            capacity=runs,
            utilisation=wanted / runs if runs > 0.0 else np.inf,
            cable=cable,
            loaded=worst.loaded,
            remark=remark,
        )
