"""Draws every figure of a report and gives it a caption."""

from __future__ import annotations

import base64
import math
import re
from collections.abc import Iterator
from typing import TYPE_CHECKING

from designer.analysis.analyse import Analysis, PoseAnalysis
from designer.report.design import captions
from designer.report.parts import Picture
from designer.report.pictures import Pictures
from designer.selection.result import SelectionResult

if TYPE_CHECKING:
    from designer.analysis.maps import WorkspaceMaps

_LITTLE = 0.02
"""A share by which sag may change a tension without a figure of that being worth its place."""


def draw(analysis: Analysis) -> Pictures:
    """Return all figures of a report; what a study has no results for is left out."""
    from designer.report.figures.opengl import why_no_scenes

    maps = None
    if analysis.workspace is not None:
        from designer.analysis.maps import workspace_maps

        maps = workspace_maps(analysis)
    missing = why_no_scenes()
    workspace = tuple(_workspace(maps, draws_scenes=not missing)) if maps is not None else ()
    robot = None if missing else _robot(analysis)
    return Pictures(
        robot=_cover(maps) if maps is not None and not missing else robot,
        loop_chart=_loop(analysis),
        pose_scene=robot,
        verdicts=_verdicts(analysis),
        workspace=workspace,
        candidates=_candidates(analysis),
        pareto=_pareto(analysis),
        usable_chart=_usable_chart(analysis),
        usable_scene=None if missing else _usable_scene(analysis, maps),
        stiffness=_stiffness(analysis),
        clearance=_clearance(analysis),
        groups=_groups(analysis),
        missing=missing,
    )


def _robot(analysis: Analysis) -> Picture | None:
    if analysis.pose is None:
        return None
    from designer.report.figures.scenes import robot_scene

    caption = captions.robot(analysis.pose)
    return _scene(caption, "The robot with its cables, in space", robot_scene(analysis.pose))


def _cover(maps: WorkspaceMaps) -> Picture:
    from designer.report.figures.scenes import cover_scene

    alternative = "The region in space, coloured by diameter"
    return _scene(captions.cover(maps), alternative, cover_scene(maps))


def _loop(analysis: Analysis) -> Picture | None:
    if analysis.pose is None or _is_idle(analysis.pose):
        return None
    from designer.report.figures.charts_pose import loop_chart

    caption = captions.loop(analysis.pose)
    return chart(caption, "Two curves that rise from the massless start", loop_chart(analysis.pose))


def _is_idle(pose: PoseAnalysis) -> bool:
    """Whether the loop settles close to where it starts, so that its curves would be flat."""
    if not (pose.sizing.statics.is_solved and pose.loop.has_converged):
        return False
    start, end = pose.massless.largest_tension_N, pose.sizing.statics.largest_tension_N
    return bool(abs(end - start) < _LITTLE * start)


def _verdicts(analysis: Analysis) -> Picture | None:
    if analysis.workspace is None:
        return None
    from designer.report.figures.charts_shares import parts, verdict_chart

    census = analysis.workspace.census
    if len(parts(census)) < 2:
        return None  # one colour from end to end says no more than the table
    return chart(
        "All samples by verdict.", "A bar with a part for each verdict", verdict_chart(census)
    )


def _workspace(maps: WorkspaceMaps, *, draws_scenes: bool) -> Iterator[Picture]:
    from designer.report.figures.charts_edge import edge_chart
    from designer.report.figures.charts_shares import served_chart
    from designer.report.figures.colours import DIAMETER, RATIO, tension_of
    from designer.report.figures.interactive import workspace_scene_html
    from designer.report.figures.scenes import workspace_scene
    from designer.report.figures.sections import slice_chart, slice_panels

    if draws_scenes:
        yield _scene(
            captions.scene(maps),
            "The region in space, coloured by diameter",
            workspace_scene(maps),
            workspace_scene_html(maps),
        )
    view = "plane" if maps.is_upright else "plan"
    tension = tension_of(maps.section)
    sag_matters = captions.largest_change(maps) > _LITTLE
    if sag_matters:
        yield chart(captions.section(maps), f"A map in {view}", slice_chart(maps))
    else:
        drawn = slice_panels(maps, (DIAMETER, tension))
        yield chart(captions.both(maps), f"Two maps in {view}", drawn)
    edge = edge_chart(maps)
    if edge is not None:
        yield chart(captions.edge(maps), "A curve that climbs toward the edge", edge)
    if sag_matters:
        drawn = slice_panels(maps, (tension, RATIO))
        yield chart(captions.panels(maps), f"Two maps in {view}", drawn)
    served = served_chart(maps.served)
    yield chart(captions.served(maps.served), "Two staircases, with sag and without", served)


