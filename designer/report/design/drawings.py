"""The figures of a design report: each is drawn when a template first asks for it, and once."""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property

import numpy as np

from designer.analysis.analyse import Analysis
from designer.analysis.maps import WorkspaceMaps, rope_maps, workspace_maps
from designer.report import format as fmt
from designer.report.design.sections import STEP_M, shares_of_inputs, slopes_of_moves, weight_effect
from designer.report.document import Drawing, in_space, vector
from designer.report.figures.charts_edge import edge_chart
from designer.report.figures.charts_path import bending_chart, path_chart
from designer.report.figures.charts_pose import loop_chart
from designer.report.figures.charts_selection import candidates_chart, pareto_chart
from designer.report.figures.charts_sensitivity import carries_chart, odds_chart, shares_chart
from designer.report.figures.charts_shares import parts, served_chart, usable_chart, verdict_chart
from designer.report.figures.colours import DIAMETER, RATIO, UTILISATION, tension_of
from designer.report.figures.groups_plan import groups_plan
from designer.report.figures.interactive import workspace_scene_html
from designer.report.figures.mode_shapes import mode_shapes
from designer.report.figures.scenes import cover_scene, robot_scene, usable_scene, workspace_scene
from designer.report.figures.sections import (
    clearance_map,
    frequency_map,
    slice_panels,
    stiffness_map,
)
from designer.report.figures.stage import Image
from designer.report.phrases import INPUT_NAMES, LITTLE, sag_matters


def chart(draw: Callable[[Drawings], str | None]) -> cached_property[Drawing | None]:
    """Make a chart of what returns its SVG; None where figures are not drawn."""

    def drawn(drawings: Drawings) -> Drawing | None:
        return vector(draw(drawings)) if drawings.draws else None

    drawn.__doc__ = draw.__doc__
    return cached_property(drawn)


def scene(draw: Callable[[Drawings], Image | None]) -> cached_property[Drawing | None]:
    """Make a picture in space of what returns its image; None where scenes are not drawn."""

    def drawn(drawings: Drawings) -> Drawing | None:
        return in_space(draw(drawings)) if drawings.draws_scenes else None

    drawn.__doc__ = draw.__doc__
    return cached_property(drawn)


