"""Figures of the workspace, with captions that say what follows from them."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import replace

import numpy as np

from designer.analysis.field import RegionField
from designer.analysis.governing_ropes import GoverningRopes
from designer.analysis.maps import Served, WorkspaceMaps
from designer.report import format as fmt
from designer.report.blocks import Box, Picture
from designer.report.figures.colours import DIAMETER, RATIO, UTILISATION, tension_of
from designer.report.pictures import chart, scene

_LITTLE = 0.02
"""A share by which sag may change a tension without a figure of that being worth its place."""
_NEAR = 0.005
"""A distance from the edge, over that of the region, that is none."""
_IN_SPACE = "The region in space, coloured by diameter"


def workspace_figures(maps: WorkspaceMaps, *, draws_scenes: bool) -> Iterator[Picture | Box]:
    """Yield maps and charts of the workspace, in the order in which they are shown."""
    from designer.report.figures.charts_edge import edge_chart
    from designer.report.figures.charts_shares import served_chart
    from designer.report.figures.interactive import workspace_scene_html
    from designer.report.figures.scenes import workspace_scene
    from designer.report.figures.sections import slice_panels

    if draws_scenes:
        page = workspace_scene_html(maps)
        yield scene(scene_caption(maps), _IN_SPACE, workspace_scene(maps), page=page)
    view = "plane" if maps.is_upright else "plan"
    place, tension, change = _place_of(maps), tension_of(maps.section), _largest_change(maps)
    if change > _LITTLE:
        drawn = slice_panels(maps, (DIAMETER, tension, RATIO))
        yield chart(panels_caption(maps), f"Three maps in {view}", drawn)
    else:
        caption = (
            f"Needed diameter and largest tension {place}. The effect of rope weight on the "
            f"tension is {fmt.percent(change, 2)} there at most."
        )
        yield chart(caption, f"Two maps in {view}", slice_panels(maps, (DIAMETER, tension)))
    edge = chart(edge_caption(maps), "A curve that climbs toward the edge", edge_chart(maps))
    drawn = served_chart(maps.served)
    share = chart(served_caption(maps.served), "Two staircases, with sag and without", drawn)
    if edge is not None:
        yield Box.of("pair keep", edge, share)
    else:
        yield replace(share, kind="half")


def rope_figures(maps: WorkspaceMaps, rope: GoverningRopes) -> Iterator[Picture]:
    """Yield the maps of the ropes of the answer."""
    from designer.report.figures.sections import slice_panels

    change = _largest_change(maps)
    other = RATIO if change > _LITTLE else tension_of(maps.section)
    view = "plane" if maps.is_upright else "plan"
    drawn = slice_panels(maps, (UTILISATION, other))
    loads = f"in the load case '{rope.load_case}', {_place_of(maps)}"
    what = "tension over that of straight weightless cables" if other is RATIO else "the tension"
    caption = (
        f"{rope.name}: utilisation (largest over allowable tension), and {what}, {loads}. The "
        f"effect of rope weight on the tension is {fmt.percent(change, 2)} there at most."
    )
    yield chart(caption, f"Two maps in {view}", drawn)


def cover_picture(maps: WorkspaceMaps, rope: GoverningRopes | None) -> Picture:
    """Return the region in space for the first page: of the ropes, else of the family."""
    from designer.report.figures.scenes import cover_scene

    if rope is None:
        return scene(cover_caption(maps), _IN_SPACE, cover_scene(maps), kind="robot")
    caption = (
        f"Utilisation of {rope.name} over {_extent(maps)}, in the load case "
        f"'{rope.load_case}'; the cables hang at the worst pose."
    )
    drawn = cover_scene(maps, UTILISATION)
    return scene(caption, "The region in space, coloured by utilisation", drawn, kind="robot")


def scene_caption(maps: WorkspaceMaps) -> str:
    """Return the caption of the workspace in space."""
    cut = ", a part of it cut away" if maps.has_area and not maps.is_upright else ""
    cables = "; the cables hang at the marked pose" if maps.focus.statics is not None else ""
    return f"Needed diameter over the region{cut}{cables}.{_span(_shown(maps))}"


def cover_caption(maps: WorkspaceMaps) -> str:
    """Return the caption of the workspace on the first page."""
    shown = _span(_shown(maps))
    rest = ", at rest" if maps.study.load_cases else ""
    return f"Needed diameter of the configured cable family over {_extent(maps)}{rest}.{shown}"


def _extent(maps: WorkspaceMaps) -> str:
    size = np.ptp(maps.region.bounds_m, axis=0)
    extent = " × ".join(fmt.trimmed(float(edge), 3) for edge in size if edge > 0.0)
    return f"the region, {extent}\u00a0m" if maps.has_area else "the points"


def _shown(maps: WorkspaceMaps) -> Iterable[RegionField]:
    return maps.shell.values() if maps.has_area else (maps.section,)


def _span(fields: Iterable[RegionField]) -> str:
    shown = tuple(fields)
    values = np.concatenate([DIAMETER.of(field).ravel() for field in shown])
    values = 1e-3 * values[np.isfinite(values)]
    if len(values) == 0:
        return ""
    ends = fmt.millimetres(float(values.min())), fmt.millimetres(float(values.max()))
    if ends[0] == ends[1]:
        return ""
    runs = "Where a cable holds, it" if any(f.is_infeasible.any() for f in shown) else "It"
    return f" {runs} runs from {ends[0]} to {ends[1]}."


def _place_of(maps: WorkspaceMaps) -> str:
    if maps.is_upright:
        return "over the region, seen from the side" if maps.has_area else "at each point"
    return "at the top of the region" if maps.has_area else "at each point, seen from above"


def panels_caption(maps: WorkspaceMaps) -> str:
    """Return the caption of the maps of need, tension, and tension over that without sag."""
    what = "Needed diameter, largest tension, and its ratio to that of weightless cables"
    shown = f"{what}, {_place_of(maps)}. White lines join poses of equal need."
    ratio = RATIO.of(maps.section)
    if not np.isfinite(ratio).any():
        return shown
    most = fmt.factor(float(np.nanmax(ratio)))
    return f"{shown} Who ignores the rope weight misses a factor of up to {most}."


def _largest_change(maps: WorkspaceMaps) -> float:
    """Return by what share sag changes the largest tension at most over the section; else zero."""
    ratio = RATIO.of(maps.section)
    return float(np.nanmax(np.abs(ratio - 1.0))) if np.isfinite(ratio).any() else 0.0


def edge_caption(maps: WorkspaceMaps) -> str:
    """Return the caption of the profile toward the edge."""
    shown = (
        "Needed diameter from the centre of the region outward, through the marked pose to the "
        "edge of the exit points' outline."
    )
    profile = maps.edge
    if profile is None or profile.region_distance_m is None:
        return shown
    text = f"{shown} The region ends {_metres(profile.region_distance_m)} before that edge"
    last, straight = (
        None if distance is None or distance < _NEAR * profile.region_distance_m else distance
        for distance in (profile.limit_distance_m, profile.straight_distance_m)
    )
    if straight is not None and (last is None or straight > 1.001 * last):
        text += (
            f"; within {_metres(straight)} of it straight cables hold nothing, and one has to hang "
            "as a counterweight"
        )
    if last is None:
        return f"{text}."
    if profile.holds_again:
        return f"{text}; within {_metres(last)} of it some poses are held and others are not."
    none = "no cable holds, however thick" if profile.is_proved else "no cable was found that holds"
    return f"{text}; within {_metres(last)} of it {none}."


def _metres(length_m: float) -> str:
    return f"{fmt.number(length_m, 3)}\u00a0m"


def served_caption(found: Served) -> str:
    """Return the caption of the share of the poses over the diameter."""
    shown = "Share of the poses that a cable of the configured family serves."
    most = np.flatnonzero(found.share >= 0.9)
    if len(most) == 0 or not np.isfinite(found.needed_m):
        return shown
    nine_tenths = fmt.millimetres(float(found.diameter_m[most[0]]))
    return (
        f"{shown} {nine_tenths} serves nine poses of ten; the last tenth takes "
        f"{fmt.millimetres(found.needed_m)}."
    )
