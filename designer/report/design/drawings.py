"""The figures of a design report: each is drawn when a template first asks for it, and once."""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from designer.report import format as fmt
from designer.report.blocks import Picture
from designer.report.design.carries import STEP_M, shares_of_inputs, slopes_of_moves
from designer.report.design.pose import weight_effect
from designer.report.design.workspace_figures import cover_picture
from designer.report.odds import INPUT_NAMES
from designer.report.pictures import Drawing, in_space, vector

if TYPE_CHECKING:
    from designer.report.design.source import Source


_LITTLE = 0.02
"""A share by which sag may change a tension without a figure of that being worth its place."""


class Drawings:
    """Figures by name; each is None where nothing is drawn, or where it would show nothing.

    Parameters
    ----------
    source : Source
        What is drawn, and whether anything is.
    """

    def __init__(self, source: Source) -> None:
        self._source = source

    @cached_property
    def stiffness(self) -> Drawing | None:
        """The displacement under a force, as a map in plan."""
        if not self._source.draws:
            return None
        from designer.report.figures.sections import stiffness_map

        return vector(stiffness_map(self._source.analysis))

    @cached_property
    def clearance(self) -> Drawing | None:
        """The smallest distance between cables and platform, as a map in plan."""
        if not self._source.draws:
            return None
        from designer.report.figures.sections import clearance_map

        return vector(clearance_map(self._source.analysis))

    @cached_property
    def odds(self) -> Drawing | None:
        """Histograms of the utilisation of each size, where inputs are not certain."""
        survey = self._source.analysis.uncertainty
        if not self._source.draws or survey is None:
            return None
        from designer.report.figures.charts_uncertainty import odds_chart

        sizes = [
            (size.candidate.size.id, size.utilisation, size is survey.chosen)
            for size in survey.sizes
            if np.isfinite(size.utilisation).any()
        ]
        return vector(odds_chart(sizes)) if sizes else None

    @cached_property
    def shares(self) -> Drawing | None:
        """The share of each input in the variance, as bars."""
        survey = self._source.analysis.uncertainty
        if not self._source.draws or survey is None:
            return None
        from designer.report.figures.charts_uncertainty import shares_chart

        return vector(shares_chart([(INPUT_NAMES[one.input], one) for one in survey.shares]))

    @cached_property
    def sensitivities(self) -> Drawing | None:
        """What changes the utilisation, as bars."""
        carries = self._source.analysis.carries
        if not self._source.draws or carries is None:
            return None
        from designer.report.figures.charts_carries import carries_chart

        shares, moves = shares_of_inputs(carries), slopes_of_moves(carries)
        if not shares or not moves:
            return None
        step = f"{fmt.trimmed(1e3 * STEP_M)} mm"
        percents = [(name, 100.0 * STEP_M * slope) for name, slope in moves]
        return vector(carries_chart(shares, percents, step))

    @cached_property
    def groups(self) -> Drawing | None:
        """The robot from above, a colour for each group of cables."""
        analysis = self._source.analysis
        choice, workspace = analysis.groups, analysis.study.workspace
        if not self._source.draws or choice is None or not choice.chosen.is_found:
            return None
        from designer.report.figures.groups_plan import groups_plan

        assert workspace is not None
        return vector(groups_plan(analysis.built.robot, workspace.region, analysis.assignment))

    @cached_property
    def governing(self) -> Drawing | None:
        """The robot in the governing pose, in space, the cable that governs marked."""
        pose = self._source.analysis.governing
        if not self._source.draws_scenes or pose is None:
            return None
        from designer.report.figures.scenes import robot_scene

        statics = pose.alone
        return in_space(robot_scene(statics, int(statics.cable_tension_N.argmax()), pose.loads))

    @cached_property
    def robot(self) -> Drawing | None:
        """The robot in the configured pose, in space."""
        pose = self._source.analysis.pose
        if not self._source.draws_scenes or pose is None:
            return None
        from designer.report.figures.scenes import robot_scene

        statics = pose.sizing.statics
        body, up = statics.robot.platform, statics.robot.level[2]
        loads = [("weight", -statics.robot.weight_N * up), ("load", body.wrench_N[:3])]
        return in_space(robot_scene(statics, loads=loads))

    @cached_property
    def loop(self) -> Drawing | None:
        """The iterations as curves; None where they would be flat."""
        pose = self._source.analysis.pose
        if not self._source.draws or pose is None or not pose.loop.iterates:
            return None
        from designer.report.figures.charts_pose import loop_chart

        effect = weight_effect(pose)
        if effect is not None and pose.loop.has_converged and abs(effect) < _LITTLE:
            return None
        return vector(loop_chart(pose))

    @cached_property
    def cover(self) -> Picture | Drawing | None:
        """The picture of the first page: the region in space, else the robot."""
        source = self._source
        if not source.draws_scenes or source.maps is None:
            return self.robot
        return cover_picture(source.rope_maps or source.maps, source.analysis.ropes)
