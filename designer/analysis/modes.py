"""How the platform oscillates at the governing pose, and where the cables' own mass joins in."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from designer.arrays import FloatArray
from designer.model.cable import STANDARD_GRAVITY_M_PER_S2
from designer.model.load_case import STATIC
from designer.model.robot import Platform
from designer.model.space import named_place
from designer.physics.inertia import NEXT_TERM
from designer.statics.inverse import Statics
from designer.statics.modes import Mode, knows_inertia, lowest_bound_Hz, platform_modes
from designer.statics.shape import string_frequencies_Hz

if TYPE_CHECKING:
    from designer.analysis.analyse import Analysis

APART = 0.01
"""Relative: up to which the cables' own oscillations change a frequency too little to be told."""


@dataclass(frozen=True, slots=True, eq=False)
class PlatformModes:
    """Natural frequencies and shapes of the platform at one pose.

    Parameters
    ----------
    modes : tuple of Mode
        By frequency.
    name, load_case : str
        Of the cables, and of the load.
    place : array (6,)
        Where the platform is [m, rad].
    string_frequency_Hz : float
        Lowest frequency of any cable as a string between fixed ends [Hz].
    lowest_bound_Hz : float
        What the lowest frequency of platform and cables together is not below [Hz].
    statics : Statics
        The equilibrium about which it oscillates.
    """

    modes: tuple[Mode, ...] = field(metadata={"json": None})
    name: str = field(metadata={"json": "cable"})
    load_case: str
    place: FloatArray = field(metadata={"json": named_place})
    string_frequency_Hz: float
    lowest_bound_Hz: float
    statics: Statics = field(metadata={"json": None})

    def excess(self, mode: Mode) -> float:
        """Return by how much of itself a frequency is too high; see `designer.physics.inertia`."""
        ratio = mode.frequency_Hz / self.string_frequency_Hz
        return mode.cable_share * NEXT_TERM * ratio**2

    @property
    def couples(self) -> bool:
        """Whether the cables' own oscillations change the lowest frequency."""
        return self.excess(self.modes[0]) > APART

    def rows(self) -> Iterator[dict[str, object]]:
        """Yield what result files hold of each mode."""
        for mode in self.modes:
            excess = self.excess(mode)
            yield {
                "frequency_Hz": mode.frequency_Hz,
                "shape": mode.shape,
                "cable_share": mode.cable_share,
                "excess": excess,
            }


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
    """Return the modes about an equilibrium (); None where there is none, or no known inertia.

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
    return PlatformModes(
        modes=modes,
        name=name,
        load_case=load_case,
        place=statics.poses.place,
        string_frequency_Hz=float(np.min(string_frequencies_Hz(statics, density))),
        lowest_bound_Hz=float(lowest_bound_Hz(statics, modes[0].frequency_Hz, density)),
        statics=statics,
    )
