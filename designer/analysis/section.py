"""Stiffness, frequency and clearance over a level section through the middle of the region."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from designer.analysis.analyse import Analysis
from designer.arrays import BoolArray, FloatArray
from designer.model.robot import Poses
from designer.statics.inverse import Statics, solve_sagging
from designer.statics.modes import frequencies_Hz, knows_inertia
from designer.statics.stiffness import largest_displacement_m_per_N
from designer.workspace.clearance import smallest_clearance
from designer.workspace.demand import is_left_out


@dataclass(frozen=True, slots=True, eq=False)
class SectionMap:
    """A value over rings about the centre of the region, see `Region.section_m`.

    Parameters
    ----------
    position_m : array (rings, spokes, 3)
        Positions, all at one height [m].
    values : array (rings, spokes)
        In SI units; NaN where there is none.
    is_bad : array (rings, spokes) of bool
        Where the study asks for a value and there is none.
    exit_points_m : array (n_cables, 3)
        Of the robot [m].
    """

    position_m: FloatArray
    values: FloatArray
    is_bad: BoolArray
    exit_points_m: FloatArray


def displacement_section(analysis: Analysis) -> SectionMap | None:
    """Return the largest displacement under a unit force [m/N]; None without an area."""
    statics = _statics(analysis, 40, 144)
    if statics is None:
        return None
    displacement = largest_displacement_m_per_N(statics)
    return _section(analysis, statics, displacement, np.isnan(displacement))


def frequency_section(analysis: Analysis) -> SectionMap | None:
    """Return the lowest frequency [Hz]; None without an area or the platform's inertia."""
    robot = analysis.built.robot
    if not knows_inertia(robot, robot.platform):
        return None
    statics = _statics(analysis, 16, 60)
    if statics is None or analysis.qualities is None:
        return None
    density = analysis.qualities.cable.cable.linear_density_kg_per_m
    lowest_Hz = frequencies_Hz(statics, robot.platform, density)
    return _section(analysis, statics, lowest_Hz, ~(lowest_Hz > 0.0))


def clearance_section(analysis: Analysis) -> SectionMap | None:
    """Return the smallest clearance [m]; None without an area or anything to compare."""
    interference = None if analysis.qualities is None else analysis.qualities.interference
    if interference is None or interference.worst is None:
        return None
    statics = _statics(analysis, 16, 60)
    if statics is None:
        return None
    distance = smallest_clearance(statics).distance_m
    return _section(analysis, statics, distance, ~statics.is_solved)


def _statics(analysis: Analysis, rings: int, spokes: int) -> Statics | None:
    """Solve the section at the middle height, with the cable of the design."""
    workspace, qualities = analysis.study.workspace, analysis.qualities
    if workspace is None or qualities is None or workspace.region.is_upright:
        return None
    if analysis.built.robot.is_planar:  # it has no area in plan
        return None
    positions = workspace.region.section_m(0.5, rings, spokes)
    if positions is None:
        return None
    poses = Poses.at(workspace.space.first(positions))
    return solve_sagging(analysis.built.robot, poses, qualities.cable.cable)


def _section(
    analysis: Analysis, statics: Statics, values: FloatArray, is_missing: BoolArray
) -> SectionMap:
    assert analysis.study.workspace is not None
    asked_for = ~is_left_out(statics, analysis.study.workspace.hangs_below)
    return SectionMap(
        position_m=statics.poses.position_m,
        values=np.where(statics.is_solved & asked_for, values, np.nan),
        is_bad=np.asarray(asked_for & is_missing),
        exit_points_m=statics.robot.exit_points_m,
    )
