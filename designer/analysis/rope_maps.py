"""What the chosen rope, or those of groups, meet over the region: the values of its maps."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from designer.analysis import grids
from designer.analysis.analyse import Analysis
from designer.analysis.field import Field
from designer.analysis.maps import Focus, WorkspaceMaps
from designer.arrays import FloatArray
from designer.model.cable import Cable, Cables
from designer.model.region import Prism, Rectangle
from designer.model.robot import Poses, Robot
from designer.selection.cases import CaseFound
from designer.statics.inverse import Statics, solve_massless, solve_sagging
from designer.study import Workspace
from designer.workspace.demand import demand_of, in_worst_turn, is_left_out


@dataclass(frozen=True, slots=True, eq=False)
class Rope:
    """The ropes of the answer as they are loaded where they are used most.

    Parameters
    ----------
    robot, cable, workspace
        What is solved.
    name : str
        Of the ropes.
    load_case : str
        Of these loads.
    place : array (n_coordinates,)
        The worst place that is known [m, rad].
    """

    robot: Robot
    cable: Cable | Cables
    workspace: Workspace
    name: str
    load_case: str
    place: FloatArray

    def statics(self, place: FloatArray) -> Statics:
        """Return the equilibrium at places (..., n_coordinates)."""
        return solve_sagging(self.robot, Poses.at(place), self.cable)

    def used(self, statics: Statics) -> FloatArray:
        """Return the largest tension over allowable tension of any cable (...)."""
        return np.asarray((statics.cable_tension_N / self.cable.allowable_tension_N).max(axis=-1))


def rope_of(analysis: Analysis) -> Rope | None:
    """Return the ropes of the answer; None where none is chosen.

    Of one rope for all cables in the governing load case, or where that keeps lengths in the worst
    of the others; where all do, in the static load of the study, as ropes for groups of cables.
    """
    study, robot, groups = analysis.study, analysis.built.robot, analysis.groups
    chosen = analysis.chosen
    if analysis.qualities is None or study.workspace is None:
        return None
    design = analysis.qualities.cable
    if groups is not None and groups.chosen is not None:
        met = groups.chosen.verification
        place = met.worst_place[int(np.argmax(met.utilisation))]
        return Rope(robot, design.cable, study.workspace, design.name, "static", place)
    if chosen is None or groups is not None:
        return None
    whole = [one for one in chosen.cases if not one.loaded.keeps_lengths]
    if not whole:
        place = chosen.verification.worst_place
        return Rope(robot, chosen.cable, study.workspace, design.name, "static", place)
    most: CaseFound = max(whole, key=lambda one: one.utilisation)
    place = most.verification.worst_place
    one = most.loaded
    return Rope(one.robot, one.cable, most.workspace, design.name, most.case.name, place)


def rope_maps(family: WorkspaceMaps, rope: Rope) -> WorkspaceMaps:
    """Return the maps of a region with the values of a rope instead of what each pose needs."""
    region, place = rope.workspace.region, rope.place
    statics = rope.statics(place)
    focus = Focus(place[:3], "worst pose", statics if statics.is_solved else None, _at(rope, place))
    shell: dict[str, Field] = {}
    if isinstance(region, Prism):
        section = _over(rope, grids.disc_m(region, region.z_m[1], 45, 120))
        pieces = grids.cutaway_m(region, place[:3])
        shell = {name: _over(rope, grid[grids.every_second(grid)]) for name, grid in pieces.items()}
    elif isinstance(region, Rectangle):
        section = _over(rope, grids.upright_disc_m(region))
        shell = {"section": section}
    else:
        section = _over(rope, family.section.position_m)
    study = replace(family.study, workspace=rope.workspace)
    return replace(family, study=study, focus=focus, section=section, shell=shell, edge=None)


def _over(rope: Rope, position_m: FloatArray) -> Field:
    """Return the field at positions (..., 3), each in the orientation that asks for the most."""
    space, axes = rope.workspace.space, position_m.shape[:-1]
    places = space.places(position_m.reshape(-1, 3))
    if space.orientations.count > 1:
        statics = rope.statics(places)
        asked = demand_of(rope.used(statics), statics, rope.workspace.hangs_below)
        places = in_worst_turn(space, places, asked)
    return _at(rope, places.reshape(*axes, -1))


def _at(rope: Rope, place: FloatArray) -> Field:
    statics = rope.statics(place)
    nothing = np.full(place.shape[:-1], np.nan)
    return Field(
        position_m=place[..., :3],
        diameter_m=nothing,
        tension_N=statics.largest_tension_N,
        massless_diameter_m=nothing,
        massless_tension_N=solve_massless(rope.robot, Poses.at(place)).largest_tension_N,
        uplift=statics.force_z_N.max(axis=-1) / rope.robot.weight_N,
        verdict=statics.verdict,
        is_left_out=is_left_out(statics, rope.workspace.hangs_below),
        utilisation=rope.used(statics),
    )
