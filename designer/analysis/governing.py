"""The pose at which the chosen rope is used most: figures to check by hand, ropes, oscillations."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from designer.arrays import FloatArray
from designer.model.cable import STANDARD_GRAVITY_M_PER_S2, Cable, Cables
from designer.model.load_case import STATIC, Loaded
from designer.model.robot import Platform, Poses, Robot
from designer.model.space import named_place
from designer.model.workspace import Workspace
from designer.selection.candidate import Candidate
from designer.selection.cases import CaseResult, governing
from designer.selection.criteria import is_paid_out, rope_diameter_m
from designer.statics.inverse import (
    MasslessStatics,
    Statics,
    sag_m,
    solve_massless,
    solve_sagging,
    stretch_m,
)
from designer.statics.modes import Mode, cable_frequencies_Hz, knows_inertia, platform_modes

if TYPE_CHECKING:
    from designer.analysis.analyse import Analysis


@dataclass(frozen=True, slots=True, eq=False)
class CableState:
    """One cable in the governing pose."""

    cable: int  #: its number, from 1
    length_m: float  #: unstrained, from the exit point [m]
    exit_tension_N: float  #: at the exit point [N]
    platform_tension_N: float  #: at the platform [N]
    angle_rad: float  #: of its pull on the platform, above the horizontal [rad]
    sag_m: float  #: largest distance from its chord [m]
    stretch_m: float  #: strained less unstrained length, between pulley and platform [m]
    safety_factor: float  #: what is left of the breaking load over the larger end tension
    frequency_Hz: float  #: lowest one between fixed ends, with sag and ice [Hz]
    pull_N: FloatArray  #: (3,) on the platform, world frame [N]
    #: behind the sheaves between exit point and drum, as the winch pulls, or pays out along a path
    #: [N]
    drum_tension_N: float
    motor_torque_Nm: float | None  #: as it does so; None where the study has no motor [N·m]


def _named_case(case: CaseResult) -> dict[str, Any]:
    place, lost = case.verification.worst_place, case.loaded.lost_cable
    names = {"load_case": case.case.name, "cable": case.most_used, "lost_cable": lost}
    return names | named_place(place)


@dataclass(frozen=True, slots=True, eq=False)
class GoverningPose:
    """The pose, or the rest after the loss of a cable, and what acts there."""

    case: CaseResult = field(metadata={"json": _named_case})  #: the load case that governs
    #: the equilibrium (1,)
    statics: Statics = field(metadata={"json": lambda at: {"at_m": at.poses.position_m[0]}})
    cables: tuple[CableState, ...]  #: those that are left
    #: name and force of what else acts on the platform, world frame (3,) [N]
    loads: tuple[tuple[str, FloatArray], ...] = field(
        metadata={"json": lambda loads: {"loads": [{"name": n, "force_N": f} for n, f in loads]}}
    )

    also_in_files: ClassVar = ("force_sum_N", "closure_residual_m", "balance_residual")

    @property
    def force_sum_N(self) -> FloatArray:
        """What all forces on the platform add up to (3,) [N]."""
        pulls = [cable.pull_N for cable in self.cables]
        return np.asarray(np.sum([*pulls, *(force for _, force in self.loads)], axis=0))

    @property
    def equilibrium(self) -> Statics:
        """The equilibrium without its leading axis."""
        return self.statics.part(0)

    @property
    def closure_residual_m(self) -> float:
        """Largest distance of a cable's end from its attachment [m]."""
        return float(self.statics.closure_residual_m().max())

    @property
    def balance_residual(self) -> float:
        """Largest part of what is left of the balance [N, N·m]."""
        return float(np.abs(self.statics.equilibrium_residual_N()).max())


def governing_pose(chosen: Candidate, safety_factor: float) -> GoverningPose | None:
    """Return the governing pose of a choice; None where nothing holds it.

    ``safety_factor`` is that of the study, for load cases without their own.
    """
    case = chosen.governing
    statics = case.statics
    if statics is None or not statics.is_solved.all():
        return None
    # Of the cables on the platform (n_cables, 3), world frame.
    plan = statics.force_x_N[0, :, None] * statics.geometry().outward[0]
    on_cables = np.column_stack([plan, statics.force_z_N[0]])
    pulls = np.asarray(-on_cables @ statics.robot.upright)
    factor = case.case.safety_factor or safety_factor
    strength_N = factor * case.loaded.cable.allowable_tension_N
    winches, exit_N = statics.robot.winches, statics.exit_tension_N[0]
    paid_out = np.broadcast_to(is_paid_out(case.loaded, statics), (1, len(exit_N)))[0]
    torque_Nm: list[float | None] = [None] * len(exit_N)
    if winches.motor_torque_Nm is not None:
        rope_m = rope_diameter_m(case.loaded.cable)
        torque_Nm = winches.torque_Nm(exit_N, rope_m, paid_out).tolist()
    rows = zip(
        case.cables.tolist(),
        statics.length_m[0].tolist(),
        exit_N.tolist(),
        statics.platform_tension_N[0].tolist(),
        np.arcsin(pulls @ _up(case.loaded) / np.linalg.norm(pulls, axis=1)).tolist(),
        sag_m(statics)[0].tolist(),
        stretch_m(statics)[0].tolist(),
        (strength_N / statics.cable_tension_N[0]).tolist(),
        cable_frequencies_Hz(statics, case.loaded.moving_density_kg_per_m)[0].tolist(),
        pulls,
        winches.drum_tension_N(exit_N, paid_out).tolist(),
        torque_Nm,
        strict=True,
    )
    cables = tuple(CableState(*row) for row in rows)
    return GoverningPose(case, statics, cables, tuple(_loads(case.loaded, case.pose)))