def _candidates(analysis: Analysis) -> Picture | None:
    if analysis.selection is None or not _has_need(analysis.selection):
        return None
    from designer.report.figures.charts_selection import candidates_chart

    caption = captions.candidates(analysis.selection)
    return chart(caption, "A row for each grade", candidates_chart(analysis.selection))


def _has_need(selection: SelectionResult) -> bool:
    """Whether a grade has a diameter that would do; else all rows would say the same."""
    outcomes = (*selection.outcomes, *selection.alternatives)
    return any(math.isfinite(outcome.continuous_diameter_m) for outcome in outcomes)


def _pareto(analysis: Analysis) -> Picture | None:
    if analysis.selection is None:
        return None
    from designer.report.figures.charts_selection import pareto_chart

    svg = pareto_chart(analysis.selection)
    if svg is None:
        return None
    caption = captions.pareto(analysis.selection)
    return chart(caption, "Clouds of points with a lower left edge", svg)


def _usable_chart(analysis: Analysis) -> Picture | None:
    selection = analysis.selection
    if selection is None or selection.usable is None or not selection.usable.differs:
        return None
    from designer.report.figures.charts_shares import usable_chart

    caption = captions.usable(selection.usable, selection.chosen)
    return chart(
        caption, "A curve that climbs to all", usable_chart(selection.usable, selection.chosen)
    )


def _usable_scene(analysis: Analysis, maps: WorkspaceMaps | None) -> Picture | None:
    selection = analysis.selection
    if selection is None or selection.usable is None or maps is None:
        return None
    from designer.report.figures.scenes import usable_scene

    png = usable_scene(maps, selection.usable)
    if png is None:
        return None
    caption = captions.layers(selection.usable)
    return _scene(caption, "The region in layers", png)


def _groups(analysis: Analysis) -> Picture | None:
    choice, workspace = analysis.groups, analysis.study.workspace
    if choice is None or choice.chosen is None or workspace is None:
        return None
    from designer.report.figures.groups_plan import groups_plan

    caption = "The robot from above. Cables are drawn as thick as they are to each other."
    svg = groups_plan(analysis.built.robot, workspace.region, choice, choice.chosen)
    return chart(caption, "Lines from the exit points to the platform, one colour a group", svg)


def _stiffness(analysis: Analysis) -> Picture | None:
    from designer.report.figures.sections import stiffness_map

    svg = stiffness_map(analysis)
    if svg is None:
        return None
    return chart(captions.stiffness(analysis), "A map in plan", svg)


def _clearance(analysis: Analysis) -> Picture | None:
    from designer.report.figures.sections import clearance_map

    svg = clearance_map(analysis)
    if svg is None:
        return None
    return chart(captions.clearance(analysis), "A map in plan", svg)


def _scene(caption: str, alternative: str, png: bytes, page: str = "") -> Picture:
    from designer.report.figures.overlay import without_empty_rows

    kept = base64.b64encode(without_empty_rows(png)).decode()
    address = f"data:image/png;base64,{kept}"
    return Picture(caption, alternative, bitmap=address, scene=page)


def chart(caption: str, alternative: str, svg: str) -> Picture:
    """Return a chart, its half-transparent parts written so that they stay vector graphics.

    PlutoPrint composes an element with ``opacity`` and a clip as a bitmap; the same with
    ``fill-opacity`` and ``stroke-opacity`` it draws.
    """
    split = r"fill-opacity: \1; stroke-opacity: \1"
    return Picture(caption, alternative, re.sub(r"(?<![-\w])opacity: ([\d.]+)", split, svg))
