r"""What the winches do along a path: lengths, tensions, speeds, power and energy against time.

At each instant the platform is in balance with its inertia (`designer.model.motion`); cables follow
as if at rest, so that their own oscillations and inertia are left out, as is that of drums and
motors. With T the tension at the exit point and v the rate of the unstrained length paid out, the
winch gives

.. math::  P = -T\,(1 + T / 2 EA)\, v

to a rope that lies on the drum free of load: work at the exit point and what the rope takes along
as strain, so that the sum over the winches is the rate of the energy of platform and cables. Its
motor gives P/η where that is positive, and takes η P where the load drives the winch.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from designer.analysis.requirements import design_loads
from designer.arrays import FloatArray
from designer.documents.plain import Json, csv_text
from designer.measured.assign import POSITION, ROTATION_VECTOR, length_names, tension_names
from designer.model.load_case import Loaded
from designer.model.motion import Motion
from designer.model.requirement import Requirement, State
from designer.model.robot import Poses
from designer.model.verdict import Verdict
from designer.model.winches import Winches
from designer.selection.criteria import rope_diameter_m
from designer.statics.inverse import Statics, solve_sagging

if TYPE_CHECKING:
    from designer.analysis.analyse import Analysis

_SOURCE = "along workspace.path, at its instants"


@dataclass(frozen=True, eq=False)
class PathCase:
    """A load case along the path, in one direction of its loads.

    Parameters
    ----------
    loaded : Loaded
        Robot and cables under its loads.
    motion : Motion
        The instants (n_instants,).
    statics : Statics
        Their equilibria (n_instants,).
    """

    loaded: Loaded
    motion: Motion
    statics: Statics

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
        length_m, time_s = self.statics.length_m, self.motion.time_s
        return np.asarray(np.gradient(length_m, time_s, axis=0, edge_order=2))

    @cached_property
    def power_W(self) -> FloatArray:
        """Of each motor, negative where the load drives it (n_instants, n_cables) [W]."""
        strain = self.tension_N / self.statics.axial_stiffness_N
        given = -self.tension_N * (1.0 + 0.5 * strain) * self.speed_m_per_s
        efficiency = self.winches.efficiency
        return np.where(given > 0.0, given / efficiency, given * efficiency)

    @cached_property
    def torque_Nm(self) -> FloatArray | None:
        """Of each motor, rope in the outermost layer (n_instants, n_cables) [N·m].

        None where no drum is given.
        """
        winches = self.winches
        if winches.drum_diameter_m is None:
            return None
        torque = winches.torque_Nm(self.tension_N, rope_diameter_m(self.loaded.cable))
        driven = self.speed_m_per_s > 0.0
        return np.where(driven, torque * winches.efficiency**2, torque)

    @cached_property
    def motor_speed_rad_per_s(self) -> FloatArray | None:
        """Of each motor, rope in the innermost layer (n_instants, n_cables) [rad/s]."""
        winches = self.winches
        if winches.drum_diameter_m is None:
            return None
        radius = 0.5 * (winches.drum_diameter_m + rope_diameter_m(self.loaded.cable))
        return np.asarray(self.speed_m_per_s * winches.gear_ratio / radius)

    @cached_property
    def energy_J(self) -> tuple[FloatArray, FloatArray]:
        """What each motor draws and what comes back to it, each (n_cables,) [J]."""
        drawn, back = (np.maximum(sign * self.power_W, 0.0) for sign in (1.0, -1.0))
        time_s = self.motion.time_s
        return np.trapezoid(drawn, time_s, axis=0), np.trapezoid(back, time_s, axis=0)

    @cached_property
    def rms_torque_Nm(self) -> FloatArray | None:
        """Root mean square over the path of each motor's torque (n_cables,) [N·m]."""
        if self.torque_Nm is None:
            return None
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
        torque, rms, turning = self.torque_Nm, self.rms_torque_Nm, self.motor_speed_rad_per_s
        for k in range(self.statics.robot.n_cables):
            tension, speed, power = (
                self.tension_N[:, k],
                self.speed_m_per_s[:, k],
                self.power_W[:, k],
            )
            yield {
                "load_case": self.name,
                "direction": self.loaded.words or None,
                "cable": k + 1,
                "tension_max_N": tension.max(),
                "tension_min_N": tension.min(),
                "length_max_m": self.statics.length_m[:, k].max(),
                "length_min_m": self.statics.length_m[:, k].min(),
                "paying_out_max_m_per_s": max(speed.max(), 0.0),
                "hauling_in_max_m_per_s": max(-speed.min(), 0.0),
                "power_max_W": power.max(),
                "power_min_W": power.min(),
                "torque_max_Nm": None if torque is None else torque[:, k].max(),
                "torque_rms_Nm": None if rms is None else rms[k],
                "motor_speed_max_rad_per_s": None if turning is None else abs(turning[:, k]).max(),
                "energy_drawn_J": drawn[k],
                "energy_returned_J": back[k],
            }


