r"""What the winches do along a path: lengths, tensions, speeds, power, energy, and bends of ropes.

At each instant the platform is in balance with its inertia (`designer.model.motion`); cables follow
as if at rest, so that their own oscillations and inertia are left out, as is that of drums and
motors. With T the tension at the drum, which differs from that at the exit point by the losses of
the sheaves (`designer.model.winches`), and v the rate of the unstrained length paid out, the winch
gives

.. math::  P = -T\,(1 + T / EA)\, v

to the rope, which it takes up as strained as it is there: without losses of sheaves the sum over
the winches is the rate of the energy of platform and cables, that of the strain of the rope on the
drums among it. Its motor gives P/η where that is positive, and takes η P where the load drives
the winch.

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
from typing import TYPE_CHECKING, Any

import numpy as np

from designer.arrays import BoolArray, FloatArray
from designer.documents.columns import POSITION, ROTATION_VECTOR, length_names, tension_names
from designer.documents.plain import Json, csv_text
from designer.model.load_case import Loaded
from designer.model.motion import Motion
from designer.model.robot import Poses
from designer.model.verdict import Requirement, State, Verdict
from designer.model.winches import RopeLife, Winches
from designer.physics.bending import borne_cycles, crossings
from designer.selection.criteria import rope_diameter_m
from designer.statics.inverse import Statics, solve_sagging

if TYPE_CHECKING:
    from designer.analysis.analyse import Analysis

_PLACES = 1000
"""Of a rope whose bends are counted."""


@dataclass(frozen=True, eq=False)
class PathCase:
    """A load case along the path, in one direction of its loads."""

    loaded: Loaded  #: robot and cables under its loads
    motion: Motion  #: the instants (n_instants,)
    statics: Statics  #: their equilibria (n_instants,)

    @property
    def name(self) -> str:
        """Of the load case."""
        return self.loaded.case.name

    @property
    def is_held(self) -> bool:
        """Whether every instant is solved: else speeds are not known."""
        return bool(self.statics.is_solved.all())

    @property
    def winches(self) -> Winches:
        """What pulls."""
        return self.statics.robot.winches

    @cached_property
    def tension_N(self) -> FloatArray:
        """At the exit points (n_instants, n_cables) [N]."""
        return self.statics.exit_tension_N

    @cached_property
    def speed_m_per_s(self) -> FloatArray:
        """Of the unstrained lengths, positive paying out (n_instants, n_cables) [m/s]."""
        return self.motion.speeds_m_per_s(self.statics.length_m)

    @cached_property
    def drum_tension_N(self) -> FloatArray:
        """At the drums, behind all sheaves (n_instants, n_cables) [N]."""
        return self.winches.drum_tension_N(self.tension_N, self.speed_m_per_s > 0.0)

    @cached_property
    def drum_speed_m_per_s(self) -> FloatArray:
        """Of the ropes at the drums, strained as they are there (n_instants, n_cables) [m/s]."""
        strain = self.drum_tension_N / self.statics.axial_stiffness_N
        return np.asarray((1.0 + strain) * self.speed_m_per_s)

    @cached_property
    def power_W(self) -> FloatArray:
        """Of each motor, negative where the load drives it (n_instants, n_cables) [W]."""
        given = -self.drum_tension_N * self.drum_speed_m_per_s
        efficiency = self.winches.efficiency
        return np.where(given > 0.0, given / efficiency, given * efficiency)

    @cached_property
    def torque_Nm(self) -> FloatArray:
        """Of each motor, rope in the outermost layer (n_instants, n_cables) [N·m]; NaN: no drum."""
        winches = self.winches
        if winches.drum_diameter_m is None:
            return np.full_like(self.tension_N, np.nan)
        rope_m, is_driven = rope_diameter_m(self.loaded.cable), self.speed_m_per_s > 0.0
        return winches.torque_Nm(self.tension_N, rope_m, is_driven)

    @cached_property
    def motor_speed_rad_per_s(self) -> FloatArray:
        """Of each motor, rope in the innermost layer (n_instants, n_cables) [rad/s]; as above."""
        winches = self.winches
        if winches.drum_diameter_m is None:
            return np.full_like(self.tension_N, np.nan)
        radius = 0.5 * (winches.drum_diameter_m + rope_diameter_m(self.loaded.cable))
        return np.asarray(self.drum_speed_m_per_s * winches.gear_ratio / radius)

    @cached_property
    def energy_J(self) -> tuple[FloatArray, FloatArray]:
        """What each motor draws and what comes back to it, each (n_cables,) [J]."""
        drawn, back = (np.maximum(sign * self.power_W, 0.0) for sign in (1.0, -1.0))
        time_s = self.motion.time_s
        return np.trapezoid(drawn, time_s, axis=0), np.trapezoid(back, time_s, axis=0)

    @cached_property
    def rms_torque_Nm(self) -> FloatArray:
        """Root mean square over the path of each motor's torque (n_cables,) [N·m]."""
        time_s = self.motion.time_s
        mean = np.trapezoid(self.torque_Nm**2, time_s, axis=0) / (time_s[-1] - time_s[0])
        return np.asarray(np.sqrt(mean))

    @cached_property
    def cable_share(self) -> float:
        """Largest share of the cables, as far as paid out, in the mass of all that moves."""
        cables_kg = self.loaded.moving_density_kg_per_m * self.statics.length_m
        total_kg = np.sum(cables_kg, axis=-1)
        return float(np.max(total_kg / (total_kg + self.loaded.moving_body.mass_kg)))

    def rows(self) -> Iterator[dict[str, object]]:
        """Yield what result files hold of each cable."""
        drawn, back = self.energy_J
        for k in range(self.statics.robot.n_cables):
            tension, drum_tension = self.tension_N[:, k], self.drum_tension_N[:, k]
            speed, power = self.drum_speed_m_per_s[:, k], self.power_W[:, k]
            yield {
                "load_case": self.name,
                "cable": k + 1,
                "tension_max_N": tension.max(),
                "tension_min_N": tension.min(),
                "drum_tension_max_N": drum_tension.max(),
                "drum_tension_min_N": drum_tension.min(),
                "length_max_m": self.statics.length_m[:, k].max(),
                "length_min_m": self.statics.length_m[:, k].min(),
                "paying_out_max_m_per_s": max(speed.max(), 0.0),
                "hauling_in_max_m_per_s": max(-speed.min(), 0.0),
                "power_max_W": power.max(),
                "power_min_W": power.min(),
                "torque_max_Nm": self.torque_Nm[:, k].max(),
                "torque_rms_Nm": self.rms_torque_Nm[k],
                "motor_speed_max_rad_per_s": abs(self.motor_speed_rad_per_s[:, k]).max(),
                "energy_drawn_J": drawn[k],
                "energy_returned_J": back[k],
            }


