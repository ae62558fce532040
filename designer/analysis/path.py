r"""What the winches do along a path: lengths, tensions, speeds, power and energy against time.

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
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from designer.analysis.path_case import PathCase
from designer.analysis.requirements import design_loads
from designer.analysis.rope_bending import CableBending, bending_of, life_requirements
from designer.documents.plain import Json, csv_text
from designer.measured.assign import POSITION, ROTATION_VECTOR, length_names, tension_names
from designer.model.load_case import Loaded
from designer.model.motion import Motion
from designer.model.robot import Poses
from designer.model.verdict import Requirement, State, Verdict
from designer.model.winches import RopeLife
from designer.statics.inverse import solve_sagging

if TYPE_CHECKING:
    from designer.analysis.analyse import Analysis

_SOURCE = "along workspace.path, at its instants"


@dataclass(frozen=True, eq=False)
class PathAnalysis:
    """The path with the cables of the design.

    Parameters
    ----------
    directions : tuple of tuple of PathCase
        Each load case in all directions of its loads.
    life : RopeLife or None
        What the study says of the bends that a rope bears.
    sheave_diameter_m : float or None
        At the exit points [m].
    is_steel : bool
        Whether the ropes are known to be of steel wire, as those of the constants are.
    """

    directions: tuple[tuple[PathCase, ...], ...]
    life: RopeLife | None = None
    sheave_diameter_m: float | None = None
    is_steel: bool = False

    @cached_property
    def cases(self) -> tuple[PathCase, ...]:
        """Each load case, in the direction in which its largest tension is largest."""
        return tuple(
            max(each, key=lambda case: np.nan_to_num(case.tension_N).max())
            for each in self.directions
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
        return [
            {name: _extreme(name, [row[name] for row in of_winch]) for name in of_winch[0]}
            for directions in self.directions
            for of_winch in zip(*(case.rows() for case in directions), strict=True)
        ]

    @property
    def of_largest_energy(self) -> tuple[PathCase, ...]:
        """Each load case, in the direction in which its motors draw the largest energy together."""
        return tuple(
            max(each, key=lambda case: np.nan_to_num(case.energy_J[0]).sum())
            for each in self.directions
        )

    @cached_property
    def bent(self) -> tuple[tuple[tuple[PathCase, tuple[CableBending, ...]], ...], ...]:
        """Each load case in all directions, with what each cable bends in one run."""
        life = self.life if self.is_steel else None
        return tuple(
            tuple((case, bending_of(case, life, self.sheave_diameter_m)) for case in each)
            for each in self.directions
        )

    @property
    def bending(self) -> tuple[tuple[CableBending, ...], ...]:
        """Of each of the cases what each cable bends; none of a case that is not held."""
        of_case = {case: cables for each in self.bent for case, cables in each}
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
    if motion is None or analysis.qualities is None:
        return None
    every = design_loads(analysis.study, analysis.built, analysis.qualities.cable)
    selection = analysis.study.selection
    grades = [rope.grade for rope in analysis.assignment.by_cable]
    return PathAnalysis(
        tuple(tuple(_along(loaded, motion) for loaded in loads.directions) for loads in every),
        None if selection is None else selection.rope_life,
        None if selection is None else selection.sheave_diameter_m,
        bool(grades) and all(g.material in ("steel", "stainless steel") for g in grades),
    )


def _along(loaded: Loaded, motion: Motion) -> PathCase:
    statics = solve_sagging(loaded.robot, Poses.at(motion.places), loaded.cable)
    return PathCase(loaded, motion, statics)


def path_requirements(analysis: Analysis) -> Iterator[Requirement]:
    """Yield what winches, motors and ropes of a study have to do along its path."""
    path = analysis.path
    if path is not None:
        yield from life_requirements(path.bent, path.life)
    winches = analysis.built.robot.winches
    asked = (
        ("winch_speed", "Winch speed", "v (1 + T/EA), v the rate of the unstrained length",
         "m/s", winches.speed_max_m_per_s, "speed_max", "drum_speed_m_per_s"),
        ("motor_speed", "Motor speed", "v (1 + T/EA) i / ((D + d) / 2), rope in the lowest layer",
         "rad/s", winches.motor_speed_rad_per_s, "motor.speed", "motor_speed_rad_per_s"),
        ("motor_power", "Motor power", "P = T v (1 + T/EA) at the drum; P / η hauling in, η P else",
         "W", winches.motor_power_W, "motor.power", "power_W"),
    )  # fmt: skip
    for id_, title, formula, unit, limit, field, quantity in asked:
        if limit is None or analysis.path is None:
            continue
        for directions in analysis.path.directions:
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
                source=f"robot.winches.{field}; {_SOURCE}",
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


def _extreme(name: str, values: Sequence[Any]) -> Any:
    if isinstance(values[0], str) or values[0] is None:
        return values[0]
    return np.min(values) if "_min_" in name else np.max(values)


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
        for where, row, verdict in rows:
            cells = ["" if np.isnan(x) else f"{x:.10g}" for x in (*where, *row)]
            yield [case.name, *cells, Verdict(int(verdict)).label]
