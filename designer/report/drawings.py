"""Draws every figure of a report and gives it a caption."""

from __future__ import annotations

import base64
import re
from collections.abc import Iterator
from dataclasses import replace
from typing import TYPE_CHECKING

from designer.analysis import Analysis
from designer.report.parts import Picture
from designer.report.pictures import Pictures

if TYPE_CHECKING:
    from designer.report.figures.maps import WorkspaceMaps


def draw(analysis: Analysis) -> Pictures:
    """Return all figures of a report; what a study has no results for is left out."""
    maps = None
    if analysis.workspace is not None:
        from designer.report.figures.maps import workspace_maps

        maps = workspace_maps(analysis)
    workspace = tuple(_workspace(maps)) if maps is not None else ()
    robot = _robot(analysis)
    # The scene to turn is large, so only the section on the workspace carries it.
    return Pictures(
        robot=replace(workspace[0], scene="") if workspace else robot,
        loop_chart=_loop(analysis),
        pose_scene=robot,
        verdicts=_verdicts(analysis),
        workspace=workspace,
        candidates=_candidates(analysis),
        pareto=_pareto(analysis),
        usable_chart=_usable_chart(analysis),
        usable_scene=_usable_scene(analysis, maps),
        stiffness=_stiffness(analysis),
        clearance=_clearance(analysis),
        groups=_groups(analysis),
    )


def _robot(analysis: Analysis) -> Picture | None:
    if analysis.pose is None:
        return None
    from designer.report.figures.robot_scene import robot_scene

    caption = "The robot in the configured pose"
    caption += (
        ", its cables in their true shape." if analysis.pose.sizing.statics.is_solved else "."
    )
    return _scene(caption, "The robot with its cables, in space", robot_scene(analysis.pose))


def _loop(analysis: Analysis) -> Picture | None:
    if analysis.pose is None:
        return None
    from designer.report.figures.charts_loop import loop_chart

    caption = "Largest tension and diameter over the turns of the loop, and the optimum."
    return chart(caption, "Two curves that rise from the massless start", loop_chart(analysis.pose))


def _verdicts(analysis: Analysis) -> Picture | None:
    if analysis.workspace is None:
        return None
    from designer.report.figures.charts_verdicts import verdict_chart

    caption = "All samples by verdict."
    return chart(
        caption, "A bar with a part for each verdict", verdict_chart(analysis.workspace.census)
    )


def _workspace(maps: WorkspaceMaps) -> Iterator[Picture]:
    from designer.report.figures.charts_edge import edge_chart
    from designer.report.figures.charts_served import served_chart
    from designer.report.figures.charts_slice import slice_chart, slice_panels
    from designer.report.figures.interactive import workspace_scene_html
    from designer.report.figures.workspace_scene import workspace_scene

    caption = "Needed diameter over the region"
    caption += ", a part of it cut away" if maps.has_area and not maps.is_upright else ""
    shown = "; the cables hang at the marked pose" if maps.focus.statics is not None else ""
    yield _scene(
        f"{caption}{shown}.",
        "The region in space, coloured by diameter",
        workspace_scene(maps),
        workspace_scene_html(maps),
    )
    place = _place_of(maps)
    view = "plane" if maps.is_upright else "plan"
    yield chart(f"Needed diameter {place}.", f"A map in {view}", slice_chart(maps))
    edge = edge_chart(maps)
    if edge is not None:
        caption = (
            "Needed diameter from the centre of the region outward, through the marked pose to the "
            "edge of the exit points' outline."
        )
        yield chart(caption, "A curve that climbs toward the edge", edge)
    caption = f"Largest tension, and its ratio to the tension without sag, {place}."
    yield chart(caption, f"Two maps in {view}", slice_panels(maps))
    caption = "Share of the poses that a cable of the configured family serves."
    yield chart(caption, "Two staircases, with sag and without", served_chart(maps.served))


