"""The way from the middle of the region outward, to the first pose that is not held."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from designer.analysis.field import RegionField, field_at
from designer.arrays import BoolArray, FloatArray, VerdictArray
from designer.model import polygon
from designer.model.region import Prism
from designer.model.verdict import Verdict, are_open
from designer.study import Study

_LIMIT = 1e-7
"""Error of the limit over the way to the edge; nearer it is not proved that no cable holds."""


@dataclass(frozen=True, slots=True, eq=False)
class EdgeProfile:
    """Sizing along a level line from the centre of the region to the hull of the exit points.

    Parameters
    ----------
    distance_m : array (n,)
        Distance to the hull's edge along the line, descending to zero [m].
    field : RegionField
        Sizing at these positions (n,).
    focus_distance_m : float
        Distance of the pose that the line was laid through [m].
    region_distance_m : float or None
        Where the line leaves the region [m]; None for a list of points.
    limit_distance_m : float or None
        Where the first pose that is not held lies, on the way outward [m]; farther out some may be
        held again. None where all are held, and where the centre is not.
    straight_distance_m : float or None
        Where the first pose lies that straight cables cannot hold, so that a cable has to hang as a
        counterweight [m]; None as above.
    """

    distance_m: FloatArray
    field: RegionField
    focus_distance_m: float
    region_distance_m: float | None
    limit_distance_m: float | None
    straight_distance_m: float | None = None

    @property
    def holds_again(self) -> bool:
        """Whether poses beyond the first that is not held are held."""
        return bool((self._beyond == Verdict.SOLVED).any())

    @property
    def is_proved(self) -> bool:
        """Whether no cable can hold what is not held beyond the limit, instead of none found."""
        return not are_open(self._beyond).any()

    @property
    def _beyond(self) -> VerdictArray:
        limit = -np.inf if self.limit_distance_m is None else self.limit_distance_m
        return self.field.verdict[self.distance_m < limit]

    @property
    def stretches_not_held_m(self) -> list[tuple[float, float]]:
        """Distances at which each stretch of poses that are not held starts and stops [m]."""
        x, failed = self.distance_m, ~self.field.is_solved
        turns = np.flatnonzero(np.diff(failed)) + 1
        between = 0.5 * (x[turns - 1] + x[turns])
        if self.limit_distance_m is not None:
            between[0] = self.limit_distance_m
        ends = [*x[:1][failed[:1]].tolist(), *between.tolist(), *([0.0] if failed[-1] else [])]
        return list(zip(ends[::2], ends[1::2], strict=True))


def edge_profile(study: Study, focus_m: FloatArray) -> EdgeProfile | None:
    """Size the level line from the centre of the region through a pose to the edge of the hull.

    The line runs at the height of ``focus_m`` (3,) [m], and through it; where that lies in the
    centre, to the nearest edge. None where the centre of the region lies outside the hull of the
    exit points, the region or the robot lies in an upright plane, or things do not fall along z.
    """
    assert study.workspace is not None
    region = study.workspace.region
    is_tilted = study.robot.gravity_direction[:2].any()
    if region.is_upright or study.robot.is_planar or is_tilted:
        return None
    hull = Prism.over(study.robot.exit_points_m, 0.0, (0.0, 0.0)).polygon_m
    centre = region.centre_m
    if not Prism(hull, (-1.0, 1.0)).contains(np.array([*centre, 0.0])):
        return None
    azimuth = _azimuth_rad(hull, centre, focus_m)
    reach = polygon.reach_m(hull, centre, azimuth)
    ray = np.array([np.cos(azimuth), np.sin(azimuth), 0.0])

    def at(distance_m: FloatArray) -> RegionField:
        start = np.array([*centre, focus_m[2]])
        return field_at(study, start + (reach - distance_m)[:, None] * ray)

    distance = reach * np.linspace(1.0, 0.0, 400) ** 2  # denser toward the edge
    field = at(distance)
    inside = region.reach_m(centre, azimuth)
    return EdgeProfile(
        distance_m=distance,
        field=field,
        focus_distance_m=reach - float(np.hypot(*(focus_m[:2] - centre))),
        region_distance_m=None if inside is None else reach - inside,
        limit_distance_m=first_failure_m(at, distance, field, lambda stretch: stretch.is_solved),
        straight_distance_m=first_failure_m(
            at, distance, field, lambda stretch: stretch.is_held_straight
        ),
    )


def _azimuth_rad(hull: FloatArray, centre: FloatArray, focus_m: FloatArray) -> float:
    """Direction to the focus, or to the nearest edge where the focus is in the centre."""
    offset = focus_m[:2] - centre
    if np.hypot(*offset) > 1e-6 * np.ptp(hull, axis=0).max():
        return float(np.arctan2(offset[1], offset[0]))
    around = np.linspace(-np.pi, np.pi, 361)
    return float(around[np.argmin([polygon.reach_m(hull, centre, a) for a in around])])


def first_failure_m(
    at: Callable[[FloatArray], RegionField],
    distance_m: FloatArray,
    field: RegionField,
    is_held: Callable[[RegionField], BoolArray],
) -> float | None:
    """Return where the first pose that is not held lies, on the way outward [m].

    Bisects between two of the descending distances (n,) [m], ``field`` being that at all of them.
    None where all poses are held, and where the first is not.
    """
    from scipy.optimize import bisect

    failed = np.flatnonzero(~is_held(field))
    if len(failed) == 0 or failed[0] == 0:
        return None

    def sign(distance_m: float) -> float:
        return 1.0 if is_held(at(np.array([distance_m])))[0] else -1.0

    ends = distance_m[failed[0] - 1], distance_m[failed[0]]
    return float(bisect(sign, *ends, xtol=_LIMIT * distance_m[0]))
