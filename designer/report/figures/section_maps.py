"""Stiffness and clearance over a horizontal section through the middle of the workspace."""

from __future__ import annotations

import numpy as np

from designer.analysis.analyse import Analysis
from designer.arrays import BoolArray
from designer.model.region import Prism
from designer.model.robot import Poses
from designer.report.figures import grids
from designer.report.figures.height_map import HeightMap, height_map
from designer.statics.inverse import Statics, solve_sagging
from designer.statics.stiffness import largest_displacement_m_per_N
from designer.workspace.clearance import smallest_clearance
from designer.workspace.demand import is_left_out

_STIFFNESS_GRID = (40, 144)
_CLEARANCE_GRID = (16, 60)
_MILLIMETRES_PER_KILONEWTON = 1e6


def stiffness_map(analysis: Analysis) -> str | None:
    """Return a map of the largest displacement under a unit force; None without an area."""
    statics = _section(analysis, *_STIFFNESS_GRID)
    if statics is None or analysis.qualities is None:
        return None
    displacement = largest_displacement_m_per_N(statics)
    values = np.where(_counts(analysis, statics), displacement, np.nan)
    shown = HeightMap(
        position_m=statics.poses.position_m,
        values=_MILLIMETRES_PER_KILONEWTON * values,
        is_bad=np.asarray(_is_asked_for(analysis, statics) & np.isnan(displacement)),
        why_bad="not held, or not stably",
        exit_points_m=statics.robot.exit_points_m,
        label="largest displacement [mm/kN]",
    )
    return height_map(shown, "stiffness")


def clearance_map(analysis: Analysis) -> str | None:
    """Return a map of the smallest clearance; None without an area or anything to compare."""
    found = None if analysis.qualities is None else analysis.qualities.interference
    if found is None or found.worst is None:
        return None
    statics = _section(analysis, *_CLEARANCE_GRID)
    if statics is None:
        return None
    distance = smallest_clearance(statics).distance_m
    shown = HeightMap(
        position_m=statics.poses.position_m,
        values=1e3 * np.where(_counts(analysis, statics), distance, np.nan),
        is_bad=np.asarray(_is_asked_for(analysis, statics) & ~statics.is_solved),
        why_bad="not held",
        exit_points_m=statics.robot.exit_points_m,
        label="smallest clearance [mm]",
        limit=1e3 * found.clearance_m,
        limit_label="the clearance that is asked for",
    )
    return height_map(shown, "clearance")


def _section(analysis: Analysis, rings: int, spokes: int) -> Statics | None:
    """Return the statics of a section at the middle height, with the cable of the design."""
    workspace, qualities = analysis.study.workspace, analysis.qualities
    if workspace is None or qualities is None or not isinstance(workspace.region, Prism):
        return None
    if analysis.built.robot.is_planar:  # it has no area in plan
        return None
    height = 0.5 * sum(workspace.region.z_m)
    positions = grids.disc_m(workspace.region, height, rings, spokes)
    poses = Poses.at(positions, workspace.orientations.turns_rad[0])
    return solve_sagging(analysis.built.robot, poses, qualities.cable.cable)


def _is_asked_for(analysis: Analysis, statics: Statics) -> BoolArray:
    assert analysis.study.workspace is not None
    return np.asarray(~is_left_out(statics, analysis.study.workspace.hangs_below))


def _counts(analysis: Analysis, statics: Statics) -> BoolArray:
    return np.asarray(statics.is_solved & _is_asked_for(analysis, statics))
