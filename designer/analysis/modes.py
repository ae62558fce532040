"""How platform and cables oscillate at the governing pose."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from designer.arrays import FloatArray
from designer.model.cable import STANDARD_GRAVITY_M_PER_S2
from designer.model.load_case import STATIC
from designer.model.robot import Platform
from designer.model.space import named_place
from designer.statics.inverse import Statics
from designer.statics.modes import Mode, cable_frequencies_Hz, knows_inertia, platform_modes

if TYPE_CHECKING:
    from designer.analysis.analyse import Analysis


@dataclass(frozen=True, slots=True, eq=False)
class PlatformModes:
    """Natural frequencies and shapes of platform and cables together at one pose.

    Parameters
    ----------
    modes : tuple of Mode
        Those in which the platform takes part, by frequency; see `platform_modes`.
    name, load_case : str
        Of the cables, and of the load.
    place : array (6,)
        Where the platform is [m, rad].
    cable_frequency_Hz : float
        Lowest frequency of any cable between fixed ends [Hz].
    statics : Statics
        The equilibrium about which it oscillates.
    """

    modes: tuple[Mode, ...] = field(metadata={"json": None})
    name: str = field(metadata={"json": "cable"})
    load_case: str
    place: FloatArray = field(metadata={"json": named_place})
    cable_frequency_Hz: float
    statics: Statics = field(metadata={"json": None})


def modes_of(analysis: Analysis) -> PlatformModes | None:
    """Return the modes at the governing pose, or where no rope is chosen with the optimum.

    That is at the configured pose, else at the worst of the workspace in the static load. None
    where no cable holds it, or the inertia is not known.
    """
    density: FloatArray | float
    governing, ropes, pose = analysis.governing, analysis.ropes, analysis.pose
    if governing is not None and analysis.groups is None:
        loaded = governing.case.loaded
        name = "" if analysis.qualities is None else analysis.qualities.cable.name
        density, body = loaded.moving_density_kg_per_m, loaded.moving_body
        return modes_at(governing.alone, body, density, name, governing.case.case.name)
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