class Drawings:
    """Figures by name; each is None where nothing is drawn, or where it would show nothing.

    Parameters
    ----------
    analysis : Analysis
        What is drawn.
    draws : bool
        Whether figures are drawn.
    missing : str
        Why pictures in space are left out; empty where they are not.
    """

    def __init__(self, analysis: Analysis, draws: bool = False, missing: str = "") -> None:
        self.analysis, self.draws, self.missing = analysis, draws, missing

    @property
    def draws_scenes(self) -> bool:
        """Whether pictures in space are drawn."""
        return self.draws and not self.missing

    @cached_property
    def maps(self) -> WorkspaceMaps | None:
        """What the figures of the workspace show; None without them."""
        if not self.draws or self.analysis.workspace is None:
            return None
        return workspace_maps(self.analysis)

    @cached_property
    def rope_maps(self) -> WorkspaceMaps | None:
        """What the maps of the ropes of the answer show; None without them."""
        if self.maps is None or self.analysis.ropes is None:
            return None
        return rope_maps(self.maps, self.analysis.ropes)

    @chart
    def stiffness(self) -> str | None:
        """The displacement under a force, as a map in plan."""
        return stiffness_map(self.analysis)

    @chart
    def frequency(self) -> str | None:
        """The lowest frequency, as a map in plan."""
        return frequency_map(self.analysis)

    @cached_property
    def mode_shapes(self) -> tuple[Drawing, ...]:
        """How the platform moves in each of its modes; empty where figures are not drawn."""
        modes = self.analysis.modes if self.draws else None
        return () if modes is None else tuple(map(Drawing, mode_shapes(modes)))

    @chart
    def clearance(self) -> str | None:
        """The smallest distance between cables and platform, as a map in plan."""
        return clearance_map(self.analysis)

    @chart
    def odds(self) -> str | None:
        """Histograms of the utilisation of each size, where inputs are not certain."""
        survey = self.analysis.uncertainty
        sizes = [
            (size.candidate.size.id, size.utilisation, size is survey.chosen)
            for size in (survey.sizes if survey is not None else ())
            if survey is not None and np.isfinite(size.utilisation).any()
        ]
        return odds_chart(sizes) if sizes else None

    @chart
    def shares(self) -> str | None:
        """The share of each input in the variance, as bars."""
        survey = self.analysis.uncertainty
        if survey is None:
            return None
        return shares_chart([(INPUT_NAMES[share.input], share) for share in survey.shares])

    @chart
    def sensitivities(self) -> str | None:
        """What changes the utilisation, as bars."""
        carries = self.analysis.sensitivity
        if carries is None:
            return None
        shares, moves = shares_of_inputs(carries), slopes_of_moves(carries)
        if not shares or not moves:
            return None
        step = f"{fmt.trimmed(1e3 * STEP_M)} mm"
        percents = [(name, 100.0 * STEP_M * slope) for name, slope in moves]
        return carries_chart(shares, percents, step)

    @chart
    def groups(self) -> str | None:
        """The robot from above, a colour for each group of cables."""
        choice, workspace = self.analysis.groups, self.analysis.study.workspace
        if choice is None or not choice.chosen.is_found:
            return None
        assert workspace is not None
        return groups_plan(self.analysis.built.robot, workspace.region, self.analysis.assignment)

    @chart
    def path(self) -> str | None:
        """What each cable does along the path."""
        path = self.analysis.path
        return None if path is None or not path.shown.is_held else path_chart(path.shown)

    @chart
    def bending(self) -> str | None:
        """How often each place of each rope bends along the path."""
        path = self.analysis.path
        if path is None or not path.shown.is_held:
            return None
        return bending_chart(path.bending[path.cases.index(path.shown)])

    @scene
    def governing(self) -> Image | None:
        """The robot in the governing pose, the cable that governs marked."""
        pose = self.analysis.governing
        if pose is None:
            return None
        statics = pose.equilibrium
        return robot_scene(statics, int(statics.cable_tension_N.argmax()), pose.loads)

    @scene
    def robot(self) -> Image | None:
        """The robot in the configured pose."""
        pose = self.analysis.pose
        if pose is None:
            return None
        statics = pose.sizing.statics
        body, up = statics.robot.platform, statics.robot.level[2]
        loads = [("weight", -statics.robot.weight_N * up), ("load", body.wrench_N[:3])]
        return robot_scene(statics, loads=loads)

    @chart
    def loop(self) -> str | None:
        """The iterations as curves; None where they would be flat."""
        pose = self.analysis.pose
        if pose is None or not pose.loop.iterates:
            return None
        effect = weight_effect(pose)
        if effect is not None and pose.loop.has_converged and abs(effect) < LITTLE:
            return None
        return loop_chart(pose)

    @cached_property
    def cover(self) -> Drawing | None:
        """The picture of the first page: the region for the ropes or the family, else the robot."""
        return self.robot if self.maps is None else self._region_on_first_page

    @scene
    def _region_on_first_page(self) -> Image | None:
        maps = self.rope_maps or self.maps
        assert maps is not None
        return cover_scene(maps, DIAMETER if self.analysis.ropes is None else UTILISATION)

    @cached_property
    def region(self) -> Drawing | None:
        """The region in space, coloured by the diameter that the family needs, also to turn."""
        maps = self.maps
        if maps is None or not self.draws_scenes:
            return None
        return in_space(workspace_scene(maps), workspace_scene_html(maps))

    @chart
    def of_ropes(self) -> str | None:
        """Maps of the utilisation of the ropes of the answer, and of tension or what sag adds."""
        maps = self.rope_maps
        if maps is None:
            return None
        other = RATIO if sag_matters(maps) else tension_of(maps.section)
        return slice_panels(maps, (UTILISATION, other))

    @chart
    def of_family(self) -> str | None:
        """Maps of what the configured family needs: diameter, tension, and what sag adds to it."""
        maps = self.maps
        if maps is None:
            return None
        quantities = DIAMETER, tension_of(maps.section)
        return slice_panels(maps, (*quantities, RATIO) if sag_matters(maps) else quantities)

    @chart
    def edge(self) -> str | None:
        """The needed diameter from the centre of the region outward."""
        return None if self.maps is None else edge_chart(self.maps)

    @chart
    def served(self) -> str | None:
        """The share of the poses over the diameter."""
        return None if self.maps is None else served_chart(self.maps.coverage)

    @chart
    def verdicts(self) -> str | None:
        """The samples by verdict; None for a single one, of which the words say enough."""
        workspace = self.analysis.workspace
        if workspace is None or len(parts(workspace.census)) < 2:
            return None
        return verdict_chart(workspace.census)

    @chart
    def pareto(self) -> str | None:
        """Every size that holds, by what sizes are compared by; None where one alone is left."""
        selection = self.analysis.selection
        if selection is None or len(selection.front) < 2:
            return None
        return pareto_chart(selection)

    @chart
    def grades(self) -> str | None:
        """Sizes and need of each grade; None where no grade has a diameter that would do."""
        selection = self.analysis.selection
        if selection is None:
            return None
        outcomes = (*selection.outcomes, *selection.alternatives)
        has_need = any(np.isfinite(outcome.continuous_diameter_m) for outcome in outcomes)
        return candidates_chart(selection) if has_need else None

    @scene
    def layers(self) -> Image | None:
        """The part of the region that each size of a grade serves; None where all serve alike."""
        selection, maps = self.analysis.selection, self.maps
        usable = None if selection is None else selection.usable
        if usable is None or not usable.differs or maps is None:
            return None
        return usable_scene(maps, usable)

    @chart
    def usable(self) -> str | None:
        """The same as a curve, where there are no layers."""
        selection = self.analysis.selection
        usable = None if selection is None else selection.usable
        if selection is None or usable is None or not usable.differs or self.layers is not None:
            return None
        return usable_chart(usable, selection.chosen)