@dataclass(frozen=True, eq=False)
class CableBending:
    """What one cable bends in a run along the path."""

    places_m: FloatArray  #: (n_places,) from the platform's end [m]
    on_sheave: FloatArray  #: (n_places,) bending cycles at the exit point
    #: (n_places,) bending cycles on the drum; None where the study does not say where it is
    on_drum: FloatArray | None
    #: (n_places,) share of the life that one run takes, after Palmgren and Miner; None where it is
    #: not known
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
    statics, winches, cables = case.statics, case.winches, []
    is_hauled = np.diff(statics.length_m, axis=0) < 0.0
    step_N = 0.5 * (case.tension_N[1:] + case.tension_N[:-1])
    # The larger of the tensions on both sides of the sheave at the exit point.
    sheave_N = step_N / np.where(is_hauled, winches.sheave_efficiency, 1.0)
    rope_m = float(np.max(rope_diameter_m(case.loaded.cable)))
    ends_m = statics.free_length_m, statics.length_m
    # Of each end of a bent piece where it is, over which diameter it bends, and with what tension.
    bends = [(end_m, sheave_diameter_m, sheave_N) for end_m in ends_m]
    if winches.positions_m is not None and winches.drum_diameter_m is not None:
        distance_m = np.linalg.norm(winches.positions_m - statics.robot.exit_points_m, axis=1)
        unstrained_m = distance_m / (1.0 + case.tension_N / statics.axial_stiffness_N)
        drum_m = winches.drum_diameter_m + rope_m
        drum_N = winches.drum_tension_N(step_N, ~is_hauled)
        bends.append((statics.length_m + unstrained_m, drum_m, drum_N))
    for k in range(statics.robot.n_cables):
        low, high = bends[0][0][:, k].min(), bends[-1][0][:, k].max()
        places_m = low + (high - low) * (np.arange(_PLACES) + 0.5) / _PLACES
        passes = [crossings(end_m[:, k], places_m) for end_m, *_ in bends]
        onto, off, *wound = (0.5 * mask.sum(axis=0) for mask in passes)
        cable = CableBending(places_m, onto + off, wound[0] if wound else None)
        if life is not None:
            over = [(bend_m, bend_N[:, k]) for _, bend_m, bend_N in bends if bend_m is not None]
            damage = _damage(passes, over, rope_m, cable.bent_m, life)
            cable = replace(cable, damage=damage)
        cables.append(cable)
    return tuple(cables)


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
    demand = life.days_min * life.runs_per_day
    for of_case in directions:
        ends = [
            (bending.runs, number, case)
            for case, cables in of_case
            for number, bending in enumerate(cables, start=1)
            if bending.runs is not None
        ]
        runs, cable, worst = min(
            ends, key=lambda end: end[0], default=(math.nan, None, of_case[0][0])
        )
        is_held = all(case.is_held for case, _ in of_case)
        state = State.HOLDS if is_held and runs >= demand else State.OPEN
        yield Requirement(
            id="rope_life",
            title="Life of the rope",
            formula="runs along the path in the days asked for ≤ 1 / Σ (n / N), half a cycle for "
            "each time that the rope is bent or straightened",
            source=f"selection.rope_life; Palmgren and Miner, N after Feyrer: {life.source}",
            state=State.FAILS if runs < demand else state,
            load_case=worst.name,
            demand=demand,
            capacity=runs,
            utilisation=demand / runs if runs > 0.0 else math.inf if runs == 0.0 else math.nan,
            cable=cable,
            loaded=worst.loaded,
            remark="" if ends or not is_held else "the constants are of steel wire ropes",
        )