def _up(loaded: Loaded) -> FloatArray:
    return np.asarray(loaded.bare[0].level[2])


def _loads(loaded: Loaded, pose: Poses) -> list[tuple[str, FloatArray]]:
    """Return what acts on the platform beside the cables, by its name."""
    body = loaded.robot.platform
    named = [("weight", -loaded.robot.weight_N * _up(loaded))]
    if loaded.wind is not None:
        named.append(("wind on the platform", body.drag_force_N))
    inertia = loaded.robot.inertia_wrench_N(pose)
    if inertia is not None:
        named.append(("inertia force", inertia[0, :3]))
    if body.centre_force_N.any():
        named.append(("inertia force", body.centre_force_N))
    if body.wrench_N[:3].any():
        named.append(("force of the study or load case", body.wrench_N[:3]))
    return named


@dataclass(frozen=True, eq=False)
class GoverningRopes:
    """The ropes of the answer as they are loaded where they are used most."""

    robot: Robot  #: as loaded
    cable: Cable | Cables
    workspace: Workspace
    name: str  #: of the ropes
    load_case: str  #: of these loads
    place: FloatArray  #: (n_coordinates,) the worst place that is known [m, rad]

    @cached_property
    def worst(self) -> Statics:
        """The equilibrium at the worst place."""
        return self.statics(self.place)

    @cached_property
    def straight(self) -> MasslessStatics:
        """The same with straight weightless cables."""
        return solve_massless(self.robot, Poses.at(self.place))

    def statics(self, place: FloatArray) -> Statics:
        """Return the equilibrium at places (..., n_coordinates)."""
        return solve_sagging(self.robot, Poses.at(place), self.cable)

    def utilisation(self, statics: Statics) -> FloatArray:
        """Return the largest tension over allowable tension of any cable (...)."""
        return np.asarray((statics.cable_tension_N / self.cable.allowable_tension_N).max(axis=-1))


def governing_ropes(analysis: Analysis) -> GoverningRopes | None:
    """Return the ropes of the answer; None where none is chosen.

    Of one rope for all cables in the governing load case, or where that keeps lengths in the worst
    of the others; where all do, in the static load of the study, as ropes for groups of cables.
    """
    design, assignment = analysis.qualities, analysis.assignment
    if design is None or not assignment.is_found:
        return None
    name = design.cable.name
    cases = () if assignment.rope is None else assignment.rope.cases
    of_poses = [case for case in cases if not case.loaded.keeps_lengths]
    if not of_poses:
        verification = assignment.verification
        place = verification.worst_place[verification.most_used]
        cable = design.cable.cable
        return GoverningRopes(design.robot, cable, design.workspace, name, STATIC.name, place)
    worst = governing(of_poses)
    place, loaded = worst.verification.worst_place, worst.loaded
    return GoverningRopes(loaded.robot, loaded.cable, worst.workspace, name, worst.case.name, place)


@dataclass(frozen=True, slots=True, eq=False)
class PlatformModes:
    """Natural frequencies and shapes of platform and cables together at one pose."""

    #: those in which the platform takes part, by frequency; see `platform_modes`
    modes: tuple[Mode, ...] = field(metadata={"json": None})
    name: str = field(metadata={"json": "cable"})  #: of the cables
    load_case: str  #: of the load
    #: (6,) where the platform is [m, rad]
    place: FloatArray = field(metadata={"json": named_place})
    cable_frequency_Hz: float  #: lowest frequency of any cable between fixed ends [Hz]
    statics: Statics = field(metadata={"json": None})  #: the equilibrium about which it oscillates


def modes_of(analysis: Analysis) -> PlatformModes | None:
    """Return the modes at the governing pose, or where no rope is chosen with the optimum.

    That is at the configured pose, else at the worst of the workspace in the static load. None
    where no cable holds it, or the inertia is not known.
    """
    density: FloatArray | float
    governing, ropes, pose = analysis.governing, analysis.ropes, analysis.pose
    if governing is not None and analysis.groups is None:
        loaded = governing.case.loaded
        density, body = loaded.moving_density_kg_per_m, loaded.moving_body
        statics, name = governing.equilibrium, analysis.assignment.name
        return modes_at(statics, body, density, name, governing.case.case.name)
    if ropes is not None:
        density = ropes.cable.linear_density_kg_per_m
        return modes_at(ropes.worst, ropes.robot.platform, density, ropes.name, ropes.load_case)
    sizing = analysis.worst_sizing if pose is None else pose.sizing
    if sizing is None:
        return None
    statics = sizing.statics
    density = statics.weight_N_per_m / STANDARD_GRAVITY_M_PER_S2
    name = f"{1e3 * float(sizing.diameter_m):.1f} mm of the configured family"
    return modes_at(statics, analysis.built.robot.platform, density, name, STATIC.name)


def modes_at(
    statics: Statics, body: Platform, density: FloatArray | float, name: str, load_case: str
) -> PlatformModes | None:
    """Return the modes about an equilibrium (); None without it, known inertia or a mode.

    Parameters
    ----------
    statics : Statics
        The equilibrium ().
    body : Platform
        What is accelerated.
    density : float or array (n_cables,)
        Linear density of the cables, with what moves with them [kg/m].
    name, load_case : str
        As in `PlatformModes`.
    """
    if not (statics.is_solved and knows_inertia(statics.robot, body)):
        return None
    modes = platform_modes(statics, body, density)
    if not modes:
        return None
    return PlatformModes(
        modes=modes,
        name=name,
        load_case=load_case,
        place=statics.poses.place,
        cable_frequency_Hz=float(cable_frequencies_Hz(statics, density).min()),
        statics=statics,
    )
