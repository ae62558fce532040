"""Numbers that captions of maps name; filters of templates."""

from __future__ import annotations

import numpy as np

from designer.analysis.edge import EdgeProfile
from designer.analysis.maps import Served, WorkspaceMaps
from designer.report import format as fmt
from designer.report.figures.colours import DIAMETER, RATIO

LITTLE = 0.02
"""A share by which sag may change a tension without a figure of that being worth its place."""
_NEAR = 0.005
"""A distance from the edge, over that of the region, that is none."""


def edges(maps: WorkspaceMaps) -> str:
    """Return the extent of the region such as ``464 × 402 × 160``, in metres."""
    size = np.ptp(maps.region.bounds_m, axis=0)
    return " × ".join(fmt.trimmed(float(edge), 3) for edge in size if edge > 0.0)


def diameters_m(maps: WorkspaceMaps) -> tuple[float, float] | None:
    """Return the least and the largest needed diameter [m] that the region in space shows."""
    values = np.concatenate([DIAMETER.of(field).ravel() for field in maps.shown])
    values = 1e-3 * values[np.isfinite(values)]
    return (float(values.min()), float(values.max())) if len(values) else None


def is_partly_held(maps: WorkspaceMaps) -> bool:
    """Return whether there are poses among those that no cable holds."""
    return any(field.is_infeasible.any() for field in maps.shown)


def largest_ratio(maps: WorkspaceMaps) -> float:
    """Return the largest tension with sag over that without; NaN where there is none."""
    ratio = RATIO.of(maps.section)
    return float(np.nanmax(ratio)) if np.isfinite(ratio).any() else float("nan")


def largest_change(maps: WorkspaceMaps) -> float:
    """Return by what share sag changes the largest tension at most over the section; else zero."""
    ratio = RATIO.of(maps.section)
    return float(np.nanmax(np.abs(ratio - 1.0))) if np.isfinite(ratio).any() else 0.0


def sag_matters(maps: WorkspaceMaps) -> bool:
    """Return whether a map of the effect of sag on the tension is worth its place."""
    return largest_change(maps) > LITTLE


def ends_of_holding(profile: EdgeProfile) -> tuple[float | None, float | None]:
    """Return how far from the edge cables hold no more, and straight ones; None at the edge [m]."""
    assert profile.region_distance_m is not None
    near_m = _NEAR * profile.region_distance_m
    last, straight = (
        None if distance is None or distance < near_m else distance
        for distance in (profile.limit_distance_m, profile.straight_distance_m)
    )
    return last, straight


def diameter_of_nine_tenths_m(served: Served) -> float | None:
    """Return the diameter that serves nine poses of ten [m]; None where none does."""
    most = np.flatnonzero(served.share >= 0.9)
    return float(served.diameter_m[most[0]]) if len(most) else None