@dataclass(frozen=True, eq=False)
class PathAnalysis:
    """The path with the cables of the design."""

    directions: tuple[tuple[PathCase, ...], ...]  #: each load case in all directions of its loads
    life: RopeLife | None = None  #: what the study says of the bends that a rope bears
    sheave_diameter_m: float | None = None  #: at the exit points [m]
    #: whether the ropes are known to be of steel wire, as those of the constants are
    is_steel: bool = False

    @cached_property
    def cases(self) -> tuple[PathCase, ...]:
        """Each load case, in the direction in which its largest tension is largest."""
        return tuple(
            max(directions, key=lambda case: np.nan_to_num(case.tension_N).max())
            for directions in self.directions
        )

    @property
    def is_held(self) -> bool:
        """Whether every instant is, in all directions."""
        return all(case.is_held for directions in self.directions for case in directions)

    @property
    def shown(self) -> PathCase:
        """The load case with the largest tension."""
        return max(self.cases, key=lambda case: np.nan_to_num(case.tension_N).max())

    @property
    def motion(self) -> Motion:
        """How the platform moves."""
        return self.cases[0].motion

    @cached_property
    def winches(self) -> list[Json]:
        """Each winch in each load case: the extremes over all directions of its loads."""

        def extreme(name: str, values: Sequence[Any]) -> Any:
            if isinstance(values[0], str):
                return values[0]
            return np.min(values) if "_min_" in name else np.max(values)

        return [
            {name: extreme(name, [row[name] for row in of_winch]) for name in of_winch[0]}
            for directions in self.directions
            for of_winch in zip(*(case.rows() for case in directions), strict=True)
        ]

    @property
    def of_largest_energy(self) -> tuple[PathCase, ...]:
        """Each load case, in the direction in which its motors draw the largest energy together."""
        return tuple(
            max(directions, key=lambda case: np.nan_to_num(case.energy_J[0]).sum())
            for directions in self.directions
        )

    @cached_property
    def bent(self) -> tuple[tuple[tuple[PathCase, tuple[CableBending, ...]], ...], ...]:
        """Each load case in all directions, with what each cable bends in one run."""
        life = self.life if self.is_steel else None
        return tuple(
            tuple((case, bending_of(case, life, self.sheave_diameter_m)) for case in directions)
            for directions in self.directions
        )

    @property
    def bending(self) -> tuple[tuple[CableBending, ...], ...]:
        """Of each of the cases what each cable bends; none of a case that is not held."""
        of_case = {case: cables for directions in self.bent for case, cables in directions}
        return tuple(of_case[case] for case in self.cases)

    def to_dict(self) -> Json:
        """Return what ``result.json`` holds."""
        motion = self.motion
        speed, gain = (
            np.linalg.norm(rates[:, :3], axis=1).max()
            for rates in (motion.velocity, motion.acceleration)
        )
        return {
            "law": motion.words,
            "duration_s": motion.time_s[-1] - motion.time_s[0],
            "instants": len(motion.time_s),
            "speed_max_m_per_s": speed,
            "acceleration_max_m_per_s2": gain,
            "cable_share": max(case.cable_share for case in self.cases),
            "winches": self.winches,
            "bending": [
                {"load_case": case.name, "cable": number, **cable.to_dict()}
                for case, cables in zip(self.cases, self.bending, strict=True)
                for number, cable in enumerate(cables, start=1)
            ],
        }

    def to_csv(self) -> str:
        """Return all instants of all load cases as a table; empty cells where one is not solved."""
        return csv_text(_table(self.cases))


