"""Draws every figure of a report and gives it a caption."""

from __future__ import annotations

from collections.abc import Iterator
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
    return Pictures(
        loop_chart=_loop(analysis),
        verdicts=_verdicts(analysis),
        workspace=tuple(_workspace(maps)) if maps is not None else (),
        candidates=_candidates(analysis),
    )


def _loop(analysis: Analysis) -> Picture | None:
    if analysis.pose is None:
        return None
    from designer.report.figures.charts_loop import loop_chart

    caption = "Largest tension and diameter over the turns of the loop, and the optimum."
    return Picture(
        caption, "Two curves that rise from the massless start", loop_chart(analysis.pose)
    )


def _verdicts(analysis: Analysis) -> Picture | None:
    if analysis.workspace is None:
        return None
    from designer.report.figures.charts_verdicts import verdict_chart

    caption = "All samples by verdict."
    return Picture(
        caption, "A bar with a part for each verdict", verdict_chart(analysis.workspace.census)
    )


def _workspace(maps: WorkspaceMaps) -> Iterator[Picture]:
    from designer.report.figures.charts_edge import edge_chart
    from designer.report.figures.charts_served import served_chart
    from designer.report.figures.charts_slice import slice_chart, slice_panels

    place = "at the top of the region" if maps.has_area else "at each point, seen from above"
    yield Picture(f"Needed diameter {place}.", "A map in plan", slice_chart(maps))
    edge = edge_chart(maps)
    if edge is not None:
        caption = (
            "Needed diameter from the centre of the region outward, through the worst pose to the "
            "edge of the exit points' outline. The nearer the edge, the steeper it climbs."
        )
        yield Picture(caption, "A curve that climbs toward the edge", edge)
    caption = f"Largest tension, and its ratio to the tension without sag, {place}."
    yield Picture(caption, "Two maps in plan", slice_panels(maps))
    caption = "Share of the poses that a cable of the configured family serves."
    yield Picture(caption, "Two staircases, with sag and without", served_chart(maps.served))


def _candidates(analysis: Analysis) -> Picture | None:
    if analysis.selection is None:
        return None
    from designer.report.figures.charts_candidates import candidates_chart

    caption = (
        "Each grade: the sizes that are sold, the diameter that the workspace needs, the sizes "
        "that were tried."
    )
    if analysis.selection.alternatives:
        caption += " A star marks grades that the study does not allow."
    return Picture(caption, "A row for each grade", candidates_chart(analysis.selection))
