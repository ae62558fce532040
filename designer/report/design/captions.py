"""Captions of the figures of a design report: what is shown, and what follows from it."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from designer.analysis.analyse import Analysis, PoseAnalysis
from designer.analysis.field import Field
from designer.analysis.maps import Served, WorkspaceMaps
from designer.report import format as fmt
from designer.report.figures.colours import DIAMETER, RATIO
from designer.selection.objectives import MEANINGS
from designer.selection.result import Candidate, SelectionResult
from designer.selection.usable import Usable

_NEGLIGIBLE = 0.005


def robot(pose: PoseAnalysis) -> str:
    """Return the caption of the robot in the configured pose."""
    if not pose.sizing.statics.is_solved:
        return "The robot in the configured pose."
    return (
        "The robot in the configured pose, its cables in their true shape, each with its tension "
        "at the exit point."
    )


def loop(pose: PoseAnalysis) -> str:
    """Return the caption of the turns of the loop."""
    shown = "Largest tension and diameter over the turns of the loop"
    start, end = pose.massless.largest_tension_N, pose.sizing.statics.largest_tension_N
    if not (pose.sizing.statics.is_solved and np.isfinite(start)):
        return f"{shown}."
    more = float(end / start) - 1.0
    if abs(more) < _NEGLIGIBLE:
        return f"{shown}. In this pose sag hardly matters."
    return (
        f"{shown}, and the optimum. Sag changes the tension of this pose by "
        f"{fmt.signed_percent(more)}."
    )


def scene(maps: WorkspaceMaps) -> str:
    """Return the caption of the workspace in space."""
    cut = ", a part of it cut away" if maps.has_area and not maps.is_upright else ""
    cables = "; the cables hang at the marked pose" if maps.focus.statics is not None else ""
    return f"Needed diameter over the region{cut}{cables}.{_span(_shown(maps))}"


def cover(maps: WorkspaceMaps) -> str:
    """Return the caption of the workspace on the first page."""
    size = np.ptp(maps.region.bounds_m, axis=0)
    extent = " × ".join(fmt.trimmed(float(edge), 3) for edge in size if edge > 0.0)
    region = f"the region, {extent}\u00a0m" if maps.has_area else "the points"
    return f"Needed diameter of the configured cable family over {region}.{_span(_shown(maps))}"


def _shown(maps: WorkspaceMaps) -> Iterable[Field]:
    return maps.shell.values() if maps.has_area else (maps.section,)


def _span(fields: Iterable[Field]) -> str:
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


def section(maps: WorkspaceMaps) -> str:
    """Return the caption of the map of the needed diameter alone."""
    return f"Needed diameter {_place_of(maps)}. White lines join poses of equal need."


def both(maps: WorkspaceMaps) -> str:
    """Return the caption of the maps of diameter and tension where sag hardly matters."""
    change = fmt.percent(largest_change(maps), 2)
    return (
        f"Needed diameter and largest tension {_place_of(maps)}. Sag changes the tension by at "
        f"most {change} there."
    )


def panels(maps: WorkspaceMaps) -> str:
    """Return the caption of the maps of tension and of its ratio to the one without sag."""
    shown = f"Largest tension, and its ratio to the tension without sag, {_place_of(maps)}."
    ratio = RATIO.of(maps.section)
    if not np.isfinite(ratio).any():
        return shown
    return (
        f"{shown} Who ignores sag misses a factor of up to {fmt.factor(float(np.nanmax(ratio)))}."
    )


def largest_change(maps: WorkspaceMaps) -> float:
    """Return by what share sag changes the largest tension at most over the section; else zero."""
    ratio = RATIO.of(maps.section)
    return float(np.nanmax(np.abs(ratio - 1.0))) if np.isfinite(ratio).any() else 0.0


def edge(maps: WorkspaceMaps) -> str:
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
        None if distance is None or distance < _NEGLIGIBLE * profile.region_distance_m else distance
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


def served(found: Served) -> str:
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


def _place_of(maps: WorkspaceMaps) -> str:
    if maps.is_upright:
        return "over the region, seen from the side" if maps.has_area else "at each point"
    return "at the top of the region" if maps.has_area else "at each point, seen from above"


def candidates(selection: SelectionResult) -> str:
    """Return the caption of the grades and their sizes."""
    text = (
        "Each grade: the sizes that are sold, the diameter that the workspace needs, the best size "
        "that holds and the mass of all cables of it."
    )
    if selection.alternatives:
        text += " A star marks grades that the study does not allow."
    return text


def pareto(selection: SelectionResult) -> str:
    """Return the caption of the sizes that hold."""
    text = "Every size that holds, by what sizes are compared by"
    if not any(MEANINGS[objective].more_is_better for objective in selection.objectives):
        text += "; better is further left and further down"
    text += ". A size of which a figure is not known is not in that panel."
    if len(selection.front) > 1:
        text += " Numbers are the rows of the table below."
    return text


def usable(found: Usable, chosen: Candidate | None) -> str:
    """Return the caption of how much of the workspace each size serves.

    Only of the chosen size is it proved between the samples that it serves all.
    """
    text = f"How much of the workspace each size of {found.grade.id} serves."
    whole = next((one.size for one in found.sizes if one.fraction == 1.0), None)
    if chosen is None or whole is not chosen.size:
        return text
    return f"{text} The chosen {whole.id} is the thinnest that serves all of it."


def layers(found: Usable) -> str:
    """Return the caption of the layers that sizes serve."""
    text = f"Where sizes of {found.grade.id} may go, a part of the region cut away:"
    if found.is_nested:
        return f"{text} each serves its own layer and those of all thinner ones."
    return (
        f"{text} each part has the colour of the thinnest of them that serves there. Not all "
        "thicker ones serve there too; the table says which."
    )


def stiffness(analysis: Analysis) -> str:
    """Return the caption of the map of displacements."""
    return (
        "Displacement of the platform under a force in its worst direction, at the middle height "
        f"of the region{_first_orientation(analysis)}."
    )


def clearance(analysis: Analysis) -> str:
    """Return the caption of the map of clearances."""
    return (
        "Smallest distance between two cables, or between a cable and the platform, at the middle "
        f"height of the region{_first_orientation(analysis)}."
    )


def _first_orientation(analysis: Analysis) -> str:
    workspace = analysis.study.workspace
    if workspace is None or workspace.orientations.is_level:
        return ""
    if workspace.orientations.range_rad is not None:
        return ", in the middle of the range of orientations"
    return ", in the first of the orientations" if workspace.orientations.count > 1 else ""