def path_of(analysis: Analysis) -> PathAnalysis | None:
    """Return the path with the cables of the design; None without a path, or without cables."""
    motion = analysis.study.robot.platform.motion
    if motion is None or not analysis.loads:
        return None

    def along(loaded: Loaded) -> PathCase:
        statics = solve_sagging(loaded.robot, Poses.at(motion.places), loaded.cable)
        return PathCase(loaded, motion, statics)

    selection = analysis.study.selection
    grades = [rope.grade for rope in analysis.assignment.by_cable]
    return PathAnalysis(
        tuple(tuple(map(along, loads.directions)) for loads in analysis.loads),
        None if selection is None else selection.rope_life,
        None if selection is None else selection.sheave_diameter_m,
        bool(grades) and all(g.material in ("steel", "stainless steel") for g in grades),
    )


def path_requirements(analysis: Analysis) -> Iterator[Requirement]:
    """Yield what winches, motors and ropes of a study have to do along its path."""
    path, winches = analysis.path, analysis.built.robot.winches
    if path is None:
        return
    yield from life_requirements(path.bent, path.life)
    limits = (
        ("winch_speed", "Winch speed", "v (1 + T/EA), v the rate of the unstrained length",
         "m/s", winches.speed_max_m_per_s, "speed_max", "drum_speed_m_per_s"),
        ("motor_speed", "Motor speed", "v (1 + T/EA) i / ((D + d) / 2), rope in the lowest layer",
         "rad/s", winches.motor_speed_rad_per_s, "motor.speed", "motor_speed_rad_per_s"),
        ("motor_power", "Motor power", "P = T v (1 + T/EA) at the drum; P / η hauling in, η P else",
         "W", winches.motor_power_W, "motor.power", "power_W"),
    )  # fmt: skip
    for id_, title, formula, unit, limit, field, quantity in limits:
        if limit is None:
            continue
        for directions in path.directions:
            sizes = [np.abs(getattr(case, quantity)) for case in directions]
            worst = int(np.argmax([np.nan_to_num(size).max() for size in sizes]))
            size, case = sizes[worst], directions[worst]
            row, cable = np.unravel_index(int(np.nan_to_num(size).argmax()), size.shape)
            demand, is_known = float(size[row, cable]), all(case.is_held for case in directions)
            state = State.HOLDS if is_known else State.OPEN
            remark = f"at {case.motion.time_s[row]:.4g} s"
            if demand > limit:
                state = State.FAILS
                if case.statics.robot.is_redundant:  # it could be held by other tensions
                    state = State.OPEN
                    remark += " with the least largest tension; other internal forces may need less"
            yield Requirement(
                id=id_,
                title=title,
                formula=f"{formula} ≤ that of the study",
                source=f"robot.winches.{field}; along workspace.path, at its instants",
                state=state,
                load_case=case.name,
                demand=demand,
                capacity=limit,
                unit=unit,
                utilisation=demand / limit,
                cable=int(cable) + 1,
                place=case.motion.places[row],
                loaded=case.loaded,
                remark=remark,
            )


def _table(cases: Sequence[PathCase]) -> Iterator[list[str]]:
    n = cases[0].statics.robot.n_cables
    at_drums, speeds, powers = (
        [f"{name}_{k}_{unit}" for k in range(1, n + 1)]
        for name, unit in (("drum_tension", "N"), ("speed", "m_per_s"), ("power", "W"))
    )
    yield [
        *("load_case", "time_s", *POSITION, *ROTATION_VECTOR),
        *(*length_names(n), *tension_names(n), *at_drums, *speeds, *powers, "verdict"),
    ]
    for case in cases:
        of_ropes = case.statics.length_m, case.tension_N, case.drum_tension_N
        rows = zip(
            np.column_stack([case.motion.time_s, case.motion.places]),
            np.hstack([*of_ropes, case.speed_m_per_s, case.power_W]),
            case.statics.verdict,
            strict=True,
        )
        for instant, row, verdict in rows:
            cells = ["" if np.isnan(x) else f"{x:.10g}" for x in (*instant, *row)]
            yield [case.name, *cells, Verdict(int(verdict)).label]
