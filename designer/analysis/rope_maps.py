"""What the chosen rope, or those of groups, meet over the region: the values of its maps."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from designer.analysis.field import RegionField
from designer.analysis.governing_ropes import GoverningRopes
from designer.analysis.maps import Focus, WorkspaceMaps
from designer.arrays import FloatArray
from designer.model.rings import every_second
from designer.model.robot import Poses
from designer.statics.inverse import solve_massless
from designer.workspace.demand import demand_of, in_worst_turn, is_left_out

_RINGS, _SPOKES = 45, 120
"""Half as fine as the maps of the family: a pose of a rope costs more than a size."""


def rope_maps(family: WorkspaceMaps, rope: GoverningRopes) -> WorkspaceMaps:
    """Return the maps of a region with the values of a rope instead of what each pose needs."""
    region, place = rope.workspace.region, rope.place
    statics = rope.worst
    focus = Focus(place[:3], "worst pose", statics if statics.is_solved else None, _at(rope, place))
    shell: dict[str, RegionField] = {}
    positions = region.section_m(1.0, _RINGS, _SPOKES)
    if positions is not None:
        section = _over(rope, positions)
        pieces = region.cutaway_m(place[:3])
        shell = {
            name: section if region.is_upright else _over(rope, grid[every_second(grid)])
            for name, grid in pieces.items()
        }
    else:
        section = _over(rope, family.section.position_m)
    study = replace(family.study, workspace=rope.workspace)
    return replace(family, study=study, focus=focus, section=section, shell=shell, edge=None)


def _over(rope: GoverningRopes, position_m: FloatArray) -> RegionField:
    """Return the field at positions (..., 3), each in the orientation that asks for the most."""
    space, axes = rope.workspace.space, position_m.shape[:-1]
    places = space.places(position_m.reshape(-1, 3))
    if space.orientations.count > 1:
        statics = rope.statics(places)
        demand = demand_of(rope.used(statics), statics, rope.workspace.hangs_below)
        places = in_worst_turn(space, places, demand)
    return _at(rope, places.reshape(*axes, -1))


def _at(rope: GoverningRopes, place: FloatArray) -> RegionField:
    statics = rope.statics(place)
    no_value = np.full(place.shape[:-1], np.nan)
    return RegionField(
        position_m=place[..., :3],
        diameter_m=no_value,
        tension_N=statics.largest_tension_N,
        massless_diameter_m=no_value,
        massless_tension_N=solve_massless(rope.robot, Poses.at(place)).largest_tension_N,
        uplift=statics.force_z_N.max(axis=-1) / rope.robot.weight_N,
        verdict=statics.verdict,
        is_left_out=is_left_out(statics, rope.workspace.hangs_below),
        utilisation=rope.used(statics),
    )