def _place_of(maps: WorkspaceMaps) -> str:
    if maps.is_upright:
        return "over the region, seen from the side" if maps.has_area else "at each point"
    return "at the top of the region" if maps.has_area else "at each point, seen from above"


def _candidates(analysis: Analysis) -> Picture | None:
    if analysis.selection is None:
        return None
    from designer.report.figures.charts_candidates import candidates_chart

    caption = (
        "Each grade: the sizes that are sold, the diameter that the workspace needs, the best size "
        "that holds."
    )
    if analysis.selection.alternatives:
        caption += " A star marks grades that the study does not allow."
    return chart(caption, "A row for each grade", candidates_chart(analysis.selection))


def _pareto(analysis: Analysis) -> Picture | None:
    if analysis.selection is None:
        return None
    from designer.report.figures.charts_pareto import pareto_chart

    svg = pareto_chart(analysis.selection)
    if svg is None:
        return None
    caption = (
        "Every size that holds, by what sizes are compared by; colour and shape tell what it is "
        "made of. A size of which a figure is not known is not in that panel."
    )
    if len(analysis.selection.front) > 1:
        caption += " Numbers are the rows of the table below."
    return chart(caption, "Clouds of points with a lower left edge", svg)


def _usable_chart(analysis: Analysis) -> Picture | None:
    selection = analysis.selection
    if selection is None or selection.usable is None or not selection.usable.differs:
        return None
    from designer.report.figures.charts_usable import usable_chart

    caption = f"How much of the workspace each size of {selection.usable.grade.id} serves."
    return chart(
        caption, "A curve that climbs to all", usable_chart(selection.usable, selection.chosen)
    )


def _usable_scene(analysis: Analysis, maps: WorkspaceMaps | None) -> Picture | None:
    selection = analysis.selection
    if selection is None or selection.usable is None or maps is None:
        return None
    from designer.report.figures.usable_scene import usable_scene

    png = usable_scene(maps, selection.usable)
    if png is None:
        return None
    caption = (
        f"Where sizes of {selection.usable.grade.id} may go, a part of the region cut away: each "
        "serves its own layer and those of all thinner ones."
    )
    return _scene(caption, "The region in nested layers", png)


def _groups(analysis: Analysis) -> Picture | None:
    choice, workspace = analysis.groups, analysis.study.workspace
    if choice is None or choice.chosen is None or workspace is None:
        return None
    from designer.report.figures.charts_groups import groups_plan

    caption = "The robot from above. Cables are drawn as thick as they are to each other."
    svg = groups_plan(analysis.built.robot, workspace.region, choice, choice.chosen)
    return chart(caption, "Lines from the exit points to the platform, one colour a group", svg)


def _stiffness(analysis: Analysis) -> Picture | None:
    from designer.report.figures.section_maps import stiffness_map

    svg = stiffness_map(analysis)
    if svg is None:
        return None
    caption = (
        "Displacement of the platform under a force in its worst direction, at the middle height "
        f"of the region{_first_orientation(analysis)}."
    )
    return chart(caption, "A map in plan", svg)


def _first_orientation(analysis: Analysis) -> str:
    workspace = analysis.study.workspace
    if workspace is None or workspace.orientations.is_level:
        return ""
    if workspace.orientations.range_rad is not None:
        return ", in the middle of the range of orientations"
    return ", in the first of the orientations" if workspace.orientations.count > 1 else ""


def _clearance(analysis: Analysis) -> Picture | None:
    from designer.report.figures.section_maps import clearance_map

    svg = clearance_map(analysis)
    if svg is None:
        return None
    caption = (
        "Smallest distance between two cables, or between a cable and the platform, at the middle "
        f"height of the region{_first_orientation(analysis)}."
    )
    return chart(caption, "A map in plan", svg)


def _scene(caption: str, alternative: str, png: bytes, page: str = "") -> Picture:
    from designer.report.figures.trim import without_empty_rows

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
