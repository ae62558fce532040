"""The smallest distance among the cables, and between them and the platform: of poses, of a region.

Each cable is taken in its true shape. A first pass over coarse pieces with a bound on what these
cut off finds which cables can come nearest; a second one looks at finer pieces there. Distances
are from axis to axis: half the diameters are not taken off.

Cables that share an exit point or an attachment are not compared: they hang in two vertical planes
that meet in the upright line through that point, and there they part. A cable is compared with the
platform's hull but for its last piece, which is meant to be near: see `cable_margin_m`.

Over a workspace some samples are looked at first, then what lies between them is searched.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, fields, replace
from itertools import combinations, pairwise
from typing import Any

import numpy as np

from designer.arrays import FloatArray, IntArray
from designer.kernel.calling import plain
from designer.model.cable import Cable, Cables
from designer.model.robot import Poses, Robot
from designer.model.workspace import Workspace
from designer.physics import catenary
from designer.statics.geometry import upright_poses
from designer.statics.inverse import Statics, solve_sagging
from designer.workspace.demand import is_counted, is_left_out
from designer.workspace.effort import CLEARANCE
from designer.workspace.refine import LIGHT, ONE_CLIMB, places_of, refine

PLATFORM = -1
"""Stands for the platform where a pair is a cable and the platform."""
_FLAT = 1e-9
"""Relative: below it a hull has no extent in a direction."""
_ROUGH, _COARSE, _FINE = 8, 24, 12
"""Pieces of a cable: where only starts are sought, in the first pass, and in each finer one."""
_FINER_PASSES = 3
_COINCIDENT = 1e-9
"""Relative: points of cables no farther apart are the same."""
_CHUNK = 256


@dataclass(frozen=True, slots=True, eq=False)
class Hull:
    """A convex body, or a flat one without a volume."""

    triangles_m: FloatArray  #: (n_triangles, 3, 3): Its surface, body frame [m]
    #: (n_faces, 4): Outward unit normals and offsets: `normal · x + offset ≤ 0` for all of them in
    # the body, and for no other point [-, m]
    halfspaces: FloatArray

    @property
    def extent_m(self) -> float:
        """Largest distance of two of its corners [m]."""
        corners = self.triangles_m.reshape(-1, 3)
        return float(np.linalg.norm(corners[:, None] - corners, axis=-1).max())

    def heights_m(self, points_m: FloatArray) -> FloatArray:
        """Return how far points (..., 3) lie beyond each face (..., n_faces) [m]."""
        return np.asarray(points_m @ self.halfspaces[:, :3].T + self.halfspaces[:, 3])

    def depth_m(self, points_m: FloatArray) -> FloatArray:
        """Return how far below the surface points (..., 3) lie; zero outside [m]."""
        return np.asarray(np.maximum(-self.heights_m(points_m).max(axis=-1), 0.0))


def platform_hull(robot: Robot) -> Hull | None:
    """Return the hull that the study gives, or that of the attachments; None for a point mass.

    None as well where all attachments lie on one line.
    """
    if robot.is_point_mass:
        return None
    hull_m = robot.platform.hull_m
    corners = robot.attachments_m if hull_m is None else hull_m
    middle = corners.mean(axis=0)
    _, spread, axes = np.linalg.svd(corners - middle)
    if spread[1] <= _FLAT * spread[0]:
        return None
    from scipy.spatial import ConvexHull

    if spread[2] > _FLAT * spread[0]:
        hull = ConvexHull(corners)
        return Hull(corners[hull.simplices], hull.equations)
    # A convex polygon, as a fan of triangles, between two faces and within its edges.
    outline = ConvexHull((corners - middle) @ axes[:2].T)
    ring = corners[outline.vertices]
    fan = [np.stack([ring[0], b, c]) for b, c in pairwise(ring[1:])]
    edges = outline.equations[:, :2] @ axes[:2]
    normals = np.concatenate([axes[2:], -axes[2:], edges])
    within = np.concatenate([[0.0, 0.0], outline.equations[:, 2]])
    return Hull(np.array(fan), np.column_stack([normals, within - normals @ middle]))


@dataclass(frozen=True, slots=True, eq=False)
class Curves:
    """Cables of many poses, any of which can be sampled anywhere."""

    start_m: FloatArray  #: (n_curves, 3): Where they leave base or pulley, upright frame [m]
    outward: FloatArray  #: (n_curves, 2): Horizontal unit vector of the plane that each hangs in
    #: (n_curves,): As in `designer.physics.catenary`; the length is that from pulley to platform
    length_m: FloatArray
    force_x_N: FloatArray
    force_z_N: FloatArray
    axial_stiffness_N: FloatArray
    weight_N_per_m: FloatArray

    @classmethod
    def of(cls, statics: Statics) -> Curves:
        """Return the cables of poses (n_poses,), cable by cable within pose by pose."""
        shape = statics.length_m.shape

        def flat(values: FloatArray) -> FloatArray:
            return np.broadcast_to(values, shape).reshape(-1)

        return cls(
            start_m=np.broadcast_to(statics.run.exit_points_m, (*shape, 3)).reshape(-1, 3),
            outward=statics.geometry().outward.reshape(-1, 2),
            length_m=flat(statics.free_length_m),
            force_x_N=flat(statics.force_x_N),
            force_z_N=flat(statics.force_z_N),
            axial_stiffness_N=flat(statics.axial_stiffness_N),
            weight_N_per_m=flat(statics.weight_N_per_m),
        )

    def polylines(
        self, which: IntArray, low: FloatArray, high: FloatArray, segments: int
    ) -> Polylines:
        """Return polylines through points of the curves, evenly spaced in unstrained length.

        Of the curves of these numbers (n,), each from ``low`` to ``high`` (n,), shares of its
        unstrained length.
        """
        share = low[:, None] + (high - low)[:, None] * np.linspace(0.0, 1.0, segments + 1)
        length = self.length_m[which, None]
        s = share * length
        F_x, F_z = self.force_x_N[which, None], self.force_z_N[which, None]
        EA, w = self.axial_stiffness_N[which, None], self.weight_N_per_m[which, None]
        x, z = catenary.position_m(s, length, F_x, F_z, EA, w)
        plan = x[..., None] * self.outward[which, None, :]
        points = self.start_m[which, None, :] + np.concatenate([plan, z[..., None]], axis=-1)
        slope = np.arctan2(F_z + w * (s - length), F_x)
        # A convex plane arc lies in the triangle of its chord and its end tangents; with a turn φ
        # from one tangent to the other its height is at most c/2 tan(φ/2). Where the arc folds
        # over, it is still no farther from the chord's ends than half its length, here bounded by
        # the triangle of a nearly full turn.
        chord = np.linalg.norm(np.diff(points, axis=-2), axis=-1)
        angle = np.minimum(np.abs(np.diff(slope, axis=-1)), 0.999 * np.pi)
        return Polylines(points, share, 0.5 * chord * np.tan(0.5 * angle))


@dataclass(frozen=True, slots=True, eq=False)
class Polylines:
    """Points of curves, and how far the curves stray from the straight pieces between them."""

    points_m: FloatArray  #: (n, segments + 1, 3): Upright frame [m]
    share: FloatArray  #: (n, segments + 1): Where they lie, as shares of the unstrained length
    #: (n, segments): No point of the curve is farther than this from its straight piece [m]
    sagitta_m: FloatArray


def names_of(pair: tuple[int, int]) -> tuple[str, str]:
    """Return names of what a pair of numbers stands for, cables counted from 1."""
    first, second = pair
    return (
        f"cable {first + 1}",
        "the platform" if second == PLATFORM else f"cable {second + 1}",
    )


@dataclass(frozen=True, slots=True, eq=False)
class Clearance:
    """How near things come in each pose; NaN where it is not solved or nothing is compared."""

    distance_m: FloatArray  #: (...): Smallest distance [m]
    #: (..., 2) of int: Between which: numbers of two cables from 0, or of a cable and `PLATFORM`
    pair: IntArray
    place_m: FloatArray  #: (..., 3): Where, base frame [m]
    #: (...): The true distance is smaller than `distance_m` by no more than this [m]
    error_m: FloatArray

    def each(self) -> Iterator[Any]:
        """Yield the four arrays."""
        return (getattr(self, field.name) for field in fields(self))

    def nearer(self, clearance: Clearance) -> Clearance:
        """Return in each pose the one of two whose distance is smaller."""
        theirs = clearance.distance_m < np.nan_to_num(self.distance_m, nan=np.inf)

        def smaller(mine: Any, its: Any) -> Any:
            apart = theirs.reshape(theirs.shape + (1,) * (mine.ndim - theirs.ndim))
            return np.where(apart, its, mine)

        return Clearance(*map(smaller, self.each(), clearance.each()))


def clearance_among_cables(statics: Statics) -> Clearance:
    """Return how near two cables come to each other in poses (...)."""
    return _in_chunks(statics, _among_cables)


def clearance_to_platform(statics: Statics) -> Clearance:
    """Return how near a cable comes to the platform in poses (...), but for its last piece."""
    return _in_chunks(statics, _to_hull)


def smallest_clearance(statics: Statics) -> Clearance:
    """Return the smaller of `clearance_among_cables` and `clearance_to_platform` in poses (...)."""
    return clearance_among_cables(statics).nearer(clearance_to_platform(statics))


def distances_among_cables_m(statics: Statics) -> FloatArray:
    """Return how near those of each pair come (n_poses, n_pairs), along rough pieces [m].

    Of `cable_pairs`, in poses (n_poses,); NaN where a pose is not solved.
    """
    pairs = cable_pairs(statics.robot)
    distance = np.full((len(statics.verdict), len(pairs)), np.nan)
    for rows in _solved_chunks(statics):
        lines = _whole(Curves.of(statics.part(rows)), _ROUGH)
        row, kind = np.indices((len(rows), len(pairs))).reshape(2, -1)
        first, second = row * statics.robot.n_cables + pairs[kind].T
        between, _, _ = _pieces(lines.points_m[first], lines.points_m[second])
        distance[rows] = between.reshape(len(rows), len(pairs))
    return distance


def _solved_chunks(statics: Statics) -> list[IntArray]:
    solved = np.flatnonzero(statics.is_solved)
    return [solved[at : at + _CHUNK] for at in range(0, len(solved), _CHUNK)]


def _whole(curves: Curves, pieces: int) -> Polylines:
    """Return the curves from end to end."""
    count = len(curves.length_m)
    return curves.polylines(np.arange(count), np.zeros(count), np.ones(count), pieces)


def _in_chunks(
    statics: Statics, function: Callable[[Statics, Curves], tuple[IntArray, Clearance] | None]
) -> Clearance:
    """Enter the smallest distance of each pose, of all that may be it in some of the poses."""
    shape = statics.verdict.shape
    n = int(np.prod(shape, dtype=np.int64))
    missing = np.full(n, np.nan), np.full((n, 2), PLATFORM), np.full((n, 3), np.nan)
    clearance = Clearance(*missing, np.full(n, np.nan))
    for rows in _solved_chunks(statics):
        poses = statics.part(rows)
        part = function(poses, Curves.of(poses))
        if part is None:
            break
        row, candidates = part
        # In descending order the last entry of each pose, its smallest, is what stays.
        order = np.argsort(-candidates.distance_m, kind="stable")
        for all_of, values in zip(clearance.each(), candidates.each(), strict=True):
            all_of[rows[row[order]]] = values[order]
    return Clearance(*(all_of.reshape((*shape, *all_of.shape[1:])) for all_of in clearance.each()))


def cable_pairs(robot: Robot) -> IntArray:
    """Return the pairs of cables (n_pairs, 2) that share neither an exit point nor an attachment.

    Cable i of pose k is curve k · n_cables + i of `Curves`.
    """
    size = float(np.linalg.norm(np.ptp(robot.exit_points_m, axis=0)))

    def apart(points: FloatArray, i: int, j: int) -> bool:
        return bool(np.linalg.norm(points[i] - points[j]) > _COINCIDENT * size)

    pairs = [
        (i, j)
        for i, j in combinations(range(robot.n_cables), 2)
        if apart(robot.exit_points_m, i, j) and apart(robot.attachments_m, i, j)
    ]
    return np.array(pairs, dtype=np.int64).reshape(-1, 2)


def cable_margin_m(robot: Robot, hull: Hull) -> FloatArray:
    """Return the end of each cable (n_cables,) that is not compared with the hull [m].

    A quarter of the hull's largest extent, and the way out of the hull for an attachment inside
    it. A straight cable that leaves the hull at an angle ψ is then told if the clearance is more
    than sin ψ times that quarter.
    """
    return np.asarray(0.25 * hull.extent_m + hull.depth_m(robot.attachments_m))


def _among_cables(statics: Statics, curves: Curves) -> tuple[IntArray, Clearance] | None:
    robot, pairs = statics.robot, cable_pairs(statics.robot)
    if len(pairs) == 0:
        return None
    n, coarse = robot.n_cables, _whole(curves, _COARSE)
    row, kind = _candidates(coarse, n, pairs)
    first, second = row * n + pairs[kind].T
    pieces = [_pick(coarse, first), _pick(coarse, second)]
    distance, middle, at = _between(*pieces)
    error = coarse.sagitta_m[first].max(axis=-1) + coarse.sagitta_m[second].max(axis=-1)
    for _ in range(_FINER_PASSES):
        pieces = [
            curves.polylines(which, *_around(piece, index), _FINE)
            for which, piece, index in zip((first, second), pieces, at, strict=True)
        ]
        distance, middle, at = _between(*pieces)
    return row, Clearance(distance, pairs[kind], middle @ robot.upright, error)


def _candidates(coarse: Polylines, n: int, pairs: IntArray) -> tuple[IntArray, IntArray]:
    """Return pose and pair where the cables can come nearer than any others surely do.

    A cable is nowhere farther from its chord than its lowest point and what a piece cuts off.
    """
    points = coarse.points_m.reshape(-1, n, *coarse.points_m.shape[1:])
    start, end = points[:, :, 0], points[:, :, -1]
    chord = end - start
    unit = chord / np.linalg.norm(chord, axis=-1, keepdims=True)
    off = points - start[:, :, None]
    off = off - np.einsum("pnsk,pnk->pns", off, unit)[..., None] * unit[:, :, None]
    sag = np.linalg.norm(off, axis=-1).max(axis=-1)
    sag = sag + coarse.sagitta_m.max(axis=-1).reshape(-1, n)
    i, j = pairs.T
    chords = np.stack([start, end], axis=-2)
    straight, _, _ = _pieces(chords[:, i].reshape(-1, 2, 3), chords[:, j].reshape(-1, 2, 3))
    straight = straight.reshape(-1, len(pairs))
    sag_sum = sag[:, i] + sag[:, j]
    surely = (straight + sag_sum).min(axis=-1, keepdims=True)
    row, kind = np.nonzero(straight - sag_sum <= surely)
    return row, kind


def _to_hull(statics: Statics, curves: Curves) -> tuple[IntArray, Clearance] | None:
    robot = statics.robot
    hull = platform_hull(robot)
    if hull is None:
        return None
    n, count = robot.n_cables, len(statics.verdict)
    share = 1.0 - np.tile(cable_margin_m(robot, hull), count) / curves.length_m
    which = np.flatnonzero(share > 0.0)
    coarse = curves.polylines(which, np.zeros(len(which)), share[which], _COARSE)
    poses = upright_poses(robot, statics.poses)
    body = _in_body(coarse.points_m, poses, which // n)
    at, segment = _near_hull(hull, body, coarse.sagitta_m, which // n)
    which, error = which[at], coarse.sagitta_m.max(axis=-1)[at]
    low, high = coarse.share[at, segment], coarse.share[at, segment + 1]
    row = which // n
    for _ in range(_FINER_PASSES):
        piece = curves.polylines(which, low, high, _FINE)
        distance, place, nearest = _hull_distance(hull, _in_body(piece.points_m, poses, row))
        low, high = _around(piece, nearest)
    world = np.einsum("nb,nkb->nk", place, poses.rotation[row]) + poses.position_m[row]
    pair = np.stack([which % n, np.full(len(which), PLATFORM)], axis=-1)
    return row, Clearance(distance, pair, world @ robot.upright, error)


def _in_body(points_m: FloatArray, poses: Poses, row: IntArray) -> FloatArray:
    """Return points (n, ·, 3) of poses ``row`` in the body frame [m]."""
    away = points_m - poses.position_m[row, None]
    return np.asarray(np.einsum("nsk,nkb->nsb", away, poses.rotation[row]))


def _near_hull(
    hull: Hull, body_m: FloatArray, sagitta_m: FloatArray, row: IntArray
) -> tuple[IntArray, IntArray]:
    """Return polylines and their pieces that can come nearer than the nearest of the last points.

    A straight piece is nowhere nearer to the body than to the face that both its ends are beyond.
    """
    surely, _, _ = _faces(body_m[:, [-1, -1]], hull.triangles_m)
    least = np.full(int(row.max(initial=-1)) + 1, np.inf)
    np.minimum.at(least, row, surely)
    heights = hull.heights_m(body_m)
    lowest = np.minimum(heights[:, :-1], heights[:, 1:]).max(axis=-1) - sagitta_m
    line, piece = np.nonzero(lowest <= least[row, None])
    return line, piece


def _hull_distance(hull: Hull, body_m: FloatArray) -> tuple[FloatArray, FloatArray, IntArray]:
    """Return distance, place and number of the nearest piece of polylines (n, segments + 1, 3)."""
    distance, place, at = _faces(body_m, hull.triangles_m)
    inside = hull.heights_m(body_m).max(axis=-1) < 0.0
    rows = np.flatnonzero(inside.any(axis=-1))
    first = inside[rows].argmax(axis=-1)
    distance[rows], place[rows] = 0.0, body_m[rows, first]
    at[rows] = np.minimum(first, body_m.shape[1] - 2)
    return distance, place, at


def _between(
    first: Polylines, second: Polylines
) -> tuple[FloatArray, FloatArray, tuple[IntArray, IntArray]]:
    """Return distance, middle and nearest pieces of polylines, one by one."""
    distance, middle, at = _pieces(first.points_m, second.points_m)
    return distance, middle, (at[:, 0], at[:, 1])


def _pieces(first_m: FloatArray, second_m: FloatArray) -> tuple[FloatArray, FloatArray, IntArray]:
    from designer.kernel.distance import nearest_pieces

    count = len(first_m)
    distance, middle = np.empty(count), np.empty((count, 3))
    at = np.zeros((count, 2), dtype=np.int64)
    nearest_pieces(plain(first_m), plain(second_m), distance, middle, at)
    return distance, middle, at


def _faces(lines_m: FloatArray, triangles_m: FloatArray) -> tuple[FloatArray, FloatArray, IntArray]:
    from designer.kernel.distance import nearest_faces

    count = len(lines_m)
    distance, place = np.empty(count), np.empty((count, 3))
    at = np.zeros(count, dtype=np.int64)
    nearest_faces(plain(lines_m), plain(triangles_m), distance, place, at)
    return distance, place, at


def _around(piece: Polylines, at: IntArray) -> tuple[FloatArray, FloatArray]:
    """Return the part of a polyline from the piece before the nearest to the one after it."""
    rows = np.arange(len(at))
    last = piece.share.shape[1] - 1
    return piece.share[rows, np.maximum(at - 1, 0)], piece.share[rows, np.minimum(at + 2, last)]


def _pick(lines: Polylines, which: IntArray) -> Polylines:
    return Polylines(lines.points_m[which], lines.share[which], lines.sagitta_m[which])


@dataclass(frozen=True, slots=True, eq=False)
class Nearest:
    """The pose in which two things come nearest to each other."""

    distance_m: float  #: how near [m]
    error_m: float  #: the true distance there is smaller by no more than this [m]
    pair: tuple[int, int]  #: two cables, from 0, or a cable and `PLATFORM`
    place: FloatArray  #: (n_coordinates,) see `designer.model.space` [m, rad]
    point_m: FloatArray  #: (3,) where the two are nearest, base frame [m]

    @property
    def names(self) -> tuple[str, str]:
        """Names of the two, cables counted from 1."""
        return names_of(self.pair)


@dataclass(frozen=True, slots=True, eq=False)
class Interference:
    """Clearances over the workspace."""

    clearance_m: float  #: what is asked for [m]
    samples: int  #: poses that were looked at and count
    violating: int  #: those of them that keep less
    #: worst pose for two cables; None where no two cables can be compared
    among_cables: Nearest | None
    to_platform: Nearest | None  #: worst pose for a cable and the platform; None for a point mass

    @property
    def worst(self) -> Nearest | None:
        """The nearer of the two."""
        clearances = [
            clearance
            for clearance in (self.among_cables, self.to_platform)
            if clearance is not None
        ]
        return min(clearances, key=lambda clearance: clearance.distance_m, default=None)

    @property
    def is_violated(self) -> bool:
        """Whether less than the clearance is kept somewhere, as far as was looked."""
        return self.worst is not None and self.worst.distance_m < self.clearance_m


def where_pairs_are_near(
    robot: Robot, workspace: Workspace, cable: Cable | Cables, places: FloatArray
) -> FloatArray:
    """Return where each pair of cables comes near (n, n_coordinates), by a short climb from places.

    Starts for a search of the smallest clearance: some pairs cross in so small a part of the space
    that no sample shows it. None in a space in which every place is tried.
    """

    def nearness(places: FloatArray) -> FloatArray:
        statics = solve_sagging(robot, Poses.at(places), cable)
        distance = distances_among_cables_m(statics)
        distance[is_left_out(statics, workspace.hangs_below)] = np.nan
        return -np.nan_to_num(distance, nan=np.inf)

    space = workspace.space
    if space.is_discrete or not len(cable_pairs(robot)):
        return np.empty((0, space.n_coordinates))
    return places_of(refine(space, nearness, places, ONE_CLIMB))


def survey(
    robot: Robot, workspace: Workspace, cable: Cable | Cables, clearance_m: float
) -> Interference:
    """Look for the smallest clearances in a workspace: `CLEARANCE` first, then between them."""
    thinned = workspace.thinned(CLEARANCE)
    statics = solve_sagging(robot, Poses.at(thinned), cable)

    def counted(among: Callable[[Statics], Clearance], statics: Statics) -> Clearance:
        clearance, is_out = among(statics), is_left_out(statics, workspace.hangs_below)
        return replace(clearance, distance_m=np.where(is_out, np.nan, clearance.distance_m))

    cables = counted(clearance_among_cables, statics)
    platform = counted(clearance_to_platform, statics)

    def nearest(
        among: Callable[[Statics], Clearance], sampled: Clearance, starts: FloatArray
    ) -> Nearest | None:
        def clearance(places: FloatArray) -> Clearance:
            poses = Poses.at(places)
            return counted(among, solve_sagging(robot, poses, cable))

        def nearness(places: FloatArray) -> FloatArray:
            return -np.nan_to_num(clearance(places).distance_m, nan=np.inf)

        if np.isnan(sampled.distance_m).all():
            return None
        (worst,) = refine(workspace.space, nearness, starts, LIGHT)
        closest = clearance(worst.place[None])
        first, second = (int(number) for number in closest.pair[0])
        return Nearest(
            distance_m=float(closest.distance_m[0]),
            error_m=float(closest.error_m[0]),
            pair=(first, second),
            place=worst.place,
            point_m=closest.place_m[0],
        )

    starts_near = np.concatenate([thinned, where_pairs_are_near(robot, workspace, cable, thinned)])
    return Interference(
        clearance_m=clearance_m,
        samples=int(is_counted(statics, workspace.hangs_below).sum()),
        violating=int((cables.nearer(platform).distance_m < clearance_m).sum()),
        among_cables=nearest(clearance_among_cables, cables, starts_near),
        to_platform=nearest(clearance_to_platform, platform, thinned),
    )