@dataclass(frozen=True, eq=False)
class PathAnalysis:
    """The path with the cables of the design.

    Parameters
    ----------
    directions : tuple of tuple of PathCase
        Each load case in all directions of its loads.
    """

    directions: tuple[tuple[PathCase, ...], ...]

    @cached_property
    def cases(self) -> tuple[PathCase, ...]:
        """Each load case, in the direction in which its largest tension is largest."""
        return tuple(
            max(each, key=lambda case: np.nan_to_num(case.tension_N).max())
            for each in self.directions
        )

    @property
    def shown(self) -> PathCase:
        """The load case with the largest tension."""
        return max(self.cases, key=lambda case: np.nan_to_num(case.tension_N).max())

    @property
    def motion(self) -> Motion:
        """How the platform moves."""
        return self.cases[0].motion

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
            "winches": [row for case in self.cases for row in case.rows()],
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
    return PathAnalysis(
        tuple(tuple(_along(loaded, motion) for loaded in loads.directions) for loads in every)
    )


def _along(loaded: Loaded, motion: Motion) -> PathCase:
    statics = solve_sagging(loaded.robot, Poses.at(motion.places), loaded.cable)
    return PathCase(loaded, motion, statics)


def path_requirements(analysis: Analysis) -> Iterator[Requirement]:
    """Yield what the winches and motors of a study have to do along its path."""
    winches = analysis.built.robot.winches
    asked = (
        ("winch_speed", "Winch speed", "rate of the unstrained length", "m/s",
         winches.speed_max_m_per_s, "speed_max", "speed_m_per_s"),
        ("motor_speed", "Motor speed", "v i / ((D + d) / 2), rope in the innermost layer", "rad/s",
         winches.motor_speed_rad_per_s, "motor.speed", "motor_speed_rad_per_s"),
        ("motor_power", "Motor power", "T v / η hauling in, η T v paying out", "W",
         winches.motor_power_W, "motor.power", "power_W"),
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


def _table(cases: Sequence[PathCase]) -> Iterator[list[str]]:
    n = cases[0].statics.robot.n_cables
    speeds, powers = (
        [f"{name}_{k}_{unit}" for k in range(1, n + 1)]
        for name, unit in (("speed", "m_per_s"), ("power", "W"))
    )
    yield [
        *("load_case", "time_s", *POSITION, *ROTATION_VECTOR),
        *(*length_names(n), *tension_names(n), *speeds, *powers, "verdict"),
    ]
    for case in cases:
        figures = (case.statics.length_m, case.tension_N, case.speed_m_per_s, case.power_W)
        rows = zip(
            np.column_stack([case.motion.time_s, case.motion.places]),
            np.hstack(figures),
            case.statics.verdict,
            strict=True,
        )
        for where, row, verdict in rows:
            cells = ["" if np.isnan(x) else f"{x:.10g}" for x in (*where, *row)]
            yield [case.name, *cells, Verdict(int(verdict)).label]
